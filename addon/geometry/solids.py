"""Closed meshes, and their places in the world."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from . import meshes, self_overlap
from .hierarchy import morton_order
from .numbering import group_by_number
from .samples import Samples, spread_samples
from .surfaces import FLOAT_ROUNDING, TOUCH_TOLERANCE, Surfaces, normals_of
from .vectors import length


@dataclass(frozen=True, eq=False)
class Solid:
    """A triangle mesh in its own space: made once and kept, since its properties are computed once.

    :param vertices: (n, 3) float64.
    :param triangles: (m, 3) int32, vertex indices, counterclockwise from outside.
    """

    vertices: np.ndarray
    triangles: np.ndarray

    @cached_property
    def closed(self) -> bool:
        """Return whether it bounds a volume: it is finite, has no open or inconsistent edges, and is not inverted."""
        return (
            len(self.triangles) >= 4
            and bool(np.isfinite(self.vertices).all())
            and meshes.is_closed(self.triangles)
            and meshes.signed_volume(self.vertices, self.triangles) > 0.0
        )

    @cached_property
    def mean_chord(self) -> float:
        """Return the mean length of straight ways through it, as of a convex body: 4 V / S (Cauchy 1850)."""
        a, b, c = (self.vertices[self.triangles[:, corner]] for corner in range(3))
        surface = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
        return 4.0 * meshes.signed_volume(self.vertices, self.triangles) / max(float(surface), 1e-30)

    @cached_property
    def samples(self) -> Samples:
        """Return points spread evenly over it."""
        return spread_samples(self.vertices, self.triangles)

    @cached_property
    def order(self) -> np.ndarray:
        """Sort the triangles by their first corners, neighbours in space one after the other, (m,)."""
        return morton_order(self.vertices.T[:, self.triangles[:, 0]])

    @cached_property
    def corners(self) -> np.ndarray:
        """Return the vertex indices of the ordered triangles, (3, m): first, second and third corners."""
        return np.ascontiguousarray(self.triangles[self.order].T, dtype=np.intp)

    @cached_property
    def islands(self) -> np.ndarray:
        """Number the connected components of the ordered triangles from 0, (m,)."""
        a, b, c = self.corners
        root = meshes.connected(len(self.vertices), np.concatenate([a, b]), np.concatenate([b, c]))
        used = np.zeros(len(self.vertices), dtype=bool)
        used[root[a]] = True
        return (np.cumsum(used) - 1)[root[a]]

    @cached_property
    def by_island(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the ordered triangles, an island's after the other's; (k + 1,) the place of each one's first."""
        return group_by_number(self.islands)

    @cached_property
    def overlapping_triangle(self) -> int | None:
        """Return a triangle where its surface overlaps itself, None where it does nowhere."""
        found = self_overlap.overlapping_triangle(self._aligned)
        return None if found is None else int(self.order[found])

    @property
    def overlaps_itself(self) -> bool:
        """Return whether its surface crosses itself, or some island does not separate the inside from the outside."""
        return self.overlapping_triangle is not None

    def inward_triangles(self) -> np.ndarray:
        """Return the triangles of islands whose normals point into them, and that are no cavities of others."""
        if len(self.by_island[1]) == 2:
            return self.order[:0]
        return np.sort(self.order[np.isin(self.islands, self_overlap.inward_islands(self._aligned))])

    @property
    def _aligned(self) -> PlacedSolid:
        """Return it so turned that the boxes of many islands are apart."""
        place = PlacedSolid(self, np.eye(4))
        return PlacedSolid(self, self_overlap.aligning_frame(place)) if len(self.by_island[1]) > 2 else place


@dataclass(frozen=True)
class Body:
    """A medium in the scene.

    :param matrix: (4, 4) from the mesh's space to the world's.
    :param priority: the lowest wins.
    :param medium: equal for bodies that are filled with the same.
    """

    solid: Solid
    matrix: np.ndarray
    priority: int
    medium: Hashable

    def is_same(self, other: Body) -> bool:
        """Return whether another body is the same solid in the same place with the same values."""
        return np.array_equal(self.matrix, other.matrix) and all(
            getattr(self, item.name) == getattr(other, item.name) for item in fields(self) if item.name != "matrix"
        )


@dataclass(frozen=True, eq=False)
class PlacedSolid(Surfaces):
    """A solid in the world."""

    solid: Solid
    matrix: np.ndarray

    @cached_property
    def flat(self) -> bool:
        """Return whether the matrix leaves no volume."""
        linear = self.matrix[:3, :3]
        return bool(abs(np.linalg.det(linear)) <= 1e-12 * np.prod(np.linalg.norm(linear, axis=0)))

    @cached_property
    def vertices(self) -> np.ndarray:
        """Return the world coordinates, (3, n)."""
        return self.matrix[:3, :3] @ self.solid.vertices.T + self.matrix[:3, 3:]

    @cached_property
    def corners(self) -> np.ndarray:
        """Return the vertex indices, (3, m), counterclockwise from outside even where the matrix mirrors."""
        mirrored = np.linalg.det(self.matrix[:3, :3]) < 0.0
        return self.solid.corners[::-1] if mirrored else self.solid.corners

    @cached_property
    def box(self) -> tuple[np.ndarray, np.ndarray]:
        """Find the lowest and the highest coordinates, (3,) each."""
        return self.vertices.min(axis=1), self.vertices.max(axis=1)

    @property
    def starts(self) -> np.ndarray:
        """Return where the triangles of the one body start and end."""
        return np.array([0, self.corners.shape[1]])

    @property
    def islands(self) -> np.ndarray:
        """Return the islands of the solid."""
        return self.solid.islands

    @property
    def by_island(self) -> tuple[np.ndarray, np.ndarray]:
        return self.solid.by_island

    @property
    def island_starts(self) -> np.ndarray:
        """Return where the islands of the one body start and end."""
        return np.array([0, len(self.solid.by_island[1]) - 1])

    @property
    def boxes(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the lowest and the highest coordinates, (3, 1) each."""
        return self.box[0][:, None], self.box[1][:, None]

    @cached_property
    def island_boxes(self) -> tuple[np.ndarray, np.ndarray]:
        return self.boxes if len(self.by_island[1]) == 2 else super().island_boxes

    @cached_property
    def areas(self) -> np.ndarray:
        """Return the areas of the triangles, (m,)."""
        return 0.5 * length(normals_of(self))


def touch_tolerance(a: PlacedSolid, b: PlacedSolid) -> float:
    """Return the distance within which surfaces of two bodies touch, scene units."""
    return float(touch_tolerances([(a, b)])[0][0])


def touch_tolerances(pairs: Sequence[tuple[PlacedSolid, PlacedSolid]]) -> tuple[np.ndarray, list[int]]:
    """Return the distance within which surfaces of two bodies touch, for every pair, and the pairs with equal boxes."""
    boxes = np.array([(a.box, b.box) for a, b in pairs])
    size = np.linalg.norm(boxes[:, :, 1] - boxes[:, :, 0], axis=2).min(axis=1)
    tolerances = TOUCH_TOLERANCE * size + FLOAT_ROUNDING * np.abs(boxes).max(axis=(1, 2, 3))
    apart = np.abs(boxes[:, 0] - boxes[:, 1]).max(axis=(1, 2))
    return tolerances, np.flatnonzero(apart <= tolerances).tolist()
