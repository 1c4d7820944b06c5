"""Rows of what the surface is like."""

from __future__ import annotations

from ..enumerations import DISTRIBUTIONS, TANGENTS
from ..native_limits import ANISOTROPIC, ANISOTROPIC_WAYS, APART
from ..parameter import BASICS, LIGHTS_BY_LOBE, Parameter

SURFACE: tuple[Parameter, ...] = (
    Parameter(
        "Roughness",
        BASICS,
        "FLOAT",
        0.0,
        "Frosts the surface: what is seen through it and mirrored in it blurs. 0 is polished; reflections follow "
        "unless they are separate (alpha is its square)",
        0.0,
        1.0,
        "FACTOR",
    ),
    Parameter(
        "Distribution",
        "Surface",
        "MENU",
        "MULTI_GGX",
        "Shape of the blur of a rough surface: how sharp its middle is and how wide its glow",
        choices=DISTRIBUTIONS,
        needs=("roughness", LIGHTS_BY_LOBE, "direct_world"),
    ),
    Parameter(
        "Anisotropy",
        "Surface",
        "FLOAT",
        0.0,
        "Stretches the blur of a rough surface across (positive) or along (negative) the tangent, as brushed or "
        "drawn glass does",
        -0.99,
        0.99,
        needs=("roughness", LIGHTS_BY_LOBE, "direct_world"),
        limit=ANISOTROPIC,
    ),
    Parameter(
        "Separate Reflection",
        "Surface",
        "BOOL",
        False,
        "Lets reflections have a roughness of their own, such as a sharp varnish on frosted glass",
        limit=APART,
    ),
    Parameter(
        "Reflection Roughness",
        "Surface",
        "FLOAT",
        0.0,
        "Blurs what is mirrored in the surface; what is seen through it keeps Roughness",
        0.0,
        1.0,
        "FACTOR",
        needs=("separate_reflection",),
    ),
    Parameter(
        "Reflection Distribution",
        "Surface",
        "MENU",
        "MULTI_GGX",
        "Shape of the blur of separate reflections",
        choices=DISTRIBUTIONS,
        needs=("reflection_roughness",),
    ),
    Parameter(
        "Reflection Anisotropy",
        "Surface",
        "FLOAT",
        0.0,
        "Stretches the blur of separate reflections across (positive) or along (negative) the tangent",
        -0.99,
        0.99,
        needs=("reflection_roughness",),
        limit=ANISOTROPIC,
    ),
    Parameter(
        "Tangent From",
        "Surface",
        "MENU",
        "TANGENT",
        "Which way along the surface anisotropy stretches the blur",
        choices=TANGENTS,
        needs=("anisotropy", "reflection_anisotropy", "direct_anisotropy"),
        limit=ANISOTROPIC_WAYS,
    ),
    Parameter(
        "Tangent",
        "Surface",
        "VECTOR",
        (0.0, 0.0, 0.0),
        "Way along the surface that anisotropy refers to: plug in a Tangent node; without a link it runs around "
        "the object's Z axis",
        unit="DIRECTION",
        needs=("anisotropy", "reflection_anisotropy", "direct_anisotropy"),
        limit=ANISOTROPIC_WAYS,
    ),
    Parameter(
        "Blur Anisotropic Poles",
        "Surface",
        "FLOAT",
        0.0,
        "Makes the blur round where the normal points along the axis of the tangents, which hides the star there: "
        "1 everywhere, 0 nowhere",
        0.0,
        1.0,
        "FACTOR",
        label="Blur Poles",
        needs=("anisotropy", "reflection_anisotropy", "direct_anisotropy"),
        limit=ANISOTROPIC_WAYS,
    ),
    Parameter(
        "Normal",
        "Surface",
        "VECTOR",
        (0.0, 0.0, 0.0),
        "Bends the surface as light sees it: plug in a Bump or Normal Map node. Without a link it is smooth as "
        "modelled",
        unit="DIRECTION",
    ),
    Parameter(
        "Thin Film Thickness",
        "Thin Film",
        "FLOAT",
        0.0,
        "Thickness in nanometres of a film on the surface, whose interference colours reflections as on a soap "
        "bubble or oil on water: 100 to 1000 shows most colour, 0 is none",
        0.0,
        100000.0,
        "WAVELENGTH",
        label="Thickness",
    ),
    Parameter(
        "Thin Film IOR",
        "Thin Film",
        "FLOAT",
        1.33,
        "Index of refraction of the film: the further from that of what is on both sides, the stronger its colours",
        1.0,
        100.0,
        label="IOR",
        needs=("thin_film_thickness",),
    ),
)
