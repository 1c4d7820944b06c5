"""Which media touch which: what lies around closed meshes that overlap. Arrays in, answers out.

A surface that no other crosses has the same surroundings everywhere, so one winding number answers for each connected
component of it. What crosses stays unknown: rays must ask the scene there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..model.contract import Exterior
from .pairs import PairRelation, candidate_pairs, relate_pairs
from .solids import Body, PlacedSolid, Solid


@dataclass(frozen=True, eq=False)
class Contact:
    """What is known of a body's outside.

    :param code: what lies outside.
    :param surrounding_body: index of a body that is the known surrounding medium where that lies outside.
    :param sole_priority: of an unknown exterior, a priority that decides by itself: the first surface of that priority which
        a ray from the body meets tells whether a body of that priority, and nothing else, holds the point.
    :param overlaps_itself: it overlaps itself.
    :param partners: bodies whose surfaces cross it or that hold part of it.
    :param coincident: other bodies, this body's triangles that share part of a plane with their surface, +1 for each
        whose normal points the same way, -1 for the others, and whether each lies on that surface as a whole.
    """

    code: Exterior
    surrounding_body: int | None = None
    sole_priority: int | None = None
    overlaps_itself: bool = False
    partners: tuple[int, ...] = ()
    coincident: tuple[tuple[int, np.ndarray, np.ndarray, np.ndarray], ...] = ()


@dataclass(eq=False)
class PairCache:
    """What is known from the last analysis: bodies in the world, and pairs of them."""

    places: dict[tuple, PlacedSolid] = field(default_factory=dict)
    pairs: dict[tuple, tuple[PairRelation, PairRelation]] = field(default_factory=dict)


def place_key(body: Body) -> tuple[Solid, bytes]:
    """Return the key of a body's place in a cache."""
    return body.solid, np.ascontiguousarray(body.matrix, dtype=np.float64).tobytes()


def analyse(bodies: Sequence[Body], cache: PairCache | None = None) -> list[Contact]:
    """Find what lies around every body.

    :param cache: what an earlier analysis found; brought up to date.
    """
    cache = PairCache() if cache is None else cache
    if not all(np.isfinite(body.matrix).all() and body.solid.closed for body in bodies):
        cache.places, cache.pairs = {}, {}
        return [
            Contact(Exterior.UNKNOWN, overlaps_itself=body.solid.closed and body.solid.overlaps_itself)
            for body in bodies
        ]
    keys = [place_key(body) for body in bodies]
    places = {
        key: cache.places.get(key) or PlacedSolid(body.solid, np.array(body.matrix, dtype=np.float64))
        for key, body in zip(keys, bodies)
    }
    candidates = candidate_pairs([places[key] for key in keys])
    pairs: dict[tuple, tuple[PairRelation, PairRelation] | None] = {}
    for i, j in candidates:
        key = (keys[i], keys[j])
        pairs[key] = cache.pairs.get(key)
    new = [key for key, pair in pairs.items() if pair is None]
    pairs.update(zip(new, relate_pairs([(places[first], places[second]) for first, second in new])))
    relations: list[list[tuple[int, PairRelation]]] = [[] for _ in bodies]
    for i, j in candidates:
        for one, other, relation in zip((i, j), (j, i), pairs[keys[i], keys[j]]):
            if relation.is_inside or relation.crosses:
                relations[one].append((other, relation))
    overlapping = [body.solid.overlaps_itself or places[key].flat for body, key in zip(bodies, keys)]
    cache.places, cache.pairs = places, pairs
    return _with_sole_priorities(
        bodies, [_contact(i, bodies, relations[i], overlapping[i]) for i in range(len(bodies))]
    )


def _contact(
    index: int, bodies: Sequence[Body], relations: list[tuple[int, PairRelation]], overlaps_itself: bool
) -> Contact:
    """Conclude what is known of one body, its sole priority apart, from what it is to its partners."""
    partners = tuple(sorted(j for j, _ in relations))
    order = bodies[index].solid.order
    coincident = tuple(
        (j, order[relation.coincident], relation.signs, relation.whole)
        for j, relation in relations
        if len(relation.coincident)
    )
    code, surrounding_body = (Exterior.UNKNOWN, None) if overlaps_itself else _exterior(index, bodies, relations)
    return Contact(code, surrounding_body, overlaps_itself=overlaps_itself, partners=partners, coincident=coincident)


def _exterior(
    index: int, bodies: Sequence[Body], relations: list[tuple[int, PairRelation]]
) -> tuple[Exterior, int | None]:
    """Return what lies outside a body, and one body that is the known surrounding medium.

    Of all bodies that hold it the strongest decides, unless another that might win there crosses the body.
    """
    own = bodies[index].priority
    uncertain = False
    for priority in sorted({bodies[j].priority for j, _ in relations}):
        members = [(j, relation) for j, relation in relations if bodies[j].priority == priority]
        containers = [j for j, relation in members if relation.is_inside]
        if containers and priority <= own:
            return Exterior.WINNER, None
        if containers and not uncertain and len({bodies[j].medium for j, _ in members}) == 1:
            return Exterior.MEDIUM, containers[0]
        uncertain = True
    return Exterior.UNKNOWN if uncertain else Exterior.AIR, None


def _with_sole_priorities(bodies: Sequence[Body], contacts: list[Contact]) -> list[Contact]:
    """Add the sole priorities: of all partners, where bodies of that priority are apart and whole."""
    faults: dict[int, list[tuple[int, ...]]] = {body.priority: [] for body in bodies}
    for i, contact in enumerate(contacts):
        own = bodies[i].priority
        faults[own] += [(i,)] * contact.overlaps_itself + [
            (i, j) for j in contact.partners if bodies[j].priority == own
        ]
    result = []
    for i, contact in enumerate(contacts):
        priorities = {bodies[j].priority for j in contact.partners}
        if contact.code == Exterior.UNKNOWN and not contact.overlaps_itself and len(priorities) == 1:
            (sole_priority,) = priorities
            # The body's own surface is left out.
            if all(i in fault for fault in faults[sole_priority]):
                contact = replace(contact, sole_priority=sole_priority)
        result.append(contact)
    return result
