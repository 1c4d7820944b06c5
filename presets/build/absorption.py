"""Absorption over the wavelength, as the literature gives it: bands, exponentials, tables, measured k.

Every term has a method ``per_metre(nm)``: the natural absorption coefficient, so that exp(-a x) is left after x metres. The
terms of a medium add up.

References:

* deLange (2016), Color, in Bamforth (ed.), Brewing materials and processes: the spectrum of an average beer.
* Linner (1970), Caramel coloring, a new method of determining its color hue and tinctorial power: the hue index.
* Pope and Fry (1997), Absorption spectrum (380-700 nm) of pure water II, Applied Optics 36(33); beyond 727.5 nm Smith and
  Baker (1981), Optical properties of the clearest natural waters, Applied Optics 20(2).
* Pekar (1953), On the effect of deformation of lattice by electrons on optical and electrical properties of crystals, Uspekhi
  Fizicheskikh Nauk 50.
* Prieur and Sathyendranath (1981), Limnology and Oceanography 26(4), and Morel (1991), Progress in Oceanography 26: what
  phytoplankton absorbs.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log
from typing import Protocol

import numpy as np

from .database import absorption_at

PER_CM = 100.0 * log(10.0)
"""1/m of a decadic absorbance of 1 in a cell of 1 cm."""


class Term(Protocol):
    """Part of what a medium absorbs."""

    def per_metre(self, nm: float) -> float:
        """The natural absorption coefficient at a wavelength in nm, 1/m."""
        ...


@dataclass(frozen=True)
class Band:
    """An absorption band: a Gaussian over the wavenumber, as crystal field and charge transfer bands are.

    Bands that vibrations broaden fall more steeply towards the red (Pekar, 1953), and so do those of dyes.

    :param nm: its peak.
    :param absorbance: decadic, of 1 cm, at the peak.
    :param width: full width at half height, 1/cm.
    :param red_width: the full width of a band whose both sides were as its red one; 0 where they are alike.
    """

    nm: float
    absorbance: float
    width: float
    red_width: float = 0.0

    def per_metre(self, nm: float) -> float:
        width = self.red_width if self.red_width and nm > self.nm else self.width
        distance = (1e7 / nm - 1e7 / self.nm) / width
        return PER_CM * self.absorbance * 2.0 ** (-4.0 * distance**2)


@dataclass(frozen=True)
class Edge:
    """Absorption that falls exponentially with the wavelength: dissolved organic matter, tannins, ultraviolet edges.

    :param nm: where it is given.
    :param absorbance: decadic, of 1 cm, there.
    :param slope: the natural exponent, 1/nm.
    """

    nm: float
    absorbance: float
    slope: float

    def per_metre(self, nm: float) -> float:
        return PER_CM * self.absorbance * exp(-self.slope * (nm - self.nm))


@dataclass(frozen=True)
class Caramel:
    """Caramel and other browned sugar: Linner's (1970) hue index is 10 log10(A510 / A610), and log A is straight.

    :param nm: where the absorbance is given.
    :param absorbance: decadic, of 1 cm, there.
    :param hue: the hue index.
    """

    nm: float
    absorbance: float
    hue: float

    def per_metre(self, nm: float) -> float:
        return PER_CM * self.absorbance * 10.0 ** (-self.hue / 1000.0 * (nm - self.nm))


@dataclass(frozen=True)
class Beer:
    """An average beer (deLange, 2016) of a colour in SRM: 12.7 times the absorbance of 1 cm at 430 nm."""

    srm: float

    def per_metre(self, nm: float) -> float:
        shape = 0.02465 * exp(-(nm - 430.0) / 17.591) + 0.97535 * exp(-(nm - 430.0) / 82.122)
        return PER_CM * self.srm / 12.7 * shape


@dataclass(frozen=True)
class Measured:
    """k of a page of the refractiveindex.info database, of something that is ``times`` as concentrated."""

    page: str
    times: float = 1.0

    def per_metre(self, nm: float) -> float:
        return self.times * max(absorption_at(self.page, nm), 0.0)


@dataclass(frozen=True)
class Wine:
    """Wine by its three published absorbances of 1 cm.

    Between 420, 520 and 620 nm stand the pigments that these stand for: tannins (an edge), the red flavylium cation (a band
    at 520 nm) and the blue quinoidal bases (a band at 620 nm); their strengths are solved for.
    """

    a420: float
    a520: float
    a620: float

    def terms(self) -> tuple[Term, ...]:
        """The edge and the two bands that have these three absorbances together."""
        points = (420.0, 520.0, 620.0)
        shapes = [
            lambda s: Edge(420.0, s, 0.0125),
            lambda s: Band(520.0, s, 4000.0, 2900.0),
            lambda s: Band(620.0, s, 2000.0),
        ]
        unit = [[shape(1.0).per_metre(nm) / PER_CM for shape in shapes] for nm in points]
        strengths = np.linalg.solve(np.array(unit), np.array([self.a420, self.a520, self.a620]))
        return tuple(shape(float(strength)) for shape, strength in zip(shapes, strengths, strict=True))

    def per_metre(self, nm: float) -> float:
        return max(sum(term.per_metre(nm) for term in self.terms()), 0.0)


@dataclass(frozen=True)
class PureWater:
    """Pure water (Pope and Fry, 1997)."""

    def per_metre(self, nm: float) -> float:
        return float(np.interp(nm, *WATER))


@dataclass(frozen=True)
class Phytoplankton:
    """Phytoplankton and what comes with it in open water (Morel, 1991) at a concentration of chlorophyll in mg/m^3."""

    chlorophyll: float

    def per_metre(self, nm: float) -> float:
        return 0.06 * float(np.interp(nm, *PHYTOPLANKTON)) * self.chlorophyll**0.65


@dataclass(frozen=True)
class YellowMatter:
    """Dissolved organic matter, which makes natural waters green and brown, by its absorption at 440 nm in 1/m."""

    at_440: float
    slope: float = 0.014

    def per_metre(self, nm: float) -> float:
        return self.at_440 * exp(-self.slope * (nm - 440.0))


def _table(start: int, values: str) -> tuple[list[float], list[float]]:
    numbers = [float(value) for value in values.split()]
    return [start + 10.0 * i for i in range(len(numbers))], numbers


WATER = _table(
    380,
    """0.01137 0.00851 0.00663 0.00473 0.00454 0.00495 0.00635 0.00922 0.00979 0.0106 0.0127 0.0150 0.0204 0.0325
    0.0409 0.0434 0.0474 0.0565 0.0619 0.0695 0.0896 0.1351 0.2224 0.2644 0.2755 0.2916 0.3108 0.340 0.410 0.439 0.465
    0.516 0.624 0.827 1.231 1.799 2.38 2.47 2.55 2.51 2.36""",
)
"""nm and 1/m, every 10 nm."""

PHYTOPLANKTON = _table(
    400,
    """0.687 0.828 0.913 0.973 1.000 0.944 0.917 0.870 0.798 0.750 0.668 0.618 0.528 0.474 0.416 0.357 0.294 0.276
    0.291 0.282 0.236 0.252 0.276 0.317 0.334 0.356 0.441 0.595 0.502 0.329 0.215 0.0""",
)
"""nm and the absorption relative to that at 440 nm, every 10 nm."""
