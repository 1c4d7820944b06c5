"""Rows of how much the surface reflects and refracts."""

from __future__ import annotations

from ..native_limits import APART
from ..parameter import Parameter

WEIGHTS: tuple[Parameter, ...] = (
    Parameter(
        "Refraction Scale",
        "Reflection and Refraction",
        "FLOAT",
        1.0,
        "Darkens what is seen through the surface: 1 is physical, 0 lets nothing through",
        0.0,
        1.0,
        "FACTOR",
        label="Refraction",
        limit=APART,
    ),
    Parameter(
        "Specular Scale",
        "Reflection and Refraction",
        "FLOAT",
        1.0,
        "Darkens what is mirrored in the surface: 1 is physical, 0 mirrors nothing",
        0.0,
        1.0,
        "FACTOR",
        label="Reflection",
        limit=APART,
    ),
    Parameter(
        "Refract Sky",
        "Reflection and Refraction",
        "BOOL",
        True,
        "Shows the world behind the medium. Off, what is seen through it is black where nothing else stands there",
        limit=APART,
    ),
    Parameter(
        "Reflect Sky",
        "Reflection and Refraction",
        "BOOL",
        True,
        "Mirrors the world in the medium's outside. Off, reflections are black where nothing else stands there",
        limit=APART,
    ),
)
