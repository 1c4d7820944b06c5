"""Indices of refraction and tables of light, whatever the numbers."""

import math
import tempfile
from pathlib import Path

import numpy as np
import property_tests
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

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
    sellmeier_ior,
)
from nested_dielectric.model.distributions import DISTRIBUTIONS
from nested_dielectric.model.gamuts import GAMUTS
from nested_dielectric.model.spectra import WAVELENGTHS
from nested_dielectric.model.spectral_tables import ENTRIES, spectral_table

iors = st.floats(1.01, 4.0)
abbes = st.floats(5.0, 200.0)
wavelengths = st.floats(*WAVELENGTHS)
strengths = st.tuples(*[st.floats(0.0, 3.0)] * 3)
resonances = st.tuples(*[st.floats(0.0, 0.1)] * 3)
"""Squares of wavelengths up to 316 nm, um^2."""


@given(iors, abbes)
def test_cauchys_curve_has_its_index_and_its_abbe_number(ior, abbe):
    n_c, n_d, n_f = (abbe_ior(ior, abbe, line) for line in (LINE_C, LINE_D, LINE_F))
    assert n_d == pytest.approx(ior, rel=1e-12)
    assert (n_d - 1.0) / (n_f - n_c) == pytest.approx(abbe, rel=1e-6)


@given(iors, abbes, wavelengths, wavelengths)
def test_shorter_waves_are_bent_more(ior, abbe, one, other):
    assume(abs(one - other) > 1e-3)
    assert (abbe_ior(ior, abbe, one) > abbe_ior(ior, abbe, other)) == (one < other)


@given(strengths, resonances, wavelengths)
def test_sellmeiers_terms_add_up_in_the_square_of_the_index(b, c, wavelength):
    whole = sellmeier_ior(b, c, wavelength) ** 2 - 1.0
    parts = [sellmeier_ior((strength,), (square,), wavelength) ** 2 - 1.0 for strength, square in zip(b, c)]
    assert whole == pytest.approx(sum(parts), rel=1e-9, abs=1e-12)


@given(strengths, resonances, wavelengths, wavelengths)
def test_beyond_its_resonances_sellmeiers_curve_falls(b, c, one, other):
    low, high = sorted((one, other))
    assert sellmeier_ior(b, c, low) >= sellmeier_ior(b, c, high) * (1.0 - 1e-12) >= 1.0 - 1e-12


@given(st.tuples(*[property_tests.FLOATS] * 3), st.tuples(*[property_tests.FLOATS] * 3), wavelengths)
def test_sellmeiers_formula_has_an_index_or_none_and_raises_nothing(b, c, wavelength):
    n = sellmeier_ior(b, c, wavelength)
    assert math.isnan(n) or n >= 0.0


@given(iors, st.floats(0.0, 0.5), wavelengths)
def test_jfs_curve_is_even_around_its_vertex(ior, spread, wavelength):
    vertex = 780.0
    assert jf_ior(ior, spread, wavelength) == pytest.approx(jf_ior(ior, spread, 2.0 * vertex - wavelength), rel=1e-12)
    assert jf_ior(ior, spread, vertex) == pytest.approx(ior - spread / 2.0)


models = st.fixed_dictionaries(
    {
        "ior": iors,
        "abbe": abbes,
        "dispersion": st.floats(0.001, 0.1),
        "sellmeier_b": strengths.filter(lambda b: sum(b) > 0.1),
        "sellmeier_c": resonances,
        "dispersion_model": st.sampled_from(("ABBE", "SELLMEIER", "JF")),
    }
)


@given(models)
def test_every_model_but_jfs_goes_through_the_index(values):
    if values["dispersion_model"] == "JF":
        return
    assert material_ior(values, LINE_D) == pytest.approx(values["ior"], rel=1e-12)


@given(models)
def test_how_far_off_two_terms_are_is_0_for_them_and_never_negative(values):
    deviation = abbe_deviation(values)
    assert deviation >= 0.0
    if values["dispersion_model"] == "ABBE":
        assert deviation < 1e-9
        assert abbe_number(values) == pytest.approx(values["abbe"], rel=1e-6)


WORDS = tuple(choice.keyword for choice in DISTRIBUTIONS)
TABLES = tuple(choice.keyword for choice in GAMUTS if choice.keyword != "SCENE")


def assert_white(table: np.ndarray) -> None:
    """The mean of all rows is white to single precision, and wavelengths rise within visible light."""
    assert table.shape == (ENTRIES, 4) and np.isfinite(table).all()
    assert table[:, :3].mean(axis=0, dtype=np.float64) == pytest.approx(1.0, abs=1e-6)
    assert np.all(np.diff(table[:, 3]) >= 0.0)
    assert WAVELENGTHS[0] <= table[0, 3] and table[-1, 3] <= WAVELENGTHS[1]


@settings(max_examples=property_tests.FEW)
@given(st.sampled_from(WORDS), st.sampled_from(TABLES), st.floats(0.0, 1.0), st.booleans())
def test_white_stays_white_in_every_table(word, gamut, saturation, clamped):
    table = spectral_table(word, gamut, saturation, clamped)
    assert_white(table)
    if clamped:
        assert table[:, :3].min() >= 0.0
    if saturation == 0.0:
        assert np.ptp(table[:, :3], axis=1).max() < 1e-5


rows = st.lists(
    st.tuples(st.integers(300, 900), st.floats(0.0, 1e6, allow_subnormal=False)),
    max_size=30,
    unique_by=lambda row: row[0],
)


@settings(max_examples=property_tests.FEW)
@given(rows)
def test_any_measured_light_is_balanced_to_white_or_refused(measured):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "light.csv")
        file.write_text("".join(f"{nm}, {power}\n" for nm, power in measured), encoding="utf-8")
        try:
            table = spectral_table(file, "REC709", 1.0, False)
        except SpectrumError as error:
            assert "light.csv" in str(error)
            return
    assert_white(table)


@settings(max_examples=property_tests.FEW)
@given(st.text())
def test_any_word_and_any_file_is_a_light_or_refused(text):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "light.csv")
        file.write_text(text, encoding="utf-8", newline="")
        for distribution in (file, text):
            with pytest.raises(SpectrumError):
                spectral_table(distribution, "REC709", 1.0, False)
