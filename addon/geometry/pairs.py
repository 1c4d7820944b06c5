"""What two bodies are to each other: apart, one within the other, crossing, with faces in the same place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from .coplanar import coincident_triangles, parallel_pairs, share_a_plane
from .hierarchy import BoxHierarchy, morton_order, overlapping_leaves
from .numbering import CHUNK, NO_FACES, compact_numbers
from .solids import PlacedSolid, touch_tolerances
from .surfaces import FLOAT_ROUNDING, TOUCH_TOLERANCE, JoinedSurfaces, Surfaces
from .triangles import with_normals, without_separating_axis
from .vectors import length
from .winding import count_islands_inside

# Bodies of no more triangles are compared many pairs at a time, which have so many triangles together.
SMALL_BODY = 4096
BATCH_TRIANGLES = 1 << 18


@dataclass(frozen=True, eq=False)
class PairRelation:
    """What one body of a pair is to the other.

    :param is_inside: it lies wholly inside the other body.
    :param crosses: its surface crosses or touches the other's, or some of its islands lie inside the other body.
    :param coincident: triangles that share part of a plane with the other's surface; signs: +1 if the normals point the
        same way, else -1; whole: those that lie on it as a whole.
    """

    is_inside: bool = False
    crosses: bool = False
    coincident: np.ndarray = field(default_factory=lambda: NO_FACES)
    signs: np.ndarray = field(default_factory=lambda: NO_FACES)
    whole: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=bool))


_APART = PairRelation()


def candidate_pairs(places: Sequence[PlacedSolid]) -> list[tuple[int, int]]:
    """Find the pairs of bodies whose boxes meet."""
    if len(places) < 2:
        return []
    low, high = np.array([place.box for place in places]).transpose(1, 2, 0)
    first, second = overlapping_boxes(low, high, 2.0 * TOUCH_TOLERANCE)
    return list(zip(first.tolist(), second.tolist()))


def overlapping_boxes(low: np.ndarray, high: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Find the pairs of boxes that meet when grown by a part of their size, the first with the lower number.

    :param low: (3, n) lowest coordinates; high: highest.
    """
    size = length(high - low)
    margin = tolerance * size + 2.0 * FLOAT_ROUNDING * np.abs(np.concatenate([low, high])).max(axis=0) * (
        tolerance > 0.0
    )
    order = morton_order((low + high) / 2.0)
    boxes = BoxHierarchy(np.concatenate([low - margin, -high - margin])[:, order], np.array([0, len(order)]))
    first, second = overlapping_leaves(boxes, boxes, 0.0)
    first, second = order[first], order[second]
    once = first < second
    return first[once], second[once]


def relate_pairs(pairs: Sequence[tuple[PlacedSolid, PlacedSolid]]) -> list[tuple[PairRelation, PairRelation]]:
    """Tell what two bodies are to each other, for every pair. Small bodies are looked at together."""
    result: dict[int, tuple[PairRelation, PairRelation]] = {}
    crowds: list[list[int]] = [[]]
    room = BATCH_TRIANGLES
    known: set[int] = set()
    for number, pair in enumerate(pairs):
        counts = {id(place): place.corners.shape[1] for place in pair}
        if min(counts.values()) > SMALL_BODY:
            result[number] = _relate_together([pair])[0]
            continue
        room -= sum(count for place, count in counts.items() if place not in known)
        if room < 0:
            crowds.append([])
            room = BATCH_TRIANGLES - sum(counts.values())
            known = set()
        crowds[-1].append(number)
        known.update(counts)
    for numbers in crowds:
        result.update(zip(numbers, _relate_together([pairs[number] for number in numbers])))
    return [result[number] for number in range(len(pairs))]


def _relate_together(pairs: Sequence[tuple[PlacedSolid, PlacedSolid]]) -> list[tuple[PairRelation, PairRelation]]:
    """Tell what two bodies are to each other, for some pairs at once."""
    if not pairs:
        return []
    tolerances, alike = touch_tolerances(pairs)
    result = {}
    for number in alike:
        relation = _identical(*pairs[number], tolerances[number])
        if relation is not None:
            result[number] = (relation, relation)
    left = [number for number in range(len(pairs)) if number not in result]
    if len(left) == 1:
        a, b = pairs[left[0]]
        first = second = np.zeros(1, dtype=np.intp)
    elif left:
        places = {id(place): place for number in left for place in pairs[number]}
        a = b = JoinedSurfaces(list(places.values()))
        index = {place: number for number, place in enumerate(places)}
        first, second = (np.array([index[id(pairs[number][end])] for number in left]) for end in (0, 1))
    if left:
        result.update(zip(left, _relate_surfaces(a, first, b, second, tolerances[left])))
    return [result[number] for number in range(len(pairs))]


def _relate_surfaces(
    a: Surfaces, first: np.ndarray, b: Surfaces, second: np.ndarray, tolerance: np.ndarray
) -> list[tuple[PairRelation, PairRelation]]:
    """Tell what bodies are to each other in pairs.

    :param first: (n,) which body of a each pair has; second: which of b; tolerance: within which they touch.
    """
    i, j = overlapping_leaves(a.hierarchy, b.hierarchy, float(tolerance.max()), first, second)
    pair = _pairs_of_bodies(a, i, first, b, j, second)
    touch, coincident = _touching(a, i, b, j, pair, tolerance)
    relations = []
    for surfaces, bodies, others, partners, found in zip((a, b), (first, second), (b, a), (second, first), coincident):
        inside = np.zeros(len(first), dtype=np.intp)
        inside[~touch] = count_islands_inside(surfaces, bodies[~touch], others, partners[~touch], tolerance[~touch])
        is_inside = inside == np.diff(surfaces.island_starts)[bodies]
        relations.append(_split_by_pair(surfaces, bodies, is_inside, touch | (~is_inside & (inside > 0)), *found))
    return list(zip(*relations))


def _pairs_of_bodies(
    a: Surfaces, i: np.ndarray, first: np.ndarray, b: Surfaces, j: np.ndarray, second: np.ndarray
) -> np.ndarray:
    """Find the pair of bodies to which each pair of triangles belongs, (len(i),)."""
    if len(first) == 1:
        return np.zeros(len(i), dtype=np.intp)
    count = len(b.starts)
    keys = first * count + second
    order = np.argsort(keys)
    bodies = (np.searchsorted(each.starts, faces, side="right") - 1 for each, faces in ((a, i), (b, j)))
    return order[np.searchsorted(keys[order], next(bodies) * count + next(bodies))]


def _split_by_pair(
    surfaces: Surfaces,
    bodies: np.ndarray,
    is_inside: np.ndarray,
    crosses: np.ndarray,
    coincident: np.ndarray,
    signs: np.ndarray,
    whole: np.ndarray,
) -> list[PairRelation]:
    """Return the relation of a body to its partner for each pair.

    :param coincident: sorted triangles, each by its place in a table with a row for every pair.
    """
    width = surfaces.corners.shape[1]
    ends = np.searchsorted(coincident, width * np.arange(len(bodies) + 1)).tolist()
    result = []
    for number, first in enumerate((width * np.arange(len(bodies)) + surfaces.starts[bodies]).tolist()):
        if is_inside[number] or crosses[number]:
            some = slice(*ends[number : number + 2])
            result.append(
                PairRelation(
                    bool(is_inside[number]), bool(crosses[number]), coincident[some] - first, signs[some], whole[some]
                )
            )
        else:
            result.append(_APART)
    return result


def _identical(a: PlacedSolid, b: PlacedSolid, tolerance: float) -> PairRelation | None:
    """Return the relation of either of two bodies with the same triangles in the same places, or None of others."""
    if a.corners.shape != b.corners.shape or a.vertices.shape != b.vertices.shape:
        return None
    if not np.array_equal(a.corners, b.corners) or np.abs(a.vertices - b.vertices).max() > tolerance:
        return None
    faces = np.arange(a.corners.shape[1])
    every = np.ones(len(faces), dtype=np.int8)
    return PairRelation(crosses=True, coincident=faces, signs=every, whole=every.astype(bool))


def _touching(
    a: Surfaces, i: np.ndarray, b: Surfaces, j: np.ndarray, pair: np.ndarray, tolerance: np.ndarray
) -> tuple[np.ndarray, list[tuple[np.ndarray, np.ndarray, np.ndarray]]]:
    """Find which bodies cross, touch or coincide in pairs, and with which faces they coincide.

    :param i: (n,) triangles of a; j: those of b which may; pair: the pair of bodies to which both belong.
    :param tolerance: of every pair of bodies.
    :return: whether each pair touches; for a and b: triangles that coincide, their signs, and whether they do as a whole.
        Triangles are sorted, each by its place in a table with a row for every pair.
    """
    touch = np.zeros(len(tolerance), dtype=bool)
    if len(i) == 0:
        return touch, 2 * [(NO_FACES, _APART.signs, _APART.whole)]
    (keys_a, i), (keys_b, j) = (
        compact_numbers(pair * width + faces, len(tolerance) * width)
        for faces, width in ((i, a.corners.shape[1]), (j, b.corners.shape[1]))
    )
    of_a, of_b = (with_normals(each, keys % each.corners.shape[1]) for each, keys in ((a, keys_a), (b, keys_b)))
    chunks = [slice(start, start + CHUNK) for start in range(0, len(i), CHUNK)]
    pairs = [without_separating_axis(of_a, i[chunk], of_b, j[chunk], tolerance[pair[chunk]]) for chunk in chunks]
    i, j, tolerance = (np.concatenate(parts) for parts in zip(*pairs))
    touch[keys_a[i] // a.corners.shape[1]] = True
    i, j, cosine, tolerance = parallel_pairs(of_a, i, of_b, j, tolerance)
    shared = share_a_plane(of_a, i, of_b, j, tolerance)
    result = []
    for keys, *other in ((keys_a, of_a, i, of_b, j), (keys_b, of_b, j, of_a, i)):
        faces, signs, whole = coincident_triangles(*other, cosine, shared, tolerance)
        result.append((keys[faces], signs, whole))
    return touch, result
