"""The colour that a spectrum of transmittance has.

Light of daylight (CIE D65) goes through the medium, is seen by the CIE 1931 observer and written in linear RGB of Rec.709's
primaries, relative to the light without the medium: what absorbs nothing is (1, 1, 1).

A deep colour lies outside what these primaries can mix: a channel would be negative. And Beer-Lambert's law goes on from the
preset's depth by the logarithm of every channel, so 0 would be black at any thickness. Channels are therefore cut off at
1e-4 and 1: 1e-4 is below what an 8 bit picture shows.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

import numpy as np

from nested_dielectric import spectra

from .absorption import Term

WAVELENGTHS = np.arange(380.0, 781.0, 5.0)
"""nm; the CIE's own step for colorimetry."""

DARKEST = 1e-4


def transmittance(absorption: Iterable[Term], metres: float) -> np.ndarray:
    """The share of light left at WAVELENGTHS after a way through the medium."""
    terms = tuple(absorption)
    return np.array([np.exp(-metres * sum(term.per_metre(float(nm)) for term in terms)) for nm in WAVELENGTHS])


@cache
def _observer() -> np.ndarray:
    """D65 times the CIE 1931 colour matching functions at WAVELENGTHS, so that the Ys add up to 1; (81, 3)."""
    colour = spectra._colour()
    shape = colour.SpectralShape(WAVELENGTHS[0], WAVELENGTHS[-1], 5.0)
    light = colour.SDS_ILLUMINANTS["D65"].copy().align(shape).values
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape).values
    seen = light[:, None] * observer
    return seen / seen[:, 1].sum()


def tristimulus(spectrum: np.ndarray) -> np.ndarray:
    """CIE XYZ of daylight through a spectrum of transmittance at WAVELENGTHS; Y is the luminous transmittance."""
    return spectrum @ _observer()


def linear_rgb(spectrum: np.ndarray) -> np.ndarray:
    """Linear Rec.709 RGB of a spectrum of transmittance, relative to daylight itself and not cut off."""
    from_xyz = np.linalg.inv(spectra._colour().RGB_COLOURSPACES["ITU-R BT.709"].matrix_RGB_to_XYZ)
    white = from_xyz @ tristimulus(np.ones_like(spectrum))
    return from_xyz @ tristimulus(spectrum) / white


def colour_at_depth(absorption: Iterable[Term], metres: float) -> tuple[float, float, float]:
    """The parameter Transmittance of a medium for a depth."""
    rgb = linear_rgb(transmittance(absorption, metres)).clip(DARKEST, 1.0)
    return tuple(float(f"{channel:.4f}") if channel >= 0.01 else float(f"{channel:.2g}") for channel in rgb)
