"""Operators that give presets to objects, and fit their colour to them."""

import bpy

from ...model.parameter import ParameterError
from ...nodes.compatibility import UnsupportedError
from ...scene import media
from ...scene.preset_library import catalogue, load_preset
from ...scene.preset_materials import edited_material, fit_depth, preset_material, preset_of
from ...scene.preset_values import measured_depth
from ...scene.shapes import thickness
from ..active_medium import active_medium, has_editable_medium
from ..polls import supported
from ..preferences import DEPTHS, EDITED, FIT, MATERIALS, MEASURED, preference
from .preset_pictures import items, searched_items


def targets(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Return the selected objects that can be media, or else the active object."""
    selected = [obj for obj in context.selected_editable_objects or () if obj.type in media.SOLID_TYPES]
    return selected or [obj for obj in [context.object] if obj is not None and obj.type in media.SOLID_TYPES]


class AssignPreset(bpy.types.Operator):
    """Assign a preset to objects."""

    bl_idname = "nested_dielectric.assign_preset"
    bl_label = "Assign Preset"
    bl_description = "Make the selected objects media of a preset: glass, water, wine, gems and others"
    bl_options = {"REGISTER", "UNDO"}
    bl_property = "found"

    preset: bpy.props.EnumProperty(
        name="Preset", description="What the objects are to be", items=lambda self, context: items()
    )
    found: bpy.props.EnumProperty(
        name="Found", items=lambda self, context: searched_items(), options={"HIDDEN", "SKIP_SAVE"}
    )
    material: bpy.props.EnumProperty(
        name="Material",
        description="What to do where the file's material of the preset was edited",
        items=MATERIALS,
        options={"SKIP_SAVE"},
    )
    depth: bpy.props.EnumProperty(
        name="Depth", description="How thick a body shows the preset's colour", items=DEPTHS, options={"SKIP_SAVE"}
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        preset = catalogue().presets.get(properties.preset) if properties.is_property_set("preset") else None
        if preset is None:
            return cls.bl_description
        return f"Make the selected objects {preset.name}: {preset.description.rstrip('.')}"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not targets(context):
            cls.poll_message_set("Select a mesh, curve, surface, text or metaball")
            return False
        return supported(cls)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        for name in ("material", "depth"):
            if not self.properties.is_property_set(name):
                setattr(self, name, preference(name))
        if self.properties.is_property_set("preset"):
            return self.execute(context)
        context.window_manager.invoke_search_popup(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        if self.properties.is_property_set("found"):
            self.preset = self.found
            self.property_unset("found")
        objects = targets(context)
        try:
            loaded = load_preset(self.preset)
            edited = edited_material(loaded, objects)
            material = preset_material(loaded, objects, fit=self.depth == FIT, use_edited=self.material == EDITED)
            for obj in objects:
                media.assign(obj, material)
        except (ParameterError, UnsupportedError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"{material.name} assigned to {', '.join(obj.name for obj in objects)}")
        if edited is not None and edited != material:
            self.report(
                {"INFO"},
                f"{edited.name!r} was edited, so {material.name!r}, which is as the preset has it, was assigned; "
                "to have the edited one, choose Material: Use Edited",
            )
        elif edited is not None:
            text = f"{edited.name!r} was edited; Material: Clean Copy is as the preset {loaded.name!r} has it"
            self.report({"INFO"}, text)
        return {"FINISHED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "preset")
        preset = load_preset(self.preset)
        choice = layout.column()
        choice.enabled = edited_material(preset, targets(context)) is not None
        choice.prop(self, "material")
        choice = layout.column()
        choice.enabled = preset.has_colour
        choice.prop(self, "depth")


class FitDepth(bpy.types.Operator):
    """Fit the depth of a medium's colour to an object, or to what its preset was measured at."""

    bl_idname = "nested_dielectric.fit_depth"
    bl_label = "Fit Depth"
    bl_description = (
        "Set how thick a body is that shows the medium's colour as it is: thinner ones are paler, thicker ones darker"
    )
    bl_options = {"REGISTER", "UNDO"}

    depth: bpy.props.EnumProperty(
        name="Depth",
        description="How thick a body shows the medium's colour",
        items=(
            (FIT, "Active Object", "As thick as the active object: the mean way through it"),
            (MEASURED, "As Measured", "As thick as what the preset was measured at, in the scene's units"),
        ),
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        how = {
            FIT: "as thick as the active object, the mean way through it",
            MEASURED: "as thick as what its preset was measured at",
        }
        return f"Let the medium have its colour in a body {how[properties.depth]}"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return has_editable_medium(cls, context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        material = active_medium(context)
        try:
            depth = self.wanted(context.object, material)
            fit_depth(material, depth)
        except ParameterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        length = bpy.utils.units.to_string("METRIC", "LENGTH", depth * context.scene.unit_settings.scale_length)
        self.report({"INFO"}, f"{material.name} has its colour in a body {length} thick")
        return {"FINISHED"}

    def wanted(self, obj: bpy.types.Object | None, material: bpy.types.Material) -> float:
        """Return the depth to set, in scene units.

        :raises ParameterError: where there is none.
        """
        if self.depth == MEASURED:
            preset = preset_of(material)
            if preset is None:
                raise ParameterError(f"{material.name!r} knows no preset; fit its depth to the active object")
            return measured_depth(preset)
        if obj is None:
            raise ParameterError("There is no active object to fit the depth to; select one")
        depth = thickness(obj)
        if depth <= 0.0:
            raise ParameterError(f"{obj.name!r} has no thickness; make it a closed mesh")
        return depth


CLASSES = (AssignPreset, FitDepth)
