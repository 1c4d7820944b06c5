"""Indices of refraction as parameters of the material.

Published curves of three Sellmeier terms are taken as they are; others are fitted by three, whose error the tests know.

References:

* Quan and Fry (1995), Empirical equation for the index of refraction of seawater, Applied Optics 34(18).
* ICUMSA (1974), the refractive index of sucrose solutions at 20 C, 589 nm.
* CRC Handbook of Chemistry and Physics, Concentrative properties of aqueous solutions: ethanol at 20 C, 589 nm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from . import database

LINE_B, LINE_C, LINE_D, LINE_F, LINE_G = 686.7, 656.2725, 587.5618, 486.1327, 430.8
"""Fraunhofer's lines, nm."""

VISIBLE = np.arange(380.0, 781.0, 5.0)


class Index(Protocol):
    """What gives a material its index."""

    def parameters(self) -> dict[str, Any]:
        """The material's parameters of index and dispersion."""
        ...


def sellmeier(b: tuple[float, ...], c: tuple[float, ...], nm: float) -> float:
    """n of n^2 = 1 + sum of B L^2 / (L^2 - C), with L in micrometres."""
    squared = (nm * 1e-3) ** 2
    return (1.0 + sum(each * squared / (squared - square) for each, square in zip(b, c, strict=True))) ** 0.5


def _rounded(values: tuple[float, ...], digits: int = 9) -> list[float]:
    return [float(f"{value:.{digits}g}") for value in values]


@dataclass(frozen=True)
class Sellmeier:
    """Three Sellmeier terms; C in square micrometres."""

    b: tuple[float, float, float]
    c: tuple[float, float, float]

    def parameters(self) -> dict[str, Any]:
        return {
            "ior": round(sellmeier(self.b, self.c, LINE_D), 7),
            "dispersion_model": "SELLMEIER",
            "sellmeier_b": list(self.b),
            "sellmeier_c": list(self.c),
        }


@dataclass(frozen=True)
class Abbe:
    """An index at the d line and an Abbe number; 0 is no dispersion."""

    ior: float
    abbe: float

    def parameters(self) -> dict[str, Any]:
        return {"ior": round(self.ior, 5), "dispersion_model": "ABBE", "abbe": round(self.abbe, 2)}


@dataclass(frozen=True)
class Page:
    """Three Sellmeier terms fitted to a page of the refractiveindex.info database between two wavelengths, nm."""

    page: str
    start: float = 380.0
    end: float = 780.0

    def parameters(self) -> dict[str, Any]:
        terms = fit(lambda nm: database.index_at(self.page, nm), np.linspace(self.start, self.end, 81))
        return Sellmeier(*terms).parameters()


def fit(curve: Callable[[float], float], wavelengths: np.ndarray) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Fit three Sellmeier terms to a curve: a constant, an ultraviolet resonance, whose place is searched, and one far in the
    infrared. Only the strengths are free at a place, so the fit is linear and has one solution.
    """
    squared = (wavelengths * 1e-3) ** 2
    wanted = np.array([curve(float(nm)) for nm in wavelengths]) ** 2 - 1.0
    best = None
    for place in np.arange(0.002, 0.0801, 0.0005):
        c = (0.0, round(float(place), 4), 100.0)
        terms = np.stack([squared / (squared - each) for each in c], axis=1)
        b = np.linalg.lstsq(terms, wanted, rcond=None)[0]
        error = float(np.abs(terms @ b - wanted).max())
        # Noise of the last bit must not choose.
        if best is None or error < best[0] * 0.999:
            best = error, tuple(_rounded(tuple(b))), c
    return best[1:]


@dataclass(frozen=True)
class SeaWater:
    """Sea water by Quan and Fry (1995), 400 to 700 nm.

    :param salinity: grams of salt in a kilogram.
    :param celsius: temperature.
    """

    salinity: float
    celsius: float

    def at(self, nm: float) -> float:
        """Index at a wavelength in nm."""
        s, t = self.salinity, self.celsius
        n = 1.31405 + (1.779e-4 - 1.05e-6 * t + 1.6e-8 * t**2) * s - 2.02e-6 * t**2
        return n + (15.868 + 0.01155 * s - 0.00423 * t) / nm - 4382.0 / nm**2 + 1.1455e6 / nm**3

    def parameters(self) -> dict[str, Any]:
        return Sellmeier(*fit(self.at, np.arange(400.0, 701.0, 5.0))).parameters()


SUGAR = (
    (0, 10, 20, 30, 40, 50, 60, 65, 70, 80),
    (*(1.33299, 1.34783, 1.36384, 1.38115, 1.39986, 1.42009, 1.44193, 1.45348, 1.46546, 1.49071),),
)
"""Grams of sucrose in 100 g (Brix) and n_D at 20 C (ICUMSA)."""

ETHANOL = (
    (0, 5, 10, 20, 30, 40, 50, 60, 70, 80, 90, 100),
    (*(1.3330, 1.3364, 1.3396, 1.3469, 1.3535, 1.3583, 1.3616, 1.3638, 1.3652, 1.3658, 1.3650, 1.3614),),
)
"""Grams of ethanol in 100 g and n_D at 20 C (CRC)."""

WATER_ABBE = 55.7
"""Of water at 20 C, by Daimon and Masumura's (2007) curve."""


@dataclass(frozen=True)
class Drink:
    """Water with sugar and alcohol: what each adds to water's index adds up; the Abbe number is water's.

    :param brix: grams of sugar, or of other dissolved matter, in 100 g.
    :param alcohol: grams of ethanol in 100 g.
    """

    brix: float = 0.0
    alcohol: float = 0.0

    def parameters(self) -> dict[str, Any]:
        # Parabolas through neighbouring points would change the last digit alone.
        n = float(np.interp(self.brix, *SUGAR)) + float(np.interp(self.alcohol, *ETHANOL)) - ETHANOL[1][0]
        return Abbe(round(n, 4), WATER_ABBE).parameters()


@dataclass(frozen=True)
class Gem:
    """A gem by gemmology's two numbers.

    :param ior: at the D line.
    :param fire: the index at Fraunhofer's G line above that at his B line; Cauchy's two terms through both have the Abbe
        number.
    """

    ior: float
    fire: float

    def parameters(self) -> dict[str, Any]:
        slope = self.fire / (LINE_G**-2 - LINE_B**-2)
        return Abbe(self.ior, (self.ior - 1.0) / (slope * (LINE_F**-2 - LINE_C**-2))).parameters()
