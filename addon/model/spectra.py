"""Spectral tables: the colours that light is split into, ready to be drawn by a random number.

A table turns a random number into a wavelength and the RGB weight of light of that wavelength. The weights average to
exactly white, so whatever does not split the colours looks as it does without the table.

References:

* CIE 15:2018, Colorimetry: CIE 1931 2 degree observer, tables of illuminants, linear interpolation of illuminants.
* Judd, MacAdam and Wyszecki (1964), Spectral distribution of typical daylight: the D series.
* Planck (1901), Ueber das Gesetz der Energieverteilung im Normalspectrum: the black body.
* Lam (1985), Metamerism and colour constancy, University of Bradford: the Bradford adaptation.
* Sansonetti, Salit and Reader (1996), Wavelengths of spectral lines in mercury pencil lamps.
* Sansonetti (2008), Wavelengths, transition probabilities and energy levels for the spectra of sodium.
"""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache, lru_cache
from itertools import pairwise
from math import isfinite
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from .choice import Choice

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WAVELENGTHS = (380.0, 780.0)
"""First and last wavelength of a table, nm."""

ENTRIES = 4096
"""Rows of a table."""

CELL = 0.1
"""Width of the cells that spectra are integrated over, nm."""

MAX_RMS = 100.0
"""Largest root mean square weight of a channel: beyond it the noise hides the picture."""

MAX_CSV = 10_000_000
"""Most characters of a file of power, of which a spectrum has some thousand lines: a device has no end."""

DISTRIBUTIONS = (
    Choice("FULL", "Full", "Equal energy at all wavelengths (CIE E)"),
    Choice("DAYLIGHT", "Daylight", "Noon daylight (CIE D65)"),
    Choice("BLUE_SKY", "Blue Sky", "Clear north sky (CIE D series, 20000 K)"),
    Choice("SUNSET", "Sunset", "A low sun (black body, 2500 K)"),
    Choice("LED", "LED", "A white light-emitting diode (CIE LED-B3)"),
    Choice("FLUORESCENT", "Fluorescent", "A cool white fluorescent lamp with the lines of mercury (CIE FL2)"),
    Choice("SODIUM", "Sodium", "A low-pressure sodium lamp: two yellow lines, which hardly split"),
)

GAMUTS = (
    Choice("SCENE", "Scene", "The file's own working space"),
    Choice("REC709", "Rec.709", "ITU-R BT.709, the primaries of sRGB"),
    Choice("ADOBE_RGB", "Adobe RGB", "Adobe RGB (1998)"),
    Choice("WIDE_GAMUT", "Wide Gamut RGB", "Adobe Wide Gamut RGB"),
    Choice("PROPHOTO", "ProPhoto RGB", "ProPhoto RGB (ROMM)"),
    Choice("ACES_AP0", "ACES AP0", "ACES2065-1, which holds every colour"),
    Choice("ACESCG", "ACEScg", "ACEScg, the primaries AP1"),
    Choice("REC2020", "Rec.2020", "ITU-R BT.2020"),
)

MERCURY_LINES = ((404.656,), (435.833,), (546.074,), (576.960, 579.066))
"""Mercury's strong visible lines, nm, in air (Sansonetti, Salit and Reader, 1996); lines too close for the CIE's
samples to tell apart stand together.
"""

SODIUM_LINES = ((588.995, 2.0), (589.592, 1.0))
"""Sodium's doublet, nm in air (Sansonetti, 2008), with its power in an optically thin gas."""

_CIE_NAMES = {"FULL": "E", "DAYLIGHT": "D65", "LED": "LED-B3", "FLUORESCENT": "FL2"}

_COLOURSPACES = {
    "REC709": "ITU-R BT.709",
    "ADOBE_RGB": "Adobe RGB (1998)",
    "WIDE_GAMUT": "Adobe Wide Gamut RGB",
    "PROPHOTO": "ProPhoto RGB",
    "ACES_AP0": "ACES2065-1",
    "ACESCG": "ACEScg",
    "REC2020": "ITU-R BT.2020",
}

_REMEDY = (
    f"use one of {', '.join(choice.keyword for choice in DISTRIBUTIONS)}, a CIE illuminant such as D50 or FL11, or a "
    "CSV file of wavelength (nm) and power"
)


class SpectrumError(ValueError):
    """A spectrum, gamut or saturation that no table can be made of. The text names what is wrong and the remedy."""


@dataclass(frozen=True)
class Spectrum:
    """Power over wavelength, in an arbitrary unit.

    ``power`` (per nm) is linear between the ``wavelengths`` (nm, increasing) and zero outside them; ``lines`` are pairs
    of a wavelength (nm) and a finite power.
    """

    name: str = field(compare=False)
    wavelengths: tuple[float, ...]
    power: tuple[float, ...]
    lines: tuple[tuple[float, float], ...] = ()


def illuminant_names() -> tuple[str, ...]:
    """The names of the CIE's illuminants that a distribution may be given as."""
    return tuple(name for name in _colour().SDS_ILLUMINANTS if not name.startswith("ISO"))


def spectrum(distribution: str | os.PathLike) -> Spectrum:
    """Return the spectrum of a distribution.

    :param distribution: a word of :data:`DISTRIBUTIONS`, a name of :func:`illuminant_names` (both in any case), or the
        path of a CSV file with two columns, wavelength (nm) and power per nm.
    :raises SpectrumError: for anything else, and for a file that cannot be read as such.
    """
    if isinstance(distribution, str):
        word = distribution.upper()
        if any(word == choice.keyword for choice in DISTRIBUTIONS):
            return _word_spectrum(word)
        for name in illuminant_names():
            if word == name.upper():
                return _cie_spectrum(name)
    elif not isinstance(distribution, os.PathLike):
        raise SpectrumError(f"distribution {distribution!r}: {_REMEDY}")
    return _csv_spectrum(Path(distribution))


def spectral_table(
    distribution: str | os.PathLike = "DAYLIGHT",
    gamut: str = "REC709",
    saturation: float = 1.0,
    clamp_negative: bool = True,
) -> np.ndarray:
    """Return the table that draws colours of a distribution.

    Row k is for random numbers from k / ENTRIES to (k + 1) / ENTRIES. It holds the mean RGB weight of that bin and the
    wavelength at its middle, so the mean of all rows is white. Wavelengths increase with the row. They are drawn in
    proportion to the length of their RGB vector: by the inequality of Cauchy and Schwarz this makes the variance of the
    weights, summed over the channels, as small as it can be.

    The distribution is the white of the table: it is adapted to the white of the gamut (Lam, 1985). Saturation is
    applied before negative weights are clamped; clamping dims the other channels so that the mean stays white.

    :param distribution: see :func:`spectrum`.
    :param gamut: a word of :data:`GAMUTS` but SCENE, which only a caller with the file can resolve.
    :param saturation: 0 (greys of each wavelength's luminance) to 1.
    :param clamp_negative: cut off negative weights, which most wavelengths have in every gamut but ACES AP0.
    :return: (ENTRIES, 4) float32, read-only: R, G, B, and wavelength in nm. The same object for the same arguments.
    :raises SpectrumError: for unknown words, a saturation out of range, bad files, and light that cannot be white.
    """
    if gamut not in _COLOURSPACES:
        raise SpectrumError(f"gamut {gamut!r}: one of {', '.join(_COLOURSPACES)} is needed")
    try:
        saturation = float(saturation)
    except (TypeError, ValueError):
        raise SpectrumError(f"saturation {saturation!r}: a number from 0 to 1 is needed") from None
    if not 0.0 <= saturation <= 1.0:
        raise SpectrumError(f"saturation {saturation:g}: a number from 0 to 1 is needed")
    return _table(spectrum(distribution), gamut, saturation, bool(clamp_negative))


def preview(table: np.ndarray, width: int, height: int) -> np.ndarray:
    """Draw how often each wavelength is drawn, as a filled curve in the wavelengths' colours on a dark ground.

    The horizontal axis goes over :data:`WAVELENGTHS`. A line is one column, cut off at the top where it outshines the
    rest.

    :return: (height, width, 4) float32 RGBA from 0 to 1, scene-linear in the table's RGB, the bottom row first as in
        Blender's images.
    """
    ground = np.array([0.01, 0.01, 0.01])
    rgb, nm = table[:, :3].astype(float), table[:, 3]
    edges = np.linspace(*WAVELENGTHS, width + 1)
    drawn = np.interp(edges, nm, (np.arange(len(table)) + 0.5) / len(table))
    share = np.diff(drawn)
    cumulative = np.cumsum(rgb, axis=0) / len(table)
    color = np.diff([np.interp(edges, nm, channel) for channel in cumulative.T]).T.clip(0.0)
    color /= np.maximum(color.max(axis=1, keepdims=True), 1e-12)

    # The median of neighbouring columns does not see lines.
    padded = np.pad(share, 2)
    continuum = np.median([padded[i : i + width] for i in range(5)], axis=0).max()
    curve = share / (continuum or share.max())
    cover = np.clip(curve * height - np.arange(height)[:, None], 0.0, 1.0)[..., None]
    picture = np.ones((height, width, 4), np.float32)
    picture[..., :3] = ground + cover * (color - ground)
    return picture


def plot(distribution: str | os.PathLike, table: np.ndarray) -> Figure:
    """Draw a distribution's power, its table's weights and their colours over the wavelength.

    :raises SpectrumError: where matplotlib is missing, as in Blender's own Python.
    """
    light = spectrum(distribution)
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise SpectrumError(
            "plots need matplotlib, which this Python lacks; leave the plot out, or install matplotlib"
        ) from None
    figure = Figure(figsize=(8.0, 7.0), layout="constrained")
    power, weights, strip = figure.subplots(3, sharex=True, height_ratios=(3, 3, 1))
    largest = max(light.power) or 1.0
    power.fill_between(light.wavelengths, np.array(light.power) / largest, color="0.8")
    power.plot(light.wavelengths, np.array(light.power) / largest, color="0.3", label="per nm, over the largest")
    if light.lines:
        strongest = max(strength for _, strength in light.lines)
        power.vlines(
            *zip(*((nm, 0.0, strength / strongest) for nm, strength in light.lines)),
            color="tab:red",
            label="lines, over the strongest",
        )
        power.legend()
    power.set(title=light.name, ylabel="power", ylim=(0.0, 1.05))
    for channel, name in enumerate("RGB"):
        weights.plot(table[:, 3], table[:, channel], color=f"tab:{('red', 'green', 'blue')[channel]}", label=name)
    weights.axhline(0.0, color="0.3", linewidth=0.5)
    weights.set(ylabel="weight")
    weights.legend()
    shown = preview(table, 400, 60)
    shown[..., :3] **= 1 / 2.2
    strip.imshow(shown, origin="lower", aspect="auto", extent=(*WAVELENGTHS, 0, 1))
    strip.set(xlabel="wavelength (nm)", ylabel="drawn", yticks=(), xlim=WAVELENGTHS)
    return figure


@cache
def _colour() -> ModuleType:
    """colour-science, imported when it is first needed: that takes a second.

    Without SciPy and matplotlib it warns, puts mock modules in their place, which would make other add-ons believe that
    they are there, and changes how NumPy prints.
    """
    with warnings.catch_warnings(), np.printoptions():
        warnings.simplefilter("ignore")
        try:
            import colour
        except ImportError as error:
            raise SpectrumError(
                f"spectra need colour-science ({error}); install the extension's zip again, or pip install "
                "colour-science"
            ) from None
    for name, module in list(sys.modules.items()):
        if type(module).__module__ == "unittest.mock":
            del sys.modules[name]
    return colour


@cache
def _word_spectrum(word: str) -> Spectrum:
    if word == "SODIUM":
        return Spectrum(word, WAVELENGTHS, (0.0, 0.0), SODIUM_LINES)
    if word in _CIE_NAMES:
        return _cie_spectrum(_CIE_NAMES[word])
    colour = _colour()
    if word == "SUNSET":
        samples = colour.sd_blackbody(2500.0, colour.SpectralShape(*WAVELENGTHS, 1.0))
    else:
        samples = colour.sd_CIE_illuminant_D_series(colour.temperature.CCT_to_xy_CIE_D(20000.0))
    return Spectrum(word, tuple(samples.wavelengths.tolist()), tuple(samples.values.tolist()))


@cache
def _cie_spectrum(name: str) -> Spectrum:
    samples = _colour().SDS_ILLUMINANTS[name]
    wavelengths, power, lines = samples.wavelengths, samples.values.copy(), ()
    if name.startswith("FL"):
        power, lines = _separate_lines(wavelengths, power)
    return Spectrum(name, tuple(wavelengths.tolist()), tuple(power.tolist()), lines)


def _separate_lines(wavelengths: np.ndarray, power: np.ndarray) -> tuple[np.ndarray, tuple[tuple[float, float], ...]]:
    """Take mercury's lines out of an evenly sampled fluorescent lamp.

    The CIE's tables hold a line as power of the two samples around it: FL1 to FL12 share it out so that its centre is
    kept, FL3.1 to FL3.15 leave nearly all of it at the nearest sample. Either way it is what these two samples have
    above the straight line between the samples next to them, times the step. (In triphosphor lamps that includes part
    of terbium's emission, which is within 3 nm of the green line.) No power is lost, and none becomes negative. The
    lines of discharge lamps under high pressure (HP1 to HP5) are broad, and stay in the samples.

    :return: what is left of the power, and pairs of a line's wavelength and power.
    """
    left = power.copy()
    step = wavelengths[1] - wavelengths[0]
    lines = []
    for group in MERCURY_LINES:
        after = int(np.searchsorted(wavelengths, group[0], side="right"))
        around = slice(after - 1, after + 1)
        ends = wavelengths[[after - 2, after + 1]]
        straight = np.interp(wavelengths[around], ends, power[[after - 2, after + 1]])
        left[around] = np.minimum(power[around], straight)
        line_power = float((power[around] - left[around]).sum() * step)
        if line_power > 0.0:
            lines += [(nm, line_power / len(group)) for nm in group]
    return left, tuple(lines)


def _csv_spectrum(path: Path) -> Spectrum:
    try:
        with path.open(encoding="utf-8-sig") as file:
            text = file.read(MAX_CSV + 1)
    except FileNotFoundError:
        raise SpectrumError(f"distribution {str(path)!r}: no such word, CIE illuminant or file; {_REMEDY}") from None
    except (OSError, ValueError) as error:
        raise SpectrumError(f"{path}: cannot be read as a CSV file ({error}); {_REMEDY}") from None
    if len(text) > MAX_CSV:
        raise SpectrumError(f"{path}: is longer than {MAX_CSV:,} characters; {_REMEDY}")
    rows: list[tuple[float, float, int]] = []
    header_allowed = True
    for number, line in enumerate(text.splitlines(), 1):
        cells = [cell.strip() for cell in line.partition("#")[0].split(",")]
        if cells == [""]:
            continue
        try:
            row = [float(cell) for cell in cells]
        except ValueError:
            row = None
        if row is None and header_allowed and not _is_number(cells[0]):
            header_allowed = False
            continue
        header_allowed = False
        if row is None or len(row) != 2 or not all(map(isfinite, row)):
            raise SpectrumError(
                f"{path}, line {number}: {line.strip()!r}: two finite numbers are needed, wavelength (nm) and power, "
                "separated by a comma"
            )
        if row[1] < 0.0:
            raise SpectrumError(f"{path}, line {number}: power {row[1]:g} is negative; zero is the least")
        rows.append((*row, number))
    if len(rows) < 2:
        raise SpectrumError(f"{path}: at least two rows of wavelength (nm) and power are needed")
    rows.sort()
    for (before, _, _), (wavelength, _, number) in pairwise(rows):
        if wavelength == before:
            raise SpectrumError(
                f"{path}, line {number}: wavelength {wavelength:g} nm stands there twice; keep one of the rows"
            )
    light = Spectrum(path.name, tuple(row[0] for row in rows), tuple(row[1] for row in rows))
    if not _cells(light)[2].any():
        raise SpectrumError(
            f"{path}: no power between {WAVELENGTHS[0]:g} and {WAVELENGTHS[1]:g} nm; the first column is the "
            "wavelength in nm"
        )
    return light


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _cells(light: Spectrum) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Divide a spectrum into cells along the wavelength; a line is a cell without width.

    :return: where each cell begins and ends, nm, and its power; the largest power per nm is 1.
    """
    first, last = WAVELENGTHS
    samples, power = np.array(light.wavelengths), np.array(light.power)
    lines = np.array(light.lines).reshape(-1, 2)
    scale = max(power.max(), lines[:, 1].max(initial=0.0)) or 1.0
    grid = first + CELL * np.arange(round((last - first) / CELL) + 1)
    # Cells break at samples too, so that power is linear over each of them, and its value in the middle is its mean.
    edges = np.unique(np.round(np.concatenate((grid, samples, lines[:, 0])), 9))
    edges = edges[(edges >= first) & (edges <= last)]
    middles = (edges[:-1] + edges[1:]) / 2.0
    content = np.interp(middles, samples, power / scale, left=0.0, right=0.0) * np.diff(edges)
    start = np.concatenate((edges[:-1], lines[:, 0]))
    end = np.concatenate((edges[1:], lines[:, 0]))
    order = np.argsort(start + end, kind="stable")
    return start[order], end[order], np.concatenate((content, lines[:, 1] / scale))[order]


@cache
def _gamut(keyword: str) -> tuple[np.ndarray, np.ndarray]:
    """The white's XYZ (Y = 1) and the matrix from RGB to XYZ of a gamut.

    The matrix is derived from the primaries: published ones are rounded, and their white is not quite white.
    """
    colour = _colour()
    space = colour.RGB_COLOURSPACES[_COLOURSPACES[keyword]]
    return colour.xy_to_XYZ(space.whitepoint), colour.normalised_primary_matrix(space.primaries, space.whitepoint)


def converted(rgb: Sequence[float], source: str, target: str) -> tuple[float, float, float]:
    """Convert a scene-linear colour from one gamut to another, white to white (Bradford's adaptation).

    :raises SpectrumError: without colour-science, if they differ.
    """
    if source == target:
        return tuple(rgb)
    (white, to_xyz), (other_white, other_to_xyz) = _gamut(source), _gamut(target)
    adaptation = _colour().adaptation.matrix_chromatic_adaptation_VonKries(white, other_white, transform="Bradford")
    return tuple((np.linalg.inv(other_to_xyz) @ adaptation @ to_xyz @ np.array(rgb)).tolist())


@lru_cache(maxsize=64)
def _table(light: Spectrum, gamut: str, saturation: float, clamp_negative: bool) -> np.ndarray:
    colour = _colour()
    start, end, power = _cells(light)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    middle = (start + end) / 2.0
    xyz = power[:, None] * np.stack([np.interp(middle, observer.wavelengths, row) for row in observer.values.T], axis=1)
    with np.errstate(all="ignore"):
        xyz /= xyz[:, 1].sum()
        white, to_xyz = _gamut(gamut)
        adaptation = colour.adaptation.matrix_chromatic_adaptation_VonKries(
            xyz.sum(axis=0), white, transform="Bradford"
        )
        rgb = xyz @ adaptation.T @ np.linalg.inv(to_xyz).T
        rgb /= rgb.sum(axis=0)
        rms = _rms(rgb)
    if not rms <= MAX_RMS:
        raise SpectrumError(
            f"distribution {light.name!r}: this light is too narrow to be balanced to white (weights of {rms:.3g}); "
            "spread it over more wavelengths"
        )
    grey = (rgb @ to_xyz[1] / to_xyz[1].sum())[:, None]
    rgb = grey + saturation * (rgb - grey)
    if clamp_negative:
        rgb = np.maximum(rgb, 0.0)
    rgb /= rgb.sum(axis=0)

    # Both are 0 at the first edge, and linear in each other within a cell.
    drawn = np.cumsum(np.linalg.norm(rgb, axis=1))
    drawn = np.concatenate(([0.0], drawn / drawn[-1]))
    cumulative = np.concatenate((np.zeros((1, 3)), np.cumsum(rgb, axis=0)))
    bins = np.arange(ENTRIES + 1) / ENTRIES
    table = np.empty((ENTRIES, 4), np.float32)
    for channel in range(3):
        table[:, channel] = np.diff(np.interp(bins, drawn, cumulative[:, channel])) * ENTRIES
    number = (bins[:-1] + bins[1:]) / 2.0
    cell = np.searchsorted(drawn[1:], number, side="right")
    along = (number - drawn[cell]) / (drawn[cell + 1] - drawn[cell])
    table[:, 3] = start[cell] + along * (end[cell] - start[cell])
    table.flags.writeable = False
    return table


def _rms(rgb: np.ndarray) -> float:
    """The largest root mean square weight of a channel, if cells are drawn in proportion to the length of their RGB."""
    effect = np.linalg.norm(rgb, axis=1)
    return float(np.sqrt((rgb**2 / np.maximum(effect, 1e-300)[:, None]).sum(axis=0) * effect.sum()).max())
