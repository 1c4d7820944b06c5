"""Operators: what the panels' buttons and menus do, each a call of one plain function."""

from functools import cache

import bpy

from . import media
from .compatibility import UnsupportedError, blender_problem
from .parameters import ParameterError
from .preparation import prepare
from .presets import load_preset, preset_names

_SOLID_TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}


@cache
def _preset_items() -> tuple[tuple[str, str, str], ...]:
    """The presets as Blender wants its menus; kept, because Blender does not hold on to the strings itself."""
    presets = [load_preset(key) for key in preset_names()]
    return tuple((preset.key, preset.name, preset.description) for preset in presets)


def _targets(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The selected objects that can be media, or else the active object."""
    selected = [obj for obj in context.selected_editable_objects or () if obj.type in _SOLID_TYPES]
    return selected or [obj for obj in [context.object] if obj is not None and obj.type in _SOLID_TYPES]


def _supported(cls: type[bpy.types.Operator]) -> bool:
    """Grey an operator out, with the reason, in a Blender that cannot render nested dielectrics."""
    problem = blender_problem()
    if problem:
        cls.poll_message_set(problem)
    return not problem


class AssignPreset(bpy.types.Operator):
    """Make the selected objects media of a preset: glass, water, ice and others"""

    bl_idname = "nested_dielectric.assign_preset"
    bl_label = "Assign Nested Dielectric"
    bl_options = {"REGISTER", "UNDO"}

    preset: bpy.props.EnumProperty(name="Preset", items=lambda self, context: _preset_items())

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not _targets(context):
            cls.poll_message_set("Select a mesh, curve, surface, text or metaball")
            return False
        return _supported(cls)

    def execute(self, context: bpy.types.Context) -> set[str]:
        objects = _targets(context)
        try:
            for obj in objects:
                material = media.assign(obj, self.preset)
        except ParameterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"{material.name} assigned to {', '.join(obj.name for obj in objects)}")
        return {"FINISHED"}


class _MediumOperator(bpy.types.Operator):
    """What operators on one medium of the scene share."""

    bl_options = {"REGISTER", "UNDO"}

    name: bpy.props.StringProperty(
        name="Object", description="A medium of the scene; the active object if empty", options={"SKIP_SAVE"}
    )

    def execute(self, context: bpy.types.Context) -> set[str]:
        name = self.name or getattr(context.object, "name", "")
        obj = next((medium for medium in media.media(context.scene) if medium.name == name), None)
        if obj is None:
            scene = context.scene.name
            self.report({"ERROR"}, f"{name!r} is no medium of scene {scene!r}; assign a preset to it first")
            return {"CANCELLED"}
        try:
            return self.change(context, obj)
        except ParameterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}


class PriorityMove(_MediumOperator):
    """Move a medium up or down in the order in which media win over each other"""

    bl_idname = "nested_dielectric.priority_move"
    bl_label = "Move Medium"

    direction: bpy.props.EnumProperty(
        name="Direction",
        items=(
            ("UP", "Up", "Win over one more medium"),
            ("DOWN", "Down", "Give way to one more medium"),
        ),
    )

    def change(self, context: bpy.types.Context, obj: bpy.types.Object) -> set[str]:
        moved = media.move_priority(context.scene, obj, -1 if self.direction == "UP" else 1)
        return {"FINISHED"} if moved else {"CANCELLED"}


class PriorityOwn(_MediumOperator):
    """Give an object a priority of its own, or return it to that of its material"""

    bl_idname = "nested_dielectric.priority_own"
    bl_label = "Own Priority"

    def change(self, context: bpy.types.Context, obj: bpy.types.Object) -> set[str]:
        media.set_priority(obj, media.get_priority(obj) if media.own_priority(obj) is None else None)
        return {"FINISHED"}


class Prepare(bpy.types.Operator):
    """Set what this scene needs to render nested dielectrics, and look for problems with its media"""

    bl_idname = "nested_dielectric.prepare"
    bl_label = "Prepare Scene"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _supported(cls)

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            preparation = prepare(context.scene)
        except UnsupportedError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for change in preparation.changes or ("Nothing to change",):
            self.report({"INFO"}, change)
        for problem in preparation.problems:
            self.report({"WARNING"}, str(problem))
        return {"FINISHED"}


def draw_preset_menu(self: bpy.types.Menu, context: bpy.types.Context) -> None:
    """The presets as a submenu of a menu of Blender's."""
    self.layout.operator_menu_enum(AssignPreset.bl_idname, "preset", text="Nested Dielectric")


CLASSES = (AssignPreset, PriorityMove, PriorityOwn, Prepare)
