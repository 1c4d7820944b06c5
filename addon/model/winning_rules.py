"""Who has to win over whom where two media overlap, by what they are and which contains which; and why, in words."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum

from .media_kinds import Kind


@dataclass(frozen=True)
class Placed:
    """An object that is a medium, with all its instances.

    :param owner: equal for objects that have their number from the same place, such as a material.
    :param medium: equal for objects that are filled with the same.
    :param kind: None if unknown; density: kg/m³, None if unknown.
    :param volume: of one instance, cubic scene units.
    :param is_fixed: its number cannot be changed.
    """

    name: str
    owner: Hashable
    priority: int
    medium: Hashable
    kind: Kind | None = None
    density: float | None = None
    volume: float = 0.0
    is_fixed: bool = False


@dataclass(frozen=True)
class Overlap:
    """Two objects of which one lies wholly inside the other, or else crosses or touches it. Both are indices."""

    one: int
    other: int
    is_inside: bool = False


class Reason(IntEnum):
    """Why one medium has to win over another, the weakest reason first.

    What lies wholly within a winner would not be there at all, whatever it is: so that is the strongest.
    """

    APART = 0
    KEPT = 1
    FLOATS = 2
    KIND = 3
    INSIDE = 4


@dataclass(frozen=True)
class Order:
    """One object has to win over another: both are indices."""

    winner: int
    loser: int
    reason: Reason

    def in_words(self, bodies: Sequence[Placed], is_winner: bool) -> str:
        """Say why, of the winner or of the loser, as the rest of a sentence that goes on after "because"."""
        one, other = (bodies[index] for index in (self.winner, self.loser)[:: 1 if is_winner else -1])
        if self.reason == Reason.INSIDE:
            return f"it lies inside {other.name!r}" if is_winner else f"{other.name!r} lies inside it"
        if self.reason == Reason.KIND:
            return f"it is {one.kind.noun} and {other.name!r} is {other.kind.noun}"
        if self.reason == Reason.FLOATS:
            which = f"it floats on {other.name!r}" if is_winner else f"{other.name!r} floats on it"
            return f"{which} ({bodies[self.winner].density:.0f} against {bodies[self.loser].density:.0f} kg/m³)"
        if self.reason == Reason.KEPT:
            return f"it wins over {other.name!r} as before" if is_winner else f"{other.name!r} wins over it as before"
        return f"with one number it and {other.name!r} would be one medium"


def orders_by_nature(bodies: Sequence[Placed], overlaps: Iterable[Overlap]) -> list[Order]:
    """Return who has to win by what they are, whatever their numbers; the strongest reasons first.

    Where two liquids overlap the lighter wins, as the presets have it: the surface between them is then its own underside.
    """
    found: dict[tuple[int, int], Reason] = {}
    for overlap in overlaps:
        order = _order(bodies, overlap)
        if order is not None:
            pair = order.winner, order.loser
            found[pair] = max(order.reason, found.get(pair, order.reason))
    orders = [Order(*pair, reason) for pair, reason in found.items()]
    return sorted(orders, key=lambda order: (-order.reason, bodies[order.winner].name, bodies[order.loser].name))


def _order(bodies: Sequence[Placed], overlap: Overlap) -> Order | None:
    one, other = bodies[overlap.one], bodies[overlap.other]
    if one.medium == other.medium:
        return None
    if overlap.is_inside:
        return Order(overlap.one, overlap.other, Reason.INSIDE)
    if one.kind is None or other.kind is None:
        return None
    if one.kind != other.kind:
        return _first_wins(overlap, one.kind, other.kind, Reason.KIND)
    if one.kind == Kind.LIQUID and None not in (one.density, other.density) and one.density != other.density:
        return _first_wins(overlap, one.density, other.density, Reason.FLOATS)
    return None


def _first_wins(overlap: Overlap, one: float, other: float, reason: Reason) -> Order:
    winner, loser = (overlap.one, overlap.other) if one < other else (overlap.other, overlap.one)
    return Order(winner, loser, reason)


def orders_as_they_are(
    bodies: Sequence[Placed], overlaps: Iterable[Overlap], decided: Collection[frozenset[int]]
) -> Iterator[Order]:
    """Yield the orders that an artist has chosen where nothing else decides.

    Of two media that have one number, and so would be one, the smaller wins: it is whole there.

    :param decided: pairs of which something has decided.
    """
    pairs = {frozenset((overlap.one, overlap.other)) for overlap in overlaps} - set(decided)
    by_name = {index: (body.name, index) for index, body in enumerate(bodies)}.get
    for pair in sorted((sorted(pair, key=by_name) for pair in pairs), key=lambda pair: [*map(by_name, pair)]):
        one, other = (bodies[index] for index in pair)
        if one.medium == other.medium:
            continue
        if one.priority != other.priority:
            winner, loser = pair if one.priority < other.priority else pair[::-1]
            yield Order(winner, loser, Reason.KEPT)
        else:
            winner, loser = sorted(pair, key=lambda index: (bodies[index].volume, bodies[index].name))
            yield Order(winner, loser, Reason.APART)
