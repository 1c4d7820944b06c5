"""What a medium is told of its exterior, what holds for several media at once, and how it is stored in one number."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from ..model.contract import AIR_AROUND, NO_SOLE_PRIORITY, Exterior, Facts, pack_facts
from ..nodes.sockets import CLEAR


@dataclass(frozen=True)
class ExteriorFacts:
    """What a medium is told of its exterior; the defaults tell nothing.

    :param code: what lies outside.
    :param sole_priority: of an unknown exterior, the one priority of all that touches the medium, or NO_SOLE_PRIORITY.
    :param may_hold_objects: objects that are no media may stand in it.
    :param medium: priority, IOR and transmittance depth of the medium outside; transmittance: its colour.
    :param by_volume: Cycles' own volume absorbs inside; gives_back: its surfaces give back what other volumes absorbed.
    """

    code: Exterior = Exterior.UNKNOWN
    sole_priority: float = NO_SOLE_PRIORITY
    overlaps_itself: bool = False
    may_hold_objects: bool = True
    medium: tuple[float, float, float] = AIR_AROUND
    transmittance: tuple[float, float, float, float] = CLEAR
    by_volume: bool = False
    gives_back: bool = False

    @property
    def absorbs(self) -> bool:
        """Return whether the medium outside is said to absorb."""
        return self.transmittance != CLEAR

    def merged(self, other: ExteriorFacts) -> ExteriorFacts | None:
        """Return what holds for both, or None if that is less than each is told."""
        if self == other:
            return self
        if (self.code, self.medium, self.transmittance) != (other.code, other.medium, other.transmittance):
            return None
        return replace(
            self,
            sole_priority=self.sole_priority if self.sole_priority == other.sole_priority else NO_SOLE_PRIORITY,
            overlaps_itself=self.overlaps_itself or other.overlaps_itself,
            may_hold_objects=self.may_hold_objects or other.may_hold_objects,
        )


def common_facts(several: Iterable[ExteriorFacts]) -> ExteriorFacts | None:
    """Return what all may be told at once, or None if that is less than some are told."""
    first, *others = several
    for other in others:
        first = first and first.merged(other)
    return first


def packed(facts: ExteriorFacts) -> float:
    """Return the number that an object stores for what it is told."""
    return pack_facts(
        Facts(facts.code, facts.overlaps_itself, facts.may_hold_objects, facts.absorbs, facts.sole_priority)
    )
