"""Where a triangle mesh fails to bound a volume: at which triangles, and which of them are turned the wrong way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import meshes


@dataclass(frozen=True, eq=False)
class MeshFaults:
    """What is wrong with the edges of a mesh.

    :param holes: triangles at edges that only they have; crowded: at edges of three or more that no other pairs with.
    :param turned: those that look the other way than most of their connected component, or than its outside; where it has
        but one side, those along the seam.
    """

    holes: np.ndarray
    crowded: np.ndarray
    turned: np.ndarray


def mesh_faults(vertices: np.ndarray, triangles: np.ndarray) -> MeshFaults:
    """Find the triangles at which a mesh is not closed, and where all edges are paired those that are turned.

    :param vertices: (n, 3); triangles: (m, 3) their indices, points in one place under one index.
    """
    edge, forward, owner = _half_edges(triangles)
    count = np.bincount(edge)
    holes, crowded = (np.unique(owner[odd[edge]]) for odd in (count == 1, (count > 2) & (count % 2 == 1)))
    if len(holes) or len(crowded):
        return MeshFaults(holes, crowded, holes[:0])
    uneven = np.bincount(edge, weights=np.where(forward, 1.0, -1.0)) != 0.0
    seam = np.unique(owner[uneven[edge]])
    if len(seam) == 0:
        return MeshFaults(seam, seam, seam)
    turned = _turned(vertices, triangles, edge, forward, owner)
    return MeshFaults(holes, crowded, seam if turned is None else turned)


def _half_edges(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return for each side of a triangle the number of its edge, whether it runs along it, and the triangle."""
    start = triangles.T.reshape(-1).astype(np.int64)
    end = np.roll(triangles, -1, axis=1).T.reshape(-1).astype(np.int64)
    owner = np.tile(np.arange(len(triangles)), 3)
    proper = np.flatnonzero(start != end)
    start, end = start[proper], end[proper]
    low, high = np.minimum(start, end), np.maximum(start, end)
    _, edge = np.unique(low * (int(high.max(initial=0)) + 1) + high, return_inverse=True)
    return edge.reshape(-1), start < end, owner[proper]


def _turned(
    vertices: np.ndarray, triangles: np.ndarray, edge: np.ndarray, forward: np.ndarray, owner: np.ndarray
) -> np.ndarray | None:
    """Return the triangles that look inwards, of components whose triangles do not all look alike.

    Each triangle is two nodes of a graph, as it is and turned; an edge of two joins the pairs that look alike.

    :return: None where a component has but one side.
    """
    room = len(triangles)
    order = np.argsort(edge, kind="stable")
    count = np.bincount(edge)
    first = (np.cumsum(count) - count)[count == 2]
    one, other = order[first], order[first + 1]
    flip = forward[one] == forward[other]
    a, b = owner[one], owner[other]
    links = np.concatenate([a, a + room]), np.concatenate([b + room * flip, b + room * ~flip])
    root = meshes.connected(2 * room, *links)
    as_it_is, reversed_ = root[:room], root[room:]
    if (as_it_is == reversed_).any():
        return None
    component = np.minimum(as_it_is, reversed_)
    side = np.where(as_it_is == component, 1.0, -1.0)
    p, q, r = (vertices[corner].astype(np.float64) - vertices.mean(axis=0) for corner in triangles.T)
    volume = np.bincount(component, weights=side * np.einsum("ij,ij->i", p, np.cross(q, r)), minlength=room)
    mixed = np.bincount(component, minlength=room) != np.abs(np.bincount(component, weights=side, minlength=room))
    return np.flatnonzero((side != np.where(volume[component] < 0.0, -1.0, 1.0)) & mixed[component])
