"""Spectra, gamuts and indices of refraction against formulae written anew, in extended precision where that counts."""

import itertools
import math
import tempfile
from pathlib import Path

import numpy as np
import property_tests
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from nested_dielectric.model import colour_science, spectrum_files
from nested_dielectric.model.colour_science import SpectrumError
from nested_dielectric.model.dispersion import (
    LINE_C,
    LINE_D,
    LINE_F,
    abbe_deviation,
    abbe_ior,
    abbe_number,
    jf_ior,
    material_ior,
    mean_inverse_square_offsets,
    sellmeier_ior,
)
from nested_dielectric.model.distributions import illuminant_names, spectrum
from nested_dielectric.model.gamuts import COLOURSPACES, adaptation_matrix, converted, white_and_primaries
from nested_dielectric.model.spectra import WAVELENGTHS, Spectrum, cells
from nested_dielectric.model.spectral_tables import preview

ROUNDING = 2.0**-53

wavelengths = st.floats(*WAVELENGTHS)
iors = st.floats(0.01, 100.0)

# Indices of refraction


def exact(number: float) -> np.longdouble:
    return np.longdouble(number)


def exact_sellmeier(b, c, wavelength) -> tuple[np.longdouble, np.longdouble]:
    """Return n^2, and the size of all that it is a sum of (Sellmeier 1872)."""
    square = (exact(wavelength) / 1000) ** 2
    terms = [exact(strength) * square / (square - exact(resonance)) for strength, resonance in zip(b, c)]
    amplified = [
        abs(term) * (1 + 2 * max(square, exact(resonance)) / abs(square - exact(resonance)))
        for term, resonance in zip(terms, c)
    ]
    return 1 + sum(terms), 1 + sum(amplified)


@given(
    st.tuples(*[st.floats(-1e4, 1e4)] * 3),
    st.tuples(*[st.one_of(st.floats(0.0, 0.1), st.floats(0.0, 1e6))] * 3),
    wavelengths,
)
def test_sellmeiers_index_is_that_of_extended_precision(b, c, wavelength):
    """Within a few roundings of its terms, each next to its resonance as far as it is ill-conditioned there."""
    assume(all(abs((wavelength * 1e-3) ** 2 - each) > 1e-9 for each in c))
    n = sellmeier_ior(b, c, wavelength)
    square, size = exact_sellmeier(b, c, wavelength)
    slack = 8 * ROUNDING * size
    if math.isnan(n):
        assert square <= slack
    else:
        assert abs(exact(n) ** 2 - square) <= slack


@given(iors, st.floats(1e-3, 1e6), wavelengths)
def test_cauchys_index_is_that_of_extended_precision(ior, abbe, wavelength):
    lines = [exact(line) ** -2 for line in (LINE_F, LINE_C, wavelength, LINE_D)]
    slope = (exact(ior) - 1) / exact(abbe) / (lines[0] - lines[1])
    size = abs(slope) * (lines[2] + lines[3]) + ior
    assert abs(abbe_ior(ior, abbe, wavelength) - (ior + slope * (lines[2] - lines[3]))) <= 16 * ROUNDING * size
    assert abbe_ior(ior, 0.0, wavelength) == ior


@given(iors, st.floats(-10.0, 10.0), wavelengths)
def test_jfs_index_is_that_of_extended_precision(ior, spread, wavelength):
    t = (exact(wavelength) - 370) / 410
    expected = exact(ior) + ((1 - t) ** 2 - exact(0.5)) * exact(spread)
    assert abs(jf_ior(ior, spread, wavelength) - expected) <= 8 * ROUNDING * (ior + abs(spread))


@given(
    st.lists(st.tuples(st.floats(-2.0, 5.0), st.floats(-2.0, 5.0), st.floats(-2.0, 5.0), wavelengths), min_size=1),
    iors,
    st.floats(5.0, 200.0),
)
def test_a_table_has_the_mean_index_that_its_mean_offset_gives(rows, ior, abbe):
    """Cauchy's two terms are linear in the offset, in 1/um^2."""
    table = np.array(rows)
    offsets = mean_inverse_square_offsets(table)
    slope = (ior - 1.0) / abbe / (LINE_F**-2 - LINE_C**-2)
    for channel in range(3):
        mean = np.mean([row[channel] * (abbe_ior(ior, abbe, row[3]) - ior) for row in rows])
        size = np.mean([abs(row[channel]) for row in rows]) * (abs(slope) * 1e-5 + ior)
        assert slope * 1e-6 * offsets[channel] == pytest.approx(mean, abs=1e-12 * size)


@given(iors, st.floats(0.5, 1e4), st.floats(-1.0, 1.0), st.sampled_from(("ABBE", "JF")))
def test_abbes_number_is_the_index_over_its_spread(ior, abbe, spread, model):
    values = {"ior": ior, "abbe": abbe, "dispersion": spread, "dispersion_model": model}
    n_c, n_d, n_f = (material_ior(values, line) for line in (LINE_C, LINE_D, LINE_F))
    if n_f == n_c:
        assert abbe_number(values) == math.inf
    else:
        assert abbe_number(values) == pytest.approx((n_d - 1.0) / (n_f - n_c), rel=1e-12)
    worst = max(
        abs(abbe_ior(n_d, 0.0 if n_f == n_c else (n_d - 1.0) / (n_f - n_c), nm) - material_ior(values, nm))
        for nm in range(380, 781)
    )
    assert abbe_deviation(values) == pytest.approx(worst, rel=1e-9, abs=1e-12)


# Spectra

samples = st.lists(
    st.tuples(st.floats(300.0, 900.0).map(lambda nm: round(nm, 3)), st.floats(0.0, 1e3, allow_subnormal=False)),
    min_size=2,
    max_size=12,
    unique_by=lambda row: row[0],
).map(sorted)
lines = st.lists(st.tuples(st.floats(380.0, 780.0), st.floats(1e-3, 1e3)), max_size=3).map(tuple)


def power_between(rows, low: float, high: float) -> float:
    """Integrate a spectrum that is linear between its rows, exactly."""
    total = 0.0
    for (a, before), (b, after) in itertools.pairwise(rows):
        begin, end = max(a, low), min(b, high)
        if begin < end:
            at = [before + (after - before) * (nm - a) / (b - a) for nm in (begin, end)]
            total += 0.5 * (at[0] + at[1]) * (end - begin)
    return total


@given(samples, lines)
def test_cells_hold_all_power_of_visible_light_in_order(rows, sharp):
    nm, power = zip(*rows)
    begin, end, content = cells(Spectrum("test", nm, power, sharp))
    largest = max(*power, *(strength for _, strength in sharp)) or 1.0
    expected = power_between(rows, *WAVELENGTHS) + sum(strength for _, strength in sharp)
    assert content.sum() * largest == pytest.approx(expected, rel=1e-9, abs=1e-9 * largest)
    assert np.all(np.diff(begin + end) >= 0.0) and content.min() >= 0.0
    broad = begin < end
    assert begin[0] >= WAVELENGTHS[0] and end[-1] <= WAVELENGTHS[1]
    assert (end - begin)[broad].sum() == pytest.approx(WAVELENGTHS[1] - WAVELENGTHS[0])
    assert np.allclose(begin[broad][1:], end[broad][:-1])


@settings(max_examples=property_tests.FEW)
@given(
    samples, st.sampled_from(("", "wavelength, power\n", "# from a lamp\n\nnm,W\n")), st.randoms(use_true_random=False)
)
def test_a_file_of_power_is_read_in_order_with_every_digit(rows, heading, random):
    assume(any(380.0 <= nm <= 780.0 and power > 0.0 for nm, power in rows))
    mixed = list(rows)
    random.shuffle(mixed)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "lamp.csv")
        file.write_text(heading + "".join(f"{nm!r}, {power!r} # measured\n" for nm, power in mixed), encoding="utf-8")
        try:
            light = spectrum_files.read_spectrum(file, "mend it")
        except SpectrumError:
            assert not cells(Spectrum("", *zip(*rows)))[2].any()
            return
        assert list(zip(light.wavelengths, light.power)) == rows and light.name == "lamp.csv"
        assert spectrum(file) == light


def test_a_low_sun_is_a_black_body():
    """Planck 1901, with the constants of 2019; CIE's second constant of 1.4388e-2 m K is within 1e-5 of them."""
    light = spectrum("SUNSET")
    nm, power = np.array(light.wavelengths), np.array(light.power)
    h, c, k = 6.62607015e-34, 299792458.0, 1.380649e-23
    metres = nm * 1e-9
    planck = 2.0 * h * c**2 / metres**5 / np.expm1(h * c / (metres * k * 2500.0))
    assert np.allclose(power / power[200], planck / planck[200], rtol=1e-4)


@pytest.mark.parametrize("word", ["FULL", "DAYLIGHT", "BLUE_SKY", "SUNSET", "LED", "FLUORESCENT", "SODIUM"])
def test_a_distribution_has_power_at_rising_wavelengths(word):
    light = spectrum(word.lower())
    assert list(light.wavelengths) == sorted(set(light.wavelengths)) and len(light.power) == len(light.wavelengths)
    assert min(light.power) >= 0.0 and cells(light)[2].sum() > 0.0
    assert all(strength > 0.0 for _, strength in light.lines)


@settings(max_examples=property_tests.FEW)
@given(st.sampled_from(sorted(illuminant_names())), st.randoms(use_true_random=False))
def test_an_illuminant_is_found_in_any_case(name, random):
    word = "".join(random.choice((letter.upper(), letter.lower())) for letter in name)
    assert spectrum(word) == spectrum(name)


# Gamuts

PRIMARIES = {
    "REC709": ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06), (0.3127, 0.3290)),
    "REC2020": ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046), (0.3127, 0.3290)),
    "ADOBE_RGB": ((0.64, 0.33), (0.21, 0.71), (0.15, 0.06), (0.3127, 0.3290)),
    "ACESCG": ((0.713, 0.293), (0.165, 0.830), (0.128, 0.044), (0.32168, 0.33767)),
    "ACES_AP0": ((0.7347, 0.2653), (0.0, 1.0), (0.0001, -0.0770), (0.32168, 0.33767)),
}
"""Chromaticities of red, green, blue and white: ITU-R BT.709-6 and BT.2020-2, Adobe RGB (1998), SMPTE ST 2065-1, Academy
S-2014-004.
"""

BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])
"""Lam 1985: from XYZ to sharpened cones."""


def xyz_of(x: float, y: float) -> np.ndarray:
    return np.array([x / y, 1.0, (1.0 - x - y) / y])


@pytest.mark.parametrize("gamut", PRIMARIES)
def test_a_gamut_is_made_of_its_published_primaries(gamut):
    """The three are scaled so that they add up to white (SMPTE RP 177-1993)."""
    *primaries, white = (xyz_of(*xy) if xy[1] else np.array([0.0, 0.0, 0.0]) for xy in PRIMARIES[gamut])
    matrix = np.stack(primaries, axis=1)
    expected = matrix * np.linalg.solve(matrix, white)
    found_white, found = white_and_primaries(gamut)
    assert np.allclose(found_white, white, atol=1e-12) and np.allclose(found, expected, atol=1e-9)


@given(*[st.tuples(st.floats(0.2, 0.5), st.floats(0.2, 0.5))] * 2)
def test_an_adaptation_takes_white_to_white_by_scaling_cones(one, other):
    white, other_white = xyz_of(*one), xyz_of(*other)
    matrix = adaptation_matrix(white, other_white)
    scales = (BRADFORD @ other_white) / (BRADFORD @ white)
    assert np.allclose(matrix, np.linalg.inv(BRADFORD) @ np.diag(scales) @ BRADFORD, rtol=1e-6, atol=1e-9)
    assert np.allclose(matrix @ white, other_white, rtol=1e-9)


gamuts = st.sampled_from(sorted(COLOURSPACES))
colours = st.tuples(*[st.floats(0.0, 1.0)] * 3)


@given(colours, gamuts, gamuts, gamuts)
def test_a_colour_comes_back_from_another_gamut_and_goes_the_same_by_a_third(colour, one, other, third):
    there = converted(colour, one, other)
    assert converted(there, other, one) == pytest.approx(colour, abs=1e-9)
    assert converted(there, other, third) == pytest.approx(converted(colour, one, third), abs=1e-9)
    assert converted((1.0, 1.0, 1.0), one, other) == pytest.approx((1.0, 1.0, 1.0), abs=1e-9)


def test_the_science_of_colours_is_imported_once():
    assert colour_science.colour_science() is colour_science.colour_science()


# Previews


@settings(max_examples=property_tests.FEW)
@given(st.integers(0, 2**31), st.integers(32, 64), st.integers(8, 40), st.integers(2, 20))
def test_a_preview_is_a_filled_curve_within_its_picture(seed, rows, width, height):
    rng = np.random.default_rng(seed)
    nm = np.sort(rng.uniform(*WAVELENGTHS, rows))
    table = np.column_stack([rng.uniform(-0.5, 3.0, (rows, 3)), nm]).astype(np.float32)
    picture = preview(table, width, height)
    assert picture.shape == (height, width, 4) and picture.dtype == np.float32
    assert np.isfinite(picture).all() and picture.min() >= 0.0 and picture.max() <= 1.0
    ground = np.isclose(picture[..., :3], 0.01).all(axis=2)
    assert np.all(ground[1:] >= ground[:-1])  # no ground below the curve
