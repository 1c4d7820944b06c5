"""Saying why media will not show before a render starts.

The notices stand in Render properties, the Render menu, the status bar, and over the picture.
"""

from __future__ import annotations

import textwrap

import bpy

from ...cutting.backends import last_choice
from ...nodes.compatibility import blender_problem
from ...nodes.render_settings import achromatic_reason, settings_problem
from ...preparation.guard import faults, guarded
from ...scene.debug_views import debug_notice
from ..drawing import draw_alert
from ..media_list import listed_media
from ..operators.debug_operators import ShowDebugView
from ..operators.preparation_operators import Prepare
from ..operators.update_operators import CopyFaults

MOST_CHARACTERS = 100
"""Of a notice that has one line."""


def render_problem(scene: bpy.types.Scene) -> str | None:
    """Return why a render would not show the media of a scene, or what went wrong; None if it would, or has none."""
    if faults():
        return str(faults()[0])
    listed = listed_media(scene)
    if not listed.rows and not listed.problems:
        return None
    settings = blender_problem() or settings_problem(scene) if listed.rows else None
    if settings:
        return settings
    if listed.problems:
        return str(listed.problems[0])
    asking = _asking(scene) if listed.rows else None
    if asking:
        return asking
    return achromatic_reason(scene) if listed.disperses else None


def _asking(scene: bpy.types.Scene) -> str | None:
    """Return the first medium that must ask though nothing in the scene's renders can, in a sentence."""
    chosen = last_choice(scene)
    if chosen is None or not chosen.asking:
        return None
    name, reason = chosen.asking[0]
    return f"{name!r} {reason}, which Cycles' own nodes cannot; mend it, or press Prepare Scene"


def draw_fault_button(layout: bpy.types.UILayout) -> None:
    """Draw the button that copies what a report of an error needs, where there was one."""
    if faults():
        layout.operator(CopyFaults.bl_idname, icon="COPYDOWN")


@guarded("while a panel was drawn", writes=False)
def draw_in_properties(self: bpy.types.Panel, context: bpy.types.Context) -> None:
    """Draw the notice in Render properties, in full, with the button that mends it."""
    problem = render_problem(context.scene)
    if problem:
        draw_alert(self.layout, context, problem)
        draw_fault_button(self.layout)
        self.layout.operator(Prepare.bl_idname, icon="CHECKMARK")
    draw_debug_notice(self.layout, context)


def _debug_notice(scene: bpy.types.Scene) -> str:
    """Return that a debug view is on in a scene with media; empty where none is."""
    return debug_notice(scene) if listed_media(scene).rows else ""


def draw_debug_notice(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw that a debug view is on, and the button that switches it off."""
    notice = _debug_notice(context.scene)
    if notice:
        draw_alert(layout, context, notice)
        layout.operator(ShowDebugView.bl_idname, text="Debug View: None", icon="X").view = "NONE"


@guarded("while a panel was drawn", writes=False)
def draw_in_line(self: bpy.types.Header | bpy.types.Menu, context: bpy.types.Context) -> None:
    """Draw the notice in one line of a header or a menu."""
    problem = render_problem(context.scene) or _debug_notice(context.scene)
    if problem:
        row = self.layout.row()
        row.alert = True
        row.label(text=_short(problem), icon="ERROR")


@guarded("while a panel was drawn", writes=False)
def draw_over_picture(self: bpy.types.Header, context: bpy.types.Context) -> None:
    """Draw the notice where a render's picture is shown, which is all that an artist sees who pressed F12."""
    image = context.space_data.image
    if image is not None and image.type == "RENDER_RESULT":
        draw_in_line(self, context)


def _short(text: str) -> str:
    return textwrap.shorten(text[0].upper() + text[1:], MOST_CHARACTERS, placeholder=" ...")


PLACES = (
    ("RENDER_PT_context", draw_in_properties),
    ("TOPBAR_MT_render", draw_in_line),
    ("STATUSBAR_HT_header", draw_in_line),
    ("IMAGE_HT_header", draw_over_picture),
)
"""Blender's panels, menus and headers, and what is added to them."""
