"""How far the dispersion of Cycles' own nodes is off has a closed form."""

import pytest

from nested_dielectric.model.dispersion import LINE_C, LINE_D, LINE_F, abbe_deviation


def test_how_far_own_dispersion_is_off_has_a_closed_form():
    """JF's curve is a parabola of the wavelength, furthest from Cauchy's at the violet end."""
    ior, spread = 1.5, 0.03

    def parabola(nm):
        return (1.0 - (nm - 370.0) / 410.0) ** 2

    slope = spread * (parabola(LINE_F) - parabola(LINE_C)) / (LINE_F**-2 - LINE_C**-2)
    expected = abs(spread * (parabola(380.0) - parabola(LINE_D)) - slope * (380.0**-2 - LINE_D**-2))
    values = {"ior": ior, "dispersion_model": "JF", "dispersion": spread}
    assert abbe_deviation(values) == pytest.approx(expected, rel=1e-9)
    assert abbe_deviation({"ior": ior, "dispersion_model": "ABBE", "abbe": 30.0}) == pytest.approx(0.0, abs=1e-12)
    assert abbe_deviation({"ior": ior, "dispersion_model": "ABBE", "abbe": 0.0}) == 0.0
