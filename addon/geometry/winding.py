"""Winding numbers of closed surfaces about points, by signed crossings along rays."""

from __future__ import annotations

import numpy as np

from .hierarchy import leaves_in_boxes
from .numbering import CHUNK, index_ranges
from .surfaces import Surfaces

# A coordinate above everything.
ABOVE_ALL = 1e300


def winding_numbers(
    points: np.ndarray, surfaces: Surfaces, bodies: np.ndarray | None = None, left_out: np.ndarray | None = None
) -> np.ndarray:
    """Return the winding numbers of closed meshes about points, as signed crossings along rays upwards.

    An island counts only where a point lies in its box.

    :param points: (k, 3).
    :param bodies: (k,) the body for each point; None for the first.
    :param left_out: (k,) the triangle that is not counted for each point.
    :return: (k,) integers.
    """
    bodies = np.zeros(len(points), dtype=np.intp) if bodies is None else bodies
    by_island = surfaces.by_island[0]
    result = np.zeros(len(points), dtype=np.intp)
    for start in range(0, len(points), CHUNK):
        some = slice(start, start + CHUNK)
        owner, island = _candidate_islands(points[some], surfaces, bodies[some])
        owner += start
        low = points[owner].T
        high = np.array([low[0], low[1], np.full(len(owner), ABOVE_ALL)])
        ray, face = leaves_in_boxes(surfaces.island_trees, island, low, high)
        owner, face = owner[ray], by_island[face]
        if left_out is not None:
            other = face != left_out[owner]
            owner, face = owner[other], face[other]
        result += ray_crossings(points, surfaces, owner, face)
    return result


def count_islands_inside(
    a: Surfaces, first: np.ndarray, b: Surfaces, second: np.ndarray, tolerance: np.ndarray
) -> np.ndarray:
    """Count the islands of bodies that lie inside the other body of a pair, whose surfaces are apart, (n,).

    :param first: (n,) which body of a each pair has; second: which of b; tolerance: of the pair.
    """
    low, high = (side[:, second] + margin for side, margin in zip(b.boxes, (-tolerance, tolerance)))
    pair, island = index_ranges(a.island_starts[first], a.island_starts[first + 1])
    lowest, highest = a.island_boxes
    within = (lowest[:, island] >= low[:, pair]) & (highest[:, island] <= high[:, pair])
    pair, island = (each[within.all(axis=0)] for each in (pair, island))
    faces, starts = a.by_island
    inside = winding_numbers(a.centroids(faces[starts[island]]), b, second[pair]) >= 1  # one triangle speaks for all
    return np.bincount(pair[inside], minlength=len(first))


def _candidate_islands(points: np.ndarray, surfaces: Surfaces, bodies: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Find the islands in whose boxes points may lie.

    :param points: (n, 3); bodies: (n,) the body for each.
    :return: two arrays: points and islands.
    """
    count = len(surfaces.by_island[1]) - 1
    if count == len(surfaces.starts) - 1:
        return np.arange(len(points)), bodies
    island, tree = surfaces.pieces
    owner, piece = leaves_in_boxes(tree, bodies, points.T, points.T)
    return np.divmod(np.unique(owner * count + island[piece]), count)


def ray_crossings(points: np.ndarray, surfaces: Surfaces, owner: np.ndarray, face: np.ndarray) -> np.ndarray:
    """Sum the signed crossings of the rays upwards from points with some triangles, outwards positive.

    An edge that a ray meets is decided as if the point were moved by an infinitesimal along x and a smaller one along y
    (Edelsbrunner and Muecke 1990, Simulation of simplicity), so neighbouring triangles agree.

    :param points: (k, 3).
    :param owner: (n,) points; face: the triangles that may lie above each.
    :return: (k,) integers.
    """
    a, b, c = (surfaces.vertices[:, corner[face]] - points[owner].T for corner in surfaces.corners)
    areas = [_cross_2d(u, v) for u, v in ((b, c), (c, a), (a, b))]
    sides = [_side_of_edge(area, u, v) for area, (u, v) in zip(areas, ((b, c), (c, a), (a, b)))]
    covered = (sides[0] == sides[1]) & (sides[1] == sides[2])
    above = (areas[0] * a[2] + areas[1] * b[2] + areas[2] * c[2]) * sides[0] > 0.0
    crossing = np.where(covered & above, sides[0], 0)
    return np.rint(np.bincount(owner, weights=crossing, minlength=len(points))).astype(np.intp)


def _cross_2d(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return twice the signed area of the triangle of the origin, u and v as seen from above; negated for v, u."""
    return u[0] * v[1] - u[1] * v[0]


def _side_of_edge(area: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return +1 if a point just beside the origin lies left of the edge from u to v, -1 if right, 0 if the edge is vertical."""
    side = np.sign(area)
    side = np.where(side == 0.0, -np.sign(v[1] - u[1]), side)
    return np.where(side == 0.0, np.sign(v[0] - u[0]), side)
