"""Functions of the shader's headers about smooth interfaces, and what Fresnel and Snell have them return."""

from __future__ import annotations

import numpy as np
from osl_measure import Draw, Function, dot

FEW = "a few roundings of the formula"

ALL = "all that the limits let through"

USUAL = "ratios from 1/3 to 3 but around 1"

ROOT = "the cosine behind the surface is the root of a sum with 1, whose rounding counts at ratios below 0.1"


def amplitudes(cos_i: np.ndarray, eta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the amplitudes of reflection across and in the plane of incidence, 1 where all is reflected (Born and Wolf 1999,
    section 1.5.2), with Snell's law for the cosine behind the surface.
    """
    square = ((eta - 1.0) * (eta + 1.0) + cos_i * cos_i) / (eta * eta)
    cos_t = np.sqrt(np.maximum(square, 0.0))
    across = (cos_i - eta * cos_t) / (cos_i + eta * cos_t)
    within = (eta * cos_i - cos_t) / (eta * cos_i + cos_t)
    return np.where(square > 0.0, across, 1.0), np.where(square > 0.0, within, 1.0)


def reflectance(cos_i: np.ndarray, eta: np.ndarray) -> np.ndarray:
    """Return the reflectance of unpolarised light."""
    across, within = amplitudes(cos_i, eta)
    return 0.5 * (across**2 + within**2)


def refracted(direction: np.ndarray, n: np.ndarray, eta: np.ndarray) -> np.ndarray:
    """Return where light goes that comes along a direction, zero where all is reflected (Glassner 1989, chapter 2)."""
    cos_i = -dot(direction, n)
    square = 1.0 - (1.0 - cos_i**2) / eta**2
    cos_t = np.sqrt(np.maximum(square, 0.0))
    out = direction / eta[:, None] + (cos_i / eta - cos_t)[:, None] * n
    return np.where(square[:, None] >= 0.0, out, 0.0)


def ratios(d: Draw) -> np.ndarray:
    """Ratios of all indices that media may have, half of them around 1."""
    return d.either(d.logarithmic(1e-4, 1e4), d.linear(0.5, 2.5), 1.0 + d.signed(1e-6, 0.1))


def usual(d: Draw) -> np.ndarray:
    """Ratios of indices that there are, none nearer to 1 than a hundredth."""
    return d.either(d.logarithmic(1.0 / 3.0, 0.99), d.logarithmic(1.01, 3.0))


def facing(d: Draw) -> dict[str, np.ndarray]:
    """A viewer, a normal towards it, and a ratio of indices."""
    n = d.direction()
    return {"I": d.around(n, d.linear(0.01, 1.0)), "n": n, "eta": ratios(d)}


FUNCTIONS = (
    Function(
        "fresnel_dielectric",
        "fresnel.h",
        lambda d: {"cos_i": d.cosine(), "eta": usual(d)},
        "r[0] = fresnel_dielectric(cos_i, eta);",
        lambda cos_i, eta: [reflectance(cos_i, eta)],
        16.0,
        FEW,
        domain=USUAL,
    ),
    Function(
        "fresnel_dielectric",
        "fresnel.h",
        lambda d: {"cos_i": d.cosine(), "eta": ratios(d)},
        "r[0] = fresnel_dielectric(cos_i, eta);",
        lambda cos_i, eta: [reflectance(cos_i, eta)],
        100.0,
        ROOT,
        domain=ALL,
    ),
    Function(
        "fresnel_polarized",
        "fresnel.h",
        lambda d: {"cos_i": d.cosine(), "eta": usual(d)},
        "vector f = fresnel_polarized(cos_i, eta); r[0] = f[0]; r[1] = f[1];",
        lambda cos_i, eta: [part**2 for part in amplitudes(cos_i, eta)],
        16.0,
        "Rp has its zero at Brewster's angle, where nothing is left to be right about",
        domain=USUAL,
    ),
    Function(
        "fresnel_polarized",
        "fresnel.h",
        lambda d: {"cos_i": d.cosine(), "eta": ratios(d)},
        "vector f = fresnel_polarized(cos_i, eta); r[0] = f[0]; r[1] = f[1];",
        lambda cos_i, eta: [part**2 for part in amplitudes(cos_i, eta)],
        100.0,
        ROOT,
        domain=ALL,
    ),
    Function(
        "fresnel_f0",
        "fresnel.h",
        lambda d: {"eta": ratios(d)},
        "r[0] = fresnel_f0(eta);",
        lambda eta: [((1.0 - eta) / (1.0 + eta)) ** 2],
        4.0,
        FEW,
    ),
    Function(
        "refracted_direction",
        "fresnel.h",
        facing,
        "vector out = refracted_direction(n, eta); r[0] = out[0]; r[1] = out[1]; r[2] = out[2];",
        lambda I, n, eta: [refracted(-I, n, eta)],  # noqa: E741
        8.0,
        FEW,
    ),
    Function(
        "shadow_fresnel",
        "absorption.h",
        lambda d: {
            "cos_i": d.cosine(),
            "eta": ratios(d),
            "mode": d.choice(0.0, 1.0, 2.0, 3.0),
            "enters": d.choice(0.0, 1.0),
        },
        "Incidence at; at.cos_i = cos_i; at.eta = eta; at.enters = (int)enters; r[0] = shadow_fresnel(at, (int)mode);",
        lambda cos_i, eta, mode, enters: [
            np.select(
                [mode == 0.0, (mode == 3.0) | ((mode == 2.0) & (enters > 0.0))],
                [0.0, 1.0 - reflectance(cos_i, eta)],
                1.0,
            )
        ],
        100.0,
        ROOT,
        codes=("mode", "enters"),
        terms=lambda cos_i, eta, mode, enters: [np.ones(len(eta))],
    ),
)
