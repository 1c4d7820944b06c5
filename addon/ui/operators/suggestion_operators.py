"""Operator: priorities that are suggested, each to be accepted or not."""

from __future__ import annotations

import textwrap

import bpy

from ...checking.priority_suggestions import Suggestion, accept_priorities, suggest_priorities
from ..polls import has_media

WIDTH = 480
"""Of the dialog, in Blender's units of about a pixel."""

LETTERS = 68
"""Of a reason in a line of it."""


class NestedDielectricSuggestion(bpy.types.PropertyGroup):
    """A suggestion in the dialog; registered by its name, which other extensions must not have."""

    is_accepted: bpy.props.BoolProperty(name="Accept", description="Give this priority", default=True)
    is_object: bpy.props.BoolProperty(name="Object's Own")
    number: bpy.props.IntProperty(name="Number", description="The owner's number in this session")
    before: bpy.props.IntProperty(name="Before")
    after: bpy.props.IntProperty(name="After")
    reason: bpy.props.StringProperty(name="Reason")

    def take(self, suggestion: Suggestion) -> None:
        """Take over a suggestion."""
        self.name = suggestion.owner.name
        self.is_object = isinstance(suggestion.owner, bpy.types.Object)
        self.number = suggestion.owner.session_uid
        self.before, self.after, self.reason = suggestion.before, suggestion.after, suggestion.reason

    def found(self) -> Suggestion | None:
        """Return the suggestion, or None if its owner is gone."""
        owners = bpy.data.objects if self.is_object else bpy.data.materials
        owner = next((owner for owner in owners if owner.session_uid == self.number), None)
        return None if owner is None else Suggestion(owner, self.before, self.after, self.reason)


class SuggestPriorities(bpy.types.Operator):
    """Suggest priorities, and give media those that are accepted."""

    bl_idname = "nested_dielectric.suggest_priorities"
    bl_label = "Suggest Priorities"
    bl_description = (
        "Look at which media contain and cross which, and suggest who should win: what lies inside another, then "
        "bubbles, solids, ice and liquids. Nothing changes before you accept it; from a script all is accepted"
    )
    bl_options = {"REGISTER", "UNDO"}

    suggestions: bpy.props.CollectionProperty(type=NestedDielectricSuggestion, options={"HIDDEN", "SKIP_SAVE"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return has_media(cls, context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        self.suggestions.clear()
        for suggestion in suggest_priorities(context.scene):
            self.suggestions.add().take(suggestion)
        if not self.suggestions:
            return self.nothing()
        return context.window_manager.invoke_props_dialog(self, width=WIDTH, confirm_text="Accept")

    def nothing(self) -> set[str]:
        self.report({"INFO"}, "Nothing to suggest: the priorities fit how the media overlap")
        return {"CANCELLED"}

    def draw(self, context: bpy.types.Context) -> None:
        for row in self.suggestions:
            box = self.layout.column(align=True)
            line = box.split(factor=0.72)
            names = line.row()
            names.prop(row, "is_accepted", text="")
            names.label(text=row.name, icon="OBJECT_DATA" if row.is_object else "MATERIAL")
            line.label(text=f"{row.before} \N{RIGHTWARDS ARROW} {row.after}")
            lines = box.column(align=True)
            lines.active = row.is_accepted
            for text in textwrap.wrap(f"because {row.reason}", LETTERS):
                lines.label(text=text, icon="BLANK1")

    def execute(self, context: bpy.types.Context) -> set[str]:
        if self.suggestions:
            chosen = [row.found() for row in self.suggestions if row.is_accepted]
        else:
            chosen = list(suggest_priorities(context.scene))
            if not chosen:
                return self.nothing()
        changes, kept = accept_priorities(context.scene, filter(None, chosen))
        for line in kept:
            self.report({"WARNING"}, line)
        for line in changes:
            self.report({"INFO"}, line)
        count = f"{len(changes)} priorit{'y' if len(changes) == 1 else 'ies'}"
        self.report({"INFO"}, f"Changed {count}" if changes else "Nothing changed")
        return {"FINISHED"} if changes else {"CANCELLED"}


CLASSES = (NestedDielectricSuggestion, SuggestPriorities)
