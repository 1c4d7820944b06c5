"""Every preset as a slab that the camera looks straight through, against Fresnel and Beer-Lambert."""

import math

import numpy as np
import pytest
from scenes import add_box, add_camera, new_scene, render, set_half_world
from significance import ROUNDING

import nested_dielectric as nd
from nested_dielectric.model.parameters import PARAMETERS
from nested_dielectric.model.presets import all_presets
from nested_dielectric.model.spectral_tables import spectral_table

PIXELS = 6
"""On a slab's side."""
COLUMNS = 10
SAMPLES = 576
DEFAULTS = {parameter.keyword: parameter.default for parameter in PARAMETERS}

# A share of the depth that leaves light even of the darkest colours; whatever is colourless is as thick as a hand.
SHARE = 0.4
CLEAR = 0.1


FILMS = [preset.key for preset in all_presets() if "thin_film_thickness" in preset.parameters]
ROUGH = [preset.key for preset in all_presets() if "roughness" in preset.parameters]


def thickness(values: dict) -> float:
    return SHARE * values["transmittance_depth"] if min(values["transmittance"]) < 1.0 else CLEAR


def through(values: dict) -> np.ndarray:
    """Light that a slab lets through straight on, by colour: both faces with all reflections between them."""
    face = ((values["ior"] - 1.0) / (values["ior"] + 1.0)) ** 2
    left = np.array(values["transmittance"]) ** (thickness(values) / values["transmittance_depth"])
    return (1.0 - face) ** 2 * left / (1.0 - (face * left) ** 2)


def noise(values: dict) -> np.ndarray:
    """Standard error of a slab's mean over `through`, by colour, if samples are independent: every sample shows what is
    behind or nothing, and one that is split into colours shows one wavelength's share of white.
    """
    face = ((values["ior"] - 1.0) / (values["ior"] + 1.0)) ** 2
    share = (1.0 - face) / (1.0 + face)
    weights = (spectral_table()[:, :3].astype(float) ** 2).mean(axis=0) if values["disperse"] else np.ones(3)
    return np.sqrt((weights / share - 1.0) / (SAMPLES * (PIXELS - 2) ** 2))


@pytest.fixture(scope="module")
def slabs() -> dict:
    """What every preset's slab shows of a world that is white behind it and black in front: {key: (values, mean)}."""
    library = all_presets()
    rows = math.ceil(len(library) / COLUMNS)
    scene = new_scene()
    scene.render.resolution_x, scene.render.resolution_y = COLUMNS * PIXELS, rows * PIXELS
    set_half_world(2, -1)
    shown = {}
    for number, preset in enumerate(library):
        row, column = divmod(number, COLUMNS)
        values = DEFAULTS | preset.parameters
        # Their diagonals miss the pixels' corners.
        low, high = (column + 0.031, -row - 0.953, -thickness(values)), (column + 0.967, -row - 0.019, 0.0)
        add_box(preset.key, low, high, nd.new_material(preset.name, preset=preset.key))
        shown[preset.key] = values, row * PIXELS, column * PIXELS
    middle = (COLUMNS / 2, -rows / 2)
    add_camera((*middle, 3.0), (*middle, 0.0), width=max(COLUMNS, rows))
    nd.analyse(scene)
    picture = render(SAMPLES)
    # The pixels around a slab's edge see past it.
    inside = slice(1, PIXELS - 1)
    return {
        key: (values, picture[row : row + PIXELS, column : column + PIXELS][inside, inside].mean(axis=(0, 1)))
        for key, (values, row, column) in shown.items()
    }


def test_light_through_every_preset_is_what_fresnel_and_beer_lambert_say(slabs):
    """Within 4 standard errors and rounding."""
    wrong = {}
    for key, (values, mean) in slabs.items():
        expected = through(values)
        if key not in FILMS + ROUGH and np.any(np.abs(mean - expected) > expected * 4.0 * noise(values) + ROUNDING):
            wrong[key] = f"{mean} instead of {expected}"
    assert wrong == {}


@pytest.mark.parametrize("key", FILMS)
def test_a_film_reflects_no_less_and_no_more_than_its_two_faces_can_together(slabs, key):
    """Airy (1833): whatever the film's thickness, the amplitudes of its faces add up or take away from each other. Both
    faces of the slab carry it.
    """
    values, mean = slabs[key]
    film, inside = values["thin_film_ior"], values["ior"]
    first, second = (film - 1.0) / (film + 1.0), (inside - film) / (inside + film)
    bounds = sorted(((first + sign * second) / (1.0 + sign * first * second)) ** 2 for sign in (1.0, -1.0))
    brightest, darkest = ((1.0 - bound) / (1.0 + bound) for bound in bounds)
    slack = 4.0 * math.sqrt((1.0 / darkest - 1.0) / (SAMPLES * (PIXELS - 2) ** 2))
    assert np.all((mean > darkest * (1.0 - slack)) & (mean < brightest * (1.0 + slack)))
    # 100 nm against reflections is nearly the same for all colours.
    assert np.ptp(mean) > (0.001 if key == "coated_lens" else 0.005)


@pytest.mark.parametrize("key", ROUGH)
def test_a_rough_slab_lets_most_light_through(slabs, key):
    """GGX of single scattering loses up to a fifth here; Multiscatter GGX makes up for the loss by Cycles' tables, which add
    up to 3 %.
    """
    _, mean = slabs[key]
    assert np.all((mean > 0.8) & (mean < 1.03))
