"""Triangles that lie in the same place in one plane."""

from __future__ import annotations

import numpy as np

from . import meshes
from .numbering import CHUNK
from .solids import Solid
from .triangles import clip_to_prism, edge_directions, overlap_along
from .vectors import cross, dot, length

# Cosine of the largest angle between faces that coincide.
LEAST_COSINE = 0.999

# Sine of the largest angle between faces of one flat side.
LARGEST_BEND = 1e-3


def parallel_pairs(
    a: np.ndarray, i: np.ndarray, b: np.ndarray, j: np.ndarray, tolerance: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Keep the pairs of triangles that are parallel, with the products of their normals and their tolerances."""
    cosine = dot(a[3][:, i], b[3][:, j])
    parallel = np.abs(cosine) >= LEAST_COSINE
    return i[parallel], j[parallel], cosine[parallel], tolerance[parallel]


def coincident_triangles(
    a: np.ndarray,
    i: np.ndarray,
    b: np.ndarray,
    j: np.ndarray,
    cosine: np.ndarray,
    shared: np.ndarray,
    tolerance: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Find which triangles of a coincide with parallel ones of b, in part or as a whole.

    :param a: (4, 3 axes, k) triangles; i: (n,) which of them each pair has; b and j: the others.
    :param cosine: (n,) products of the normals; shared: whether the pair shares part of a plane; tolerance: within which
        that is.
    :return: the triangles; int8 signs of the products; whether all corners and the centre lie on some of b.
    """
    q = b[:, :, j]
    edges = edge_directions(q.swapaxes(0, 1))
    samples = np.concatenate([a[:3], a[:3].mean(axis=0, keepdims=True)])[:, :, i].swapaxes(0, 1)
    on = np.abs(dot(samples - q[0][:, None], q[3][:, None])) <= tolerance
    for corner in range(3):
        on &= dot(samples - q[corner][:, None], cross(q[3], edges[:, corner])[:, None]) >= -tolerance
    covered = np.zeros((4, a.shape[2]), dtype=bool)
    for sample in range(4):
        covered[sample, i[on[sample]]] = True
    whole = covered.all(axis=0)
    signs = np.zeros(a.shape[2], dtype=np.int8)
    for pairs in (shared, on[3]):
        signs[i[pairs]] = np.where(cosine[pairs] >= 0.0, 1, -1)
    in_part = np.zeros(a.shape[2], dtype=bool)
    in_part[i[shared]] = True
    faces = np.flatnonzero(whole | in_part)
    return faces, signs[faces], whole[faces]


def share_a_plane(a: np.ndarray, i: np.ndarray, b: np.ndarray, j: np.ndarray, tolerance: np.ndarray) -> np.ndarray:
    """Return whether nearly parallel triangles overlap by more than the tolerance where they lie in one place, (n,)."""
    result = np.zeros(len(i), dtype=bool)
    for start in range(0, len(i), CHUNK):
        chunk = slice(start, start + CHUNK)
        p, q = a[:, :, i[chunk]].swapaxes(0, 1), b[:, :, j[chunk]].swapaxes(0, 1)
        within = cross(edge_directions(p), p[:, 3:]), cross(edge_directions(q), q[:, 3:])
        found = np.flatnonzero(overlap_along(p, q, np.concatenate(within, axis=1), -tolerance[chunk]))
        heights, _ = clip_to_prism(p[:, :, found], q[:, :, found])
        result[start + found] = np.nan_to_num(np.abs(heights), nan=np.inf).max(axis=0) <= tolerance[chunk][found]
    return result


def flat_sides(solid: Solid) -> np.ndarray:
    """Assign a number to each triangle, the same to those of one flat side, (m,).

    Triangles of a flat side are joined by edges that do not bend.
    """
    corners = solid.triangles.T.astype(np.int64)
    a, b = np.concatenate(corners), np.concatenate(np.roll(corners, -1, axis=0))
    edges = np.minimum(a, b) * len(solid.vertices) + np.maximum(a, b)
    order = np.argsort(edges, kind="stable")
    same = edges[order[1:]] == edges[order[:-1]]
    faces = order % len(solid.triangles)
    first, second = faces[:-1][same], faces[1:][same]
    p, q, r = (solid.vertices.T[:, corner] for corner in corners)
    normals = cross(q - p, r - p)
    u, v = normals[:, first], normals[:, second]
    bend = length(cross(u, v))
    flat = (bend <= LARGEST_BEND * length(u) * length(v)) & (dot(u, v) > 0.0)
    return meshes.connected(len(solid.triangles), first[flat], second[flat])
