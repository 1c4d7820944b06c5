"""Products of vectors that are stored by axis: the first axis of an array is that of coordinates."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def dot(u: Sequence[np.ndarray], v: Sequence[np.ndarray]) -> np.ndarray:
    """Return the scalar products of vectors."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def length(vectors: Sequence[np.ndarray]) -> np.ndarray:
    """Return the lengths of vectors."""
    return np.sqrt(dot(vectors, vectors))


def cross(u: Sequence[np.ndarray], v: Sequence[np.ndarray]) -> np.ndarray:
    """Return the vector products of vectors."""
    return np.stack([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])
