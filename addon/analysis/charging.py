"""Which media are left to Cycles' own volumes, and which media make up for that. No bpy.

A volume absorbs for every ray, whatever stands in it and wherever light starts; but Cycles knows no priorities, so it absorbs
where another medium wins, too. Surfaces of the winner then give back what was taken there.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass

THIN = 3.0
"""Optical depth of the clearest colour on a mean way through the winner up to which it may be taken and given back: Cycles ends
paths on which little is left.
"""

READABLE = 20.0
"""That of any colour: single precision holds a few times as much."""


@dataclass(frozen=True, eq=False)
class Filling:
    """A body and what fills it.

    :param chord: mean length of ways through it.
    :param coefficients: what is absorbed of three colours per length; None if it may change.
    :param certain: its material may be told what follows from the body's place.
    :param simple: it can be a volume: with one material, that absorbs alike everywhere, and apart from others of its
        priority.
    :param wanted: something is near that only a volume charges for rightly.
    """

    material: Hashable
    priority: int
    chord: float
    coefficients: tuple[float, float, float] | None
    certain: bool = True
    simple: bool = True
    wanted: bool = False

    @property
    def absorbs(self) -> bool:
        """Whether it may absorb."""
        return self.coefficients is None or max(self.coefficients) > 0.0


def left_to_volumes(
    fillings: Sequence[Filling], pairs: Iterable[tuple[int, int]]
) -> tuple[set[Hashable], set[Hashable]]:
    """Tell whose volumes absorb for all rays, and which materials give back what those took where they do not win.

    :param pairs: indices of bodies that overlap.

    A medium that nothing wins over is left to its volume; another where something wants it. Ways through a winner end at its
    own surfaces and at those of who wins over it or is one with it.
    """
    over: dict[int, set[int]] = {}
    for pair in pairs:
        for one, other in (pair, pair[::-1]):
            if fillings[other].priority <= fillings[one].priority:
                over.setdefault(one, set()).add(other)
    unfit, divided = set(), set()
    wanted = {each.material for each in fillings if each.wanted}
    ends = {
        index: set().union(winners, *(over.get(winner, set()) for winner in winners)) - {index}
        for index, winners in over.items()
        if fillings[index].absorbs
    }
    for index, each in enumerate(fillings):
        if index in ends:
            divided.add(each.material)
        if not (
            each.simple
            and all(fillings[end].certain for end in ends.get(index, ()))
            and all(_can_be_given_back(fillings[winner], each) for winner in over.get(index, ()))
        ):
            unfit.add(each.material)
    volumes = {each.material for each in fillings if each.absorbs} - unfit - (divided - wanted)
    enders = set().union(*(ends[index] for index in ends if fillings[index].material in volumes))
    return volumes, {fillings[end].material for end in enders}


def _can_be_given_back(winner: Filling, loser: Filling) -> bool:
    """Return whether surfaces of a winner can give back what the volume of a loser takes within it."""
    if loser.coefficients is None or winner.priority == loser.priority:
        return False
    return winner.chord * min(loser.coefficients) <= THIN and winner.chord * max(loser.coefficients) <= READABLE
