"""Distributions: the spectra of light that users name by a word, by the CIE's name of an illuminant or by a file.

Sources:

* CIE 15:2018, Colorimetry: tables of illuminants, their linear interpolation.
* Judd, MacAdam and Wyszecki (1964), Spectral distribution of typical daylight: the D series.
* Planck (1901), Ueber das Gesetz der Energieverteilung im Normalspectrum: the black body.
* Sansonetti, Salit and Reader (1996), Wavelengths of spectral lines in mercury pencil lamps.
* Sansonetti (2008), Wavelengths, transition probabilities and energy levels for the spectra of sodium.
"""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path

import numpy as np

from .choice import Choice
from .colour_science import SpectrumError, colour_science
from .spectra import WAVELENGTHS, Spectrum
from .spectrum_files import read_spectrum

DISTRIBUTIONS = (
    Choice("FULL", "Full", "Equal energy at all wavelengths (CIE E)"),
    Choice("DAYLIGHT", "Daylight", "Noon daylight (CIE D65)"),
    Choice("BLUE_SKY", "Blue Sky", "Clear north sky (CIE D series, 20000 K)"),
    Choice("SUNSET", "Sunset", "A low sun (black body, 2500 K)"),
    Choice("LED", "LED", "A white light-emitting diode (CIE LED-B3)"),
    Choice("FLUORESCENT", "Fluorescent", "A cool white fluorescent lamp with the lines of mercury (CIE FL2)"),
    Choice("SODIUM", "Sodium", "A low-pressure sodium lamp: two yellow lines, which hardly split"),
)

MERCURY_LINES = ((404.656,), (435.833,), (546.074,), (576.960, 579.066))
"""Mercury's strong visible lines, nm, in air (Sansonetti, Salit and Reader, 1996); lines too close for the CIE's
samples to tell apart stand together.
"""

SODIUM_LINES = ((588.995, 2.0), (589.592, 1.0))
"""Sodium's doublet, nm in air (Sansonetti, 2008), with its power in an optically thin gas."""

_CIE_NAMES = {"FULL": "E", "DAYLIGHT": "D65", "LED": "LED-B3", "FLUORESCENT": "FL2"}

_REMEDY = (
    f"use one of {', '.join(choice.keyword for choice in DISTRIBUTIONS)}, a CIE illuminant such as D50 or FL11, or a "
    "CSV file of wavelength (nm) and power"
)


def illuminant_names() -> tuple[str, ...]:
    """Return the names of the CIE's illuminants that a distribution may be given as."""
    return tuple(name for name in colour_science().SDS_ILLUMINANTS if not name.startswith("ISO"))


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
    return read_spectrum(Path(distribution), _REMEDY)


@cache
def _word_spectrum(word: str) -> Spectrum:
    if word == "SODIUM":
        return Spectrum(word, WAVELENGTHS, (0.0, 0.0), SODIUM_LINES)
    if word in _CIE_NAMES:
        return _cie_spectrum(_CIE_NAMES[word])
    colour = colour_science()
    if word == "SUNSET":
        samples = colour.sd_blackbody(2500.0, colour.SpectralShape(*WAVELENGTHS, 1.0))
    else:
        samples = colour.sd_CIE_illuminant_D_series(colour.temperature.CCT_to_xy_CIE_D(20000.0))
    return Spectrum(word, tuple(samples.wavelengths.tolist()), tuple(samples.values.tolist()))


@cache
def _cie_spectrum(name: str) -> Spectrum:
    samples = colour_science().SDS_ILLUMINANTS[name]
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
