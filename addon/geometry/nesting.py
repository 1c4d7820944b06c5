"""What a ray meets on its way through nested bodies: interfaces that exist, and surfaces that do not. No bpy."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Crossing:
    """A surface that a ray meets.

    :param body: equal for surfaces of one body; priority: of its medium, the lowest wins.
    :param enters: the ray goes into it.
    """

    body: Hashable
    priority: int
    enters: bool


@dataclass(frozen=True)
class Met:
    """What a ray has met.

    :param valid: interfaces between two media, each of which costs a bounce of transmission or reflection.
    :param hidden: surfaces inside a winner, each of which costs a transparent bounce.
    :param priorities: the most priorities that a point of its way lies in at once.
    """

    valid: int = 0
    hidden: int = 0
    priorities: int = 0


def count_crossings(crossings: Iterable[Crossing]) -> Met:
    """Count what a ray meets that begins in air and goes straight on.

    A surface is valid if its medium wins over all others that hold the point (Schmidt and Budge, 2002).
    """
    holds: Counter[Hashable] = Counter()
    priorities: dict[Hashable, int] = {}
    valid = hidden = most = 0
    for crossing in crossings:
        priorities[crossing.body] = crossing.priority
        others = (priorities[body] for body, count in holds.items() if count > 0 and body != crossing.body)
        if min(others, default=crossing.priority + 1) > crossing.priority:
            valid += 1
        else:
            hidden += 1
        holds[crossing.body] += 1 if crossing.enters else -1
        most = max(most, len({priorities[body] for body, count in holds.items() if count > 0}))
    return Met(valid, hidden, most)
