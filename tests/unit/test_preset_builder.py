"""Preset files against the tables that they are built from, and spectra in between against published numbers.

The database and SciPy are in the tests' own environment alone, so nothing of the builder is imported before a test runs.
"""

import sys
from math import exp, log10
from pathlib import Path

import numpy as np
import pytest

from nested_dielectric.model import dispersion, presets
from nested_dielectric.model.parameters import PARAMETERS

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT))  # for presets.build

DEFAULTS = {parameter.keyword: parameter.default for parameter in PARAMETERS}

# Pages of the refractiveindex.info database, the nm that they hold, and how near the preset's three terms come: 2e-7 for what
# is printed with these terms, else the error of the fit, which is below the last digit of the measurement.
PAGES = [
    ("glass", "glass/soda-lime/Rubin-clear", 380, 2e-7),
    ("ice", "main/H2O/Warren-2008", 390, 6e-5),
    ("water", "main/H2O/Daimon-20.0C", 380, 2e-7),
    ("crystal", "specs/SCHOTT-optical/LLF1", 380, 2e-7),
    ("borosilicate_glass", "specs/SCHOTT-misc/BOROFLOAT33", 380, 2e-7),
    ("f2", "specs/SCHOTT-optical/F2", 380, 2e-7),
    ("sf10", "specs/SCHOTT-optical/SF10", 380, 2e-7),
    ("lasf9", "specs/SCHOTT-optical/N-LASF9", 380, 2e-7),
    ("lasf35", "specs/SCHOTT-optical/LASF35", 380, 2e-7),
    ("bak4", "specs/SCHOTT-optical/N-BAK4", 380, 2e-7),
    ("fk51a", "specs/SCHOTT-optical/N-FK51A", 380, 2e-7),
    ("quartz", "main/SiO2/Ghosh-o", 380, 2e-7),
    ("sapphire", "main/Al2O3/Malitson-o", 380, 2e-7),
    ("spinel", "main/MgAl2O4/Tropf", 380, 2e-7),
    ("fluorite", "main/CaF2/Malitson", 380, 2e-7),
    ("polystyrene", "organic/polystyrene/Sultanova", 437, 2e-7),
    ("isopropanol", "organic/propanol/Sani-formula", 380, 2e-7),
    ("rock_salt", "main/NaCl/Li", 380, 2e-5),
    ("moissanite", "main/SiC/Wang-6H-o", 436, 2e-5),
    ("methanol", "organic/methanol/Moutzouris", 450, 2e-5),
    ("acetone", "organic/acetone/Rheims", 477, 2e-5),
    ("silicone", "organic/polydimethylsiloxane/Gupta", 380, 1e-3),
    ("uv_resin", "other/Norland_NOA-61/Norland", 450, 2e-4),
    ("pet", "organic/polyethylene_terephthalate/Zhang", 400, 1e-3),
]


@pytest.fixture(scope="module")
def media():
    from presets.build import MEDIA

    return {medium.key: medium for medium in MEDIA}


def absorption(medium, nm: float) -> float:
    """Natural absorption coefficient, 1/m."""
    return sum(term.per_metre(nm) for term in medium.absorption)


def absorbance(medium, nm: float, centimetres: float = 1.0) -> float:
    """Decadic absorbance of a cell."""
    return -log10(exp(-absorption(medium, nm) * centimetres / 100.0))


def test_the_files_are_what_the_tables_make(media):
    from presets.build import preset_files

    texts = preset_files()
    assert sorted(texts) == list(presets.preset_names())
    for key, text in texts.items():
        assert (presets.PRESET_FOLDER / f"{key}.toml").read_text(encoding="utf-8") == text, f"make presets: {key}"


@pytest.mark.parametrize("key, page, start, accuracy", PAGES, ids=[page[0] for page in PAGES])
def test_a_preset_has_the_index_of_its_page_of_the_database(key, page, start, accuracy):
    from presets.build.database import index_at

    values = DEFAULTS | presets.load_preset(key).parameters
    for nm in np.linspace(start, 780, 41):
        assert dispersion.material_ior(values, nm) == pytest.approx(index_at(page, nm), rel=0, abs=accuracy)


def test_what_absorbs_nothing_is_white_and_twice_the_way_is_the_square_of_the_spectrum(media):
    from presets.build.colours import linear_rgb, transmittance

    assert linear_rgb(transmittance((), 1.0)) == pytest.approx(1.0, abs=1e-12)
    green = media["bottle_green"].absorption
    assert transmittance(green, 0.01) == pytest.approx(transmittance(green, 0.005) ** 2)


@pytest.mark.filterwarnings("ignore:Aligning")
def test_the_colour_of_a_spectrum_is_that_of_colour_science(media):
    """Its own integration, of ASTM E308, over its own steps; its white differs from the primaries' by 1e-4."""
    from presets.build import colours

    from nested_dielectric.model import colour_science

    colour = colour_science.colour_science()
    for key in ("window_glass", "grey_glass", "amethyst", "dish_soap", "wine_rose"):
        spectrum = colours.transmittance(media[key].absorption, media[key].depth)
        through = colour.SpectralDistribution(dict(zip(colours.WAVELENGTHS, spectrum, strict=True)))
        xyz = colour.sd_to_XYZ(through, illuminant=colour.SDS_ILLUMINANTS["D65"]) / 100.0
        space = colour.RGB_COLOURSPACES["ITU-R BT.709"]
        assert colours.linear_rgb(spectrum) == pytest.approx(space.matrix_XYZ_to_RGB @ xyz, abs=2e-3)


@pytest.mark.parametrize("part, tolerance", [(0.25, 0.17), (0.5, 0.12), (1.0, 0.066)])
def test_thinner_layers_of_a_medium_have_the_colour_of_its_spectrum(media, part, tolerance):
    """Three channels fall as powers, a spectrum as a mixture of them, faster at first: ruby and cranberry differ most."""
    from presets.build.colours import linear_rgb, transmittance

    for key, medium in media.items():
        if medium.absorption:
            colour = np.array(presets.load_preset(key).parameters["transmittance"])
            spectral = linear_rgb(transmittance(medium.absorption, part * medium.depth)).clip(0.0, 1.0)
            assert colour**part == pytest.approx(spectral, abs=tolerance), key


@pytest.mark.parametrize("nm, tolerance", [(550, 0.03), (600, 0.1), (650, 0.06), (700, 0.05)])
def test_water_absorbs_as_another_compilation_has_it(media, nm, tolerance):
    """Segelstein's (1981) k, from measurements before Pope and Fry's; below 550 nm old measurements had impurities."""
    from presets.build.database import absorption_at

    assert absorption(media["pool_water"], nm) == pytest.approx(absorption_at("main/H2O/Segelstein", nm), rel=tolerance)


@pytest.mark.parametrize("key, low, high", [("tropical_sea", 0.018, 0.033), ("sea_water", 0.062, 0.116)])
def test_sea_water_dims_blue_light_as_jerlovs_types_of_water_do(media, key, low, high):
    """Jerlov (1976), Marine optics: daylight of 475 nm falls by 0.018/m in oceanic type I, 0.033/m in IB, 0.062/m in II and
    0.116/m in III. That counts a little scattering and slanting light, so these are bounds.
    """
    assert low < absorption(media[key], 475.0) < high


def test_amber_glass_protects_what_is_in_it_as_pharmacopoeias_ask(media):
    """USP <671>: no more than 10 % of the light of 290 to 450 nm passes a container of 2 mm and more (small ones; 450 nm is the
    hardest).
    """
    assert all(10 ** -absorbance(media["bottle_amber"], nm, 0.2) < 0.1 for nm in range(380, 451, 10))


def test_honey_has_the_colour_intensity_of_light_amber_honeys(media):
    """ABS450 of half a gram in a millilitre (Beretta et al., 2005, Analytica Chimica Acta 533: 25 to 3413 mAU, those of this
    class 300 to 700); honey weighs 1.42 g/ml.
    """
    assert 0.3 < absorbance(media["honey"], 450.0) * 0.5 / 1.42 < 0.7


def test_honey_has_the_water_of_wedmores_formula(media):
    """Wedmore (1955): (-0.2681 - log10(n - 1)) / 0.002243, in percent; the table that the preset is of says 18.0."""
    index = presets.load_preset("honey").parameters["ior"]
    assert (-0.2681 - log10(index - 1.0)) / 0.002243 == pytest.approx(18.0, abs=0.1)


def test_beer_falls_as_steeply_as_the_asbc_asks_of_beer_without_haze(media):
    """ASBC, Methods of analysis, Beer-10: beer is free of turbidity if its absorbance at 700 nm is at most 0.039 of that at 430
    nm.
    """
    for key in ("beer_pale", "beer_amber", "beer_dark"):
        assert absorbance(media[key], 700.0) <= 0.039 * absorbance(media[key], 430.0)


def test_olive_oil_has_the_pigments_that_analysis_finds_in_oil(media):
    """Minguez-Mosquera et al. (1991): chlorophylls in mg/kg are A670 / (613 x 100) x 10^6 and carotenoids A470 / (2000 x 100) x
    10^6, of a gram of oil in a millilitre and 1 cm; oil weighs 0.916 g/ml. The other pigment's tail is a twentieth.
    """
    oil = media["olive_oil"]
    assert absorbance(oil, 670.0) / 0.916 / (613 * 100) * 1e6 == pytest.approx(8.0, rel=0.05)
    assert absorbance(oil, 470.0) / 0.916 / (2000 * 100) * 1e6 == pytest.approx(3.0, rel=0.1)


@pytest.mark.parametrize("key, points", [("wine_red", (0.8, 1.0, 0.12)), ("wine_rose", (0.15, 0.17, 0.03))])
def test_wine_has_its_three_published_absorbances_and_no_negative_pigment(media, key, points):
    assert [absorbance(media[key], nm) for nm in (420, 520, 620)] == pytest.approx(points)
    (wine,) = media[key].absorption
    assert all(term.absorbance > 0.0 for term in wine.terms())


def test_caramel_has_its_hue_index(media):
    """Linner (1970): 10 log10(A510 / A610)."""
    cola = media["cola"]
    assert 10 * log10(absorbance(cola, 510.0) / absorbance(cola, 610.0)) == pytest.approx(5.0)


def test_a_gem_has_the_fire_that_its_abbe_number_was_made_of():
    from presets.build.indices import Gem

    values = DEFAULTS | Gem(1.672, 0.020).parameters()
    assert dispersion.material_ior(values, 430.8) - dispersion.material_ior(values, 686.7) == pytest.approx(
        0.020, abs=1e-5
    )


def test_a_medium_that_lacks_published_numbers_says_so(media):
    """Those whose colour, index or roughness was chosen by hand."""
    chosen = "amber amethyst apple_juice aquamarine blue_sapphire blue_topaz bottle_amber citrine cloudy_ice coffee "
    chosen += (
        "cranberry_juice dish_soap emerald epoxy garnet olive_oil perfume peridot sunflower_oil tanzanite tea topaz "
    )
    chosen += "vinegar"
    assert [key for key in chosen.split() if "no published" not in media[key].source.lower()] == []
