"""Comparisons of noise fail as often as they say, and see what they say."""

import math

import numpy as np
import pytest
import significance
from significance import (
    ASSERTIONS,
    POWER,
    SUITE,
    assert_mean,
    assert_same_picture,
    assertion_rate,
    deviations,
    sidak,
    tile_means,
    two_sided_chance,
    two_sided_quantile,
    visible_difference,
    welch,
)

SIDE = 32
SPREAD = 0.3


@pytest.fixture
def unsaved(monkeypatch):
    """Failures here are wanted: they leave no pictures, and most of the message is not worth its time."""
    monkeypatch.setattr(significance, "visible_difference", lambda *_: np.zeros(1))
    monkeypatch.setattr(significance, "save_deviations", lambda *_: "nowhere")


def noise(chance: np.random.Generator, count: int, mean: float = 1.0, spread: float = SPREAD) -> np.ndarray:
    """Batches of pictures whose pixels are independent."""
    return chance.normal(mean, spread, (count, SIDE, SIDE, 3))


# One-sided 0.9, 0.975, 0.995 and 0.9995 in the tables of Abramowitz and Stegun (1964), 26.10.
TABLE = {
    1: (3.078, 12.706, 63.657, 636.619),
    2: (1.886, 4.303, 9.925, 31.598),
    5: (1.476, 2.571, 4.032, 6.869),
    10: (1.372, 2.228, 3.169, 4.587),
    30: (1.310, 2.042, 2.750, 3.646),
    120: (1.289, 1.980, 2.617, 3.373),
}


@pytest.mark.parametrize("freedom", TABLE)
def test_quantiles_are_those_of_tables(freedom):
    for rate, expected in zip((0.2, 0.05, 0.01, 0.001), TABLE[freedom]):
        found = two_sided_quantile(rate, freedom)
        assert found == pytest.approx(expected, abs=6e-4 if expected < 20.0 else 1e-2)
        assert two_sided_chance(found, freedom) == pytest.approx(rate, rel=1e-9)


def test_chances_have_closed_forms_at_one_and_two_degrees_of_freedom_and_far_out():
    for t in (0.1, 1.0, 7.0, 60.0):
        assert two_sided_chance(t, 1) == pytest.approx(1.0 - 2.0 / math.pi * math.atan(t), rel=1e-9)
        assert two_sided_chance(t, 2) == pytest.approx(1.0 - t / math.sqrt(2.0 + t * t), rel=1e-7)
    for t in (1.0, 4.0, 6.0):
        assert two_sided_chance(t, 1e9) == pytest.approx(math.erfc(t / math.sqrt(2.0)), rel=1e-5)
    assert two_sided_chance(0.0, 7.0) == 1.0


def test_rates_of_all_comparisons_add_up_to_that_of_the_suite():
    assert 1.0 - (1.0 - assertion_rate()) ** ASSERTIONS == pytest.approx(SUITE)
    assert 1.0 - (1.0 - sidak(0.3, 48)) ** 48 == pytest.approx(0.3)
    assert sidak(1e-12, 3) == pytest.approx(1e-12 / 3.0, rel=1e-9)


def test_degrees_of_freedom_follow_the_noisier_set():
    chance = np.random.default_rng(1)
    wide, narrow = chance.normal(0.0, 10.0, (4, 1)), chance.normal(0.0, 0.01, (64, 1))
    assert welch(wide, narrow)[2][0] == pytest.approx(3.0, abs=0.01)
    equal = chance.normal(0.0, 1.0, (2000, 1))
    assert welch(equal, equal[::-1])[2][0] == pytest.approx(2 * 1999.0)


@pytest.mark.parametrize("counts", [(16, 16), (8, 4)])
def test_equal_pictures_fail_as_often_as_the_rate_says(counts, monkeypatch, unsaved):
    """Within 4 deviations of the binomial distribution, at a rate that simulations can see."""
    rate, trials = 0.1, 1000
    monkeypatch.setattr(significance, "assertion_rate", lambda: rate)
    chance = np.random.default_rng(2)
    failures = 0
    for _ in range(trials):
        a, b = (chance.normal(1.0, spread, (count, 2, 2, 3)) for count, spread in zip(counts, (0.3, 0.1)))
        try:
            assert_same_picture(a, b, size=1)
        except AssertionError:
            failures += 1
    # The mean of the whole depends on the tiles, and Welch's distribution is an approximation from few batches: a little below.
    assert 0.6 * rate * trials < failures < rate * trials + 4.0 * math.sqrt(rate * (1.0 - rate) * trials)


def test_a_difference_in_one_tile_is_found_as_often_as_the_power_says():
    chance = np.random.default_rng(3)
    batches, trials = 16, 1500
    rate = sidak(assertion_rate(), 13)
    spread = SPREAD / 16.0  # of the mean of 16 x 16 pixels
    error = spread * math.sqrt(2.0 / batches)
    limit = two_sided_quantile(rate, 2 * batches - 2)
    normal = two_sided_quantile(2.0 * (1.0 - POWER), 1e9)
    visible = (limit * (1.0 - 0.25 / 30.0) + normal * math.sqrt(1.0 + limit**2 / 60.0)) * error
    told = np.mean([visible_difference(noise(chance, batches), noise(chance, batches)).mean() for _ in range(5)])
    assert told == pytest.approx(visible, rel=0.05)
    a = chance.normal(1.0 + visible, spread, (batches, trials))
    b = chance.normal(1.0, spread, (batches, trials))
    found = (deviations(a, b)[1] < rate).sum()
    assert abs(found - POWER * trials) < 4.0 * math.sqrt(POWER * (1.0 - POWER) * trials)


def test_a_planted_difference_is_found_and_named(unsaved):
    chance = np.random.default_rng(4)
    ours, reference = noise(chance, 16), noise(chance, 16)
    assert_same_picture(ours, reference)
    assert_same_picture(ours, tile_means(reference))
    ours[:, 16:, :16, 1] *= 1.06
    with pytest.raises(AssertionError, match=r"tile \(1, 0\) of G is 1\.0.* is found with 99%.*Pictures: nowhere"):
        assert_same_picture(ours, tile_means(reference))
    assert_same_picture(ours, reference, bias=0.06)


def test_a_difference_that_is_too_small_for_any_tile_is_found_in_the_whole(unsaved):
    chance = np.random.default_rng(5)
    ours, reference = noise(chance, 16, spread=0.2), noise(chance, 16, spread=0.2)
    ours *= 1.013
    assert visible_difference(ours, reference, 8).min() > 0.02
    with pytest.raises(AssertionError, match="standard errors apart"):
        assert_same_picture(ours, reference, size=8)


def test_what_has_no_noise_differs_by_rounding_alone(unsaved):
    ours = np.full((4, SIDE, SIDE, 3), 0.5)
    assert_same_picture(ours, ours * (1.0 + 3e-6))
    with pytest.raises(AssertionError):
        assert_same_picture(ours, ours * (1.0 + 3e-5))


def test_the_mean_of_a_picture_is_held_to_what_is_expected():
    chance = np.random.default_rng(6)
    (picture,) = noise(chance, 1)
    error = SPREAD / SIDE
    assert_mean(picture, 1.0)
    assert_mean(np.ones((4, 4, 3)), 1.0 + 1e-5)
    with pytest.raises(AssertionError):
        assert_mean(picture, (1.0, 1.0, 1.0 + 10.0 * error))
