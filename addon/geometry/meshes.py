"""Whether a triangle mesh bounds a volume. No bpy: arrays in, answers out."""

from __future__ import annotations

import numpy as np


def open_edge_count(triangles: np.ndarray) -> int:
    """Count edges that a closed, consistently oriented surface would not have.

    :param triangles: (n, 3) vertex indices. In a closed oriented surface every directed edge is met exactly as often
        as its reverse.
    """
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    edges = edges[edges[:, 0] != edges[:, 1]]
    forward = edges[:, 0] < edges[:, 1]
    low, high = edges.min(axis=1), edges.max(axis=1)
    undirected = low * (int(high.max(initial=0)) + 1) + high
    _, index = np.unique(undirected, return_inverse=True)
    balance = np.bincount(index, weights=np.where(forward, 1.0, -1.0))
    return int(np.count_nonzero(balance))


def same_places(vertices: np.ndarray) -> np.ndarray:
    """Return for every vertex the first one in exactly the same place.

    A seam whose sides have vertices of their own, as texts, caps of curves and files for printers have, is so no gap.

    :param vertices: (n, 3) float32.
    """
    rows = np.ascontiguousarray(vertices + np.float32(0.0)).view(np.dtype((np.void, 12))).reshape(-1)
    _, first, place = np.unique(rows, return_index=True, return_inverse=True)
    return first[place.reshape(-1)].astype(np.int32)


def signed_volume(vertices: np.ndarray, triangles: np.ndarray) -> float:
    """Return the volume inside a closed mesh, negative if its normals point inwards.

    Sum of the tetrahedra of every triangle and the origin, by the divergence theorem. ``vertices``: (m, 3), cubed in
    the result.
    """
    if len(triangles) == 0:
        return 0.0
    x, y, z = (
        [axis[triangles[:, corner]] for corner in range(3)] for axis in (vertices - vertices.mean(axis=0)).T.copy()
    )
    normal_x = (y[1] - y[0]) * (z[2] - z[0]) - (z[1] - z[0]) * (y[2] - y[0])
    return float(np.dot(normal_x, x[0] + x[1] + x[2]) / 6.0)


def surface_area(vertices: np.ndarray, triangles: np.ndarray) -> float:
    """Return the area of a mesh. ``vertices``: (m, 3), squared in the result."""
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


def mean_chord(vertices: np.ndarray, triangles: np.ndarray) -> float:
    """Return the mean length of the straight ways through a closed mesh, in units of its ``vertices``; 0 without a surface.

    It is 4 V / S, exact for convex bodies in light from everywhere (Cauchy 1850, Note sur divers théorèmes relatifs à la
    rectification des courbes et à la quadrature des surfaces).
    """
    area = surface_area(vertices, triangles)
    return 4.0 * abs(signed_volume(vertices, triangles)) / area if area > 0.0 else 0.0


def is_closed(triangles: np.ndarray) -> bool:
    """Return whether every directed edge is met exactly as often as its reverse, without sorting the edges.

    With two random numbers r and s for every vertex, the sum of r[a] s[b] - s[a] r[b] over all directed edges is 0 if
    the edges cancel. If they do not, it is a polynomial of the random numbers other than 0, whose value is 0 modulo
    2**64 in less than one of 2**55 meshes (Schwartz 1980, Fast probabilistic algorithms for verification of polynomial
    identities).

    :param triangles: (n, 3) vertex indices.
    """
    count = int(triangles.max(initial=-1)) + 1
    generator = np.random.default_rng(0)
    r, s = (generator.integers(0, 2**64, count, dtype=np.uint64) for _ in range(2))
    (ra, rb, rc), (sa, sb, sc) = ([table[triangles[:, corner]] for corner in range(3)] for table in (r, s))
    total = ra * (sb - sc) + rb * (sc - sa) + rc * (sa - sb)
    return int(total.sum(dtype=np.uint64)) == 0


def connected(count: int, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the root of the connected component of every node of a graph.

    Roots are hooked onto smaller roots across all links at once, and paths to roots halved, until no link joins two
    components (Shiloach and Vishkin 1982, An O(log n) parallel connectivity algorithm).

    :param count: number of nodes.
    :param a: one end of every link, a node's index; b: the other end.
    :return: (count,) nodes; equal for nodes that links join.
    """
    root = np.arange(count)
    while len(a):
        root[np.maximum(a, b)] = np.minimum(a, b)
        while not np.array_equal(above := root.take(root), root):
            root = above.take(above)
        a, b = root.take(a), root.take(b)
        apart = np.flatnonzero(a != b)
        a, b = a.take(apart), b.take(apart)
    return root
