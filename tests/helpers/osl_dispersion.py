"""Functions of the shader's headers about indices and wavelengths, and what published curves have them return."""

from __future__ import annotations

import numpy as np
from osl_interfaces import FEW
from osl_measure import Draw, Function
from osl_values import BACKFACING

from nested_dielectric.model.contract import DispersionModel

LINE_C, LINE_D, LINE_F = 656.2725, 587.5618, 486.1327
"""Fraunhofer's, in nm: of hydrogen, helium and hydrogen."""

SHORTEST, LONGEST = 380.0, 780.0


def offset(wavelength: np.ndarray) -> np.ndarray:
    """Return Cauchy's (1836) second term less that of the d line."""
    return wavelength**-2.0 - LINE_D**-2.0


def sellmeier(b: np.ndarray, c: np.ndarray, wavelength: np.ndarray) -> np.ndarray:
    """Return Sellmeier's (1872) index, b and c (n, 3), 0 where there is none."""
    square = (np.asarray(wavelength) * 1e-3) ** 2
    terms = b * np.expand_dims(square, -1) / (np.expand_dims(square, -1) - c)
    return np.sqrt(np.maximum(1.0 + terms.sum(axis=-1), 0.0))


def sellmeier_terms(b: np.ndarray, c: np.ndarray, wavelength: np.ndarray) -> np.ndarray:
    """Return the size of what is summed under the root, over the root, as far as that makes a difference."""
    square = (np.asarray(wavelength) * 1e-3) ** 2
    terms = b * np.expand_dims(square, -1) / (np.expand_dims(square, -1) - c)
    total = 1.0 + np.abs(terms).sum(axis=-1)
    return total / np.maximum(sellmeier(b, c, wavelength), np.sqrt(total * 1e-7))


def jf(spread: np.ndarray, wavelength: np.ndarray) -> np.ndarray:
    """Return what JF Nested Dielectric (2014) adds to the index: a parabola with its vertex at 780 nm."""
    return spread * (((780.0 - wavelength) / 410.0) ** 2 - 0.5)


def index(wavelength, ior, model, abbe, b, c, spread) -> np.ndarray:
    """Return the index at a wavelength by the model of each: by Abbe's number, by Sellmeier's terms, JF's."""
    linear = np.where(abbe > 0.0, (ior - 1.0) / abbe / (LINE_F**-2.0 - LINE_C**-2.0) * offset(wavelength), 0.0)
    curved = sellmeier(b, c, wavelength) - sellmeier(b, c, LINE_D)
    return ior + np.select(
        [model == DispersionModel.SELLMEIER, model == DispersionModel.JF], [curved, jf(spread, wavelength)], linear
    )


def index_terms(wavelength, ior, model, abbe, b, c, spread) -> np.ndarray:
    """Return the size of what the index is a sum of."""
    curved = sellmeier_terms(b, c, wavelength) + sellmeier_terms(b, c, LINE_D)
    one = np.abs(index(wavelength, ior, model, abbe, b, c, spread)) + np.abs(ior)
    return one + np.select(
        [model == DispersionModel.SELLMEIER, model == DispersionModel.JF],
        [curved, np.abs(spread)],
        np.where(abbe > 0.0, np.abs(ior - 1.0) / abbe, 0.0),
    )


def usable(ior: np.ndarray) -> np.ndarray:
    """Return what Snell's law can use: 1 in place of what is out of all bounds."""
    return np.where((ior >= 1e-3) & (ior <= 1e3), ior, 1.0)


def curves(d: Draw) -> dict[str, np.ndarray]:
    """Media by all models: glasses, and all that the limits let through."""
    b = d.vector(*[d.either(d.linear(0.0, 3.0), d.signed(1e-3, 1e4)) for _ in range(3)])
    c = d.vector(*[d.either(d.linear(0.0, 0.1), d.logarithmic(1e-6, 1e6)) for _ in range(3)])
    return {
        "ior": d.either(d.linear(1.0, 3.0), d.logarithmic(0.01, 100.0)),
        "model": d.choice(*DispersionModel),
        "abbe": d.either(d.linear(10.0, 100.0), d.logarithmic(1e-3, 1e6), d.choice(0.0)),
        "b": b,
        "c": c,
        "spread": d.either(d.linear(-0.1, 0.1), d.signed(1e-4, 10.0)),
    }


CURVE = "DispersionCurve curve = dispersion_curve(1, (int)model, abbe, b, c, spread);\n"

PAIR = """
DispersiveIor a, z;
a.white = n1; a.cauchy_b = b1; a.nearly_linear = 1; a.at_path = n1;
z.white = n2; z.cauchy_b = b2; z.nearly_linear = 1; z.at_path = n2;
"""


def pair(d: Draw) -> dict[str, np.ndarray]:
    """Two media that split light as glasses do, or more; some of nearly the same index."""
    first, second = (d.either(d.linear(1.0, 3.0), d.logarithmic(1e-3, 1e3)) for _ in range(2))
    return {
        "n1": first,
        "n2": d.either(second, second, first * (1.0 + d.signed(1e-6, 1e-3))),
        "b1": d.either(d.linear(0.0, 3e4), d.signed(1.0, 1e6)),
        "b2": d.either(d.linear(0.0, 3e4), d.signed(1.0, 1e6)),
    }


def ratio(n1, n2, b1, b2, by) -> np.ndarray:
    """Return the ratio of two indices with a second term of Cauchy's at an offset."""
    return np.maximum(n2 + b2 * by, 1e-3) / np.maximum(n1 + b1 * by, 1e-3)


def ratio_terms(n1, n2, b1, b2, by) -> np.ndarray:
    """Return the ratio's size as far as the sums above and below it tell."""
    above, below = (np.maximum(n + b * by, 1e-3) for n, b in ((n2, b2), (n1, b1)))
    return above / below * ((n2 + np.abs(b2 * by)) / above + (n1 + np.abs(b1 * by)) / below)


def dispersing(n1, n2, b1, b2):
    """Return a ratio that is not 1, and its reciprocal number of Abbe's kind: (n_F - n_C) / (n_d - 1)."""
    at_d = ratio(n1, n2, b1, b2, 0.0)
    at_d = np.where(np.abs(at_d - 1.0) < 1e-4, 1.0 + 1e-4, at_d)
    spread = ratio(n1, n2, b1, b2, offset(LINE_F)) - ratio(n1, n2, b1, b2, offset(LINE_C))
    return at_d, spread / (at_d - 1.0)


def dispersing_terms(n1, n2, b1, b2):
    """Return the sizes of what both are differences of."""
    at_d, number = dispersing(n1, n2, b1, b2)
    terms = ratio_terms(n1, n2, b1, b2, offset(LINE_F)) + ratio_terms(n1, n2, b1, b2, offset(LINE_C))
    return at_d, (terms + np.abs(number) * at_d) / np.abs(at_d - 1.0)


OPTICS = """
Interface s;
s.from.ior = a; s.to.ior = z;
Incidence at;
at.eta = n2 / n1;
Optics o = make_optics(s, at, (int)front, thickness, film);
r[0] = o.ior; r[1] = o.film_ior; r[2] = o.film_thickness;
split_by_closures(s, o);
r[3] = o.ior; r[4] = o.inverse_abbe;
"""


def optics(back, front, n1, n2, b1, b2, thickness, film):
    """Return indices as closures take them: by the ray, or as met from the front; and split from the front."""
    turned = (back > 0.0) & (front > 0.0)
    outer, inner = (np.where(back > 0.0, each, other) for each, other in ((n2, n1), (n1, n2)))
    spread = [np.where(back > 0.0, each, other) for each, other in ((b2, b1), (b1, b2))]
    return (
        np.where(turned, n1 / n2, n2 / n1),
        film / np.where(turned, n2, n1),
        thickness,
        *dispersing(outer, inner, *spread),
    )


def optics_terms(back, n1, n2, b1, b2, **inputs):
    """Return sizes: those of the ratio's number are of differences."""
    outer, inner = (np.where(back > 0.0, each, other) for each, other in ((n2, n1), (n1, n2)))
    spread = [np.where(back > 0.0, each, other) for each, other in ((b2, b1), (b1, b2))]
    plain = optics(back=back, n1=n1, n2=n2, b1=b1, b2=b2, **inputs)
    return *plain[:3], *dispersing_terms(outer, inner, *spread)


FUNCTIONS = (
    Function(
        "sanitized_ior",
        "dispersion.h",
        lambda d: {"ior": d.either(d.signed(1e-6, 1e6), d.choice(np.nan, np.inf, -np.inf, 1e-3, 1e3, 0.0))},
        "r[0] = sanitized_ior(ior);",
        lambda ior: [usable(ior)],
        0.0,
        "a choice",
        codes=("ior",),
    ),
    Function(
        "inverse_square_offset",
        "dispersion.h",
        lambda d: {"wavelength": d.linear(SHORTEST, LONGEST)},
        "r[0] = inverse_square_offset(wavelength);",
        lambda wavelength: [offset(wavelength)],
        4.0,
        FEW,
    ),
    Function(
        "sellmeier_ior",
        "dispersion.h",
        lambda d: {"b": curves(d)["b"], "c": curves(d)["c"], "wavelength": d.linear(SHORTEST, LONGEST)},
        "r[0] = sellmeier_ior(b, c, wavelength);",
        lambda b, c, wavelength: [sellmeier(b, c, wavelength)],
        8.0,
        "near a resonance the index is the wavelength's last digits",
        terms=lambda b, c, wavelength: [sellmeier_terms(b, c, wavelength)],
    ),
    Function(
        "jf_offset",
        "dispersion.h",
        lambda d: {"spread": d.signed(1e-4, 10.0), "wavelength": d.linear(SHORTEST, LONGEST)},
        "r[0] = jf_offset(spread, wavelength);",
        lambda spread, wavelength: [jf(spread, wavelength)],
        4.0,
        FEW,
    ),
    Function(
        "ior_at",
        "dispersion.h",
        lambda d: {"wavelength": d.linear(SHORTEST, LONGEST)} | curves(d),
        CURVE + "r[0] = ior_at(ior, curve, wavelength);",
        lambda wavelength, **curve: [index(wavelength, **curve)],
        16.0,
        "a sum of terms of the curve, whose sizes count",
        codes=("model",),
        terms=lambda wavelength, **curve: [index_terms(wavelength, **curve)],
        covers=("dispersion_curve",),
    ),
    Function(
        "dispersive_ior",
        "dispersion.h",
        lambda d: {"wavelength": d.linear(SHORTEST, LONGEST)} | curves(d),
        CURVE + "DispersiveIor n = dispersive_ior(ior, curve, 1, wavelength);"
        "r[0] = n.white; r[1] = n.at_path; r[2] = n.cauchy_b;",
        lambda wavelength, **curve: [
            usable(curve["ior"] + (curve["model"] == DispersionModel.JF) * jf(curve["spread"], LINE_D)),
            usable(index(wavelength, **curve)),
            (index(LINE_F, **curve) - index(LINE_C, **curve)) / (offset(LINE_F) - offset(LINE_C)),
        ],
        32.0,
        "the slope is a difference of two indices",
        codes=("model",),
        terms=lambda wavelength, **curve: [
            curve["ior"] + np.abs(curve["spread"]),
            index_terms(wavelength, **curve),
            (index_terms(LINE_F, **curve) + index_terms(LINE_C, **curve)) / (offset(LINE_F) - offset(LINE_C)),
        ],
    ),
    Function(
        "eta_at",
        "dispersion.h",
        lambda d: pair(d) | {"by": d.linear(offset(LONGEST), offset(SHORTEST))},
        PAIR + "r[0] = eta_at(a, z, by);",
        lambda n1, n2, b1, b2, by: [ratio(n1, n2, b1, b2, by)],
        4.0,
        "a ratio of two sums, whose terms count",
        terms=lambda n1, n2, b1, b2, by: [ratio_terms(n1, n2, b1, b2, by)],
    ),
    Function(
        "dispersing_ratio",
        "dispersion.h",
        pair,
        PAIR + "r[0] = dispersing_ratio(a, z, r[1]);",
        lambda n1, n2, b1, b2: dispersing(n1, n2, b1, b2),
        8.0,
        "the number is a difference of two ratios over another",
        terms=lambda n1, n2, b1, b2: dispersing_terms(n1, n2, b1, b2),
    ),
    Function(
        "make_optics",
        "closures.h",
        lambda d: (
            pair(d)
            | {
                "back": d.choice(0.0, 1.0),
                "front": d.choice(0.0, 1.0),
                "thickness": d.linear(0.0, 1e5),
                "film": d.logarithmic(1.0, 100.0),
            }
        ),
        PAIR + OPTICS,
        optics,
        8.0,
        FEW,
        codes=("back", "front"),
        terms=optics_terms,
        more=("contract.h", BACKFACING),
        covers=("split_by_closures",),
    ),
)
