"""Spectra: power over wavelength, and its division into cells for integrals."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

WAVELENGTHS = (380.0, 780.0)
"""First and last wavelength of visible light here, nm."""

CELL = 0.1
"""Width of the cells that spectra are integrated over, nm."""


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


def cells(light: Spectrum) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
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
