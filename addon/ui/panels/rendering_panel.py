"""What renders a scene's media: the shader or Cycles' own nodes, cut surfaces or not."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ...cutting.backends import last_choice
from ...cutting.baked_cut import is_baked
from ...cutting.cut_scene import is_cut, last_cut
from ...nodes.render_with import BACKENDS, get_backend
from ..drawing import draw_text
from ..media_list import listed_media
from ..operators.preparation_operators import CutSurfaces, KeepCut, RenderWith
from ..operators.problem_operators import ShowProblem

MOST_LINES = 20
"""Names whose reasons are listed."""


def draw_backend(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw the choice of what renders the media, and which materials are left to the shader and why."""
    scene = context.scene
    if not listed_media(scene).rows:
        return
    backend = get_backend(scene)
    name = next(choice.name for choice in BACKENDS if choice.keyword == backend)
    layout.operator_menu_enum(RenderWith.bl_idname, "backend", text=f"Render With: {name}")
    chosen = last_choice(scene)
    if chosen is None or not chosen.headline:
        return
    if not chosen.osl:
        draw_text(layout, context, chosen.headline, "INFO")
        return
    header, body = layout.panel("nested_dielectric_backends", default_closed=True)
    header.label(text=chosen.headline, icon="INFO")
    if body is not None:
        _draw_reasons(body, context, chosen.osl)


def draw_cut(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw the switch of whether surfaces are cut in renders, and what cannot be and why."""
    scene = context.scene
    cut = is_cut(scene)
    if not cut and not listed_media(scene).rows:
        return
    row = layout.row(align=True)
    row.operator(CutSurfaces.bl_idname, icon="CHECKBOX_HLT" if cut else "CHECKBOX_DEHLT", depress=cut)
    if cut:
        row.operator(KeepCut.bl_idname, depress=is_baked(scene))
    found = last_cut(scene)
    if found is None or not found.asking:
        return
    header, body = layout.panel("nested_dielectric_uncut", default_closed=True)
    header.label(text=f"{len(found.asking)} of {len(found.asking) + len(found.media)} Not Cut", icon="INFO")
    if body is not None:
        _draw_reasons(body, context, found.asking)


def _draw_reasons(layout: bpy.types.UILayout, context: bpy.types.Context, reasons: Sequence[tuple[str, str]]) -> None:
    """Draw names, each with a button that shows what has it, and reasons; of very many the first."""
    for name, reason in reasons[:MOST_LINES]:
        layout.row().operator(ShowProblem.bl_idname, text=name, icon="VIEWZOOM").name = name
        draw_text(layout, context, reason, "DOT")
    if len(reasons) > MOST_LINES:
        layout.label(text=f"And {len(reasons) - MOST_LINES} more", icon="BLANK1")
