"""Random scenes of media make no light, and look the same however they are rendered."""

import time

import pytest
from random_media import SCENES, SPLIT_SCENES, random_media_scene
from scenes import rarely
from significance import stress_rate
from split_media import build_split
from ways import faults, measured, measured_split

SPLIT_SAMPLES = 8
"""Of each of a pixel's parts, so 128 a pixel."""

NEAR_EDGES = 1
"""Of some hundred points on pieces, those that may lie so near to an edge that brute force finds what is beyond it."""


@pytest.mark.parametrize("seed", rarely(SCENES, (2, 11)))
def test_a_random_scene_makes_no_light_and_looks_the_same_by_every_way(seed, record):
    """Asked, told, cut and by Cycles' own nodes, in a world of which one channel is white."""
    start = time.monotonic()
    found = measured(random_media_scene(seed))
    record("random", str(seed), seconds=time.monotonic() - start, **found)
    assert faults(found, stress_rate()) == []


@pytest.mark.parametrize("seed", rarely(SPLIT_SCENES, (1000,)))
def test_a_random_scene_looks_as_split_by_hand(seed, record):
    """By every way; of Cycles' own Glass, as each surface would be if nothing else were there, most do not."""
    start = time.monotonic()
    found = measured_split(random_media_scene(seed), build_split, SPLIT_SAMPLES)
    record("split", str(seed), seconds=time.monotonic() - start, **found)
    assert len(found["wrong pieces"]) <= NEAR_EDGES
    assert faults(found, stress_rate()) == []
