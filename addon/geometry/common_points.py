"""A point that lies in two bodies."""

from __future__ import annotations

import numpy as np

from .hierarchy import overlapping_leaves
from .solids import PlacedSolid, touch_tolerance
from .surfaces import normals_of
from .vectors import cross, dot, length
from .winding import winding_numbers

DEEP = 4.0
"""How far a point lies in both, in distances within which surfaces count as touching."""

MOST_CROSSINGS = 4096
"""Pairs of triangles that are looked at where surfaces cross."""


def common_point(a: PlacedSolid, b: PlacedSolid) -> np.ndarray | None:
    """Return a point in the world that lies in both of two bodies, (3,); None where they touch at most."""
    depth = DEEP * touch_tolerance(a, b)
    for one in (a, b):
        samples = one.solid.samples
        first = np.unique(one.solid.islands, return_index=True)[1]
        points = np.concatenate([samples.corners.transpose(2, 1, 0), one.solid.vertices[one.solid.corners[:, first].T]])
        points = points @ one.matrix[:3, :3].T + one.matrix[:3, 3]
        normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
        normals *= np.sign(np.linalg.det(one.matrix[:3, :3])) / np.maximum(
            np.linalg.norm(normals, axis=1, keepdims=True), 1e-300
        )
        found = _first_within(points.mean(axis=1) - depth * normals, a, b)
        if found is not None:
            return found
    return _first_within(_beside_crossings(a, b, depth), a, b)


def _first_within(points: np.ndarray, a: PlacedSolid, b: PlacedSolid) -> np.ndarray | None:
    """Return the first of (n, 3) points that lies in both bodies."""
    for place in (a, b):
        low, high = place.box
        points = points[((points >= low) & (points <= high)).all(axis=1)]
        points = points[winding_numbers(points, place) >= 1] if len(points) else points
    return points[0] if len(points) else None


def _beside_crossings(a: PlacedSolid, b: PlacedSolid, depth: float) -> np.ndarray:
    """Return points below both surfaces, (n, 3), beside where edges of one run through triangles of the other."""
    i, j = (each[:MOST_CROSSINGS] for each in overlapping_leaves(a.hierarchy, b.hierarchy, 0.0))
    found = [np.empty((0, 3))]
    for one, faces, other, others in ((a, i, b, j), (b, j, a, i)):
        normals = [normals_of(place, some) for place, some in ((one, faces), (other, others))]
        inwards = -sum(normal / np.maximum(length(normal), 1e-300) for normal in normals)
        p, q, r = (other.vertices[:, corner[others]] for corner in other.corners)
        for start, end in ((0, 1), (1, 2), (2, 0)):
            u, v = (one.vertices[:, one.corners[corner, faces]] for corner in (start, end))
            heights = dot(normals[1], u - p), dot(normals[1], v - p)
            with np.errstate(divide="ignore", invalid="ignore"):
                point = u + heights[0] / (heights[0] - heights[1]) * (v - u)
                sides = np.array([dot(normals[1], cross(y - x, point - x)) for x, y in ((p, q), (q, r), (r, p))])
            through = (heights[0] * heights[1] < 0.0) & (sides >= 0.0).all(axis=0)
            found.append((point + depth * inwards)[:, through].T)
    return np.concatenate(found)
