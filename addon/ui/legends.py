"""Legends of debug views: which view a context shows, its rows, and their colours as a screen shows them."""

from __future__ import annotations

import bpy
import numpy as np

from ..model.contract import DebugView
from ..model.debug_views import VIEWS, Colour, Step
from ..scene.debug_views import get_debug_view, legend
from .icons import SIZE
from .media_list import listed_media
from .pictures import drawn_icon

PLAIN_TRANSFORMS = ("Standard", "Raw")
"""View transforms that leave the legend's colours as they are, or darken all alike."""


def shown_legend(scene: bpy.types.Scene, layer: bpy.types.ViewLayer | None) -> tuple[str, tuple[Step, ...]]:
    """Return the name of the debug view that is on, and the rows of its legend; an empty name where none is."""
    view = get_debug_view(scene, layer)
    if view == DebugView.NONE:
        return "", ()
    return VIEWS[view].name, legend(view, listed_media(scene).rows)


def colour_note(scene: bpy.types.Scene) -> str:
    """Return why the picture's colours are not the legend's; empty where they are."""
    transform = scene.view_settings.view_transform
    return (
        ""
        if transform in PLAIN_TRANSFORMS
        else f"View Transform {transform} changes these colours; Standard shows them"
    )


def screen_colour(colour: Colour) -> Colour:
    """Return a linear colour as screens take it (IEC 61966-2-1)."""
    return tuple(12.92 * c if c <= 0.0031308 else 1.055 * c ** (1.0 / 2.4) - 0.055 for c in colour)


def swatch(colour: Colour) -> int:
    """Return the number of an icon of one colour; 0 while the extension is not registered."""

    def draw() -> np.ndarray:
        pixels = np.zeros((SIZE, SIZE, 4), dtype=np.float32)
        pixels[2:-2, 2:-2] = (*screen_colour(colour), 1.0)
        return pixels

    return drawn_icon(f"swatch {colour}", draw)
