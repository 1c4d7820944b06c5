"""Whole numbers of which some must be below others: which of them to change so that as little as can be changes, and to what.

Nodes are 0 to n - 1; a pair is two of them, of which the first is to have the lower number.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import pairwise

from .parameter import MAX_PRIORITY

GRID = 5
"""New numbers are multiples of it where there are any: half of the step between those of the presets."""

Pairs = Collection[tuple[int, int]]


def is_possible(count: int, pairs: Pairs, fixed: Mapping[int, int]) -> bool:
    """Return whether there are numbers from 0 to 1000 as some pairs want them, where some are fixed."""
    after = _after(count, pairs)
    order = _in_order(after)
    if order is None:
        return False
    lowest = [0] * count
    for node in order:
        if lowest[node] > fixed.get(node, MAX_PRIORITY):
            return False
        lowest[node] = fixed.get(node, lowest[node])
        for other in after[node]:
            lowest[other] = max(lowest[other], lowest[node] + 1)
    return True


def in_circles(count: int, pairs: Pairs) -> set[int]:
    """Return the nodes that are in circles of pairs, or between two circles."""
    before = _after(count, [(second, first) for first, second in pairs])
    return set(range(count)) - set(_sorted_part(_after(count, pairs))) - set(_sorted_part(before))


def possible_pairs(count: int, pairs: Sequence[tuple[int, int]], known: Pairs, fixed: Mapping[int, int]) -> list[int]:
    """Return the places of those among some pairs that go with the known ones and with each other; the first ones first."""
    kept = list(known)
    chosen: list[int] = []
    pending = [(0, len(pairs))] if pairs else []
    while pending:
        start, end = pending.pop()
        if is_possible(count, [*kept, *pairs[start:end]], fixed):
            kept += pairs[start:end]
            chosen += range(start, end)
        elif end - start > 1:
            middle = (start + end) // 2
            pending += [(middle, end), (start, middle)]
    return chosen


def fewest_changes(numbers: Sequence[int], weights: Sequence[int], pairs: Pairs) -> set[int]:
    """Return the nodes of the smallest weight in all that have to get another number.

    Two numbers cannot both stay where one has to be below the other and is not, with room for the nodes between them. That is
    a partial order, so what can stay is its heaviest antichain, which a maximum flow finds (Dilworth 1950; Ford and Fulkerson
    1962).

    :param pairs: no circles among them.
    """
    count = len(numbers)
    after = _after(count, pairs)
    order = _in_order(after)
    steps_to_end = [0] * count
    for node in reversed(order):
        steps_to_end[node] = max((steps_to_end[other] + 1 for other in after[node]), default=0)
    clashes: dict[int, list[int]] = {}
    lowest = [0] * count
    for place, node in enumerate(order):
        for other in after[node]:
            lowest[other] = max(lowest[other], lowest[node] + 1)
        steps = _steps_from(node, after, order[place:])
        clashes[node] = [other for other, step in steps.items() if step and numbers[other] - numbers[node] < step]
    out = {node for node in order if not lowest[node] <= numbers[node] <= MAX_PRIORITY - steps_to_end[node]}
    left = {node: set(others) - out for node, others in clashes.items() if node not in out}
    return out | _lightest_cover({node: others for node, others in left.items() if others}, weights)


def numbered(numbers: Sequence[int], pairs: Pairs, changed: Collection[int], wanted: Sequence[int]) -> list[int]:
    """Return the numbers with others for those that are to change, near what is wanted of each.

    :param changed: as :func:`fewest_changes` returns it.
    """
    after = _after(len(numbers), pairs)
    order = _in_order(after)
    highest = [MAX_PRIORITY] * len(numbers)
    for node in reversed(order):
        for other in after[node]:
            highest[node] = min(highest[node], (highest[other] if other in changed else numbers[other]) - 1)
    lowest = [0] * len(numbers)
    result = list(numbers)
    for node in order:
        if node in changed:
            result[node] = _chosen(lowest[node], highest[node], wanted[node])
        for other in after[node]:
            lowest[other] = max(lowest[other], result[node] + 1)
    return result


def _chosen(low: int, high: int, wanted: int) -> int:
    """Return a number from ``low`` to ``high``: what is wanted, or a multiple of :data:`GRID` next to it, or the middle."""
    if low <= wanted <= high:
        return wanted
    first, last = -(-low // GRID) * GRID, high // GRID * GRID
    if first > last:
        return (low + high) // 2
    return first if wanted < low else last


def _after(count: int, pairs: Iterable[tuple[int, int]]) -> list[list[int]]:
    """List for every node those that must have higher numbers."""
    after: list[set[int]] = [set() for _ in range(count)]
    for first, second in pairs:
        after[first].add(second)
    return [sorted(others) for others in after]


def _sorted_part(after: Sequence[Sequence[int]]) -> list[int]:
    """Return the nodes, each behind all that must have lower numbers; without those in circles and behind them."""
    waiting = [0] * len(after)
    for others in after:
        for other in others:
            waiting[other] += 1
    order = [node for node, count in enumerate(waiting) if not count]
    for node in order:
        for other in after[node]:
            waiting[other] -= 1
            if not waiting[other]:
                order.append(other)
    return order


def _in_order(after: Sequence[Sequence[int]]) -> list[int] | None:
    """Return all nodes in an order that pairs allow, or None where they go in circles."""
    order = _sorted_part(after)
    return order if len(order) == len(after) else None


def _steps_from(start: int, after: Sequence[Sequence[int]], order: Iterable[int]) -> dict[int, int]:
    """Return the most steps from a node to each that can be reached from it."""
    steps = {start: 0}
    for node in order:
        if node in steps:
            for other in after[node]:
                steps[other] = max(steps.get(other, 0), steps[node] + 1)
    return steps


def _lightest_cover(clashes: Mapping[int, Collection[int]], weights: Sequence[int]) -> set[int]:
    """Return the nodes of the smallest weight in all without which no clash of a partial order is left.

    :param clashes: by node, those after it that it clashes with.
    """
    left = {node: weights[node] for node in clashes}
    right = {node: weights[node] for node in sorted(set().union(*clashes.values()))}
    flow: dict[int, dict[int, int]] = {node: {} for node in right}
    while True:
        came_from, end = _augmenting(clashes, left, right, flow)
        if end is None:
            break
        path = [end]
        while (before := came_from[path[-1]]) is not None:
            path.append(before)
        amount = min(right[end[1]], left[path[-1][1]])
        for (_, other), (_, node) in list(pairwise(path))[1::2]:
            amount = min(amount, flow[node][other])
        for (side, other), (_, node) in pairwise(path):
            first, second, sign = (node, other, 1) if side else (other, node, -1)
            flow[second][first] = flow[second].get(first, 0) + sign * amount
        left[path[-1][1]] -= amount
        right[end[1]] -= amount
    return {node for node in clashes if (0, node) not in came_from} | {node for side, node in came_from if side}


def _augmenting(
    clashes: Mapping[int, Collection[int]],
    left: Mapping[int, int],
    right: Mapping[int, int],
    flow: Mapping[int, Mapping[int, int]],
) -> tuple[dict[tuple[int, int], tuple[int, int] | None], tuple[int, int] | None]:
    """Look for a way on which more can flow: where each place (side, node) was come to from, and the end of the way."""
    came_from: dict[tuple[int, int], tuple[int, int] | None] = {(0, node): None for node in left if left[node]}
    queue = deque(came_from)
    while queue:
        place = side, node = queue.popleft()
        if side and right[node]:
            return came_from, place
        others = [other for other, amount in flow[node].items() if amount] if side else sorted(clashes[node])
        for other in others:
            if (1 - side, other) not in came_from:
                came_from[1 - side, other] = place
                queue.append((1 - side, other))
    return came_from, None
