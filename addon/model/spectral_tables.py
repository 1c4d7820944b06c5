"""Spectral tables: the colours that light is split into, ready to be drawn by a random number.

A table turns a random number into a wavelength and the RGB weight of light of that wavelength. The weights average to
exactly white, so whatever does not split the colours looks as it does without the table.

Sources:

* CIE 15:2018, Colorimetry: CIE 1931 2 degree observer.
* Lam (1985), Metamerism and colour constancy, University of Bradford: the Bradford adaptation.
"""

from __future__ import annotations

import os
from functools import lru_cache

import numpy as np

from .colour_science import SpectrumError, colour_science
from .distributions import spectrum
from .gamuts import COLOURSPACES, adaptation_matrix, white_and_primaries
from .spectra import WAVELENGTHS, Spectrum, cells

ENTRIES = 4096
"""Rows of a table."""

MAX_RMS = 100.0
"""Largest root mean square weight of a channel: beyond it the noise hides the picture."""


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

    :param distribution: see :func:`~nested_dielectric.model.distributions.spectrum`.
    :param gamut: a word of :data:`~nested_dielectric.model.gamuts.GAMUTS` but SCENE, which only a caller with the file can
        resolve.
    :param saturation: 0 (greys of each wavelength's luminance) to 1.
    :param clamp_negative: cut off negative weights, which most wavelengths have in every gamut but ACES AP0.
    :return: (ENTRIES, 4) float32, read-only: R, G, B, and wavelength in nm. The same object for the same arguments.
    :raises SpectrumError: for unknown words, a saturation out of range, bad files, and light that cannot be white.
    """
    if gamut not in COLOURSPACES:
        raise SpectrumError(f"gamut {gamut!r}: one of {', '.join(COLOURSPACES)} is needed")
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


@lru_cache(maxsize=64)
def _table(light: Spectrum, gamut: str, saturation: float, clamp_negative: bool) -> np.ndarray:
    start, end, power = cells(light)
    rgb = _balanced(light.name, _tristimuli((start + end) / 2.0, power), gamut, saturation, clamp_negative)
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


def _tristimuli(wavelengths: np.ndarray, power: np.ndarray) -> np.ndarray:
    """Return the (n, 3) XYZ of cells with a wavelength (nm) and a power, to the CIE 1931 2 degree observer."""
    observer = colour_science().MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    matching = [np.interp(wavelengths, observer.wavelengths, row) for row in observer.values.T]
    return power[:, None] * np.stack(matching, axis=1)


def _balanced(name: str, xyz: np.ndarray, gamut: str, saturation: float, clamp_negative: bool) -> np.ndarray:
    """Return the (n, 3) RGB of cells in a gamut, adapted to its white; the sum of each channel is 1.

    :raises SpectrumError: for light that is too narrow to be white.
    """
    with np.errstate(all="ignore"):
        xyz = xyz / xyz[:, 1].sum()
        white, to_xyz = white_and_primaries(gamut)
        rgb = xyz @ adaptation_matrix(xyz.sum(axis=0), white).T @ np.linalg.inv(to_xyz).T
        rgb /= rgb.sum(axis=0)
        rms = _rms(rgb)
    if not rms <= MAX_RMS:
        raise SpectrumError(
            f"distribution {name!r}: this light is too narrow to be balanced to white (weights of {rms:.3g}); "
            "spread it over more wavelengths"
        )
    grey = (rgb @ to_xyz[1] / to_xyz[1].sum())[:, None]
    rgb = grey + saturation * (rgb - grey)
    if clamp_negative:
        rgb = np.maximum(rgb, 0.0)
    return rgb / rgb.sum(axis=0)


def _rms(rgb: np.ndarray) -> float:
    """Return the largest root mean square weight of a channel, if cells are drawn in proportion to the length of their RGB."""
    effect = np.linalg.norm(rgb, axis=1)
    return float(np.sqrt((rgb**2 / np.maximum(effect, 1e-300)[:, None]).sum(axis=0) * effect.sum()).max())
