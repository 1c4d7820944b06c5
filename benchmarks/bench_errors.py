"""How far pictures are from the truth, and how much of that is not noise.

Pictures are (height, width, 3) linear floats.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

DARK = 1e-2
"""Added to squares of the truth, so that black does not count infinitely."""

BLOCK = 8
"""Pixels along the side of a block. Means of blocks have less noise, so what is wrong in them shows earlier."""


def block_means(picture: np.ndarray, size: int = BLOCK) -> np.ndarray:
    """Means of blocks, (height / size, width / size, 3)."""
    height, width, channels = picture.shape
    return picture.reshape(height // size, size, width // size, size, channels).mean(axis=(1, 3))


@dataclass(frozen=True, eq=False)
class Reference:
    """Two independent pictures of the truth. Their difference tells how much noise is left in their mean."""

    first: np.ndarray
    second: np.ndarray

    @cached_property
    def mean(self) -> np.ndarray:
        return (self.first + self.second) / 2.0

    @cached_property
    def noise(self) -> float:
        """Relative mean square error of the mean."""
        return float(np.mean((self.first - self.second) ** 2 / 4.0 / weights(self.mean)))

    @cached_property
    def blocks(self) -> Reference:
        """The same by blocks."""
        return Reference(block_means(self.first), block_means(self.second))

    @property
    def block_noise(self) -> float:
        """:attr:`noise` by blocks."""
        return self.blocks.noise


def weights(truth: np.ndarray) -> np.ndarray:
    """What squares of errors are divided by."""
    return truth**2 + DARK


def relative_error(picture: np.ndarray, truth: np.ndarray) -> float:
    """Relative mean square error, the truth's own noise included."""
    return float(np.mean((picture - truth) ** 2 / weights(truth)))


@dataclass(frozen=True)
class Floor:
    """The relative mean square error that any number of samples leaves, and the standard error of one that is 0."""

    relmse: float
    standard_error: float

    @property
    def certain(self) -> bool:
        """Whether it is more than chance."""
        return self.relmse > 4.0 * self.standard_error


def floor(first: np.ndarray, second: np.ndarray, reference: Reference) -> Floor:
    """What two independent pictures of one way have in common that two independent ones of the truth have not.

    The product of independent errors is the square of what they share, on average: neither noise is in it. Its variance
    without anything shared is the square of the noise's; the three channels are taken for one, whose noise is alike.
    """
    a, b = reference.first, reference.second
    products = ((first - a) * (second - b) + (first - b) * (second - a)) / 2.0 / weights(reference.mean)
    noise = ((first - second) ** 2 + (a - b) ** 2) / 2.0 / weights(reference.mean)
    error = np.sqrt(np.sum(noise.mean(axis=2) ** 2)) / noise[..., 0].size
    return Floor(float(products.mean()), float(error))
