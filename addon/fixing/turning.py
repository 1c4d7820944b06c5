"""Which faces of a mesh have to be turned so that all look out of the medium: NumPy and trees, nothing is changed."""

from __future__ import annotations

import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ..geometry import meshes

_DIRECTION = np.array((0.3713, 0.4871, 0.7904))
"""Along no edge of usual meshes."""

_STEP = 1e-6
"""By which a ray goes on behind what it has met, in the largest coordinate of the mesh."""


def islands_of(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Return the number of each triangle's connected component, (m,), from 0; seams connect.

    :param vertices: (n, 3) float32; triangles: (m, 3) indices.
    """
    joined = meshes.same_places(vertices)[triangles]
    a, b, c = joined.T
    root = meshes.connected(len(vertices), np.concatenate([a, b]), np.concatenate([b, c]))
    return np.unique(root[a], return_inverse=True)[1].reshape(-1)


def is_consistent(vertices: np.ndarray, triangles: np.ndarray) -> bool:
    """Return whether triangles are closed and turned alike; seams are no gaps."""
    return meshes.open_edge_count(meshes.same_places(vertices)[triangles]) == 0


def turned_islands(vertices: np.ndarray, before: np.ndarray, after: np.ndarray, islands: np.ndarray) -> np.ndarray:
    """Return which islands are still to be turned, once the faces of each are turned alike, (k,) bool.

    Islands in no other look outwards. What lies in another keeps its sense towards it where it had one, as the wall of a
    hollow body or as a body in a body; else it is a hollow, by the parity of what it lies in.

    :param before: (m, 3) triangles as they were; after: (m, 3) as each island is turned alike now; islands: (m,).
    """
    count = int(islands.max(initial=-1)) + 1
    inside = _containers(vertices, after, islands, count)
    then, now = (_volumes(vertices, triangles, islands, count) for triangles in (before, after))
    consistent = _consistent_islands(vertices, before, islands, count)
    wanted = np.ones(count)
    for island, around in enumerate(inside):
        root = next((other for other in sorted(around) if not inside[other]), None)
        if root is not None and consistent[island] and consistent[root]:
            wanted[island] = np.sign(then[island]) * np.sign(then[root])
        elif len(around) % 2:
            wanted[island] = -1.0
    return now * wanted < 0.0


def _volumes(vertices: np.ndarray, triangles: np.ndarray, islands: np.ndarray, count: int) -> np.ndarray:
    """Return the volume of each island, negative where its faces look inwards, (k,)."""
    corners = vertices[triangles].astype(np.float64)
    number = np.maximum(np.bincount(islands, minlength=count), 1)
    middle = corners.mean(axis=1)
    centres = np.stack([np.bincount(islands, middle[:, axis], count) / number for axis in range(3)], axis=1)
    a, b, c = (corners - centres[islands, None]).swapaxes(0, 1)
    return np.bincount(islands, np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0, count)


def _consistent_islands(vertices: np.ndarray, triangles: np.ndarray, islands: np.ndarray, count: int) -> np.ndarray:
    """Return which islands are closed and turned alike, (k,) bool."""
    corners = meshes.same_places(vertices)[triangles]
    edges = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]).astype(np.int64)
    low, high = edges.min(axis=1), edges.max(axis=1)
    _, first, which = np.unique(low * len(vertices) + high, return_index=True, return_inverse=True)
    balance = np.bincount(which.reshape(-1), np.sign(edges[:, 1] - edges[:, 0]))
    result = np.ones(count, dtype=bool)
    result[np.tile(islands, 3)[first[balance != 0.0]]] = False
    return result


def _containers(vertices: np.ndarray, triangles: np.ndarray, islands: np.ndarray, count: int) -> list[set[int]]:
    """Return in which other islands each lies, by the parity of what a ray meets from its outermost point."""
    if count < 2:
        return [set() for _ in range(count)]
    tree = BVHTree.FromPolygons(vertices.tolist(), triangles.tolist(), all_triangles=True)
    along = vertices @ _DIRECTION
    step = Vector(_DIRECTION).normalized() * float(np.abs(vertices).max()) * _STEP
    result = []
    for island in range(count):
        corners = np.unique(triangles[islands == island])
        point = Vector(vertices[corners[along[corners].argmax()]])
        met = np.zeros(count, dtype=int)
        while (hit := tree.ray_cast(point + step, _DIRECTION))[0] is not None:
            met[islands[hit[2]]] += 1
            point = hit[0]
        met[island] = 0
        result.append(set(np.flatnonzero(met % 2).tolist()))
    return result
