"""Rows of the light that falls on other surfaces."""

from __future__ import annotations

from dataclasses import replace

from ..enumerations import SHADOW_MODES
from ..native_limits import APART, DISPERSION, LOBE_SHAPES
from ..parameter import LIGHTS_BY_LOBE, Parameter

CAUSTICS: tuple[Parameter, ...] = (
    Parameter(
        "Caustic Refraction",
        "Caustics",
        "BOOL",
        True,
        "Bright patterns that light refracted by this medium throws on other surfaces",
        label="Refraction",
        limit=APART,
    ),
    Parameter(
        "Caustic Reflection",
        "Caustics",
        "BOOL",
        True,
        "Bright patterns that light mirrored by the medium's outside throws on other surfaces",
        label="Reflection",
        limit=APART,
    ),
    Parameter(
        "Caustic Total Reflection",
        "Caustics",
        "BOOL",
        True,
        "Bright patterns of light that was reflected totally inside the medium",
        label="Total Reflection",
        limit=APART,
    ),
    Parameter(
        "Caustic Internal Reflections",
        "Caustics",
        "BOOL",
        True,
        "Bright patterns of light that was weakly reflected inside the medium",
        label="Internal Reflections",
        needs=("internal_reflections",),
        limit=APART,
    ),
    Parameter(
        "Caustic Dispersion",
        "Caustics",
        "BOOL",
        True,
        "Splits bright patterns on other surfaces into colours, also those of shadow caustics",
        label="Dispersion",
        needs=("disperse",),
        limit=replace(DISPERSION, decides=False),
    ),
    Parameter(
        "Caustic Direct Refraction",
        "Caustics",
        "BOOL",
        True,
        "Light of small lights that direct refraction throws on other surfaces",
        label="Direct Refraction",
        needs=(LIGHTS_BY_LOBE,),
        limit=LOBE_SHAPES,
    ),
    Parameter(
        "Caustic Direct Reflection",
        "Caustics",
        "BOOL",
        True,
        "Light of small lights that direct reflection throws on other surfaces",
        label="Direct Reflection",
        needs=(LIGHTS_BY_LOBE,),
        limit=LOBE_SHAPES,
    ),
    Parameter(
        "Caustic Roughness Offset",
        "Caustics",
        "FLOAT",
        0.1,
        "Softens the light that direct refraction throws on other surfaces",
        0.0,
        1.0,
        "FACTOR",
        label="Roughness Offset",
        needs=(LIGHTS_BY_LOBE, "direct_world"),
        limit=LOBE_SHAPES,
    ),
    Parameter(
        "Caustic Max Distance",
        "Caustics",
        "FLOAT",
        -1.0,
        "Bright patterns fade to nothing on surfaces this far from the medium; below 0 they do not",
        -1.0,
        1e6,
        "DISTANCE",
        label="Max Distance",
        limit=APART,
    ),
    Parameter(
        "Shadow Mode",
        "Shadows",
        "MENU",
        "OUTSIDE_FRESNEL",
        "How dark and coloured the medium's shadows are, which stand in for caustics",
        choices=SHADOW_MODES,
        label="Shadow",
    ),
)
