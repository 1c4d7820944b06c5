"""Pairs of triangles: whether they are apart, and what of one lies straight above the other."""

from __future__ import annotations

import numpy as np

from .surfaces import Surfaces, normals_of
from .vectors import cross, dot, length

# Cosine of the largest angle between faces that a plane through an edge of one may part where no other does.
NEARLY_PARALLEL = 0.9


def with_normals(surfaces: Surfaces, faces: np.ndarray) -> np.ndarray:
    """Return the corners of triangles and their unit normals, (4, 3 axes, k)."""
    normals = normals_of(surfaces, faces)
    points = surfaces.vertices[:, surfaces.corners[:, faces]].transpose(1, 0, 2)
    return np.concatenate([points, (normals / np.maximum(length(normals), 1e-300))[None]])


def without_separating_axis(
    a: np.ndarray, i: np.ndarray, b: np.ndarray, j: np.ndarray, tolerance: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Keep the pairs of triangles between which no plane leaves a gap of more than the tolerance, with their tolerances.

    Of two convex polyhedra that are apart, some plane along a face of one, or along an edge of each, lies between
    (Gottschalk, Lin and Manocha 1996, OBBTree); of two flat ones in nearly a plane, one that stands on an edge.

    :param a: (4, 3 axes, k) triangles; i: (n,) which of them each pair has; b and j: the others; tolerance: (n,).
    """
    keep = _plane_distance(a[:, :, i], b[0][:, j], b[3][:, j]) <= tolerance
    i, j, tolerance = i[keep], j[keep], tolerance[keep]
    keep = _plane_distance(b[:, :, j], a[0][:, i], a[3][:, i]) <= tolerance
    i, j, tolerance = i[keep], j[keep], tolerance[keep]
    if len(i) == 0:
        return i, j, tolerance
    p, q = a[:, :, i].swapaxes(0, 1), b[:, :, j].swapaxes(0, 1)
    edges_p, edges_q = edge_directions(p), edge_directions(q)
    keep = overlap_along(p, q, cross(edges_p[:, :, None], edges_q[:, None]).reshape(3, 9, -1), tolerance)
    flat = np.flatnonzero(keep & (np.abs(dot(p[:, 3], q[:, 3])) >= NEARLY_PARALLEL))
    if len(flat):
        p, q = p[:, :, flat], q[:, :, flat]
        within = cross(edges_p[:, :, flat], p[:, 3:]), cross(edges_q[:, :, flat], q[:, 3:])
        keep[flat] = overlap_along(p, q, np.concatenate(within, axis=1), tolerance[flat])
    return i[keep], j[keep], tolerance[keep]


def overlap_along(p: np.ndarray, q: np.ndarray, axes: np.ndarray, tolerance: np.ndarray) -> np.ndarray:
    """Return whether triangles overlap along all axes, but for a gap of the tolerance, (k,).

    :param p: (3 axes, 3 or more, k) triangles; q: the others; axes: (3, n, k).
    """
    lengths = length(axes)
    along_p, along_q = (dot((t[:, :3] - q[:, :1])[:, :, None], axes[:, None]) for t in (p, q))
    gap = np.maximum(along_p.min(axis=0) - along_q.max(axis=0), along_q.min(axis=0) - along_p.max(axis=0))
    # Nearly parallel edges span no plane.
    return ((gap <= tolerance * lengths) | (lengths < 1e-6)).all(axis=0)


def _plane_distance(triangles: np.ndarray, point: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Return the distances of (4, 3 axes, k) triangles from planes through (3, k) points; negative where planes cross them."""
    heights = [dot(corner - point, normal) for corner in triangles[:3]]
    lowest = np.minimum(np.minimum(heights[0], heights[1]), heights[2])
    highest = np.maximum(np.maximum(heights[0], heights[1]), heights[2])
    return np.maximum(lowest, -highest)


def edge_directions(triangles: np.ndarray) -> np.ndarray:
    """Return the unit vectors from each corner of (3 axes, 3 or more, k) triangles to the next, (3 axes, 3, k)."""
    edges = np.roll(triangles[:, :3], -1, axis=1) - triangles[:, :3]
    return edges / np.maximum(length(edges), 1e-300)


def clip_to_prism(p: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Clip triangles p to what lies straight above or below triangles q, both (3 axes, 4, k) with their normals.

    :return: (6, k) heights above q's plane of the corners of that part, not numbers where there is none; (k,) its area as
        seen along q's normal.
    """
    polygon = p[:, :3] - q[:, :1]
    edges = edge_directions(q)
    for corner in range(3):
        start = (q[:, corner] - q[:, 0])[:, None]
        polygon = _clip(polygon, dot(polygon - start, cross(q[:, 3], edges[:, corner])[:, None]))
    normal = q[:, 3:]
    area = 0.5 * np.abs(dot(cross(polygon, np.roll(polygon, -1, axis=1)), normal).sum(axis=0))
    return dot(polygon, normal), np.nan_to_num(area)


def _clip(polygons: np.ndarray, heights: np.ndarray) -> np.ndarray:
    """Clip convex polygons to what lies above a plane (Sutherland and Hodgman 1974, Reentrant polygon clipping).

    :param polygons: (3 axes, n, k) corners in order, some repeated where there are fewer.
    :param heights: (n, k) heights of the corners above the plane.
    :return: (3 axes, n + 1, k); not numbers where nothing is left.
    """
    count, number = heights.shape
    following = np.roll(heights, -1, axis=0)
    above = heights >= 0.0
    crossed = above != (following >= 0.0)
    part = np.divide(heights, heights - following, out=np.zeros_like(heights), where=crossed)
    cuts = polygons + part * (np.roll(polygons, -1, axis=1) - polygons)
    corners = np.stack([polygons, cuts], axis=2).reshape(3, 2 * count, number)
    kept = np.stack([above, crossed], axis=1).reshape(2 * count, number)
    order = np.argsort(~kept, axis=0, kind="stable")[: count + 1]
    order = np.where(np.arange(count + 1)[:, None] < kept.sum(axis=0), order, order[0])
    return np.where(kept.any(axis=0), np.take_along_axis(corners, order[None], axis=1), np.nan)
