"""How far faces of bodies may move before they meet a surface."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .hierarchy import BoxHierarchy, overlapping_leaves
from .numbering import CHUNK, NO_FACES
from .solids import Body, PlacedSolid, touch_tolerance
from .triangles import clip_to_prism, with_normals

# Part of a face from which on what lies beyond is a wall, not the rim of what the face lies on.
LEAST_WALL = 0.01


class Walls:
    """Where the surfaces of bodies are, to tell how far faces may move."""

    def __init__(self, bodies: Sequence[Body]) -> None:
        self._places = [PlacedSolid(body.solid, body.matrix) for body in bodies]
        self.boxes = np.array([place.box for place in self._places]).reshape(-1, 2, 3)
        """(n, 2, 3) lowest and highest coordinates of every body."""

    def clearance(self, index: int, faces: np.ndarray, sides: np.ndarray, reach: float) -> float:
        """Find how far triangles of a body may move before they meet a wall, a body's own or another's.

        Surfaces that reach a triangle's plane where it lies, and what is straight before less than a hundredth of it,
        are no walls.

        :param faces: (k,) the triangles; sides: (k,) 1 where they move outwards, -1 where inwards.
        :param reach: how far to look, scene units; the answer where there is no wall.
        """
        place = self._places[index]
        own = np.empty_like(place.solid.order)
        own[place.solid.order] = np.arange(len(own))
        faces = own[faces]
        side = np.zeros(len(own))
        side[faces] = sides
        faces = np.sort(faces)
        moved = BoxHierarchy(place.bounds[:, faces], np.array([0, len(faces)]))
        low, high = moved.bounds[:3].min(axis=1), -moved.bounds[3:].min(axis=1)
        near = (self.boxes[:, 0] <= high + reach).all(axis=1) & (self.boxes[:, 1] >= low - reach).all(axis=1)
        for beyond in (self._places[other] for other in np.flatnonzero(near)):
            first, second = overlapping_leaves(moved, beyond.hierarchy, reach)
            reach = _distance_before(place, faces[first], side, beyond, second, reach)
        return reach


def _distance_before(
    place: PlacedSolid, first: np.ndarray, side: np.ndarray, beyond: PlacedSolid, second: np.ndarray, reach: float
) -> float:
    """Return the least distance within reach from triangles to those of a surface that lie before them on one side."""
    found = [(NO_FACES, np.empty(0), np.empty(0))]
    for start in range(0, len(first), CHUNK):
        i, j = first[start : start + CHUNK], second[start : start + CHUNK]
        heights, area = clip_to_prism(with_normals(beyond, j).swapaxes(0, 1), with_normals(place, i).swapaxes(0, 1))
        lowest = (heights * side[i]).min(axis=0)
        before = np.flatnonzero((lowest > touch_tolerance(place, beyond)) & (lowest < reach))
        found.append((i[before], lowest[before], area[before]))
    i, lowest, area = (np.concatenate(parts) for parts in zip(*found))
    order = np.lexsort([lowest, i])
    i, lowest, area = i[order], lowest[order], area[order]
    # Of all that lies before one triangle, from the nearest on.
    covered = np.cumsum(area)
    start = np.searchsorted(i, i)
    covered -= covered[start] - area[start]
    return float(lowest[covered >= LEAST_WALL * place.areas[i]].min(initial=reach))
