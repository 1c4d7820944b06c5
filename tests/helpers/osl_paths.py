"""Functions of the shader's headers about a path that meets a surface, and what they are to return."""

from __future__ import annotations

import numpy as np
from osl_dispersion import LONGEST, PAIR, SHORTEST, offset, ratio
from osl_interfaces import FEW, reflectance
from osl_measure import Draw, Function, dot


def white_reflection(n1, n2, b1, b2, cos_i, means):
    """Return whether white light is reflected as a whole, by which ratio, and in which colour."""
    etas = ratio(n1[:, None], n2[:, None], b1[:, None], b2[:, None], means)
    most = etas.max(axis=1)
    denser = (ratio(n1, n2, b1, b2, offset(SHORTEST)) > 1.0) & (ratio(n1, n2, b1, b2, offset(LONGEST)) > 1.0)
    strongest = np.maximum(reflectance(cos_i, most), 1e-12)
    return denser * 1.0, most, reflectance(cos_i[:, None], etas) / strongest[:, None]


def met(d: Draw) -> dict[str, np.ndarray]:
    """Surfaces of two media that a camera looks at."""
    n = d.direction()
    return {
        "I": d.around(n, d.linear(-0.2, 1.0)),
        "N": n,
        "artist": d.either(np.zeros((d.count, 3)), 3.0 * d.around(n, d.linear(0.9, 1.0))),
        "n1": d.linear(1.0, 3.0),
        "n2": d.linear(1.0, 3.0),
        "first": d.choice(0.0, 5.0, 1e9),
        "second": d.choice(0.0, 5.0, 1e9),
        "splits": d.choice(0.0, 1.0),
    }


def meeting(I, N, artist, n1, n2, first, second, splits):  # noqa: E741  OSL's names
    """Return how the light meets the surface, as Incidence lists it from ``n`` to ``exits``; a camera's path is no walk."""
    has = np.linalg.norm(artist, axis=1) > 0.0
    n = np.where(has[:, None], artist / np.maximum(np.linalg.norm(artist, axis=1), 1e-30)[:, None], N)
    cos_i = np.clip(dot(I, n), 0.0, 1.0)
    eta = n2 / n1
    total = (eta - 1.0) * (eta + 1.0) + cos_i**2 < 0.0
    return n, cos_i, eta, total * 1.0, (first < 1e9) * 1.0, (first == 1e9) * 1.0, (second == 1e9) * 1.0, splits


INTERFACE = """
Interface s;
s.valid = 1;
s.from = air();
s.to = air();
s.from.priority = first; s.to.priority = second;
s.from.ior = a; s.to.ior = z;
s.from.disperses = 0; s.to.disperses = (int)splits;
PathSpectrum path = {1, 0.0, 0, 0};
"""


def white(d: Draw) -> dict[str, np.ndarray]:
    """Two media that split light as glasses do, or more, and where the middles of red, green and blue are."""
    return {
        "n1": d.linear(1.0, 3.0),
        "n2": d.linear(1.0, 3.0),
        "b1": d.linear(0.0, 3e5),
        "b2": d.linear(0.0, 3e5),
        "cos_i": d.cosine(),
        "means": d.vector(*[d.linear(offset(LONGEST), offset(SHORTEST)) for _ in range(3)]),
    }


WHITE = "float first = 0.0, second = 0.0, splits = 1.0;\n" + PAIR + INTERFACE

STEP = """
path.portals = (int)portals;
Incidence at;
at.disperses = (int)apart; at.is_walk = (int)walk; at.after_portal = (int)after; at.cos_i = cos_i; at.eta = n2 / n1;
Weights factor = {color(1.0), color(1.0)};
closure color portal = 0;
step_to_wavelength(s, path, (int)table, means * 1e6, color(1.0), at, factor, portal);
r[0] = factor.reflected[0]; r[1] = factor.reflected[1]; r[2] = factor.reflected[2];
r[3] = factor.transmitted[0]; r[4] = at.eta;
"""


def steps(d: Draw) -> dict[str, np.ndarray]:
    """Paths with and without a wavelength, just behind a portal and elsewhere."""
    portals = d.choice(0.0, 0.0, 1.0, 3.0)
    return white(d) | {
        "portals": portals,
        "after": d.choice(0.0, 1.0) * (portals > 0.0),
        "apart": d.choice(0.0, 1.0, 1.0, 1.0),
        "walk": d.choice(0.0, 0.0, 0.0, 1.0),
        "table": d.choice(0.0, 1.0, 2.0),
    }


def stepped(portals, after, apart, walk, table, **pair):
    """Return the factors on both lobes and the ratio: white light that is due steps back, but for what is reflected white."""
    denser, eta, colour = white_reflection(**pair)
    due = (apart > 0.0) & (walk == 0.0) & ((portals == 0.0) | (after > 0.0))
    leaves = due & ((portals == 0.0) | (portals <= table))
    whole = due & (denser > 0.0)
    enters = np.where(whole, np.maximum(1.0 - reflectance(pair["cos_i"], eta), 0.05), 1.0)
    reflected = np.where((whole & (after == 0.0))[:, None], colour, 1.0)
    reflected[(whole & (after > 0.0)) | (leaves & ~whole)] = 0.0
    transmitted = np.where(leaves, 0.0, 1.0 / enters)
    return reflected, transmitted, np.where(whole & (after == 0.0), eta, pair["n2"] / pair["n1"])


FUNCTIONS = (
    Function(
        "reflected_white",
        "wavelength_step.h",
        white,
        WHITE + "float eta; color white = reflected_white(s, cos_i, means, eta);"
        "r[0] = reflects_white(s); r[1] = eta; r[2] = white[0]; r[3] = white[1]; r[4] = white[2];",
        white_reflection,
        100.0,
        "a ratio of reflectances, each ill-conditioned where its ratio of indices is near 1",
        covers=("reflects_white",),
    ),
    Function(
        "meet_surface",
        "incidence.h",
        met,
        "float b1 = 0.0, b2 = 0.0;" + PAIR + INTERFACE + "Incidence at; meet_surface(s, path, (normal)artist, 1, at);"
        "r[0] = at.n[0]; r[1] = at.n[1]; r[2] = at.n[2]; r[3] = at.cos_i; r[4] = at.eta; r[5] = at.is_tir; r[6] = at.inside;"
        "r[7] = at.enters; r[8] = at.exits; r[9] = at.disperses;",
        meeting,
        8.0,
        FEW,
        codes=("first", "second", "splits"),
        covers=("splits_light", "relative_ior", "air"),
    ),
    Function(
        "step_to_wavelength",
        "wavelength_step.h",
        steps,
        WHITE + STEP,
        stepped,
        100.0,
        "the reflectances of reflected_white",
        codes=("portals", "after", "apart", "walk", "table"),
    ),
)
