"""Pictures that the extension draws or loads for Blender's panels and menus, kept while it is registered."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import bpy
import bpy.utils.previews
import numpy as np

_pictures: bpy.utils.previews.ImagePreviewCollection | None = None
"""By name; the first word is the kind of picture."""


def open_pictures() -> None:
    """Make room for pictures."""
    global _pictures
    _pictures = bpy.utils.previews.new()


def close_pictures() -> None:
    """Give back what pictures take."""
    global _pictures
    bpy.utils.previews.remove(_pictures)
    _pictures = None


def drawn_picture(name: str, draw: Callable[[], np.ndarray], most: int | None = None) -> int:
    """Return the number of the icon that shows a picture, drawn on first use; 0 while there are none.

    :param draw: returns (height, width, 4) float32 as a screen shows it, with the lowest row first.
    :param most: pictures of this kind that are kept; the oldest goes for one more.
    """
    if _pictures is None:
        return 0
    if name not in _pictures:
        if most is not None:
            _make_room(name.split()[0], most)
        pixels = draw()
        drawn = _pictures.new(name)
        drawn.image_size = pixels.shape[1::-1]
        drawn.image_pixels_float.foreach_set(pixels.ravel())
    return _pictures[name].icon_id


def _make_room(kind: str, most: int) -> None:
    alike = [name for name in _pictures if name.split()[0] == kind]
    if len(alike) >= most:
        del _pictures[alike[0]]


def loaded_picture(name: str, path: Path) -> int:
    """Return the number of the icon that shows a file of a picture; 0 while there are none."""
    if _pictures is None:
        return 0
    if name not in _pictures:
        _pictures.load(name, str(path), "IMAGE").icon_size[:]  # read at once: menus do not wait for it
    return _pictures[name].icon_id


def drawn_icon(name: str, draw: Callable[[], np.ndarray]) -> int:
    """Return the number of a small icon, drawn on first use; 0 while there are none.

    :param draw: returns (height, width, 4) float32, colours multiplied by alpha, with the lowest row first.
    """
    if _pictures is None:
        return 0
    if name not in _pictures:
        pixels = draw()
        icon = _pictures.new(name)
        icon.icon_size = pixels.shape[1::-1]
        icon.icon_pixels_float.foreach_set(pixels.ravel())
    return _pictures[name].icon_id
