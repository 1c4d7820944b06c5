"""Whether a triangle mesh bounds a volume. No bpy: arrays in, answers out."""

from __future__ import annotations

import numpy as np


def open_edge_count(triangles: np.ndarray) -> int:
    """Count edges that a closed, consistently oriented surface would not have.

    :param triangles: (n, 3) vertex indices. In a closed oriented surface every directed edge is met exactly as often
        as its reverse.
    """
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    forward = edges[:, 0] < edges[:, 1]
    low, high = edges.min(axis=1), edges.max(axis=1)
    undirected = low * (int(high.max(initial=0)) + 1) + high
    _, index = np.unique(undirected, return_inverse=True)
    balance = np.bincount(index, weights=np.where(forward, 1.0, -1.0))
    return int(np.count_nonzero(balance))


def signed_volume(vertices: np.ndarray, triangles: np.ndarray) -> float:
    """Return the volume inside a closed mesh, negative if its normals point inwards.

    Sum of the tetrahedra of every triangle and the origin, by the divergence theorem. ``vertices``: (m, 3), cubed in
    the result.
    """
    if len(triangles) == 0:
        return 0.0
    a, b, c = (vertices[triangles[:, corner]] - vertices.mean(axis=0) for corner in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def boxes_overlap(low_a: np.ndarray, high_a: np.ndarray, low_b: np.ndarray, high_b: np.ndarray) -> bool:
    """Tell whether two axis-aligned boxes share a volume."""
    return bool(np.all(np.maximum(low_a, low_b) < np.minimum(high_a, high_b)))
