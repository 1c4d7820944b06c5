"""Rows of what a medium is made of."""

from __future__ import annotations

from ..enumerations import DISPERSION_MODELS
from ..native_limits import DISPERSION, DISPERSION_CURVE
from ..parameter import BASICS, MAX_PRIORITY, Limit, Parameter

MEDIUM: tuple[Parameter, ...] = (
    Parameter(
        "Priority",
        BASICS,
        "INT",
        0,
        "Which medium fills the space where two overlap: the one with the lower number, whose shape stays whole. "
        "Equal numbers melt into one medium. An object's own priority overrides this one",
        0,
        MAX_PRIORITY,
    ),
    Parameter(
        "IOR",
        BASICS,
        "FLOAT",
        1.33,
        "How strongly light bends and how much the surface reflects: 1 is air and invisible, water 1.33, glass "
        "1.52, diamond 2.42. Measured against vacuum at 587.56 nm. Keep it unlinked: neighbours read its value",
        0.01,
        100.0,
    ),
    Parameter(
        "Transmittance",
        BASICS,
        "COLOR",
        (1.0, 1.0, 1.0),
        "Colour that white light has after it has gone Depth far through the medium: what is thinner looks paler, "
        "what is thicker darker",
        0.0,
        1.0,
        label="Colour",
        limit=Limit("leave rays to objects within it untinted where its volume cannot take them all", decides=False),
    ),
    Parameter(
        "Transmittance Depth",
        BASICS,
        "FLOAT",
        1.0,
        "How far light goes through the medium until it has Colour, in scene units: make it the object's "
        "thickness to see just that colour, larger for a paler medium. 0 is a colourless medium",
        0.0,
        1e6,
        "DISTANCE",
        label="Depth",
        needs=("transmittance",),
    ),
    Parameter(
        "Disperse",
        "Dispersion",
        "BOOL",
        False,
        "Splits light into its colours where it enters or leaves: rainbows behind prisms, fire in diamonds. "
        "Colours that another medium has split are bent by this one's own dispersion, with or without this",
        limit=DISPERSION,
    ),
    Parameter(
        "Dispersion Model",
        "Dispersion",
        "INDEX",
        "ABBE",
        "How the index of refraction changes with the wavelength (in the node: 0 Abbe, 1 Sellmeier, 2 JF)",
        choices=DISPERSION_MODELS,
        label="Model",
        limit=DISPERSION_CURVE,
    ),
    Parameter(
        "Abbe",
        "Dispersion",
        "FLOAT",
        55.0,
        "Abbe number V_d: the lower, the wider the colours spread. Diamond 55, crown glass 64, dense flint 26; 0 "
        "is no dispersion",
        0.0,
        1e6,
    ),
    Parameter(
        "Sellmeier B",
        "Dispersion",
        "VECTOR",
        (1.03961212, 0.231792344, 1.01046945),
        "Strengths of the Sellmeier formula's three terms, as catalogues of glass print them. The curve is "
        "shifted to go through IOR",
        -1e4,
        1e4,
        limit=DISPERSION_CURVE,
    ),
    Parameter(
        "Sellmeier C",
        "Dispersion",
        "VECTOR",
        (0.00600069867, 0.0200179144, 103.560653),
        "Squares of the Sellmeier formula's three resonances, in square micrometres, as catalogues of glass print them",
        0.0,
        1e6,
        limit=DISPERSION_CURVE,
    ),
    Parameter(
        "Dispersion",
        "Dispersion",
        "FLOAT",
        0.03,
        "Index at 370 nm above that at 780 nm, as JF Nested Dielectric has it: the larger, the wider the colours "
        "spread",
        -10.0,
        10.0,
        label="Spread",
        limit=DISPERSION_CURVE,
    ),
)
