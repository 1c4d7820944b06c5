"""How an index of refraction changes with the wavelength.

The shader holds the same formulae (osl/dispersion.h); these serve the presets, the panels and the tests.

Sources:

* Sellmeier (1872), Ueber die durch die Aetherschwingungen erregten Mitschwingungen der Koerpertheilchen, Annalen der
  Physik 223.
* Cauchy (1836), Memoire sur la dispersion de la lumiere.
* Fraunhofer's lines and the Abbe number: ISO 7944:1998.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, nan, sqrt

import numpy as np

LINE_C = 656.2725
"""Hydrogen's red line, nm."""
LINE_D = 587.5618
"""Helium's yellow line, nm: the wavelength that IOR refers to."""
LINE_F = 486.1327
"""Hydrogen's blue line, nm."""


def sellmeier_ior(b: Sequence[float], c: Sequence[float], wavelength: float) -> float:
    """Return the index of refraction by Sellmeier (1872): n^2 = 1 + sum of B L^2 / (L^2 - C), L in micrometres.

    :param b: three strengths.
    :param c: the squares of the three resonances, square micrometres.
    :param wavelength: nm.
    :return: NaN where the formula has no real index.
    """
    squared = (wavelength * 1e-3) ** 2
    n2 = 1.0
    for strength, resonance in zip(b, c):
        if squared == resonance:
            return nan
        n2 += strength * squared / (squared - resonance)
    return sqrt(n2) if n2 > 0.0 else nan


def abbe_ior(ior: float, abbe: float, wavelength: float) -> float:
    """Return the index of refraction by Cauchy's (1836) two terms, through the index at the d line and the Abbe number.

    :param ior: index at 587.56 nm.
    :param abbe: V_d = (n_d - 1) / (n_F - n_C); 0 or below: no dispersion.
    :param wavelength: nm.
    """
    if abbe <= 0.0:
        return ior
    slope = (ior - 1.0) / abbe / (LINE_F**-2 - LINE_C**-2)
    return ior + slope * (wavelength**-2 - LINE_D**-2)


def jf_ior(ior: float, dispersion: float, wavelength: float) -> float:
    """Return the index of refraction of JF Nested Dielectric (2014) at a wavelength in nm.

    n = IOR + ((1 - t)^2 - 0.5) dispersion, t = (wavelength - 370 nm) / 410 nm.
    """
    t = (wavelength - 370.0) / 410.0
    return ior + ((1.0 - t) ** 2 - 0.5) * dispersion


def mean_inverse_square_offsets(table: np.ndarray) -> np.ndarray:
    """Return the mean of L^-2 - L_d^-2 over the red, green and blue of a spectral table (entries, 4), in 1/um^2.

    An index by Cauchy's two terms is linear in it.
    """
    offsets = (table[:, 3:] * 1e-3) ** -2.0 - (LINE_D * 1e-3) ** -2
    return (table[:, :3].astype(np.float64) * offsets).mean(axis=0)


def material_ior(values: dict, wavelength: float) -> float:
    """Return the index of refraction of a material at a wavelength in nm, as the shader takes it.

    ``values`` holds the material's parameters by keyword. Sellmeier's curve is shifted so that it goes through IOR at
    the d line: the published one if IOR is its own.
    """
    ior = values["ior"]
    model = values["dispersion_model"]
    if model == "SELLMEIER":
        curve = [sellmeier_ior(values["sellmeier_b"], values["sellmeier_c"], nm) for nm in (wavelength, LINE_D)]
        return ior + curve[0] - curve[1]
    if model == "JF":
        return jf_ior(ior, values["dispersion"], wavelength)
    return abbe_ior(ior, values["abbe"], wavelength)


def abbe_number(values: dict) -> float:
    """Return V_d = (n_d - 1) / (n_F - n_C) of a material's parameters; infinite where nothing disperses."""
    spread = material_ior(values, LINE_F) - material_ior(values, LINE_C)
    return (material_ior(values, LINE_D) - 1.0) / spread if spread else float("inf")


VISIBLE = (380, 780)
"""nm."""


def abbe_deviation(values: dict) -> float:
    """Return how far Cauchy's two terms are at most off a material's own index over visible light.

    They go through its index at the d line and have its Abbe number. NaN where the material has no index.
    """
    ior, abbe = material_ior(values, LINE_D), abbe_number(values)
    if abbe == inf:
        abbe = 0.0
    return float(
        max(abs(abbe_ior(ior, abbe, nm) - material_ior(values, nm)) for nm in range(VISIBLE[0], VISIBLE[1] + 1))
    )
