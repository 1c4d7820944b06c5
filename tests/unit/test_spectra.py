"""Spectral tables against colour-science's own computations, and against what a table must be."""

import hashlib
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from nested_dielectric.model import colour_science, distributions, spectral_tables
from nested_dielectric.model.colour_science import SpectrumError
from nested_dielectric.model.distributions import DISTRIBUTIONS, spectrum
from nested_dielectric.model.gamuts import GAMUTS
from nested_dielectric.model.spectral_tables import ENTRIES, preview, spectral_table

colour = colour_science.colour_science()

WORDS = [choice.keyword for choice in DISTRIBUTIONS]
SPACES = {
    "REC709": "ITU-R BT.709",
    "ADOBE_RGB": "Adobe RGB (1998)",
    "WIDE_GAMUT": "Adobe Wide Gamut RGB",
    "PROPHOTO": "ProPhoto RGB",
    "ACES_AP0": "ACES2065-1",
    "ACESCG": "ACEScg",
    "REC2020": "ITU-R BT.2020",
}
MERCURY = (404.656, 435.833, 546.074, 576.960, 579.066)

# A table knows wavelengths at the middles of its bins only; where its rows are dense, what lies between is nearly
# linear.
EDGES = np.arange(430.0, 681.0, 10.0)
BETWEEN = 2e-5
# Published matrices are rounded, that of ProPhoto by 2e-4.
ROUNDED = {"PROPHOTO": 6e-5}


def weights(table) -> np.ndarray:
    return table[:, :3].astype(float)


def integrals(table, edges) -> np.ndarray:
    """RGB of the light between wavelengths, (len(edges) - 1, 3); all of it together is white."""
    rgb = weights(table) / ENTRIES
    before = np.cumsum(rgb, axis=0) - rgb / 2
    return np.diff([np.interp(edges, table[:, 3], channel, left=0.0, right=1.0) for channel in before.T]).T


def reference(illuminant, gamut: str, edges) -> np.ndarray:
    """The same from colour-science's 1 nm summation of an illuminant, its Bradford adaptation and its matrices."""
    space = colour.RGB_COLOURSPACES[SPACES[gamut]]
    shape = colour.SpectralShape(380, 780, 1)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().trim(shape)
    power = np.interp(observer.wavelengths, illuminant.wavelengths, illuminant.values, left=0.0, right=0.0)
    xyz = power[:, None] * observer.values
    xyz[[0, -1]] /= 2  # the trapezoidal rule
    xyz /= xyz[:, 1].sum()
    adapted = colour.adaptation.chromatic_adaptation_VonKries(
        xyz, xyz.sum(axis=0), colour.xy_to_XYZ(space.whitepoint), transform="Bradford"
    )
    rgb = adapted @ space.matrix_XYZ_to_RGB.T
    before = np.cumsum(rgb, axis=0) - rgb / 2
    return np.diff([np.interp(edges, observer.wavelengths, channel) for channel in before.T]).T


@pytest.fixture
def write(tmp_path):
    def write(text: str | bytes) -> Path:
        path = tmp_path / "light.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


@pytest.mark.parametrize("clamp", [True, False])
@pytest.mark.parametrize("gamut", SPACES)
@pytest.mark.parametrize("word", WORDS)
def test_every_table_is_white_on_average_and_runs_from_short_to_long_waves(word, gamut, clamp):
    table = spectral_table(word, gamut, 1.0, clamp)
    assert table.shape == (ENTRIES, 4) and table.dtype == np.float32
    assert np.all(np.isfinite(table))
    # Each weight is rounded to 24 bits, by at most 6e-8 of itself.
    assert np.abs(weights(table).mean(axis=0) - 1.0).max() < 1e-7
    assert np.all(np.diff(table[:, 3]) >= 0.0)
    assert table[0, 3] >= 380.0 and table[-1, 3] <= 780.0
    if clamp:
        assert table.min() >= 0.0


@pytest.mark.parametrize("gamut", SPACES)
@pytest.mark.parametrize(
    "word, illuminant",
    [
        ("FULL", "E"),
        ("DAYLIGHT", "D65"),
        ("LED", "LED-B3"),
        ("BLUE_SKY", None),
        ("SUNSET", None),
        ("d50", "D50"),
        ("led-v1", "LED-V1"),
    ],
)
def test_a_table_holds_the_colours_that_colour_science_computes_for_the_light(word, illuminant, gamut):
    if word == "BLUE_SKY":
        light = colour.sd_CIE_illuminant_D_series(colour.temperature.CCT_to_xy_CIE_D(20000))
    elif word == "SUNSET":
        light = colour.sd_blackbody(2500, colour.SpectralShape(380, 780, 1))
    else:
        light = colour.SDS_ILLUMINANTS[illuminant]
    ours = integrals(spectral_table(word, gamut, 1.0, False), EDGES)
    # The reference sums at 1 nm over corners of the light that lie between, which LEDs have most of.
    assert np.abs(ours - reference(light, gamut, EDGES)).max() < 6e-5 + ROUNDED.get(gamut, 0.0)


def test_tables_of_two_gamuts_differ_by_the_matrix_between_them():
    base = integrals(spectral_table("DAYLIGHT", "REC709", 1.0, False), EDGES)
    for gamut, name in SPACES.items():
        matrix = colour.matrix_RGB_to_RGB(
            colour.RGB_COLOURSPACES["ITU-R BT.709"],
            colour.RGB_COLOURSPACES[name],
            chromatic_adaptation_transform="Bradford",
        )
        other = integrals(spectral_table("DAYLIGHT", gamut, 1.0, False), EDGES)
        assert np.abs(other - base @ matrix.T).max() < ROUNDED.get(gamut, BETWEEN), gamut


@pytest.mark.parametrize("word", ["DAYLIGHT", "SUNSET", "LED"])
def test_clamping_cuts_off_what_is_negative_and_dims_the_rest_of_each_channel_alike(word):
    nm = np.arange(400.0, 701.0, 1.0)
    free, clamped = (spectral_table(word, "REC709", 1.0, clamp) for clamp in (False, True))
    positive = np.maximum(weights(free), 0.0)
    scale = 1.0 / positive.mean(axis=0)
    assert np.all(scale < 1.0)
    expected = np.stack([np.interp(nm, free[:, 3], channel) for channel in (positive * scale).T], axis=1)
    ours = np.stack([np.interp(nm, clamped[:, 3], channel) for channel in weights(clamped).T], axis=1)
    # How often a wavelength is drawn differs between the two tables, its colour does not.
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    ours /= np.linalg.norm(ours, axis=1, keepdims=True)
    assert np.abs(ours - expected).max() < 0.005


def test_no_saturation_is_grey_of_the_wavelengths_luminance():
    table = spectral_table("DAYLIGHT", "REC709", 0.0)
    assert np.ptp(weights(table), axis=1).max() < 1e-6
    luminance = colour.RGB_COLOURSPACES["ITU-R BT.709"].matrix_RGB_to_XYZ[1]
    full = integrals(spectral_table("DAYLIGHT", "REC709", 1.0, False), EDGES) @ luminance
    assert np.abs(integrals(table, EDGES)[:, 0] - full).max() < BETWEEN


def test_half_the_saturation_is_half_way_to_grey():
    grey, half, full = (integrals(spectral_table("LED", "ACESCG", s, False), EDGES) for s in (0.0, 0.5, 1.0))
    assert np.abs(half - (grey + full) / 2).max() < BETWEEN


def test_sodium_light_has_two_wavelengths_and_nothing_else():
    table = spectral_table("SODIUM", "REC2020")
    assert set(table[:, 3]) == {np.float32(588.995), np.float32(589.592)}
    # Their colours are nearly equal, so they are drawn by power and by how bright they look: 2 to 1 within a percent.
    assert np.mean(table[:, 3] < 589.3) == pytest.approx(2 / 3, abs=0.01)


def test_mercury_lines_of_a_fluorescent_lamp_stay_sharp():
    wavelengths = spectral_table("FLUORESCENT")[:, 3]
    values, counts = np.unique(wavelengths, return_counts=True)
    assert set(values[counts > 1]) == set(np.float32(MERCURY))
    assert all(counts[values == np.float32(line)] > 10 for line in MERCURY)


@pytest.mark.parametrize("name", [name for name in distributions.illuminant_names() if name.startswith("FL")])
def test_taking_the_lines_out_of_a_lamp_loses_no_power_and_moves_it_by_less_than_a_sample(name):
    samples = colour.SDS_ILLUMINANTS[name]
    light = spectrum(name)
    left, lines = np.array(light.power), np.array(light.lines)
    assert left.min() >= 0.0 and lines.min() > 0.0
    total = np.trapezoid(samples.values, samples.wavelengths)
    assert np.trapezoid(left, light.wavelengths) + lines[:, 1].sum() == pytest.approx(total, rel=1e-12)
    for first, last in ((395, 415), (430, 445), (540, 555), (570, 585)):
        here = lines[(lines[:, 0] > first) & (lines[:, 0] < last)]
        if not len(here):  # terbium's slope hides the yellow lines of some triphosphor lamps
            assert first == 570
            continue
        taken = np.where((samples.wavelengths >= first) & (samples.wavelengths <= last), samples.values - left, 0.0)
        centre = (taken * samples.wavelengths).sum() / taken.sum()
        assert abs(centre - (here[:, 0] @ here[:, 1]) / here[:, 1].sum()) < 2.5


@pytest.mark.parametrize("clamp", [True, False])
@pytest.mark.parametrize("gamut", SPACES)
@pytest.mark.parametrize("word", WORDS)
def test_no_other_way_to_draw_wavelengths_has_less_variance(word, gamut, clamp):
    table = spectral_table(word, gamut, 1.0, clamp)
    second_moment = (weights(table) ** 2).sum() / ENTRIES
    lengths = np.linalg.norm(integrals(table, np.linspace(379.9, 780.0, 800)), axis=1)
    # Cauchy and Schwarz: the sum of length^2 / probability is at least the square of the sum of lengths. Drawing by
    # daylight's power has 1.54 times as much.
    assert second_moment < 1.0001 * lengths.sum() ** 2


def test_the_weights_of_a_continuous_spectrum_all_have_the_length_that_makes_the_variance_least():
    length = np.linalg.norm(weights(spectral_table("DAYLIGHT", "REC709", 1.0, False)), axis=1)
    assert np.ptp(length) < 0.01 * length.mean()


def test_a_csv_file_of_an_illuminant_gives_the_illuminants_table(write):
    light = colour.SDS_ILLUMINANTS["D55"]
    rows = [f"{nm:g}, {power!r}  # measured" for nm, power in zip(light.wavelengths, light.values.tolist())]
    path = write("# a lamp\n\nwavelength,power\n" + "\r\n".join(reversed(rows)))
    assert np.array_equal(spectral_table(path), spectral_table("D55"))
    assert np.array_equal(spectral_table(str(path)), spectral_table("D55"))


def test_a_csv_file_may_be_in_any_unit_of_power_and_finer_than_the_cells(write):
    spikes = "".join(f"{400 + step},0\n{400.01 + step},1e-300\n{400.02 + step},0\n" for step in range(300))
    table = spectral_table(write(spikes), "REC2020")
    assert np.all(np.abs((table[:, 3] - 400.01 + 0.5) % 1.0 - 0.5) < 0.02)


def test_a_changed_csv_file_is_read_again(write):
    before = spectral_table(write("400,1\n700,1"))
    assert not np.array_equal(before, spectral_table(write("400,1\n700,2")))
    assert spectral_table(write("400,1\n700,1")) is before


@pytest.mark.parametrize(
    "text, words",
    [
        ("", ("at least two rows",)),
        ("nm,power\n500,1", ("at least two rows",)),
        ("400,1\n500;1", ("line 2", "two finite numbers", "comma")),
        ("400,1\n500,1,1", ("line 2", "two finite numbers")),
        ("400,1\n\n500,nan", ("line 3", "finite")),
        ("400,1\ninf,1", ("line 2", "finite")),
        ("400,1\n500,-1", ("line 2", "negative")),
        ("500,1\n400,1\n500,2", ("line 3", "500 nm", "twice")),
        ("400,one\n500,1", ("line 1", "two finite numbers")),
        ("nm,power\nnm,power\n400,1\n500,1", ("line 2",)),
        ("400,0\n700,0", ("no power between 380 and 780 nm",)),
        ("0.4,1\n0.7,1", ("no power between 380 and 780 nm", "in nm")),
        (b"\xff\xfe\x00", ("cannot be read",)),
    ],
)
def test_a_bad_csv_file_is_named_with_the_line_and_the_remedy(write, text, words):
    path = write(text)
    with pytest.raises(SpectrumError) as caught:
        spectral_table(path)
    assert all(word in str(caught.value) for word in (str(path), *words)), caught.value


def test_light_that_no_adaptation_makes_white_is_named(write):
    # Bradford's blue response changes sign at 527.2807 nm.
    path = write("526.9807,0\n527.2807,1\n527.5807,0")
    for clamp in (True, False):
        with pytest.raises(SpectrumError, match=r"'light\.csv'.*too narrow"):
            spectral_table(path, clamp_negative=clamp)


@pytest.mark.parametrize(
    "arguments, words",
    [
        (("missing.csv",), ("missing.csv", "DAYLIGHT", "FL11", "CSV file")),
        ((3,), ("3", "DAYLIGHT")),
        ((None,), ("None", "DAYLIGHT")),
        (("/",), ("cannot be read",)),
        (("DAYLIGHT", "SRGB"), ("SRGB", "REC709")),
        (("DAYLIGHT", "SCENE"), ("SCENE", "REC709")),
        (("DAYLIGHT", "REC709", float("nan")), ("saturation", "nan", "0 to 1")),
        (("DAYLIGHT", "REC709", 1.5), ("saturation", "1.5", "0 to 1")),
        (("DAYLIGHT", "REC709", "much"), ("saturation", "much", "0 to 1")),
    ],
)
def test_a_bad_argument_is_named_with_the_remedy(arguments, words):
    with pytest.raises(SpectrumError) as caught:
        spectral_table(*arguments)
    assert all(word in str(caught.value) for word in words), caught.value


def test_words_of_gamuts_are_those_of_the_tests():
    assert [choice.keyword for choice in GAMUTS] == ["SCENE", *SPACES]


@pytest.mark.parametrize("name", distributions.illuminant_names())
def test_every_cie_illuminant_has_a_table(name):
    assert np.abs(weights(spectral_table(name.lower())).mean(axis=0) - 1.0).max() < 1e-7


def test_a_table_cannot_be_changed():
    with pytest.raises(ValueError):
        spectral_table()[0, 0] = 2.0


ALONE = """
import hashlib, importlib.util, pathlib, sys, types
import numpy
for name in ("scipy", "matplotlib"):
    sys.modules[name] = None  # as if not installed
sys.modules["model"] = package = types.ModuleType("model")
package.__path__ = [sys.argv[1]]
before = numpy.get_printoptions()
from model import spectral_tables, spectrum_plots
assert "colour" not in sys.modules and "bpy" not in sys.modules
digest = hashlib.sha256()
for word in sys.argv[2:]:
    digest.update(spectral_tables.spectral_table(word).tobytes())
assert "colour" in sys.modules
assert numpy.get_printoptions() == before
assert not [name for name, module in sys.modules.items() if type(module).__module__ == "unittest.mock"]
try:
    spectrum_plots.plot("LED", spectral_tables.spectral_table("LED"))
except spectral_tables.SpectrumError as error:
    assert "matplotlib" in str(error)
print(digest.hexdigest())
"""


def test_a_process_without_blender_scipy_and_matplotlib_makes_the_same_tables_and_leaves_no_trace():
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", ALONE, Path(spectral_tables.__file__).parent, *WORDS],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0 and done.stderr == "", done.stderr
    ours = hashlib.sha256(b"".join(spectral_table(word).tobytes() for word in WORDS))
    assert done.stdout.strip() == ours.hexdigest()


@pytest.mark.parametrize("word", WORDS)
@pytest.mark.parametrize("size", [(256, 48), (16, 4), (1, 1)])
def test_a_preview_is_a_picture_of_the_lights_colours(word, size):
    width, height = size
    picture = preview(spectral_table(word, "REC709", 1.0, False), width, height)
    assert picture.shape == (height, width, 4)
    assert picture.min() >= 0.0 and picture.max() <= 1.0 and np.all(picture[..., 3] == 1.0)
    lit = picture[..., :3].sum(axis=2)
    assert np.all(np.diff(lit, axis=0) <= 1e-6), "not filled from the bottom, the first row"
    assert lit.max() > 0.5


def test_a_preview_goes_from_blue_through_green_to_red():
    row = preview(spectral_table("DAYLIGHT"), 400, 100)[0]
    assert [int(row[nm - 380, :3].argmax()) for nm in (450, 530, 640)] == [2, 1, 0]
    brightness = [row[nm - 380, :3].max() for nm in (381, 450, 530, 640, 779)]
    assert min(brightness[1:4]) > 0.9 and max(brightness[0], brightness[-1]) < 0.05


def test_spectra_increase_in_wavelength():
    for word in WORDS:
        assert all(before < after for before, after in pairwise(spectrum(word).wavelengths))
