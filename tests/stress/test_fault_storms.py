"""Storms of random calls leave nothing raised, and media that are told what they would be told afresh."""

import os

import pytest
from storms import storm

EVERYTHING = "ND_STRESS" in os.environ


@pytest.mark.always
def test_a_storm_of_buttons_undone_and_redone_raises_nothing_and_leaves_facts_true(registered):
    storm(seed=0, calls=25)


@pytest.mark.skipif(not EVERYTHING, reason="takes long: make stress")
@pytest.mark.parametrize("seed", range(1, 4))
def test_a_storm_of_a_thousand_calls_raises_nothing_and_leaves_facts_true(seed, registered):
    storm(seed, calls=1000)
