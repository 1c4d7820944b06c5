"""Closed bodies that Hypothesis draws, with corners on a lattice, where rays meet edges and corners to the last bit."""

from __future__ import annotations

import bpy  # noqa: F401  mathutils comes with it
import numpy as np
import property_tests  # noqa: F401  its profile
from hypothesis import assume
from hypothesis import strategies as st

from nested_dielectric.geometry.solids import Solid

BOX = np.array(
    [
        *((0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4)),
        *((2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)),
    ],
    dtype=np.int32,
)
TETRAHEDRON = np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)], dtype=np.int32)

coordinates = st.integers(-64, 64).map(lambda n: n / 8.0)
points = st.tuples(coordinates, coordinates, coordinates).map(np.array)
sizes = st.tuples(*[st.integers(2, 48).map(lambda n: n / 8.0)] * 3).map(np.array)


def box(corner: np.ndarray, size: np.ndarray) -> Solid:
    unit = np.array([(i & 1, i >> 1 & 1, i >> 2) for i in range(8)], dtype=np.float64)
    return Solid(corner + unit * size, BOX)


@st.composite
def tetrahedra(draw) -> Solid:
    corners = np.array([draw(points) for _ in range(4)])
    volume = np.linalg.det(corners[1:] - corners[0])
    assume(abs(volume) > 1.0)
    return Solid(corners, TETRAHEDRON if volume > 0.0 else TETRAHEDRON[:, ::-1].copy())


solids = st.one_of(st.builds(box, points, sizes), tetrahedra())

seeds = st.integers(0, 2**31)


def apart(low: np.ndarray, high: np.ndarray, other_low: np.ndarray, other_high: np.ndarray) -> np.ndarray:
    """Largest distance along an axis, of each box to each; (n, m)."""
    one = low[:, :, None] - other_high[:, None]
    return np.maximum(one, other_low[:, None] - high[:, :, None]).max(axis=0)
