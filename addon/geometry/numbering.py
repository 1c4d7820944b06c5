"""Sets and groups of whole numbers, as arrays."""

from __future__ import annotations

import numpy as np

# Numbers below which there is room for a table.
LARGEST_TABLE = 1 << 21
# Points, or pairs of triangles, that are looked at together: so many fit the processor's caches.
CHUNK = 4096

NO_FACES = np.empty(0, dtype=np.intp)


def index_ranges(start: np.ndarray, stop: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return all pairs of a place i and a number in [start[i], stop[i]), as two arrays."""
    lengths = stop - start
    owner = np.repeat(np.arange(len(start)), lengths)
    return owner, np.arange(len(owner)) + (start - (np.cumsum(lengths) - lengths))[owner]


def compact_numbers(values: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the sorted different numbers among some values below a count, and the place of each value among them."""
    if count > LARGEST_TABLE + 8 * values.size:
        different, place = np.unique(values, return_inverse=True)
        return different, place.reshape(values.shape)
    different = _sorted_set(values, count)
    place = np.empty(count, dtype=np.intp)
    place[different] = np.arange(len(different))
    return different, place[values]


def _sorted_set(values: np.ndarray, count: int) -> np.ndarray:
    """Return the sorted different numbers among some values below a count."""
    used = np.zeros(count, dtype=bool)
    used[values] = True
    return np.flatnonzero(used)


def group_by_number(numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Group the places of some numbers 0 to k - 1 by number.

    :return: the places of the first number, then those of the next; (k + 1,) where those of each number start.
    """
    starts = np.concatenate([[0], np.cumsum(np.bincount(numbers))])
    return np.arange(len(numbers)) if len(starts) == 2 else np.argsort(numbers, kind="stable"), starts
