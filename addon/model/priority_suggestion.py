"""Suggested priorities: what has to win over what where media overlap, with as few numbers changed as can be."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from .number_orders import fewest_changes, in_circles, is_possible, numbered, possible_pairs
from .winning_rules import Order, Overlap, Placed, orders_as_they_are, orders_by_nature


@dataclass(frozen=True)
class Change:
    """One number that is suggested.

    :param owner: whose number it is, if all objects that have theirs from it want the same; else None.
    :param body: the object that wants a number of its own, or one of the owner's.
    :param reason: the rest of a sentence that goes on after "because".
    """

    owner: Hashable | None
    body: int
    before: int
    after: int
    reason: str


def suggested(bodies: Sequence[Placed], overlaps: Iterable[Overlap]) -> list[Change]:
    """Return the numbers that are to change, the lowest new one first; empty where all is well.

    What lies wholly inside another wins over it; else bubbles over solids, solids over ice, ice over liquids, and of two
    liquids the one that floats. Where that decides nothing, numbers that differ keep their order, and equal ones of different
    media are parted. Objects that have one number from the same place, or that touch and are of one medium and one number, go
    on having one, unless some must win over what others must give way to. Whoever accepts all is suggested nothing more.
    """
    overlaps = list(overlaps)
    orders = _orders(bodies, overlaps)
    units = _units(bodies, overlaps, orders)
    numbers = [bodies[unit[0]].priority for unit in units]
    place = {body: index for index, unit in enumerate(units) for body in unit}
    pairs = {(place[order.winner], place[order.loser]) for order in orders}
    pairs = {(first, second) for first, second in pairs if first != second}
    changed = fewest_changes(numbers, _weights(bodies, units), pairs)
    wanted = [_usual(bodies, unit) for unit in units]
    new = numbered(numbers, pairs, changed, wanted)
    reasons = _reasons(bodies, orders, units, changed)
    numbers_by_body = {body: new[index] for index, unit in enumerate(units) for body in unit}
    changes = _by_owner(bodies, numbers_by_body, {body: reasons.get(place[body], "") for body in place})
    return sorted(changes, key=lambda change: (change.after, bodies[change.body].name))


def _orders(bodies: Sequence[Placed], overlaps: Sequence[Overlap]) -> list[Order]:
    """Return the orders that go with each other and with what cannot be changed; of those that do not, the stronger ones."""
    fixed = {index: body.priority for index, body in enumerate(bodies) if body.is_fixed}
    natural = orders_by_nature(bodies, overlaps)
    found: list[Order] = []
    for reason in sorted({order.reason for order in natural}, reverse=True):
        found += _possible(len(bodies), [order for order in natural if order.reason == reason], found, fixed)
    decided = {frozenset((order.winner, order.loser)) for order in found}
    chosen = list(orders_as_they_are(bodies, overlaps, decided))
    kept = _possible(len(bodies), chosen, found, fixed)
    left = [Order(order.loser, order.winner, order.reason.APART) for order in chosen if order not in set(kept)]
    found += kept
    return found + _possible(len(bodies), left, found, fixed)


def _possible(count: int, orders: Sequence[Order], known: Sequence[Order], fixed: Mapping[int, int]) -> list[Order]:
    pairs = [(order.winner, order.loser) for order in orders]
    return [orders[place] for place in possible_pairs(count, pairs, [(o.winner, o.loser) for o in known], fixed)]


def _units(bodies: Sequence[Placed], overlaps: Iterable[Overlap], orders: Iterable[Order]) -> list[tuple[int, ...]]:
    """Return the objects that are to keep one number, together; each alone where its fellows want another."""
    parent = list(range(len(bodies)))

    def root(body: int) -> int:
        while parent[body] != body:
            parent[body] = body = parent[parent[body]]
        return body

    first: dict[Hashable, int] = {}
    for index, body in enumerate(bodies):
        parent[root(index)] = root(first.setdefault(body.owner, index))
    for overlap in overlaps:
        one, other = bodies[overlap.one], bodies[overlap.other]
        if (one.medium, one.priority) == (other.medium, other.priority):
            parent[root(overlap.one)] = root(overlap.other)
    groups: dict[int, list[int]] = {}
    for index in range(len(bodies)):
        groups.setdefault(root(index), []).append(index)
    units = [tuple(group) for group in groups.values()]
    while True:
        place = {body: index for index, unit in enumerate(units) for body in unit}
        pairs = {(place[order.winner], place[order.loser]) for order in orders}
        inner = {first for first, second in pairs if first == second}
        pairs = {(first, second) for first, second in pairs if first != second}
        fixed = {place[index]: body.priority for index, body in enumerate(bodies) if body.is_fixed}
        if not inner and is_possible(len(units), pairs, fixed):
            return units
        torn = {index for index in inner | in_circles(len(units), pairs) if len(units[index]) > 1}
        torn = torn or set(range(len(units)))
        units = sorted(
            part
            for index, unit in enumerate(units)
            for part in (((body,) for body in unit) if index in torn else (unit,))
        )


def _weights(bodies: Sequence[Placed], units: Sequence[tuple[int, ...]]) -> list[int]:
    """Return how much it takes to change each unit: places where numbers are set, and at last numbers that are usual."""
    most = 2 * len(units) + 1
    weights = []
    for unit in units:
        owners = len({bodies[body].owner for body in unit})
        is_usual = bodies[unit[0]].priority == bodies[unit[0]].kind
        fixed = (len(bodies) + 1) * most if any(bodies[body].is_fixed for body in unit) else 0
        weights.append(owners * most + is_usual + fixed)
    return weights


def _usual(bodies: Sequence[Placed], unit: Sequence[int]) -> int:
    """Return the number that presets give what a unit is, or that it has if it is of no known kind."""
    first = bodies[unit[0]]
    return first.priority if first.kind is None else int(first.kind)


def _reasons(
    bodies: Sequence[Placed], orders: Iterable[Order], units: Sequence[tuple[int, ...]], changed: set[int]
) -> dict[int, str]:
    """Return why each unit gets another number: the strongest order with what keeps its number that its own is against.

    Of several it is the one that is broken most. Where there is none it makes room for others: the strongest of its orders with
    those that change.
    """
    place = {body: index for index, unit in enumerate(units) for body in unit}
    reasons: dict[int, tuple[tuple, str]] = {}
    for order in orders:
        ends = order.winner, order.loser
        is_broken = bodies[order.winner].priority >= bodies[order.loser].priority
        for body, other, is_winner in ((*ends, True), (*ends[::-1], False)):
            if place[body] in changed:
                is_aside = is_broken == (place[other] in changed)
                distance = bodies[order.loser].priority - bodies[order.winner].priority
                key = not is_broken, is_aside, -order.reason, distance, bodies[other].name, bodies[body].name
                reason = key, order.in_words(bodies, is_winner)
                reasons[place[body]] = min(reasons.get(place[body], reason), reason)
    return {index: text for index, (_, text) in reasons.items()}


def _by_owner(bodies: Sequence[Placed], numbers: Mapping[int, int], reasons: Mapping[int, str]) -> list[Change]:
    """Return the changes, one for an owner whose objects all get the same number."""
    owned: dict[Hashable, list[int]] = {}
    for index, body in enumerate(bodies):
        owned.setdefault(body.owner, []).append(index)
    changes = []
    for owner, members in owned.items():
        if len({numbers[body] for body in members}) == 1:
            members = members[:1]
        else:
            owner = None
        changes += [
            Change(owner, body, bodies[body].priority, numbers[body], reasons[body])
            for body in members
            if numbers[body] != bodies[body].priority
        ]
    return changes
