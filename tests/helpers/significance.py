"""Whether two pictures differ by more than noise, at one false-alarm rate for the whole suite.

All differences are in standard errors and follow Student's t distribution, whose degrees of freedom come from the data
(Welch 1947). The rate is shared out as in Sidak 1967: over the assertions of a run, and within one over tiles and channels.
"""

from __future__ import annotations

import math

import numpy as np

SUITE = 1e-2
"""Chance that a run of the suite on fresh random numbers fails although nothing is wrong."""

ASSERTIONS = 250
"""Assertions of a run that compare noise; a round number above how many there are."""

STRESS_ASSERTIONS = 1500
"""Comparisons of pictures in a run of the whole stress suite, whose false-alarm rate is :data:`SUITE`, too."""

POWER = 0.99
"""Chance with which a difference is found that :func:`visible_difference` gives."""

FLOOR = 4e-6
"""Part of a tile's mean by which single precision may differ where there is no noise."""

ROUNDING = 2e-5
"""Single precision through a handful of operations, for light of 1.

A smooth interface without internal reflections has no noise but the choice between two lobes, one of which is black.
"""


def sidak(rate: float, count: int) -> float:
    """Share a false-alarm rate out to `count` comparisons; return that of each."""
    return -math.expm1(math.log1p(-rate) / count)


def assertion_rate() -> float:
    """Return the false-alarm rate of one assertion."""
    return sidak(SUITE, ASSERTIONS)


def stress_rate() -> float:
    """Return the false-alarm rate of one comparison of the stress suite."""
    return sidak(SUITE, STRESS_ASSERTIONS)


def incomplete_beta(a: float, b: float, x: float) -> float:
    """Return the regularized incomplete beta function I_x(a, b), by Lentz's continued fraction (Press et al. 2007, 6.4)."""
    if x <= 0.0 or x >= 1.0:
        return float(x >= 1.0)
    if x > (a + 1.0) / (a + b + 2.0):
        return 1.0 - incomplete_beta(b, a, 1.0 - x)
    front = math.exp(math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x))
    fraction = c = 1.0
    d = 1.0 / (1.0 - (a + b) * x / (a + 1.0))
    fraction = d
    for m in range(1, 10_000):
        even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
        odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))
        for term in (even, odd):
            d = 1.0 / (1.0 + term * d)
            c = 1.0 + term / c
            fraction *= c * d
        if abs(c * d - 1.0) < 1e-14:
            break
    return front * fraction / a


def two_sided_chance(t: float, freedom: float) -> float:
    """Return the chance that Student's t of so many degrees of freedom is farther from 0 than `t`."""
    return incomplete_beta(freedom / 2.0, 0.5, freedom / (freedom + t * t))


def two_sided_quantile(rate: float, freedom: float) -> float:
    """Return the t that is exceeded on either side with a chance of `rate` together, by bisection."""
    low, high = 0.0, 1.0
    while two_sided_chance(high, freedom) > rate:
        low, high = high, 2.0 * high
    for _ in range(60):
        middle = (low + high) / 2.0
        low, high = (middle, high) if two_sided_chance(middle, freedom) > rate else (low, middle)
    return (low + high) / 2.0


def welch(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compare the means of two sets of batches, which may be of different sizes and variances.

    :returns: the difference of the means, its standard error and the degrees of freedom (Welch 1947, Satterthwaite 1946).
    """
    parts = [each.var(axis=0, ddof=1) / len(each) for each in (a, b)]
    total = parts[0] + parts[1]
    least = min(len(a), len(b)) - 1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        freedom = total**2 / (parts[0] ** 2 / (len(a) - 1) + parts[1] ** 2 / (len(b) - 1))
    return a.mean(axis=0) - b.mean(axis=0), np.sqrt(total), np.where(total > 0.0, freedom, least)


def tile_means(pictures: np.ndarray, size: int = 16) -> np.ndarray:
    """Return means over square tiles; (count, rows, columns, 3)."""
    count, height, width, channels = pictures.shape
    return pictures.reshape(count, height // size, size, width // size, size, channels).mean(axis=(2, 4))


def _tiles(ours: np.ndarray, reference: np.ndarray, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Return means of tiles of both; the reference may consist of them already."""
    a = tile_means(ours, size)
    return a, reference if reference.shape[1:] == a.shape[1:] else tile_means(reference, size)


def visible_difference(ours: np.ndarray, reference: np.ndarray, size: int = 16) -> np.ndarray:
    """Return which relative difference of each tile :func:`assert_same_picture` finds with a chance of :data:`POWER`.

    The noncentral t distribution is taken for normal as in Johnson and Welch 1940. Shape (rows, columns, 3).
    """
    a, b = _tiles(ours, reference, size)
    _, error, freedom = welch(a, b)
    rate = _comparison_rate(a)
    limit = np.vectorize(lambda v: two_sided_quantile(rate, v))(freedom)
    normal = two_sided_quantile(2.0 * (1.0 - POWER), 1e9)
    shift = limit * (1.0 - 0.25 / freedom) + normal * np.sqrt(1.0 + 0.5 * limit**2 / freedom)
    return shift * error / np.maximum(np.abs(b.mean(axis=0)), 1e-9)


def _comparison_rate(tiles: np.ndarray) -> float:
    """Return the false-alarm rate of one tile's channel; the mean of the whole picture is one comparison more."""
    return sidak(assertion_rate(), tiles[0].size + 1)


def deviations(a: np.ndarray, b: np.ndarray, bias: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Compare sets of tiles, of which a part `bias` may differ for reasons other than noise.

    :returns: differences in standard errors, and their chances if there is no difference; (rows, columns, 3) each. What
        rounding explains has a chance of 1.
    """
    difference, error, freedom = welch(a, b)
    allowed = bias * np.abs(b.mean(axis=0))
    difference = np.sign(difference) * np.maximum(np.abs(difference) - allowed, 0.0)
    floor = FLOOR * np.maximum(np.abs(b.mean(axis=0)), 1e-3)
    freedom = np.where(error > floor / 4.0, freedom, 1e9)
    t = difference / np.maximum(error, floor / 4.0)
    chance = np.vectorize(two_sided_chance, otypes=[float])(t, freedom)
    return t, np.where(np.abs(difference) <= floor, 1.0, chance)


def assert_same_picture(ours: np.ndarray, reference: np.ndarray, size: int = 16, bias: float = 0.0) -> None:
    """Hold two sets of batches to showing the same picture, tile by tile and in the mean of the whole.

    The reference may be one of means of tiles. Batches of subpixels spread up to 1.4 times as far as their mean errs, so equal
    pictures fail less often than :func:`assertion_rate` says.

    :param ours: independent pictures, (count, height, width, 3).
    :param reference: as many or another number of them, or of their tiles.
    :param size: side of a square tile in pixels.
    :param bias: part of each mean by which pictures may differ for a reason that stands at the call.
    """
    a, b = _tiles(ours, reference, size)
    rate = _comparison_rate(a)
    t, chance = deviations(a, b, bias)
    whole_t, whole_chance = deviations(a.mean(axis=(1, 2, 3)), b.mean(axis=(1, 2, 3)), bias)
    if min(chance.min(), whole_chance.min()) >= rate:
        return
    row, column, channel = np.unravel_index(chance.argmin(), chance.shape)
    means = a.mean(axis=0), b.mean(axis=0)
    seen = visible_difference(ours, reference, size)
    shown = [value[row, column, channel] for value in (*means, t, chance)]
    raise AssertionError(
        f"the means are {means[0].mean():.5g} and {means[1].mean():.5g}, {float(whole_t):+.1f} standard errors apart; "
        f"tile ({row}, {column}) of {'RGB'[channel]} is {shown[0]:.5g} instead of {shown[1]:.5g}, {shown[2]:+.1f} standard "
        f"errors (chance {shown[3]:.1g}, allowed {rate:.1g}). "
        f"A tile that differs by {np.median(seen):.2%} is found with {POWER:.0%}, in the noisiest by {seen.max():.2%}. "
        f"Pictures: {save_deviations(ours, reference, t, size)}"
    )


def chance_of_same_picture(ours: np.ndarray, reference: np.ndarray, size: int = 16) -> float:
    """Return the chance that two sets of batches differ as much as they do in any tile or in the mean, if both show the same.

    For suites that state a rate of their own; the parameters are those of :func:`assert_same_picture`.
    """
    a, b = _tiles(ours, reference, size)
    _, chance = deviations(a, b)
    _, whole = deviations(a.mean(axis=(1, 2, 3)), b.mean(axis=(1, 2, 3)))
    least = min(chance.min(), whole.min())
    return float(-math.expm1((chance.size + 1) * math.log1p(-min(least, 1.0 - 1e-12))))


def save_deviations(ours: np.ndarray, reference: np.ndarray, t: np.ndarray, size: int) -> str:
    """Save both mean pictures and a map of deviations in standard errors as OpenEXR files; return their folder."""
    from scenes import failure_folder, write_picture

    folder = failure_folder()
    for name, picture in (("ours", ours.mean(axis=0)), ("reference", reference.mean(axis=0)), ("deviations", t)):
        if picture.shape[0] != ours.shape[1]:
            picture = picture.repeat(size, axis=0).repeat(size, axis=1)
        write_picture(folder / f"{name}.exr", picture)
    return str(folder)


def standard_error(picture: np.ndarray) -> np.ndarray:
    """Return that of the mean of all pixels, by channel."""
    pixels = picture.reshape(-1, 3)
    return pixels.std(axis=0, ddof=1) / math.sqrt(len(pixels))


def assert_mean(picture: np.ndarray, expected) -> None:
    """Hold the mean of all pixels to what is expected, by channel, within noise and rounding."""
    mean = picture.reshape(-1, 3).mean(axis=0)
    limit = two_sided_quantile(sidak(assertion_rate(), 3), picture.size // 3 - 1)
    tolerance = limit * standard_error(picture) + ROUNDING
    assert np.all(np.abs(mean - expected) <= tolerance), f"{mean} instead of {expected} +- {tolerance}"
