"""The colour that a spectrum of transmittance has.

Light of daylight (CIE D65) goes through the medium, is seen by the CIE 1931 observer and written in linear RGB of Rec.709's
primaries, relative to the light without the medium: what absorbs nothing is (1, 1, 1).

A deep colour lies outside what these primaries can mix: a channel would be negative. And Beer-Lambert's law goes on from the
preset's depth by the logarithm of every channel. So a channel darker than 0.05 at the depth is that of half the depth,
squared, and so on: thinner layers, where the colour is seen, come right within 0.17 (with 1e-4 in place of what is negative:
0.29), the depth itself within 0.065.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

import numpy as np

from nested_dielectric.model import colour_science

from .absorption import Term

WAVELENGTHS = np.arange(380.0, 781.0, 5.0)
"""nm; the CIE's own step for colorimetry."""

LEGIBLE = 0.05
"""The least of a channel that its absorption is taken from."""

DARKEST = 1e-6
"""As the material's."""


def transmittance(absorption: Iterable[Term], metres: float) -> np.ndarray:
    """The share of light left at WAVELENGTHS after a way through the medium."""
    terms = tuple(absorption)
    return np.array([np.exp(-metres * sum(term.per_metre(float(nm)) for term in terms)) for nm in WAVELENGTHS])


@cache
def _observer() -> np.ndarray:
    """D65 times the CIE 1931 colour matching functions at WAVELENGTHS, so that the Ys add up to 1; (81, 3)."""
    colour = colour_science.colour_science()
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
    from_xyz = np.linalg.inv(colour_science.colour_science().RGB_COLOURSPACES["ITU-R BT.709"].matrix_RGB_to_XYZ)
    white = from_xyz @ tristimulus(np.ones_like(spectrum))
    return from_xyz @ tristimulus(spectrum) / white


def colour_at_depth(absorption: Iterable[Term], metres: float) -> tuple[float, float, float]:
    """The parameter Transmittance of a medium for a depth."""
    terms = tuple(absorption)
    return tuple(_rounded(_channel(terms, metres, index)) for index in range(3))


def _channel(terms: tuple[Term, ...], metres: float, index: int) -> float:
    """One channel for a depth, from the largest half, quarter and so on at which it can be told."""
    halvings = 0
    while (value := linear_rgb(transmittance(terms, metres / 2**halvings))[index]) < LEGIBLE:
        halvings += 1
    return min(max(value**2**halvings, DARKEST), 1.0)


def _rounded(channel: float) -> float:
    return float(f"{channel:.4f}") if channel >= 0.01 else float(f"{channel:.2g}")
