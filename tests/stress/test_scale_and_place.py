"""A scene looks the same however large it is and wherever it is, as far as single precision goes."""

import functools

import pytest
from far_and_small import drink
from scenes import rarely
from significance import stress_rate
from ways import Picture, against, asked, faults, take

SIZES = (1e-4, 1e-3, 1e-2, 1e-1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6)

PLACES = (1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6)
"""Distances from the origin along all axes, of a scene that is two units wide."""

FARTHEST = 1e4
"""Beyond it single precision moves points so far that pictures change, those of Cycles' own Glass as well: by 0.008 at 1e5."""


@functools.cache
def plain() -> Picture:
    drink()
    asked()
    return take(20)


@pytest.mark.parametrize("size", rarely(SIZES, (1e-4,)))
def test_a_scene_looks_the_same_however_large_it_is(size, record):
    found = against(plain(), lambda: drink(size), lambda: drink(size, glass=True))
    record("size", f"{size:g}", **found)
    assert faults(found, stress_rate()) == []


@pytest.mark.parametrize("place", rarely(PLACES))
def test_a_scene_looks_the_same_wherever_it_is(place, record):
    offset = (place, -place, place)
    found = against(plain(), lambda: drink(offset=offset), lambda: drink(offset=offset, glass=True))
    record("place", f"{place:g}", **found)
    if place <= FARTHEST:
        assert faults(found, stress_rate()) == []
    for numbers in found["ways"].values():
        assert numbers["broken"] == 0 and numbers["lowest"] >= 0.0
