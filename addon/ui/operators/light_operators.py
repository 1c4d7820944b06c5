"""Operators of a scene's lights: what carries them through media, shadow caustics and passes."""

import bpy

from ...model.choice import Choice
from ...nodes.compatibility import UnsupportedError
from ...scene import lights
from ...scene.caustics import set_shadow_caustics
from ...scene.passes import add_passes
from ..choice_items import choice_items
from ..polls import has_media, supported

LIGHT_TRANSPORTS = (
    Choice(
        lights.LOBE,
        "Lobe",
        "Media show lights in a lobe where their light leaves them: for small lights, which rays hardly find",
    ),
    Choice(lights.RAYS, "Rays", "Cycles' rays find lights, as they find all else"),
)
"""What brings lights through media."""


class LightCarrier(bpy.types.Operator):
    """Choose what carries lights through media."""

    bl_idname = "nested_dielectric.lamp_carrier"
    bl_label = "Refract Lights by Lobe"
    bl_description = "Let lobes or rays bring the selected lights, or all if none is selected, through media"
    bl_options = {"REGISTER", "UNDO"}

    carrier: bpy.props.EnumProperty(name="Carrier", items=choice_items(LIGHT_TRANSPORTS))

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        meaning = next(choice.description for choice in LIGHT_TRANSPORTS if choice.keyword == properties.carrier)
        return f"{meaning}. Sets Ray Visibility > Transmission of the selected lights, or of all if none is selected"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not any(obj.type == "LIGHT" for obj in context.scene.objects):
            cls.poll_message_set("The scene has no light; add one first")
            return False
        return supported(cls)

    def execute(self, context: bpy.types.Context) -> set[str]:
        everything = lights.scene_lights(context.scene)
        chosen = [light for light in everything if light in (context.selected_objects or ())] or everything
        by_rays = self.carrier == lights.RAYS
        changed = []
        for light in chosen:
            reason = "" if by_rays else lights.why_not_lobe(light)
            if not light.is_editable:
                self.report({"WARNING"}, f"{light.name!r} belongs to a library; make it local first")
            elif reason:
                self.report({"WARNING"}, f"{light.name!r} stays with rays, because {reason}")
            elif light.visible_transmission != by_rays:
                light.visible_transmission = by_rays
                changed.append(light.name)
        try:
            updated = lights.update_lights(context.scene)
        except UnsupportedError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if changed:
            self.report({"INFO"}, f"{'Rays' if by_rays else 'Lobes'} refract {', '.join(changed)}")
        elif not updated:
            self.report({"INFO"}, "Nothing to change")
        return {"FINISHED"}


class _SceneOperator(bpy.types.Operator):
    """What operators share that change a scene with media and say what they changed."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return has_media(cls, context) and supported(cls)

    def execute(self, context: bpy.types.Context) -> set[str]:
        for change in self.change(context.scene) or ("Nothing to change",):
            self.report({"INFO"}, change)
        return {"FINISHED"}


class ShadowCaustics(_SceneOperator):
    """Switch Cycles' shadow caustics of a scene on or off."""

    bl_idname = "nested_dielectric.shadow_caustics"
    bl_label = "Shadow Caustics"
    bl_description = (
        "Switch Cycles' shadow caustics on or off: media cast them, all other objects receive them, lights make them"
    )

    enable: bpy.props.BoolProperty(name="Enable", description="Switch shadow caustics on", default=True)

    def change(self, scene: bpy.types.Scene) -> tuple[str, ...]:
        return set_shadow_caustics(scene, self.enable)


class AddPasses(_SceneOperator):
    """Add the passes of direct and indirect light to a scene."""

    bl_idname = "nested_dielectric.add_passes"
    bl_label = "Add Passes"
    bl_description = (
        "Write direct and indirect refraction and reflection to the layers of an OpenEXR file beside the output"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not super().poll(context):
            return False
        if context.scene.render.engine != "CYCLES":
            cls.poll_message_set("Passes need Cycles; prepare the scene first")
            return False
        return True

    def change(self, scene: bpy.types.Scene) -> tuple[str, ...]:
        return add_passes(scene)


CLASSES = (LightCarrier, ShadowCaustics, AddPasses)
