"""Operators of debug views: which one a scene shows, and view layers with the numbers of all."""

from __future__ import annotations

import bpy

from ...model.debug_views import VIEWS
from ...scene.debug_views import (
    MOST_THROUGH,
    add_debug_passes,
    get_debug_view,
    has_debug_passes,
    remove_debug_passes,
    set_debug_view,
)
from ..choice_items import choice_items
from ..polls import has_media, supported


class ShowDebugView(bpy.types.Operator):
    """Show something else than light of a scene's media."""

    bl_idname = "nested_dielectric.debug_view"
    bl_label = "Debug View"
    bl_description = (
        "Show in flat colours what media know of their surfaces, in Cycles' Rendered viewports and in renders, until it is "
        "switched off. All else, and light through media, stays as it is"
    )
    bl_options = {"REGISTER", "UNDO"}

    view: bpy.props.EnumProperty(name="Debug View", items=choice_items(VIEWS), options={"SKIP_SAVE"})
    through: bpy.props.IntProperty(
        name="Look Through",
        description="Surfaces that are let through before one is shown",
        min=0,
        max=MOST_THROUGH,
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return bool(get_debug_view(context.scene)) or (has_media(cls, context) and supported(cls))

    def execute(self, context: bpy.types.Context) -> set[str]:
        set_debug_view(context.scene, self.view, self.through)
        name = next(choice.name for choice in VIEWS if choice.keyword == self.view)
        self.report({"INFO"}, f"Debug View: {name}")
        return {"FINISHED"}


class AddDebugPasses(bpy.types.Operator):
    """Add view layers with the numbers of all debug views."""

    bl_idname = "nested_dielectric.add_debug_passes"
    bl_label = "Add Debug Passes"
    bl_description = (
        "Add a view layer of one sample for each debug view. Its Emission pass holds exact numbers: priorities, counts, codes. "
        "The picture stays as it is"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return has_media(cls, context) and supported(cls)

    def execute(self, context: bpy.types.Context) -> set[str]:
        for change in add_debug_passes(context.scene) or ("Nothing to change",):
            self.report({"INFO"}, change)
        return {"FINISHED"}


class RemoveDebugPasses(bpy.types.Operator):
    """Remove the view layers of debug views."""

    bl_idname = "nested_dielectric.remove_debug_passes"
    bl_label = "Remove Debug Passes"
    bl_description = "Remove the view layers that hold the numbers of debug views"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not has_debug_passes(context.scene):
            cls.poll_message_set("The scene has no debug passes")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        for change in remove_debug_passes(context.scene):
            self.report({"INFO"}, change)
        return {"FINISHED"}


CLASSES = (ShowDebugView, AddDebugPasses, RemoveDebugPasses)
