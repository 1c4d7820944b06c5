"""Operators: checking a scene, showing what is wrong with it, and mending that."""

from __future__ import annotations

import bpy

from ...checking.finding import Action, Finding, Fix
from ...checking.kinds import Severity
from ...fixing.fix import Fixed, fix, fix_all
from ...fixing.kept import as_it_is_now
from ...fixing.words import in_words
from ...model.parameter import ParameterError
from ...preparation.check_scene import check_and_keep, keep
from ...preparation.report import last_report
from ...scene.media import all_objects
from ..polls import in_object_mode
from ..selecting import frame_selected, instancers, select_faces, select_only
from .preparation_operators import MOST_REPORTS


def kept_findings(scene: bpy.types.Scene) -> tuple[Finding, ...]:
    """Return what the panel of a scene shows: problems, then notes."""
    report = last_report(scene)
    return () if report is None else report.problems


def kept_finding(scene: bpy.types.Scene, index: int) -> Finding | None:
    """Return one of them by its place, or None."""
    findings = kept_findings(scene)
    return findings[index] if 0 <= index < len(findings) else None


class Check(bpy.types.Operator):
    """Look for problems with the media of the scene."""

    bl_idname = "nested_dielectric.check"
    bl_label = "Check Scene"
    bl_description = "Look for problems with the media of this scene, and list them here. Nothing that renders changes"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        problems = [each for each in check_and_keep(context.scene) if each.severity != Severity.NOTE]
        for problem in problems[:MOST_REPORTS]:
            self.report({"WARNING"}, str(problem))
        count = len(problems)
        text = f"{count} problem{'s' * (count != 1)} found" if count else "No problems found"
        self.report({"WARNING" if count else "INFO"}, text)
        return {"FINISHED"}


class FixProblem(bpy.types.Operator):
    """Mend one problem."""

    bl_idname = "nested_dielectric.fix"
    bl_label = "Fix"
    bl_description = "Mend this problem"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    index: bpy.props.IntProperty(
        name="Problem", description="Its place in the panel, from 0", default=-1, options={"SKIP_SAVE", "HIDDEN"}
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        kept = kept_finding(context.scene, properties.index)
        if kept is None or kept.fix is None:
            return cls.bl_description
        return f"{kept.fix.action.value}: {in_words(context.scene, kept.fix)}"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not in_object_mode(cls, context):
            return False
        if not any(kept.fix for kept in kept_findings(context.scene)):
            cls.poll_message_set("No problem is listed that can be mended by itself; press Check Scene")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        scene = context.scene
        kept = kept_finding(scene, self.index)
        if kept is None or kept.fix is None:
            self.report({"ERROR"}, "This problem has no fix; check the scene again")
            return {"CANCELLED"}
        finding = as_it_is_now(scene, kept)
        if finding is None:
            self.report({"INFO"}, f"{kept.name!r} has this problem no more")
            check_and_keep(scene)
            return {"FINISHED"}
        try:
            changes = fix(scene, finding)
        except ParameterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for change in changes[:MOST_REPORTS] or ("Nothing to change",):
            self.report({"INFO"}, change)
        if finding.fix.action != Action.PREPARE:  # which says itself what it has found
            check_and_keep(scene)
        return {"FINISHED"}


class FixAll(bpy.types.Operator):
    """Mend all problems that are safe to mend."""

    bl_idname = "nested_dielectric.fix_all"
    bl_label = "Fix All"
    bl_description = "Mend every problem whose remedy changes nothing that may have been meant, and say what is left"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not in_object_mode(cls, context):
            return False
        if not any(map(_is_safe, (kept.fix for kept in kept_findings(context.scene)))):
            cls.poll_message_set("No problem is listed that is safe to mend by itself; press Check Scene")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        fixed = fix_all(context.scene)
        found = keep(context.scene, list(fixed.left))
        self._say(Fixed(fixed.changes, tuple(found)))
        return {"FINISHED"}

    def _say(self, fixed: Fixed) -> None:
        """Report what was changed, and what is left."""
        for change in fixed.changes[:MOST_REPORTS] or ("Nothing to change",):
            self.report({"INFO"}, change)
        left = [each for each in fixed.left if each.severity != Severity.NOTE]
        for problem in left[:MOST_REPORTS]:
            self.report({"WARNING"}, f"Left: {problem}")
        count = len(left)
        text = f"{count} problem{'s' * (count != 1)} left" if count else "No problems left"
        self.report({"WARNING" if count else "INFO"}, text)


def _is_safe(wanted: Fix | None) -> bool:
    """Return whether *Fix All* does what would mend a finding."""
    return wanted is not None and wanted.safe


class ShowProblem(bpy.types.Operator):
    """Show what has a problem."""

    bl_idname = "nested_dielectric.show_problem"
    bl_label = "Show Problem"
    bl_description = "Select what has the problem, its faces for Edit Mode too, and bring it into view"
    bl_options = {"UNDO", "INTERNAL"}

    name: bpy.props.StringProperty(name="Name", description="An object, or a material", options={"SKIP_SAVE"})
    index: bpy.props.IntProperty(
        name="Problem",
        description="Its place in the panel, from 0, if it stands there",
        default=-1,
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return in_object_mode(cls, context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        kept = kept_finding(context.scene, self.index)
        objects, note = _named(context.scene, self.name if kept is None else kept.name)
        if kept is not None and kept.place.point is not None:
            context.scene.cursor.location = kept.place.point
            self.report({"INFO"}, "The 3D cursor is where the problem is")
            if not objects:
                return {"FINISHED"}
        if not objects:
            self.report({"WARNING"}, note)
            return {"CANCELLED"}
        missed = select_only(context.view_layer, objects)
        for line in missed[:MOST_REPORTS]:
            self.report({"WARNING"}, line)
        if len(missed) == len(objects):
            return {"CANCELLED"}
        if kept is not None and kept.place.faces and select_faces(context, objects[0], kept.place.faces):
            self.report({"INFO"}, "Its faces are selected: Tab shows them in Edit Mode")
        frame_selected(context)
        if note:
            self.report({"INFO"}, note)
        return {"FINISHED"}


def _named(scene: bpy.types.Scene, name: str) -> tuple[list[bpy.types.Object], str]:
    """Return what to select for a name of a problem, and what to say of it."""
    obj = scene.objects.get(name)
    if obj is not None:
        return [obj], ""
    obj = next((each for each in all_objects(scene) if each.name == name), None)
    if obj is not None:
        return instancers(scene, obj), f"{name!r} is in a collection that is instanced; its instances are selected"
    material = bpy.data.materials.get(name)
    if material is not None:
        users = [each for each in scene.objects if any(slot.material == material for slot in each.material_slots)]
        return users, f"Objects with material {name!r}" if users else f"No object of the scene has material {name!r}"
    if name == scene.name or name in scene.view_layers:
        return [], f"{name!r} is no object; its problem concerns the whole scene"
    return [], f"{name!r} is gone; prepare the scene again"


CLASSES = (Check, ShowProblem, FixProblem, FixAll)
