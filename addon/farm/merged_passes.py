"""Passes that Cycles' merging of sample ranges leaves wrong, from those of the parts.

Cycles averages what it does not know. That is right for pictures, colours and normals, but not for what its first sample
alone writes, for light that is divided by a colour, and for the numbers of Cryptomatte.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

_FIRST = re.compile(r"(.*\.)?(Depth|Position|Object Index|Material Index)\.\w+")
"""Channels that the first sample of a pixel writes alone."""

_LIGHT = re.compile(r"((?:.*\.)?(?:Diffuse|Glossy|Transmission|Subsurface)) (?:Direct|Indirect)\.([RGB])")
"""Light that Cycles divides by its colour."""

_MATTE = re.compile(r"((?:.*\.)?Crypto(?:Object|Material|Asset))(\d\d)\.([rgba])")
"""Pairs of a number, r or b, and what it covers of the pixel, g or a; the largest first."""


@dataclass(frozen=True)
class Plan:
    """Which channels of files are mended, by their places there."""

    first: tuple[int, ...]
    lights: tuple[tuple[int, int], ...]
    """Light and its colour."""
    mattes: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]
    """Numbers and what they cover."""

    def __bool__(self) -> bool:
        return bool(self.first or self.lights or self.mattes)


def plan(names: Sequence[str]) -> Plan:
    """Return what is to be mended in files with channels of these names."""
    places = {name: place for place, name in enumerate(names)}
    first, lights = [], []
    mattes: dict[str, dict[str, int]] = defaultdict(dict)
    for name, place in places.items():
        if _FIRST.fullmatch(name):
            first.append(place)
        elif found := _LIGHT.fullmatch(name):
            colour = places.get(f"{found[1]} Color.{found[2]}")
            if colour is not None:
                lights.append((place, colour))
        elif found := _MATTE.fullmatch(name):
            mattes[found[1]][found[2] + {"r": "0", "g": "1", "b": "2", "a": "3"}[found[3]]] = place
    pairs = [[levels[key] for key in sorted(levels)] for levels in mattes.values()]
    return Plan(tuple(first), tuple(lights), tuple((tuple(each[::2]), tuple(each[1::2])) for each in pairs))


def mend(channels: Plan, merged: np.ndarray, parts: Sequence[np.ndarray], shares: Sequence[float]) -> None:
    """Mend what Cycles has merged, in place.

    :param merged: (height, width, channels).
    :param parts: of the same shape, that with the first samples first.
    :param shares: the part of all samples that each holds; their sum is 1.
    """
    for place in channels.first:
        merged[..., place] = parts[0][..., place]
    for light, colour in channels.lights:
        total = sum(share * part[..., colour] for share, part in zip(shares, parts))
        times = sum(share * part[..., light] * part[..., colour] for share, part in zip(shares, parts))
        merged[..., light] = np.divide(times, total, out=merged[..., light].copy(), where=total != 0.0)
    for numbers, covers in channels.mattes:
        found = np.concatenate([part[..., numbers] for part in parts], axis=-1)
        covered = np.concatenate([share * part[..., covers] for share, part in zip(shares, parts)], axis=-1)
        merged[..., numbers], merged[..., covers] = _largest(found, covered.astype(np.float32), len(numbers))


def _largest(numbers: np.ndarray, covered: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the numbers that cover most, and how much; each once, the largest first.

    :param numbers: (height, width, pairs), read as bits, since some are no numbers that compare.
    """
    order = np.argsort(numbers.view(np.uint32), axis=-1, kind="stable")
    numbers, covered = (np.take_along_axis(each, order, axis=-1) for each in (numbers.view(np.uint32), covered))
    for pair in range(1, numbers.shape[-1]):
        same = numbers[..., pair] == numbers[..., pair - 1]
        covered[..., pair] += np.where(same, covered[..., pair - 1], 0.0)
        covered[..., pair - 1][same] = 0.0
    order = np.argsort(-covered, axis=-1, kind="stable")[..., :count]
    numbers, covered = (np.take_along_axis(each, order, axis=-1) for each in (numbers, covered))
    return np.where(covered > 0.0, numbers, 0).view(np.float32), covered
