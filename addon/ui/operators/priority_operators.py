"""Operators: the order in which media win over each other."""

from __future__ import annotations

import bpy

from ...model.parameter import ParameterError
from ...scene import media, priorities
from ..media_list import listed_media, open_or_close
from ..media_rows import active_line
from ..polls import has_media
from ..selecting import select_only


class _MediaOperator(bpy.types.Operator):
    """What operators on the scene's media share."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return has_media(cls, context)

    def medium(self, context: bpy.types.Context, name: str) -> bpy.types.Object:
        """Return an object of the scene by its name, or the active one.

        :raises ParameterError: if it is no medium.
        """
        name = name or getattr(context.object, "name", "")
        obj = next((each for each in listed_media(context.scene).objects if each.name == name), None)
        if obj is None:
            scene = context.scene.name
            raise ParameterError(f"{name!r} is no medium of scene {scene!r}; assign a preset to it first")
        return obj

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            return self.change(context)
        except ParameterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}


class PriorityMove(_MediaOperator):
    """Move a medium in the winning order."""

    bl_idname = "nested_dielectric.priority_move"
    bl_label = "Move Medium"
    bl_description = (
        "Move a material, or an object with a priority of its own, up or down in the order in which media win "
        "over each other. No other priority changes"
    )

    name: bpy.props.StringProperty(
        name="Object", description="A medium of the scene; what the list has active if empty", options={"SKIP_SAVE"}
    )
    material: bpy.props.StringProperty(
        name="Material", description="A material of media, in place of an object", options={"SKIP_SAVE"}
    )
    direction: bpy.props.EnumProperty(
        name="Direction",
        items=(
            ("UP", "Up", "Win over one more medium"),
            ("DOWN", "Down", "Give way to one more medium"),
        ),
    )

    def change(self, context: bpy.types.Context) -> set[str]:
        owner = self.owner(context)
        if not priorities.move(context.scene, owner, -1 if self.direction == "UP" else 1):
            end = "wins over all others" if self.direction == "UP" else "gives way to all others"
            self.report({"INFO"}, f"{owner.name!r} {end} already")
            return {"CANCELLED"}
        return {"FINISHED"}

    def owner(self, context: bpy.types.Context) -> priorities.Owner:
        """Return what is to be moved.

        :raises ParameterError: if there is no such medium.
        """
        if self.material:
            rows = listed_media(context.scene).rows
            found = next((row.owner for row in rows if not row.is_own and row.owner.name == self.material), None)
            if found is None:
                raise ParameterError(f"no object of the scene has its priority from material {self.material!r}")
            return found
        line = None if self.name else active_line(context.scene)
        return line.chosen if line is not None else self.medium(context, self.name)


class PriorityOwn(_MediaOperator):
    """Give an object a priority of its own, or take it."""

    bl_idname = "nested_dielectric.priority_own"
    bl_label = "Own Priority"
    bl_description = "Give an object a priority of its own, or return it to that of its material"

    name: bpy.props.StringProperty(
        name="Object", description="A medium of the scene; the active object if empty", options={"SKIP_SAVE"}
    )

    def change(self, context: bpy.types.Context) -> set[str]:
        obj = self.medium(context, self.name)
        reason = priorities.hindrance(obj)
        if reason:
            raise ParameterError(f"{obj.name!r} {reason}")
        media.set_priority(obj, media.get_priority(obj) if media.own_priority(obj) is None else None)
        return {"FINISHED"}


class SpaceOut(_MediaOperator):
    """Space out all priorities of the file."""

    bl_idname = "nested_dielectric.space_out"
    bl_label = "Space Out Priorities"
    bl_description = (
        "Give all media of the file new priorities, in steps of ten where there is room, so that one can move "
        "between any two. Who wins over whom stays"
    )

    def change(self, context: bpy.types.Context) -> set[str]:
        changes, kept = priorities.space_out()
        for line in kept:
            self.report({"WARNING"}, line)
        for line in changes:
            self.report({"INFO"}, line)
        names = f"{len(changes)} priorit{'y' if len(changes) == 1 else 'ies'}"
        self.report({"INFO"}, f"Spaced out {names}" if changes else "Nothing to change")
        return {"FINISHED"} if changes else {"CANCELLED"}


class SelectObjects(_MediaOperator):
    """Select the objects of the active row."""

    bl_idname = "nested_dielectric.select_objects"
    bl_label = "Select Objects"
    bl_description = "Select the objects that have their priority from the active row of the list"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not super().poll(context):
            return False
        if context.mode != "OBJECT":
            cls.poll_message_set("Leave this mode for Object Mode first")
            return False
        if active_line(context.scene) is None:
            cls.poll_message_set("Choose a row of the list first")
            return False
        return True

    def change(self, context: bpy.types.Context) -> set[str]:
        objects = active_line(context.scene).row.objects
        missed = select_only(context.view_layer, objects)
        if missed:
            more = f"; {len(missed) - 1} more are not selected" if len(missed) > 1 else ""
            self.report({"WARNING"}, f"{missed[0]}{more}")
        return {"FINISHED"} if len(missed) < len(objects) else {"CANCELLED"}


class OpenMaterial(bpy.types.Operator):
    """Open or close a material in the list of media."""

    bl_idname = "nested_dielectric.open_material"
    bl_label = "Show Objects of Material"
    bl_description = "Show the objects of this material in the list, or hide them"
    bl_options = {"INTERNAL"}

    number: bpy.props.IntProperty(name="Number", description="The material's number in this session")

    def execute(self, context: bpy.types.Context) -> set[str]:
        open_or_close(self.number)
        return {"FINISHED"}


CLASSES = (PriorityMove, PriorityOwn, SpaceOut, SelectObjects, OpenMaterial)
