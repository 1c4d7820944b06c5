"""Where objects may be: boxes in the world."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ..scene.media import SOLID_TYPES
from ..scene.shapes import evaluated_triangles

EVERYWHERE = np.array([(-np.inf,) * 3, (np.inf,) * 3])
"""The box of what may be anywhere."""

SHAPE_MARGIN = 0.5
"""Margin around what a render may show with another shape, in diagonals of its box.

A subdivided surface stays within the hull of any coarser one.
"""

CONVERTED = SOLID_TYPES - {"MESH"}
"""Types whose evaluated objects hold a mesh beside them."""

SHAPED = SOLID_TYPES | {"CURVES", "POINTCLOUD", "VOLUME"}
"""Types of objects that rays may meet."""


def meet_any(boxes: np.ndarray, others: Sequence[np.ndarray]) -> np.ndarray:
    """Return whether each of (n, 2, 3) boxes meets any of the others, (n,)."""
    found = np.zeros(len(boxes), dtype=bool)
    for low, high in others:
        found |= np.all((boxes[:, 0] <= high) & (boxes[:, 1] >= low), axis=1)
    return found


def corners_of(evaluated: bpy.types.Object) -> np.ndarray:
    """Return points between which an object lies, in its own space, (n, 3).

    They are the vertices where there is a mesh: Blender's box of a text does not count its thickness.
    """
    if evaluated.type in CONVERTED:
        vertices, _ = evaluated_triangles(evaluated)
        return vertices if len(vertices) else np.zeros((1, 3))
    return np.array([tuple(corner) for corner in evaluated.bound_box])


def with_margin(box: np.ndarray, margin: float) -> np.ndarray:
    """Return a (2, 3) box with a margin around it, in diagonals of it."""
    return box + np.linalg.norm(box[1] - box[0]) * margin * np.array([[-1.0], [1.0]])
