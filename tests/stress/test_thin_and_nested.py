"""Thin overlaps, thin walls and many media in one another render as the same interfaces split by hand."""

import functools

import pytest
from far_and_small import overlapping_blocks, shells, thin_walled
from scenes import rarely
from significance import stress_rate
from ways import Picture, against, asked, faults, take

OVERLAPS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
WALLS = (1e-1, 1e-2, 1e-3, 1e-4, 5e-5, 1e-5, 1e-6)

THINNEST = 1e-4
"""Walls thinner than this part of their size are nearer to each other than rays leave out in single precision, in hand-split
Glass as well.
"""

SHELLS = (2, 12, 50, 200)


@functools.cache
def deep() -> Picture:
    """Media that overlap by a tenth."""
    overlapping_blocks(0.1)
    asked()
    return take(20)


@pytest.mark.parametrize("depth", rarely(OVERLAPS, (1e-6,)))
def test_how_far_media_overlap_does_not_show(depth, record):
    found = against(deep(), lambda: overlapping_blocks(depth))
    record("overlap", f"{depth:g}", **found)
    assert faults(found, stress_rate()) == []


@pytest.mark.parametrize("thickness", rarely(WALLS))
def test_a_thin_wall_looks_as_split_by_hand(thickness, record):
    thin_walled(thickness, "split")
    split = take(20)
    found = against(split, lambda: thin_walled(thickness, "nested"), lambda: thin_walled(thickness, "naive"))
    record("wall", f"{thickness:g}", **found)
    if thickness >= THINNEST:
        assert faults(found, stress_rate()) == []
    for numbers in found["ways"].values():
        assert numbers["broken"] == 0 and numbers["lowest"] >= 0.0


@pytest.mark.parametrize("count", rarely(SHELLS))
def test_shells_in_each_other_look_as_split_by_hand(count, record):
    shells(count, "split")
    split = take(20)
    found = against(split, lambda: shells(count, "nested"), lambda: shells(count, "naive"))
    record("shells", str(count), **found)
    assert faults(found, stress_rate()) == []
