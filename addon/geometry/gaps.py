"""Surfaces that nearly touch: films of air between bodies, overlaps and walls too thin for single precision.

A body is looked at from points spread over its surface: what of another surface lies straight before or behind them, and looks
back. So a film counts by the part of the surface along which it runs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .numbering import CHUNK
from .pairs import BATCH_TRIANGLES, SMALL_BODY, overlapping_boxes
from .samples import SAMPLES, meet
from .solids import PlacedSolid, Solid, touch_tolerances
from .surfaces import JoinedSurfaces, Surfaces
from .vectors import cross, length
from .winding import winding_numbers

FILM = 0.02
"""Thickness of the thickest film, in sizes of the smaller body, where it runs around it or the bodies touch beside it."""

FLAT_FILM = 1e-3
"""The same where it only runs along one side: thicker ones stand between bodies that are meant to be apart."""

FILM_SHARE = 0.1
"""Part of the smaller body's surface along which a film runs at least."""

ONE_SIDE = 0.7
"""Length of the mean normal from which on a film runs along one side."""

FACING = 0.96
"""Cosine of the largest angle between surfaces that look at each other; two tessellations of one curve differ by less."""

THIN_SHARE = 0.02
"""Part of a surface from which on an overlap or a wall is thin, not only where it ends in an edge."""

TELLABLE = 2.0
"""The thinnest overlap that rays tell from none, in distances within which surfaces count as touching."""

FIRST = 64
"""Points of a surface that are looked at first."""


@dataclass(frozen=True, eq=False)
class Layer:
    """A layer between two surfaces that look at each other, seen from points of the first. Coordinates are stored by axis.

    :param first, second: indices of the bodies; the first is the smaller one.
    :param share: of the first one's surface.
    :param points: (3, k) on it; normals: (3, k) outwards; faces: (k,) its triangles.
    :param thickness: (k,) scene units.
    :param one_sided: it runs along one side of the first.
    """

    first: int
    second: int
    share: float
    points: np.ndarray
    normals: np.ndarray
    faces: np.ndarray
    thickness: np.ndarray
    one_sided: bool


@dataclass(frozen=True, eq=False)
class _View:
    """What the points of one surface see of another.

    :param distances: (k,) to what looks back, negative where that lies behind; infinite where there is none.
    """

    points: np.ndarray
    normals: np.ndarray
    weights: np.ndarray
    faces: np.ndarray
    distances: np.ndarray

    def share(self, seen: np.ndarray) -> float:
        """Return the part of the surface that some of the points stand for."""
        return float(self.weights[seen].sum() / max(self.weights.sum(), 1e-300))

    def layer(self, first: int, second: int, seen: np.ndarray) -> Layer:
        """Return the layer between the surfaces at some points."""
        weights = self.weights[seen]
        mean = (self.normals[:, seen] * weights).sum(axis=1) / max(weights.sum(), 1e-300)
        return Layer(
            first,
            second,
            self.share(seen),
            self.points[:, seen],
            self.normals[:, seen],
            self.faces[seen],
            np.abs(self.distances[seen]),
            bool(length(mean) > ONE_SIDE),
        )


def find_layers(places: Sequence[PlacedSolid], touching: Sequence[Sequence[int]]) -> tuple[list[Layer], list[Layer]]:
    """Find the films of air between bodies, and overlaps too thin to be told from none.

    :param touching: for each body the others that it touches, crosses or lies in.
    """
    if len(places) < 2:
        return [], []
    low, high = np.array([place.box for place in places]).transpose(1, 2, 0)
    sizes = length(high - low)
    pairs = [(i, j) if sizes[i] <= sizes[j] else (j, i) for i, j in zip(*overlapping_boxes(low, high, FILM))]
    if not pairs:
        return [], []
    tolerances, _ = touch_tolerances([(places[i], places[j]) for i, j in pairs])
    films = FILM * sizes[[i for i, _ in pairs]]
    nearly = []
    for start in range(0, len(pairs), CHUNK):
        some = slice(start, start + CHUNK)
        views = _look(places, pairs[some], films[some], TELLABLE * tolerances[some], FIRST)
        nearly += [number for number, view in enumerate(views, start) if _is_near(view, tolerances[number])]
    gaps, thin = [], []
    for number in nearly:
        some = slice(number, number + 1)
        (view,) = _look(places, pairs[some], films[some], TELLABLE * tolerances[some], SAMPLES)
        first, second = pairs[number]
        overlaps = (view.distances < -tolerances[number]).nonzero()[0]
        if view.share(overlaps) >= THIN_SHARE:
            thin.append(view.layer(first, second, overlaps))
        beside = second in touching[first] or first in touching[second]
        seen = _in_air(view, places, low, high, tolerances[number])
        if view.share(seen) < FILM_SHARE:
            continue
        if view.layer(first, second, seen).one_sided and not beside:
            seen = seen[view.distances[seen] <= FLAT_FILM * sizes[first]]
        if view.share(seen) >= FILM_SHARE:
            gaps.append(view.layer(first, second, seen))
    return gaps, thin


def _is_near(view: _View, tolerance: float) -> bool:
    """Return whether so many of a few points see a film or a thin overlap that all are to be looked at."""
    film = np.isfinite(view.distances) & (view.distances > tolerance)
    return view.share(film) >= FILM_SHARE / 2.0 or bool((view.distances < -tolerance).any())


def _in_air(
    view: _View, places: Sequence[PlacedSolid], low: np.ndarray, high: np.ndarray, tolerance: float
) -> np.ndarray:
    """Return the points before which there is a film that no body fills.

    :param low: (3, n) lowest coordinates of the bodies; high: the highest.
    """
    seen = np.flatnonzero(np.isfinite(view.distances) & (view.distances > tolerance))
    middle = view.points[:, seen] + 0.5 * view.distances[seen] * view.normals[:, seen]
    free = np.ones(len(seen), dtype=bool)
    for index in np.flatnonzero((low <= middle.max(axis=1, initial=-np.inf)[:, None]).all(axis=0)):
        within = free & ((middle >= low[:, index, None]) & (middle <= high[:, index, None])).all(axis=0)
        if within.any():
            free[within] = winding_numbers(middle[:, within].T, places[index]) < 1
    return seen[free]


def _look(
    places: Sequence[PlacedSolid], pairs: Sequence[tuple[int, int]], before: np.ndarray, behind: np.ndarray, count: int
) -> list[_View]:
    """Look from points of the first of each pair for what of the second looks back.

    :param before, behind: (n,) how far to look, for each pair; count: from how many points.
    """
    points, normals, weights, faces = _samples([places[first] for first, _ in pairs], count)
    distances = np.full(len(faces), np.inf)
    for surfaces, numbers, trees in _groups(places, pairs):
        some = (count * numbers[:, None] + np.arange(count)).ravel()
        owner = np.repeat(numbers, count)
        way, _, distance, cosine = meet(
            surfaces, np.repeat(trees, count), points[:, some], normals[:, some], before[owner], behind[owner]
        )
        # Of all that a way meets the first counts; what lies behind comes before it.
        order = np.lexsort([distance, way])
        way, distance, cosine = way[order], distance[order], cosine[order]
        behind_it = distance < 0.0
        kept = (~behind_it | (cosine <= -FACING)).nonzero()[0]
        way, first = np.unique(way[kept], return_index=True)
        kept = kept[first]
        facing = cosine[kept] <= -FACING
        distances[some[way[facing]]] = distance[kept][facing]
    parts = (slice(start, start + count) for start in range(0, len(faces), count))
    return [_View(points[:, some], normals[:, some], weights[some], faces[some], distances[some]) for some in parts]


def _samples(places: Sequence[PlacedSolid], count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return points on surfaces, as many on each: (3, k), their normals, the areas they stand for, their triangles."""
    matrices = np.array([place.matrix for place in places])
    samples = [place.solid.samples for place in places]
    corners = np.array([each.corners[:, :, :count] for each in samples])
    corners = np.einsum("nij,njck->icnk", matrices[:, :3, :3], corners) + matrices[:, :3, 3].T[:, None, :, None]
    normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = normals * np.sign(np.linalg.det(matrices[:, :3, :3]))[:, None]
    doubled = length(normals)
    shares, areas = (np.array([getattr(each, name)[..., :count] for each in samples]) for name in ("shares", "areas"))
    points = (corners * shares.transpose(1, 0, 2)).sum(axis=1)
    weights = np.divide(doubled, areas, out=np.zeros_like(doubled), where=areas > 0.0)
    normals = normals / np.maximum(doubled, 1e-300)
    faces = np.array([each.faces[:count] for each in samples])
    return points.reshape(3, -1), normals.reshape(3, -1), weights.ravel(), faces.ravel()


def _groups(
    places: Sequence[PlacedSolid], pairs: Sequence[tuple[int, int]]
) -> list[tuple[Surfaces, np.ndarray, np.ndarray]]:
    """Return surfaces that hold the second of each pair, small ones together: the pairs, and the body of each in them."""
    by_target: dict[int, list[int]] = {}
    for number, (_, second) in enumerate(pairs):
        by_target.setdefault(second, []).append(number)
    crowds: list[list[int]] = []
    room = 0
    for target in by_target:
        count = places[target].corners.shape[1]
        room -= count
        if room < 0 or count > SMALL_BODY:
            crowds.append([])
            room = BATCH_TRIANGLES - count if count <= SMALL_BODY else 0
        crowds[-1].append(target)
    result = []
    for crowd in crowds:
        surfaces = places[crowd[0]] if len(crowd) == 1 else JoinedSurfaces([places[target] for target in crowd])
        numbers = np.concatenate([by_target[target] for target in crowd])
        result.append((surfaces, numbers, np.repeat(np.arange(len(crowd)), [len(by_target[each]) for each in crowd])))
    return result


def room_ahead(layer: Layer, wall: PlacedSolid, ahead: np.ndarray, reach: float) -> float:
    """Return by how much all points of a layer may reach into a wall before one comes out of it, or farther than a distance.

    :param wall: the second body of the layer; ahead: (k,) how far before the points it begins; reach: how far to look into it.
    """
    before = np.full(len(ahead), ahead.max() + reach)
    way, _, distance, cosine = meet(
        wall, np.zeros(len(before), dtype=np.intp), layer.points, layer.normals, before, np.zeros(len(before))
    )
    leaving = cosine > 0.0
    ends = before.copy()
    np.minimum.at(ends, way[leaving], distance[leaving])
    return float(ends.min() - ahead.max())


def thin_walls(place: PlacedSolid, limit: float) -> Layer | None:
    """Return where a body's own wall is thinner than a limit, or None where no considerable part of it is."""
    points, normals, weights, faces = _samples([place], SAMPLES)
    count = len(faces)
    way, _, distance, cosine = meet(
        place, np.zeros(count, dtype=np.intp), points, -normals, np.full(count, limit), np.zeros(count)
    )
    across = cosine >= FACING  # unlike the triangle on which the way begins
    distances = np.full(count, np.inf)
    np.minimum.at(distances, way[across], distance[across])
    view = _View(points, normals, weights, faces, distances)
    seen = np.flatnonzero(np.isfinite(distances))
    return view.layer(0, 0, seen) if view.share(seen) >= THIN_SHARE else None


def thinnest_wall(solid: Solid) -> float:
    """Return the thickness of the thinnest considerable wall of a solid in its own units; infinite beyond FILM of its size."""
    place = PlacedSolid(solid, np.eye(4))
    layer = thin_walls(place, FILM * float(np.linalg.norm(np.subtract(*place.box))))
    return np.inf if layer is None else float(np.quantile(layer.thickness, min(THIN_SHARE / layer.share, 1.0)))
