"""Presets against the curves, tables and catalogues that they name, written here as these print them."""

import re
from math import sqrt

import numpy as np
import pytest

from nested_dielectric.model import colour_science, dispersion, parameters, presets

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Of red, green and blue of Rec.709."""

VISIBLE = range(380, 781)


def resonances(*terms: tuple[float, float]):
    """n^2 = 1 + sum of B L^2 / (L^2 - r^2): the form of Malitson, Peter, Dodge, Wood and Nassau."""
    return lambda um: sqrt(1 + sum(b * um**2 / (um**2 - r**2) for b, r in terms))


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


# Catalogues of the makers: n_d and V_d as printed.
CATALOGUES = [
    ("bak4", "1.56883", "55.98"),
    ("bk7", "1.51680", "64.17"),
    ("crystal", "1.54814", "45.75"),
    ("f2", "1.62004", "36.37"),
    ("fk51a", "1.48656", "84.47"),
    ("fused_silica", "1.45846", "67.8"),
    ("lasf35", "2.02204", "29.06"),
    ("lasf9", "1.85025", "32.17"),
    ("sf10", "1.72825", "28.41"),
    ("sf11", "1.78472", "25.68"),
]

# Gemmology (Webster, 1994, Gems; Read, 2005, Gemmology): range of the index, and fire. Fire is printed to 0.001; moissanite's
# as 0.104, and the measurement that the preset is of has 0.112.
GEMS = [
    ("amethyst", (1.544, 1.553), (0.013, 0.013)),
    ("aquamarine", (1.567, 1.590), (0.014, 0.014)),
    ("blue_sapphire", (1.762, 1.774), (0.018, 0.018)),
    ("citrine", (1.544, 1.553), (0.013, 0.013)),
    ("cubic_zirconia", (2.15, 2.18), (0.058, 0.066)),
    ("diamond", (2.417, 2.419), (0.044, 0.044)),
    ("emerald", (1.565, 1.602), (0.014, 0.014)),
    ("fluorite", (1.433, 1.435), (0.007, 0.008)),
    ("garnet", (1.76, 1.83), (0.024, 0.024)),
    ("moissanite", (2.647, 2.691), (0.104, 0.112)),
    ("peridot", (1.654, 1.690), (0.020, 0.020)),
    ("quartz", (1.544, 1.553), (0.013, 0.013)),
    ("ruby", (1.762, 1.774), (0.018, 0.018)),
    ("sapphire", (1.762, 1.774), (0.018, 0.018)),
    ("spinel", (1.712, 1.730), (0.020, 0.020)),
    ("tanzanite", (1.691, 1.700), (0.021, 0.021)),
    ("topaz", (1.609, 1.637), (0.014, 0.014)),
]

# Others' numbers than those which the preset is made of: n_D (589.3 nm), by whom, and why it may differ by so much.
REFRACTOMETERS = [
    ("acetone", 1.3588, 5e-4, "CRC Handbook, 20 C; half a degree is 3e-4"),
    ("borosilicate_glass", 1.473, 2e-3, "Schott, Duran; Borofloat is another glass of its kind"),
    ("ethanol", 1.3611, 5e-4, "CRC Handbook, 20 C"),
    ("glycerol", 1.4730, 2e-3, "US Pharmacopeia: 1.471 to 1.475"),
    ("isopropanol", 1.3776, 5e-4, "CRC Handbook, 20 C; the source is of room temperature"),
    ("methanol", 1.3288 - 7 * 4e-4, 1.5e-3, "CRC Handbook, 20 C, taken to 27 C"),
    ("pet", 1.575, 0.01, "Mark (1999), Polymer data handbook, amorphous"),
    ("polystyrene", 1.5905, 1.5e-3, "Mark (1999), Polymer data handbook: 1.59 to 1.592"),
    ("rock_salt", 1.5443 - 6 * 3.7e-5, 2e-4, "International Critical Tables (1929), 18 C, taken to 24 C"),
    ("sea_water", 1.3394, 1e-4, "Kaye and Laby (1995), salinity 35, 20 C"),
    ("silicone", 1.4118, 5e-4, "Dow, data sheet of Sylgard 184"),
    ("sunflower_oil", 1.4646 + 20 * 3.6e-4, 4e-3, "Codex Alimentarius 210-1999: 1.461 to 1.468 at 40 C, taken to 20 C"),
    ("uv_resin", 1.56, 2e-3, "Norland, data sheet: 1.56"),
]

# Light through a pane 6 mm thick with both reflections, in percent (Pilkington, Optifloat clear, bronze, grey and green by EN
# 410). Other makes of the same tints differ by up to 4.
PANES = [("window_glass", 88), ("bronze_glass", 50), ("grey_glass", 44), ("green_glass", 75)]

# Kelly (1943), Color designations for lights, Journal of Research of the National Bureau of Standards 31: the longest dominant
# wavelength of each hue, nm; below 0 the complement of purples and of purplish reds.
KELLY = {
    "purplish blue": 465,
    "blue": 482,
    "greenish blue": 487,
    "blue green": 493,
    "bluish green": 498,
    "green": 530,
    "yellowish green": 558,
    "yellow green": 569,
    "greenish yellow": 573,
    "yellow": 578,
    "yellowish orange": 586,
    "orange": 596,
    "reddish orange": 620,
    "red": 700,
}

# First and last of the hues that the medium is known for. Rec.709 has no red beyond that of its primary, 611 nm.
HUES = [
    ("amber", "yellowish orange", "reddish orange"),
    ("aquamarine", "blue", "blue green"),
    ("beer_pale", "yellow", "yellowish orange"),
    ("blue_sapphire", "blue", "blue"),
    ("blue_topaz", "blue", "greenish blue"),
    ("bottle_amber", "yellowish orange", "orange"),
    ("bottle_cobalt", "purplish blue", "blue"),
    ("bottle_green", "green", "yellowish green"),
    ("citrine", "yellow", "yellowish orange"),
    ("cranberry_juice", "reddish orange", "reddish orange"),
    ("emerald", "bluish green", "green"),
    ("garnet", "reddish orange", "red"),
    ("glacier_ice", "blue", "greenish blue"),
    ("honey", "yellowish orange", "reddish orange"),
    ("lake_water", "green", "yellow green"),
    ("olive_oil", "greenish yellow", "yellow"),
    ("peridot", "yellow green", "yellow green"),
    ("pool_water", "blue", "blue green"),
    ("sea_water", "blue green", "bluish green"),
    ("tropical_sea", "blue", "blue green"),
    ("whisky", "yellow", "orange"),
    ("window_glass", "blue green", "green"),
    ("wine_red", "reddish orange", "reddish orange"),
    ("wine_white", "greenish yellow", "yellow"),
]


def dominant_wavelength(key: str) -> float:
    """Of daylight through a preset's depth, nm; the complement's, below 0, where no single wavelength has the hue."""
    colour = colour_science.colour_science()
    space = colour.RGB_COLOURSPACES["ITU-R BT.709"]
    xy = colour.XYZ_to_xy(space.matrix_RGB_to_XYZ @ np.array(values(key)["transmittance"]))
    return float(colour.dominant_wavelength(xy, space.whitepoint)[0])


@pytest.mark.parametrize("key", CURVES)
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


@pytest.mark.parametrize("key, n_d, v_d", CATALOGUES)
def test_glass_has_the_index_and_abbe_number_of_its_makers_to_their_last_digit(key, n_d, v_d):
    material = values(key)
    assert f"{material['ior']:.5f}" == n_d
    assert f"{dispersion.abbe_number(material):.{len(v_d) - 3}f}" == v_d


@pytest.mark.parametrize("key, index, fire", GEMS)
def test_a_gem_has_the_index_and_fire_of_gemmology(key, index, fire):
    """Fire: the index at Fraunhofer's G line above that at his B line."""
    material = values(key)
    line_d, line_b, line_g = (dispersion.material_ior(material, nm) for nm in (589.3, 686.7, 430.8))
    assert index[0] <= line_d <= index[1]
    assert fire[0] <= round(line_g - line_b, 3) <= fire[1]


@pytest.mark.parametrize("key, index, tolerance, reason", REFRACTOMETERS)
def test_a_medium_has_the_index_that_others_measured(key, index, tolerance, reason):
    assert dispersion.material_ior(values(key), 589.3) == pytest.approx(index, rel=0, abs=tolerance), reason


def test_lead_crystal_is_what_the_law_calls_crystal():
    """Directive 69/493/EEC asks for n_D of at least 1.545 in lead crystal."""
    assert dispersion.material_ior(values("crystal"), 589.3) >= 1.545


@pytest.mark.parametrize("key, percent", PANES)
def test_a_pane_lets_as_much_light_through_as_its_makers_say(key, percent):
    material = values(key)
    rgb = np.array(material["transmittance"]) ** (0.006 / material["transmittance_depth"])
    face = ((material["ior"] - 1.0) / (material["ior"] + 1.0)) ** 2
    through = (1.0 - face) ** 2 * rgb / (1.0 - (face * rgb) ** 2)
    assert 100.0 * through @ LUMINANCE == pytest.approx(percent, abs=4.0)


@pytest.mark.parametrize("key, first, last", HUES)
def test_daylight_through_a_medium_has_the_hue_that_it_is_known_for(key, first, last):
    names = list(KELLY)
    low = KELLY[names[names.index(first) - 1]] if names.index(first) else 430
    assert low <= dominant_wavelength(key) <= KELLY[last]


@pytest.mark.parametrize("key, low, high", [("amethyst", -565, -530), ("ruby", -500, -493)])
def test_a_purple_gem_lacks_the_green_that_its_name_says(key, low, high):
    """Kelly's (1943) purple to violet, and purplish red, by their complements."""
    assert low <= dominant_wavelength(key) <= high


@pytest.mark.parametrize("key", presets.preset_names())
def test_a_preset_is_whole(key):
    """It can be found, says what it is and where its numbers come from; its colour is one that a medium can have, through the
    size of a thing; its IOR is that of its own curve.
    """
    preset, material = presets.load_preset(key), values(key)
    assert preset.group in presets.GROUPS
    assert len(preset.tags) >= 3 and all(tag == tag.lower().strip() != "" for tag in preset.tags)
    assert len(set(preset.tags)) == len(preset.tags)
    assert preset.description.endswith(".") and len(preset.description.split()) >= 4
    assert len(preset.source.split()) > 8
    if "transmittance" in preset.parameters:
        assert all(1e-6 <= channel <= 1.0 for channel in material["transmittance"])
        assert 0.001 <= preset.parameters["transmittance_depth"] <= 10.0
    if material["dispersion_model"] == "SELLMEIER":
        own = dispersion.sellmeier_ior(material["sellmeier_b"], material["sellmeier_c"], dispersion.LINE_D)
        assert material["ior"] == pytest.approx(own, rel=0, abs=5.1e-8)
        assert re.search(r"\((18|19|20)\d\d\)", preset.source)


def test_the_library_holds_what_artists_ask_for_by_different_names():
    library = presets.all_presets()
    assert len(library) >= 60
    assert len({preset.name for preset in library}) == len({preset.key for preset in library}) == len(library)
    words = {word for preset in library for word in (preset.name.lower(), *preset.tags)}
    asked = "wine glass, crystal, window, pyrex, beer bottle, sea, ocean, lake, swimming pool, ice cube, iceberg, tea, "
    asked += "coffee, coke, lager, stout, red wine, whiskey, vodka, juice, honey, syrup, oil, soap, perfume, alcohol, "
    asked += "glycerin, diamond, ruby, sapphire, emerald, amethyst, topaz, aquamarine, citrine, garnet, peridot, "
    asked += "moissanite, zirconia, quartz, plexiglass, polycarbonate, water bottle, epoxy resin, silicone, amber, "
    asked += "bubble, soap film, frosted"
    lost = [word for word in asked.split(", ") if not any(word in each for each in words)]
    assert lost == []


def test_the_library_is_in_the_order_of_menus_and_every_group_has_media():
    groups = [preset.group for preset in presets.all_presets()]
    assert list(dict.fromkeys(groups)) == list(presets.GROUPS)
    assert groups == sorted(groups, key=presets.GROUPS.index)


def test_only_presets_that_are_known_for_their_fire_split_white_light():
    assert [key for key in presets.preset_names() if values(key)["disperse"]] == [
        *("crystal", "cubic_zirconia", "diamond", "f2", "moissanite", "sf10", "sf11")
    ]


def test_a_preset_overlaps_its_vessel_and_its_ice_without_setting_priorities():
    order = ["air_bubble", "drinking_glass", "ice", "olive_oil", "wine_red"]
    priorities = [values(key)["priority"] for key in order]
    assert priorities == sorted(set(priorities))
    solids = {"Glass", "Gems and Crystals", "Plastics and Resins", "Laboratory Glass"}
    assert {preset.parameters["priority"] for preset in presets.all_presets() if preset.group in solids} == {10}
