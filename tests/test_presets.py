"""Presets against the curves, tables and catalogues that they name, written here as these print them."""

import re
from math import inf, sqrt

import pytest

from nested_dielectric import dispersion, parameters, presets

pytestmark = pytest.mark.quick

VISIBLE = range(380, 781)


def resonances(*terms: tuple[float, float]):
    """n^2 = 1 + sum of B L^2 / (L^2 - l^2): the form of Malitson, Peter, Dodge, Wood and Nassau."""
    return lambda um: sqrt(1 + sum(b * um**2 / (um**2 - l**2) for b, l in terms))


def squares(*terms: tuple[float, float]):
    """n^2 = 1 + sum of B L^2 / (L^2 - C): the form of Schott, Daimon and Masumura, Kedenburg et al."""
    return lambda um: sqrt(1 + sum(b * um**2 / (um**2 - c) for b, c in terms))


CURVES = {
    "air_bubble": lambda um: 1.0,
    "bk7": squares((1.03961212, 0.00600069867), (0.231792344, 0.0200179144), (1.01046945, 103.560653)),
    "cubic_zirconia": resonances((1.347091, 0.062543), (2.117788, 0.166739), (9.452943, 24.320570)),
    "diamond": resonances((0.3306, 0.1750), (4.3356, 0.1060)),
    "ethanol": squares((0.83189, 0.00930), (-0.15582, -49.45200)),
    "fused_silica": resonances((0.6961663, 0.0684043), (0.4079426, 0.1162414), (0.8974794, 9.896161)),
    "glass": lambda um: 1.5130 - 0.003169 * um**2 + 0.003962 * um**-2,
    "pmma": squares((0.99654, 0.00787), (0.18964, 0.02191), (0.00411, 3.85727)),
    "polycarbonate": squares((1.4182, 0.021304)),
    "sapphire": resonances((1.4313493, 0.0726631), (0.65054713, 0.1193242), (5.3414021, 18.028251)),
    "sf11": squares((1.73759695, 0.013188707), (0.313747346, 0.0623068142), (1.89878101, 155.23629)),
    "water": squares(
        (5.684027565e-1, 5.101829712e-3),
        (1.726177391e-1, 1.821153936e-2),
        (2.086189578e-2, 2.620722293e-2),
        (1.130748688e-1, 1.069792721e1),
    ),
}

# Warren and Brandt (2008) from 390 to 780 nm, every 10 nm.
ICE = """
    1.3203 1.3194 1.3185 1.3177 1.3170 1.3163 1.3157 1.3151 1.3145 1.3140 1.3135 1.3130 1.3126 1.3121
    1.3117 1.3114 1.3110 1.3106 1.3103 1.3100 1.3097 1.3094 1.3091 1.3088 1.3085 1.3083 1.3080 1.3078
    1.3076 1.3073 1.3071 1.3069 1.3067 1.3065 1.3062 1.3060 1.3059 1.3057 1.3055 1.3053
"""

# Preset, who measured, their accuracy, {nm: index}.
MEASUREMENTS = [
    ("ice", "Warren and Brandt (2008)", 5e-5, dict(zip(range(390, 781, 10), map(float, ICE.split()), strict=True))),
    ("water", "Schiebener et al. (1990)", 2e-5, {404.41: 1.34315, 589.0: 1.33336, 632.8: 1.33211}),
    (
        "ethanol",
        "Rheims et al. (1997), an Abbe refractometer",
        3e-4,
        {nm: 1.35265 + 0.00306 * (nm / 1e3) ** -2 + 0.00002 * (nm / 1e3) ** -4 for nm in range(480, 781, 20)},
    ),
    (
        "pmma",
        "Sultanova et al. (2009)",
        1e-3,
        {436.8: 1.502, 486.1: 1.497, 587.6: 1.491, 632.8: 1.489, 703.0: 1.486},
    ),
    (
        "polycarbonate",
        "Sultanova et al. (2009)",
        1e-3,
        {436.8: 1.612, 486.1: 1.599, 587.6: 1.585, 632.8: 1.580, 703.0: 1.575},
    ),
]


def values(key: str) -> dict:
    """The parameters of a material that is made from a preset."""
    defaults = {parameter.keyword: parameter.default for parameter in parameters.PARAMETERS}
    return defaults | presets.load_preset(key).parameters


@pytest.mark.parametrize("key", sorted({*presets.preset_names()} - {"ice"}))
def test_a_preset_has_the_index_that_its_source_publishes_for_every_visible_wavelength(key):
    """1e-6 is an order below the digits of the best of them; where three terms cannot hold the published form they are
    fitted to it.
    """
    material = values(key)
    assert [dispersion.material_ior(material, nm) for nm in VISIBLE] == pytest.approx(
        [CURVES[key](nm * 1e-3) for nm in VISIBLE], rel=0, abs=1e-6
    )


@pytest.mark.parametrize(
    "key, accuracy, table", [pytest.param(key, *rest, id=f"{key}: {who}") for key, who, *rest in MEASUREMENTS]
)
def test_a_preset_agrees_with_measurements_to_their_accuracy(key, accuracy, table):
    material = values(key)
    assert [dispersion.material_ior(material, nm) for nm in table] == pytest.approx(
        list(table.values()), rel=0, abs=accuracy
    )


@pytest.mark.parametrize(
    "key, n_d, v_d",
    [("bk7", "1.51680", "64.17"), ("sf11", "1.78472", "25.68"), ("fused_silica", "1.45846", "67.8")],
)
def test_glass_has_the_index_and_abbe_number_of_its_makers_to_their_last_digit(key, n_d, v_d):
    material = values(key)
    assert f"{material['ior']:.5f}" == n_d
    assert f"{dispersion.abbe_number(material):.{len(v_d) - 3}f}" == v_d


@pytest.mark.parametrize(
    "key, index, fire",
    [
        ("cubic_zirconia", (2.15, 2.18), (0.058, 0.066)),
        ("diamond", (2.417, 2.419), (0.044, 0.044)),
        ("sapphire", (1.766, 1.774), (0.018, 0.018)),
    ],
)
def test_a_gem_has_the_index_and_fire_of_gemmology(key, index, fire):
    """Fire: the index at Fraunhofer's G line above that at his B line."""
    material = values(key)
    line_d, line_b, line_g = (dispersion.material_ior(material, nm) for nm in (589.3, 686.7, 430.8))
    assert index[0] <= line_d <= index[1]
    assert fire[0] <= round(line_g - line_b, 3) <= fire[1]


@pytest.mark.parametrize("key", presets.preset_names())
def test_a_preset_names_its_source_and_its_index_is_its_own_curves(key):
    material = values(key)
    if material["dispersion_model"] == "SELLMEIER":
        own = dispersion.sellmeier_ior(material["sellmeier_b"], material["sellmeier_c"], dispersion.LINE_D)
        assert material["ior"] == pytest.approx(own, rel=0, abs=5.1e-8)
        assert re.search(r"\((18|19|20)\d\d\), \w", presets.load_preset(key).source)
    else:
        assert dispersion.abbe_number(material) == inf


def test_only_presets_that_are_known_for_their_fire_split_white_light():
    assert [key for key in presets.preset_names() if values(key)["disperse"]] == ["cubic_zirconia", "diamond", "sf11"]
