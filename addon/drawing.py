"""What panels share: where they stand, and texts in as many lines as it takes."""

from __future__ import annotations

import textwrap

import bpy


class ObjectProperties:
    """Where a panel of the Object properties stands."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}


class Sidebar:
    """Where a panel of the 3D view's sidebar stands."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Nested Dielectric"


def draw_alert(layout: bpy.types.UILayout, context: bpy.types.Context, text: str) -> None:
    """A problem, in red."""
    lines = layout.column()
    lines.alert = True
    draw_text(lines, context, text, "ERROR")


def draw_text(layout: bpy.types.UILayout, context: bpy.types.Context, text: str, icon: str) -> None:
    """A text in as many lines as the region's width makes of it, the first with an icon."""
    lines = layout.column(align=True)
    characters = int(context.region.width / context.preferences.system.ui_scale / 8.0)
    for index, line in enumerate(textwrap.wrap(text[0].upper() + text[1:], max(characters, 20))):
        lines.label(text=line, icon="BLANK1" if index else icon)
