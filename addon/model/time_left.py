"""How long a run of renders will still take, and times in words."""

from __future__ import annotations

from collections.abc import Sequence


def time_left(
    finished: Sequence[float], to_come: int, begun: float = 0.0, sampled: float = 0.0, share: float = 1.0
) -> float | None:
    """Return the seconds that are left of a run of frames; None where nothing is known yet.

    A frame takes as long as those that are finished took on average. Before one is, the present one tells, whose samples all
    take as long as those that are done.

    :param finished: the seconds that the frames took which were rendered.
    :param to_come: how many frames follow the present one.
    :param begun: the seconds that the present one took until its first sample; sampled: those since then.
    :param share: how many of its samples are done, from 0 to 1.
    """
    if finished:
        return sum(finished) / len(finished) * (1.0 - share + to_come)
    if share <= 0.0 or (sampled <= 0.0 and share < 1.0):
        return None
    whole = sampled / share
    return whole * (1.0 - share) + (begun + whole) * to_come


_UNITS = ((86400, "d"), (3600, "h"), (60, "min"), (1, "s"))


def in_words(seconds: float) -> str:
    """Return a time as people say it: ``45 s``, ``6 min``, ``2 h 10 min``, ``3 d 4 h``; up to 10 s in tenths."""
    if seconds < 9.95:
        return f"{max(seconds, 0.0):.1f} s"
    whole = round(seconds)
    if whole >= 60:
        whole = round(seconds / 60) * 60
    place = next(place for place, (size, _) in enumerate(_UNITS) if whole >= size)
    size, unit = _UNITS[place]
    text = f"{whole // size} {unit}"
    if unit in ("d", "h"):
        smaller, name = _UNITS[place + 1]
        rest = whole % size // smaller
        text += f" {rest} {name}" if rest else ""
    return text
