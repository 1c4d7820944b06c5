"""The panel of debug views: which one is on, its legend, and passes."""

from __future__ import annotations

import bpy

from ...model.contract import DebugView
from ...model.debug_views import VIEWS
from ...scene.debug_views import MOST_THROUGH, get_debug_view, get_through, has_debug_passes
from ..drawing import Sidebar, draw_text
from ..legends import colour_note, shown_legend, swatch
from ..operators.debug_operators import AddDebugPasses, RemoveDebugPasses, ShowDebugView

MOST_ROWS = 32
"""Rows of a legend that are drawn; a scene may have hundreds of priorities."""


def draw_debug(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw which debug view is on and what its colours mean, and the buttons of passes."""
    scene = context.scene
    view = get_debug_view(scene)
    layout.operator_menu_enum(ShowDebugView.bl_idname, "view", text=f"Debug View: {VIEWS[view].name}")
    if view != DebugView.NONE:
        draw_through(layout, scene, view)
        draw_legend(layout, context)
    buttons = layout.row(align=True)
    buttons.operator(AddDebugPasses.bl_idname, icon="RENDERLAYERS")
    if has_debug_passes(scene):
        buttons.operator(RemoveDebugPasses.bl_idname, text="", icon="X")


def draw_through(layout: bpy.types.UILayout, scene: bpy.types.Scene, view: DebugView) -> None:
    """Draw how many surfaces are looked through, with buttons for one less and one more."""
    through = get_through(scene)
    row = layout.row(align=True)
    row.label(text=f"Look Through: {through}")
    for step, icon in ((-1, "REMOVE"), (1, "ADD")):
        button = row.row(align=True)
        button.enabled = 0 <= through + step <= MOST_THROUGH
        operator = button.operator(ShowDebugView.bl_idname, text="", icon=icon)
        operator.view, operator.through = view.name, max(through + step, 0)


def draw_legend(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw a swatch and words for each colour."""
    _, steps = shown_legend(context.scene, None)
    rows = layout.column(align=True)
    for step in steps[:MOST_ROWS]:
        rows.label(text=step.words, icon_value=swatch(step.colour))
    if len(steps) > MOST_ROWS:
        rows.label(text=f"And {len(steps) - MOST_ROWS} more", icon="BLANK1")
    note = colour_note(context.scene)
    if note:
        draw_text(layout, context, note, "INFO")


class DebugPanel(Sidebar, bpy.types.Panel):
    """Debug views, in the sidebar of the 3D view."""

    bl_idname = "NESTED_DIELECTRIC_PT_sidebar_debug"
    bl_parent_id = "NESTED_DIELECTRIC_PT_sidebar"
    bl_label = "Debug View"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        draw_debug(self.layout, context)


CLASSES = (DebugPanel,)
