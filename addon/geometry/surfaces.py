"""Surfaces of one or many bodies in the world, with the boxes by which their triangles are found."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from .hierarchy import FIRST_TREE, BoxHierarchy, leaves_in_boxes, morton_order, padded_boxes
from .numbering import index_ranges
from .vectors import cross

# Surfaces closer than this touch, in sizes of the smaller body.
TOUCH_TOLERANCE = 1e-5

# A few units in the last place of the float32 coordinates that Cycles traces.
FLOAT_ROUNDING = 2.5e-7

# Boxes into which a long or flat island is cut at most, along its longest axis and the next.
MOST_PIECES = (64, 8)


class Surfaces:
    """Triangles of one or many bodies in the world, one body's after the other's. Coordinates are stored by axis.

    :ivar vertices: (3, n) world coordinates.
    :ivar corners: (3, m) vertex indices, counterclockwise from outside.
    :ivar starts: (bodies + 1,) first triangle of each body, and the number of all.
    :ivar islands: (m,) number of every triangle's connected component, those of a body in a row.
    :ivar by_island: the triangles, an island's after the other's; (k + 1,) the place of each one's first.
    :ivar island_starts: (bodies + 1,) first island of each body, and the number of all.
    """

    vertices: np.ndarray
    corners: np.ndarray
    starts: np.ndarray
    islands: np.ndarray
    by_island: tuple[np.ndarray, np.ndarray]
    island_starts: np.ndarray

    @cached_property
    def bounds(self) -> np.ndarray:
        """Find the lowest coordinates of the triangles, and the highest ones negated, (6, m)."""
        bounds = padded_boxes(self.corners.shape[1])
        for axis in range(3):
            a, b, c = (self.vertices[axis].take(corner) for corner in self.corners)
            np.minimum(np.minimum(a, b), c, out=bounds[axis])
            np.negative(np.maximum(np.maximum(a, b), c), out=bounds[axis + 3])
        return bounds

    @cached_property
    def hierarchy(self) -> BoxHierarchy:
        """Build the hierarchy of all triangles, a tree for each body."""
        return BoxHierarchy(self.bounds, self.starts)

    @cached_property
    def island_trees(self) -> BoxHierarchy:
        """Build the hierarchy of the triangles by island, a tree for each island."""
        return BoxHierarchy(self.bounds[:, self.by_island[0]], self.by_island[1])

    @cached_property
    def pieces(self) -> tuple[np.ndarray, BoxHierarchy]:
        """Return the islands in some boxes that together hold all of them, and a tree of those boxes for each body."""
        bounds, island = _island_pieces(self)
        body = np.searchsorted(self.island_starts, island, side="right") - 1
        order = morton_order((bounds[:3] - bounds[3:]) / 2.0)
        order = order[np.argsort(body[order], kind="stable")]
        starts = np.searchsorted(body[order], np.arange(len(self.starts)))
        return island[order], BoxHierarchy(bounds[:, order], starts)

    @cached_property
    def island_axes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Find the principal axes of every island.

        :return: (k, 3, 3) axes as columns, the longest first; (3, k) how far the island extends along them; (3, k) its middle.
        """
        low, high = self.island_boxes
        faces, starts = self.by_island
        count = len(starts) - 1
        centre = (low + high) / 2.0
        numbers = np.repeat(np.arange(count), 3 * np.diff(starts))
        offset = self.vertices[:, self.corners[:, faces].T.ravel()] - centre[:, numbers]
        products = np.stack([u * v for u in offset for v in offset])
        squares = np.add.reduceat(products, 3 * starts[:-1], axis=1).T.reshape(-1, 3, 3)
        axes = np.linalg.eigh(squares)[1][:, :, ::-1]
        along = np.einsum("kn,nka->an", offset, axes[numbers])
        least, most = (each.reduceat(along, 3 * starts[:-1], axis=1) for each in (np.minimum, np.maximum))
        return axes, most - least, centre + np.einsum("nka,an->kn", axes, (least + most) / 2.0)

    @cached_property
    def island_boxes(self) -> tuple[np.ndarray, np.ndarray]:
        """Find the lowest and the highest coordinates of the islands, (3, k) each."""
        faces, starts = self.by_island
        bounds = np.minimum.reduceat(self.bounds[:, faces], starts[:-1], axis=1)
        return bounds[:3], -bounds[3:]

    @cached_property
    def boxes(self) -> tuple[np.ndarray, np.ndarray]:
        """Find the lowest and the highest coordinates of the bodies, (3, bodies) each."""
        bounds = np.minimum.reduceat(self.bounds, self.starts[:-1], axis=1)
        return bounds[:3], -bounds[3:]

    def points(self, faces: np.ndarray) -> np.ndarray:
        """Return the corners of some triangles, (k, 3 corners, 3 axes)."""
        return self.vertices.T[self.corners[:, faces].T]

    def centroids(self, faces: np.ndarray) -> np.ndarray:
        """Return the centres of some triangles, (k, 3)."""
        return self.points(faces).mean(axis=1)


class JoinedSurfaces(Surfaces):
    """Surfaces of many bodies as one, each given with one body."""

    def __init__(self, places: Sequence[Surfaces]) -> None:
        def starts(counts: list[int]) -> np.ndarray:
            return np.concatenate([[0], np.cumsum(counts)])

        def joined(parts: list[np.ndarray], first: np.ndarray) -> np.ndarray:
            return np.concatenate([part + start for part, start in zip(parts, first.tolist())], axis=-1)

        self.vertices = np.concatenate([place.vertices for place in places], axis=1)
        first_vertices = starts([place.vertices.shape[1] for place in places])
        self.corners = joined([place.corners for place in places], first_vertices)
        self.starts = starts([place.corners.shape[1] for place in places])
        self.island_starts = starts([len(place.by_island[1]) - 1 for place in places])
        self.islands = joined([place.islands for place in places], self.island_starts)
        faces = joined([place.by_island[0] for place in places], self.starts)
        first_faces = joined([place.by_island[1][:-1] for place in places], self.starts)
        self.by_island = faces, np.append(first_faces, self.starts[-1])


def _island_pieces(surfaces: Surfaces) -> tuple[np.ndarray, np.ndarray]:
    """Find boxes that together hold all islands.

    Islands that would leave most of a box empty, as long or flat ones do that lie askew, are cut along their own axes.

    :return: (6, n) lowest coordinates and highest ones negated; (n,) the island in each.
    """
    axes, extent, middle = surfaces.island_axes
    skew = np.sort(np.abs(axes), axis=1)[:, 1].T * extent
    thin = np.maximum(extent, 1e-9 * extent[0])
    parts = np.array([np.clip(skew[i] / thin[i + 1], 1, MOST_PIECES[i]).astype(int) for i in range(2)])
    island, number = index_ranges(np.zeros(parts.shape[1], dtype=int), parts[0] * parts[1])
    part = np.divmod(number, parts[1][island])
    step = extent / np.array([*parts, np.ones(parts.shape[1])])
    offset = (np.array([*part, 0 * number]) + 0.5) * step[:, island] - 0.5 * extent[:, island]
    centre = middle[:, island] + np.einsum("nka,an->kn", axes[island], offset)
    # Cut boxes must not leave a gap to rounding.
    half = np.einsum("nka,an->kn", np.abs(axes), step / 2.0)[:, island] + FLOAT_ROUNDING * np.abs(centre).max()
    return np.concatenate([centre - half, -centre - half]), island


def normals_of(surfaces: Surfaces, faces: np.ndarray | slice = slice(None)) -> np.ndarray:
    """Return the outward normals of triangles, as long as twice their areas, (3, ...)."""
    a, b, c = (corner[faces] for corner in surfaces.corners)
    u, v = ([], [])
    for axis in surfaces.vertices:
        first = axis[a]
        u.append(axis[b] - first)
        v.append(axis[c] - first)
    return cross(u, v)


def faces_in_box(surfaces: Surfaces, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return the triangles of the first body whose boxes meet a box."""
    return leaves_in_boxes(surfaces.hierarchy, FIRST_TREE, low[:, None], high[:, None])[1]
