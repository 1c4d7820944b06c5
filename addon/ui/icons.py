"""Icons that Blender has not."""

from __future__ import annotations

import numpy as np

from .pictures import drawn_icon

SIZE = 32

_CHECK = ((0.14, 0.50), (0.40, 0.24), (0.88, 0.78))
"""Corners of a check mark, in parts of the icon."""

_GREEN = (0.36, 0.78, 0.38)

_WIDTH = 0.075


def ready_icon() -> int:
    """Return the number of a green check mark; 0 while the extension is not registered."""
    return drawn_icon("icon ready", _check_mark)


def _check_mark() -> np.ndarray:
    """Return (SIZE, SIZE, 4) pixels from the bottom up, with colours multiplied by alpha and smooth edges."""
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
