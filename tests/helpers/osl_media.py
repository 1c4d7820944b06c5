"""Functions of the shader's headers about media, and what they are to return."""

from __future__ import annotations

import numpy as np
from osl_interfaces import FEW, reflectance, usual
from osl_measure import Draw, Function

from nested_dielectric.model.parameters import BY_KEYWORD

CHOICE = "a choice"

ODD = (np.nan, np.inf, -np.inf, 0.0, 3.3e38, -3.3e38, 1e-38)
"""Numbers that a link may give."""


def anything(d: Draw) -> np.ndarray:
    """Numbers of all sizes, and what is none."""
    return d.either(d.signed(1e-30, 1e30), d.linear(-2.0, 2.0), d.choice(*ODD))


def is_number(x: np.ndarray) -> np.ndarray:
    return np.isfinite(x) & (np.abs(x) < 3.4e38)


def limited(keyword: str, x: np.ndarray) -> np.ndarray:
    """Return what counts of a number, or of (n, 3) numbers, by the limits of a parameter."""
    low, high, standard = BY_KEYWORD[keyword].limits
    numbers = is_number(x) if x.ndim == 1 else is_number(x.sum(axis=1))[:, None]
    return np.where(numbers, np.clip(x, low, high), standard)


def limit(d: Draw) -> dict[str, np.ndarray]:
    """Numbers for a number, a color, a vector, an integer."""
    triple = [d.either(d.signed(1e-12, 1e12), d.linear(-2.0, 2.0)) for _ in range(3)]
    triple[0] = d.either(triple[0], triple[0], triple[0], d.choice(*ODD))
    return {"x": anything(d), "w": d.vector(*triple), "whole": d.choice(-2e9, -5.0, 0.0, 7.0, 1000.0, 1001.0, 1.9e9)}


def limits(x, w, whole):
    """Return what :data:`LIMIT` puts out."""
    usable = is_number(x) & (np.abs(x) < 1e30)
    square = (w.astype(np.float32) ** 2).sum(axis=1)
    priority = BY_KEYWORD["priority"]
    in_range = np.abs(whole) < 2e9
    return [
        is_number(x) * 1.0,
        (usable & (x >= 1e-3) & (x <= 1e3)) * 1.0,
        limited("ior", x),
        limited("transmittance", w),
        limited("sellmeier_b", w),
        np.where(in_range, np.clip(whole, priority.minimum, priority.maximum), priority.default),
        ((square > 0.0) & is_number(square)) * 1.0,
        np.where(is_number(w[:, 0]), w.max(axis=1), 0.0),
    ]


LIMIT = """
color c = (color)w;
color t = bounded(c, TRANSMITTANCE_LIMITS);
vector b = bounded(w, SELLMEIER_B_LIMITS);
r[0] = is_number(x); r[1] = within(x, 1e-3, 1e3, 1.0); r[2] = bounded(x, IOR_LIMITS);
r[3] = t[0]; r[4] = t[1]; r[5] = t[2]; r[6] = b[0]; r[7] = b[1]; r[8] = b[2];
r[9] = bounded((int)whole, PRIORITY_LIMITS); r[10] = has_direction(w); r[11] = is_number(w[0]) ? max_component(c) : 0.0;
"""

# Media


def materials(d: Draw) -> dict[str, np.ndarray]:
    """Whatever sockets may hold of a medium."""
    return {
        "priority": d.choice(-3.0, 0.0, 1.0, 999.0, 1000.0, 1001.0, 1e6),
        "ior": d.either(d.linear(1.0, 3.0), anything(d)),
        "tint": d.either(
            *[d.vector(*[d.linear(low, high) for _ in range(3)]) for low, high in ((0, 1), (-1, 2), (1, 1))]
        ),
        "depth": d.either(d.linear(0.0, 10.0), anything(d)),
        "volume": d.choice(0.0, 1.0),
    }


def medium(priority, ior, tint, depth, volume):
    """Return a medium's priority, index, transmittance, depth, and whether its surfaces charge for it."""
    tint, depth = (
        limited("transmittance", tint),
        limited("transmittance_depth", depth * np.where(volume > 0.0, 0.0, 1.0)),
    )
    absorbs = (tint.min(axis=1) < 1.0) & (depth > 0.0)
    return np.clip(priority, 0, 1000), limited("ior", ior), tint, depth, absorbs * 1.0


SHOWN = "r[0] = m.priority; r[1] = m.ior.white; r[2] = m.transmittance[0]; r[3] = m.transmittance[1];" + (
    "r[4] = m.transmittance[2]; r[5] = m.transmittance_depth; r[6] = m.absorbs;"
)

PRIORITIES = (0.0, 1.0, 2.5, 500.0, 1000.0, 1001.0, -1.0, np.nan, np.inf)


def stored(d: Draw) -> dict[str, np.ndarray]:
    """Properties of objects: numbers, vectors, and none."""
    number = d.choice(*PRIORITIES)
    other = d.either(number, number, number, d.choice(0.0, 5.0))
    return {"own": np.stack([number, number, other, d.choice(0.0, 1.0, 1.0)], axis=1)}


def counts(own: np.ndarray) -> np.ndarray:
    """Return whether a property is one whole number within the limits of priorities."""
    one = (own[:, 0] == own[:, 1]) & (own[:, 0] == own[:, 2]) & (own[:, 3] > 0.0)
    return one & np.isin(own[:, 0], (0.0, 1.0, 500.0, 1000.0))


# Transmittance


def tints(d: Draw) -> dict[str, np.ndarray]:
    """Media that let light through a way, from nothing to all."""
    return {
        "tint": d.vector(
            *[d.either(d.linear(0.0, 1.0), d.logarithmic(1e-6, 1.0), d.choice(0.0, 1.0)) for _ in range(3)]
        ),
        "depth": d.either(d.logarithmic(1e-3, 1e6), d.choice(0.0)),
        "way": d.either(d.logarithmic(1e-5, 1e6), d.choice(0.0, -1.0)),
    }


def left(tint, depth, way):
    """Return what a medium leaves of light (Beer 1852)."""
    ways = np.maximum(way, 0.0) / np.where(depth > 0.0, depth, np.inf)
    with np.errstate(all="ignore"):
        through = np.exp(np.log(tint) * ways[:, None])
    return [np.where((ways == 0.0)[:, None], 1.0, through)]


# Weights

CONTROLLED = """
Incidence at;
at.cos_i = cos_i; at.eta = eta; at.is_walk = 0; at.is_tir = (int)total; at.inside = (int)inside; at.exits = (int)exits;
at.on_caustic = (int)caustic;
LobeControls lobe = {0, roughness, 0.0};
CausticSwitches switches = {(int)keeps, (int)reflects, (int)totals, (int)carries, 0};
Weights weight = {color(reflected), color(transmitted)};
switch_caustics(at, switches, (int)lit, weight);
cut_off_energy(at, exponent, lobe, lobe, color(0.5, 1.0, 0.25), weight);
Weights twice = {color(2.0), color(4.0)};
scale_weights(twice, weight);
r[0] = weight.reflected[0]; r[1] = weight.transmitted[2];
"""


def controls(d: Draw) -> dict[str, np.ndarray]:
    """Surfaces on all ways, and all that an artist may switch."""
    switches = ("total", "inside", "exits", "caustic", "keeps", "reflects", "totals", "carries", "lit")
    return {name: d.choice(0.0, 1.0) for name in switches} | {
        "cos_i": d.cosine(),
        "eta": usual(d),
        "roughness": d.choice(0.0, 0.5),
        "reflected": d.linear(0.0, 1.0),
        "transmitted": d.linear(0.0, 1.0),
        "exponent": d.either(d.linear(-20.0, 0.0), d.linear(-3.0, 0.0)),
    }


def carried(cos_i, eta, roughness, reflected, transmitted, **_):
    """Return how much of the light both lobes carry, without switches."""
    f = np.where(roughness == 0.0, reflectance(cos_i, eta), 1.0)
    return reflected * f, transmitted * np.where(roughness == 0.0, 1.0 - f, 1.0)


def weights(exponent, reflected, transmitted, **inputs):
    """Return both weights after the switches and the cut-off, times 2 and 4."""
    bit = {name: values > 0.0 for name, values in inputs.items()}
    dark = bit["caustic"] & ((bit["total"] & ~bit["totals"]) | (~bit["inside"] & ~bit["reflects"]))
    kept = bit["keeps"] | (bit["lit"] & bit["carries"] & ~bit["exits"])
    stopped = bit["caustic"] & ~kept
    cuts = exponent > -20.0
    parts = carried(reflected=reflected, transmitted=transmitted, **inputs)
    weak = [cuts & (part < 10.0**exponent) for part in parts]
    return np.where(dark | weak[0], 0.0, 2.0 * reflected), np.where(stopped | weak[1], 0.0, 4.0 * transmitted)


def near_the_cut_off(exponent, **inputs):
    """Return sizes: without bounds where a power of 10 by approximation may fall on either side."""
    return [
        np.where(np.abs(part / 10.0**exponent - 1.0) < 1e-3 + 1e-6 / (part + 1e-12), np.inf, 1.0)
        for part in carried(**inputs)
    ]


FUNCTIONS = (
    Function(
        "bounded",
        "bounds.h",
        limit,
        LIMIT,
        limits,
        1.0,
        CHOICE,
        codes=("x", "w", "whole"),
        covers=("is_number", "within", "has_direction", "max_component"),
    ),
    Function(
        "material_medium",
        "medium.h",
        materials,
        "DispersionCurve curve = dispersion_curve(0, 0, 0.0, vector(0.0), vector(0.0), 0.0);"
        "Medium m = material_medium((int)priority, ior, curve, 0, 0.0, color(tint), depth, (int)volume);" + SHOWN,
        medium,
        1.0,
        CHOICE,
        codes=("priority", "ior", "tint", "depth", "volume"),
        covers=("set_absorption",),
    ),
    Function(
        "plain_medium",
        "medium.h",
        materials,
        "Medium m = plain_medium(priority, ior, color(tint), depth * (volume > 0.0 ? 0.0 : 1.0));" + SHOWN,
        medium,
        1.0,
        CHOICE,
        codes=("priority", "ior", "tint", "depth", "volume"),
        covers=("air",),
    ),
    Function(
        "own_priority",
        "medium.h",
        stored,
        "r[0] = own_priority(7.0);",
        lambda own: [np.where(counts(own), own[:, 0], 7.0)],
        0.0,
        CHOICE,
        codes=("own",),
        more=("contract.h", '#undef OBJECT_PRIORITY\n#define OBJECT_PRIORITY "own"'),
        covers=("is_priority",),
    ),
    Function(
        "beer_lambert",
        "transmittance.h",
        tints,
        "color c = beer_lambert(color(tint), depth, way); r[0] = c[0]; r[1] = c[1]; r[2] = c[2];",
        left,
        64.0,
        "OSL's power is an approximation; below 1e-6 nothing shows",
        terms=lambda **inputs: [1e-6 + left(**inputs)[0]],
    ),
    Function(
        "absorption_coefficients",
        "transmittance.h",
        lambda d: tints(d) | {"depth": d.logarithmic(1e-3, 1e6)},
        "color c = absorption_coefficients(color(tint), depth); r[0] = c[0]; r[1] = c[1]; r[2] = c[2];",
        lambda tint, depth, way: [-np.log(np.maximum(tint, 1e-6)) / depth[:, None]],
        16.0,
        "OSL's logarithm is an approximation",
    ),
    Function(
        "switch_caustics",
        "weights.h",
        controls,
        CONTROLLED,
        weights,
        2.0,
        CHOICE,
        codes=("total", "inside", "exits", "caustic", "keeps", "reflects", "totals", "carries", "lit", "roughness"),
        terms=near_the_cut_off,
        covers=("cut_off_energy", "scale_weights"),
    ),
    Function(
        "step_back",
        "spectrum.h",
        lambda d: {"P": d.vector(*[d.signed(1e-6, 1e6) for _ in range(3)])},
        "r[0] = step_back();",
        lambda P: [5e-5 + 2e-6 * np.abs(P).max(axis=1)],
        4.0,
        FEW,
    ),
    Function(
        "needed_curves",
        "spectrum.h",
        lambda d: (
            {name: d.choice(0.0, 1.0) for name in ("possible", "front", "splits")}
            | {"wavelength": d.choice(0.0, 1.0, 550.0)}
        ),
        "PathSpectrum path = {(int)possible, wavelength, 0, 0};"
        "r[0] = needed_curves(path, (int)front, (int)splits); r[1] = lacks_table(path);",
        lambda possible, front, splits, wavelength: [
            ((possible + front) > 0.0) * (1.0 + ((splits + wavelength) > 0.0)),
            (wavelength > 0.0) & (wavelength < 100.0),
        ],
        0.0,
        CHOICE,
        codes=("possible", "front", "splits", "wavelength"),
        covers=("lacks_table",),
    ),
)
