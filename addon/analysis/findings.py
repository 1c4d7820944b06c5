"""What an analysis found, in words."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Found:
    """What an analysis found, by name of object, each in the order of the scene's media.

    :param known: media that need not ask the scene.
    :param asking: media that ask it.
    :param overlapping: media that overlap themselves.
    :param coincident: pairs of media with faces in the same place.
    :param doubts: why nothing is told to any medium, by name; empty where it is.
    """

    known: tuple[str, ...] = ()
    asking: tuple[str, ...] = ()
    overlapping: tuple[str, ...] = ()
    coincident: tuple[tuple[str, str], ...] = ()
    doubts: tuple[tuple[str, str], ...] = ()

    def without(self, cut: Iterable[str]) -> Found:
        """Return what concerns renders of media of which some are cut, by name: their surfaces ask nothing."""
        cut = set(cut)
        asking = tuple(name for name in self.asking if name not in cut)
        return replace(self, asking=asking, doubts=self.doubts if asking else ())

    def __str__(self) -> str:
        """Say what was found, a line for each kind."""
        lines = [f"{name!r} {reason}, so all media ask the scene what surrounds them" for name, reason in self.doubts]
        lines += [
            f"{what}: {listed(names)}"
            for names, what in (
                (self.known, "know what surrounds them"),
                (() if self.doubts else self.asking, "ask the scene what surrounds them"),
                (self.overlapping, "overlap themselves, which takes longer"),
            )
            if names
        ]
        return "\n".join(lines)


def listed(names: tuple[str, ...], most: int = 4) -> str:
    """Return names for a sentence: the first few, and how many more there are."""
    shown = ", ".join(map(repr, names[:most]))
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"
