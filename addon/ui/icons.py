"""Icons that Blender has not."""

from __future__ import annotations

import bpy
import bpy.utils.previews
import numpy as np

SIZE = 32
READY = "ready"

_CHECK = ((0.14, 0.50), (0.40, 0.24), (0.88, 0.78))
"""Corners of a check mark, in parts of the icon."""

_GREEN = (0.36, 0.78, 0.38)
_WIDTH = 0.075

_icons: bpy.utils.previews.ImagePreviewCollection | None = None
"""While the extension is registered."""


def open_icons() -> None:
    """Draw the icons."""
    global _icons
    _icons = bpy.utils.previews.new()
    icon = _icons.new(READY)
    icon.icon_size = (SIZE, SIZE)
    icon.icon_pixels_float.foreach_set(_check_mark().ravel())


def close_icons() -> None:
    """Give back what the icons take."""
    global _icons
    bpy.utils.previews.remove(_icons)
    _icons = None


def ready_icon() -> int:
    """Return the number of a green check mark."""
    return 0 if _icons is None else _icons[READY].icon_id


def _check_mark() -> np.ndarray:
    """(SIZE, SIZE, 4) pixels from the bottom up, with colours multiplied by alpha and smooth edges."""
    centres = (np.arange(SIZE) + 0.5) / SIZE
    points = np.stack(np.meshgrid(centres, centres), axis=-1)
    distance = np.full((SIZE, SIZE), np.inf)
    for start, end in zip(np.array(_CHECK), np.array(_CHECK)[1:]):
        way = end - start
        along = np.clip((points - start) @ way / (way @ way), 0.0, 1.0)
        distance = np.minimum(distance, np.linalg.norm(points - start - along[..., None] * way, axis=-1))
    pixels = np.empty((SIZE, SIZE, 4), dtype=np.float32)
    pixels[..., 3] = np.clip((_WIDTH - distance) * SIZE + 0.5, 0.0, 1.0)
    pixels[..., :3] = np.array(_GREEN) * pixels[..., 3:]
    return pixels
