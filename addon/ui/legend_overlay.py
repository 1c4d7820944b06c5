"""The legend of a debug view over Cycles' Rendered viewports."""

from __future__ import annotations

from collections.abc import Callable

import bpy

from ..model.debug_views import Colour, Step
from .legends import colour_note, screen_colour, shown_legend

MOST_ROWS = 24

_MARGIN, _LINE, _TEXT = 16.0, 20.0, 12.0
"""In pixels of a screen without scaling: around the legend, from row to row, height of the text."""


def show_legends() -> Callable[[], None]:
    """Draw legends over 3D views from now on; return what ends it."""
    if bpy.app.background:
        return lambda: None
    handler = bpy.types.SpaceView3D.draw_handler_add(draw_overlay, (), "WINDOW", "POST_PIXEL")
    return lambda: bpy.types.SpaceView3D.draw_handler_remove(handler, "WINDOW")


def draw_overlay() -> None:
    """Draw the legend over the 3D view that is being drawn, if its scene shows a debug view there."""
    context = bpy.context
    space = context.space_data
    if space.shading.type != "RENDERED" or context.scene.render.engine != "CYCLES" or not space.overlay.show_overlays:
        return
    name, steps = shown_legend(context.scene, context.view_layer)
    if not name:
        return
    words = [f"Debug View: {name}", *(step.words for step in steps[:MOST_ROWS])]
    if len(steps) > MOST_ROWS:
        words.append(f"And {len(steps) - MOST_ROWS} more")
    note = colour_note(context.scene)
    _draw([*words, note] if note else words, steps[:MOST_ROWS], _free_left(context.area))


def _free_left(area: bpy.types.Area) -> float:
    """Return the width of what lies over the left end of a 3D view, in pixels."""
    return max((region.width for region in area.regions if region.type == "TOOLS"), default=0)


def _draw(words: list[str], steps: tuple[Step, ...], left: float) -> None:
    """Draw rows of words from the bottom up to the title, and swatches before those of the steps."""
    try:
        import blf
    except ImportError:
        return
    scale = bpy.context.preferences.system.ui_scale
    line, margin = _LINE * scale, _MARGIN * scale
    font, x = 0, left + 2.0 * margin
    blf.size(font, _TEXT * scale)
    width = max(blf.dimensions(font, text)[0] for text in words) + 2.0 * line
    height = line * len(words)
    _fill((0.0, 0.0, 0.0), 0.6, x - 0.5 * margin, margin, width + margin, height + 0.5 * margin)
    blf.color(font, 1.0, 1.0, 1.0, 1.0)
    for place, text in enumerate(words):
        y = margin + height - line * (place + 0.75)
        is_step = 0 < place <= len(steps)
        if is_step:
            _fill(screen_colour(steps[place - 1].colour), 1.0, x, y - 0.1 * line, 0.7 * line, 0.7 * line)
        blf.position(font, x + line * is_step, y, 0.0)
        blf.draw(font, text)


def _fill(colour: Colour, alpha: float, x: float, y: float, width: float, height: float) -> None:
    """Fill a rectangle."""
    try:
        import gpu
        from gpu_extras.batch import batch_for_shader

        shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    except (ImportError, SystemError):  # there is no GPU
        return
    corners = [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]
    batch = batch_for_shader(shader, "TRIS", {"pos": corners}, indices=[(0, 1, 2), (2, 3, 0)])
    gpu.state.blend_set("ALPHA")
    shader.uniform_float("color", (*colour, alpha))
    batch.draw(shader)
    gpu.state.blend_set("NONE")
