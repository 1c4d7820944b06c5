"""Every parameter of the material, written down once.

Sockets of the node group, keyword arguments of :func:`nested_dielectric.new_material`, the names a preset file may
use, the inputs of the OSL shader and the manual's table all come from :data:`PARAMETERS`.

A spectral table is baked from the parameters of the panel `Spectrum`, so these are settings of a material and no
sockets.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import inf, isfinite
from typing import Any

from . import spectra
from .choice import Choice

GROUP_NAME = "Nested Dielectric"
"""Name of the node group and of the group node in a material; the shader reads neighbours' sockets by it."""

PRIORITY_PROPERTY = "nd_priority"
"""Custom property of an object that overrides the priority of its material."""

MAX_PRIORITY = 1000

LARGEST = 3.4e38
"""As in osl/bounds.h: what is not below is infinite to single precision, or nearly."""

UNLIMITED_REFLECTIONS = 1024
"""As in osl/nested_dielectric.osl: from here on Cycles' own limits are the lower ones."""


class ParameterError(ValueError):
    """An unknown parameter, or a value that it cannot take. The text names both and the remedy."""


LAMPS_BY_LOBE = "lamps_by_lobe"
"""Stands among what parameters need for lamps of the scene that the lobes of direct refraction and reflection carry."""

TINTED_MEDIA = "tinted_media"
"""Stands there for colour of the medium, or of one that it may touch."""


@dataclass(frozen=True)
class Limit:
    """Where Cycles' own nodes render a parameter otherwise than the shader does.

    :param text: what they do instead, after "Cycles' own nodes".
    :param alone: they have nothing like it, else they come near.
    :param before: the limit is gone from this version of Blender on; None if it stays.
    :param decides: the parameter alone makes a medium need the shader, else another of the same limit, or the scene.
    :param neutral: value at which the parameter does nothing; None for the parameter's default.
    :param needs: keywords of which one must be at work for the limit to show.
    """

    text: str
    alone: bool = False
    before: tuple[int, int, int] | None = None
    decides: bool = True
    neutral: Any = None
    needs: tuple[str, ...] = ()


APART = Limit(
    "weigh reflection by the surface, not by its facets, where it is rough or has a film",
    needs=("roughness", "reflection_roughness", "thin_film_thickness"),
)
LOBES = Limit("have no lobes of their own for lamps and the world", alone=True, neutral=False)
LOBE_SHAPES = replace(LOBES, decides=False)
ANISOTROPIC = Limit("are isotropic before Blender 5.3", before=(5, 3, 0))
ANISOTROPIC_WAYS = replace(ANISOTROPIC, decides=False)
DISPERSION = Limit("split light by an Abbe number, in daylight, and not before Blender 5.3")
DISPERSION_CURVE = Limit("take its Abbe number alone", decides=False)
SPECTRUM = Limit("split light in daylight, in the working space, unclamped", alone=True, decides=False)
GLOW = Limit("do not tint what glows behind a medium", needs=(TINTED_MEDIA,))


@dataclass(frozen=True)
class Parameter:
    """One parameter of the material.

    ``kind`` is one of ``INT``, ``FLOAT``, ``BOOL``, ``COLOR`` (scene-linear RGB), ``VECTOR``, ``MENU``, ``INDEX`` (a
    word in Python, its place among the choices in the socket: neighbours cannot read menus), ``TEXT`` and
    ``SHADER``; ``minimum`` and ``maximum`` are hard limits, ``unit`` the subtype of the socket (``FACTOR``,
    ``DISTANCE``, ``WAVELENGTH``, ``DIRECTION`` or empty). ``label`` is a shorter name for panels whose heading says the
    rest; ``needs`` are keywords of which one must not be 0, off or white for this parameter to show in the picture;
    ``limit`` is where Cycles' own nodes do otherwise than the shader.
    """

    name: str
    panel: str
    kind: str
    default: Any
    description: str
    minimum: float | None = None
    maximum: float | None = None
    unit: str = ""
    choices: tuple[Choice, ...] = ()
    label: str = ""
    needs: tuple[str, ...] = ()
    limit: Limit | None = None

    @property
    def keyword(self) -> str:
        """The name in Python and in preset files: the socket's name in snake_case."""
        return self.name.lower().replace(" ", "_")

    @property
    def osl_name(self) -> str:
        """The name of the shader's input."""
        return "".join(word[0].upper() + word[1:] for word in self.name.split())

    def check(self, value: Any) -> Any:
        """Return ``value`` as the type the parameter holds; :class:`ParameterError` if it cannot hold it."""
        return _CHECKS[self.kind](self, value)

    def bounded(self, value: Any) -> Any:
        """Return what a socket's value counts as, as osl/bounds.h has it: numbers within the limits, and in place of what is
        none the default. Values of parameters without limits stay as they are.
        """
        if self.limits is None:
            return value
        low, high, default = self.limits
        if self.kind not in ("COLOR", "VECTOR"):
            return min(max(value, low), high) if is_number(value) else default
        first, alpha = tuple(value)[: len(default)], tuple(value)[len(default) :]
        return (*((min(max(each, low), high) for each in first) if is_number(sum(first)) else default), *alpha)

    @property
    def limits(self) -> tuple[float, float, Any] | None:
        """Least, most and default of the socket; None where it takes no numbers, or any."""
        if self.kind == "INDEX":
            words = [choice.keyword for choice in self.choices]
            return 0, len(words) - 1, words.index(self.default)
        return None if self.minimum is None else (self.minimum, self.maximum, self.default)


def is_number(value: float) -> bool:
    """Tell NaN and infinity from all else, as osl/bounds.h does."""
    return abs(value) < LARGEST


def _number(parameter: Parameter, value: Any) -> float:
    try:
        number = float(value)
    except OverflowError:
        number = inf
    except (TypeError, ValueError):
        raise ParameterError(f"{parameter.keyword}={value!r}: a number is needed") from None
    if not isfinite(number):
        raise ParameterError(f"{parameter.keyword}={value!r}: a finite number is needed")
    low, high = parameter.minimum, parameter.maximum
    if (low is not None and number < low) or (high is not None and number > high):
        raise ParameterError(f"{parameter.keyword}={value!r} is outside {_range(parameter)}")
    return number


def _integer(parameter: Parameter, value: Any) -> int:
    number = _number(parameter, value)
    if number != int(number):
        raise ParameterError(f"{parameter.keyword}={value!r}: a whole number is needed")
    return int(number)


def _boolean(parameter: Parameter, value: Any) -> bool:
    if isinstance(value, (bool, int, float)) and value in (0, 1):
        return bool(value)
    raise ParameterError(f"{parameter.keyword}={value!r}: True or False is needed")


def _triple(parameter: Parameter, value: Any) -> tuple[float, float, float]:
    try:
        components = tuple(value)
    except TypeError:
        components = ()
    if isinstance(value, str) or len(components) not in ((3, 4) if parameter.kind == "COLOR" else (3,)):
        raise ParameterError(f"{parameter.keyword}={value!r}: three numbers are needed")
    return tuple(_number(parameter, component) for component in components[:3])


def _choice(parameter: Parameter, value: Any) -> Choice:
    for choice in parameter.choices:
        if isinstance(value, str) and value == choice.keyword:
            return choice
    words = ", ".join(choice.keyword for choice in parameter.choices)
    raise ParameterError(f"{parameter.keyword}={value!r}: one of {words} is needed")


def _text(parameter: Parameter, value: Any) -> str:
    if not isinstance(value, str) or not value:
        raise ParameterError(f"{parameter.keyword}={value!r}: a word or the path of a file is needed")
    return value


def _shader(parameter: Parameter, value: Any) -> None:
    raise ParameterError(f"{parameter.keyword} is a Shader socket: link a shader node to '{parameter.name}' instead")


_CHECKS = {
    "INT": _integer,
    "FLOAT": _number,
    "BOOL": _boolean,
    "COLOR": _triple,
    "VECTOR": _triple,
    "MENU": _choice,
    "INDEX": _choice,
    "TEXT": _text,
    "SHADER": _shader,
}

SHADOW_MODES = (
    Choice("BLACK", "Black", "No light passes a shadow; light arrives by paths alone, as caustics"),
    Choice("TRANSMISSION", "Transmission Only", "Shadows take the colour that absorption leaves"),
    Choice(
        "OUTSIDE_FRESNEL",
        "Transmission and Outside Fresnel",
        "Also darker by what the surface reflects where a shadow ray enters from air",
    ),
    Choice(
        "ALL_FRESNEL",
        "Transmission and All Fresnel",
        "Also darker by what every interface reflects; total reflection shows as black edges",
    ),
)

DISTRIBUTIONS = (
    Choice("GGX", "GGX", "Single scattering: rough surfaces lose some energy"),
    Choice(
        "MULTI_GGX", "Multiscatter GGX", "Keeps the energy of light that scatters several times on the microsurface"
    ),
    Choice("BECKMANN", "Beckmann", "A narrower lobe with shorter tails"),
)

TANGENTS = (
    Choice("TANGENT", "Tangent", "The socket Tangent; without a link, around the object's Z axis"),
    Choice("REFRACTION", "Refraction", "The way of the refracted light along the surface"),
)

DISPERSION_MODELS = (
    Choice("ABBE", "Abbe", "Cauchy's two terms, from the index and the Abbe number"),
    Choice("SELLMEIER", "Sellmeier", "Three terms, as most measured curves are published"),
    Choice("JF", "JF", "The spread of JF Nested Dielectric, for scenes that come from there"),
)

BASICS = "Basics"
"""Panel of what artists change first; the node shows it without a heading, in the order of :data:`BASIC_KEYWORDS`."""

BASIC_KEYWORDS = ("transmittance", "transmittance_depth", "ior", "roughness", "priority")

SPECTRUM_PANEL = "Spectrum"

PARAMETERS: tuple[Parameter, ...] = (
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
        needs=("roughness", LAMPS_BY_LOBE, "direct_world"),
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
        needs=("roughness", LAMPS_BY_LOBE, "direct_world"),
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
    Parameter(
        "Direct Refraction",
        "Direct Light",
        "FLOAT",
        1.0,
        "Brightness of the highlights that small lamps make through the medium, drawn without the noise of rays. "
        "For lamps whose Ray Visibility has Transmission off; rays see all others",
        0.0,
        1.0,
        "FACTOR",
        label="Refraction",
        needs=(LAMPS_BY_LOBE,),
        limit=LOBES,
    ),
    Parameter(
        "Direct Reflection",
        "Direct Light",
        "FLOAT",
        1.0,
        "Brightness of the highlights that small lamps make on the medium's outside, drawn without the noise of "
        "rays. For lamps whose Ray Visibility has Glossy off",
        0.0,
        1.0,
        "FACTOR",
        label="Reflection",
        needs=(LAMPS_BY_LOBE,),
        limit=LOBES,
    ),
    Parameter(
        "Separate Direct Lobe",
        "Direct Light",
        "BOOL",
        False,
        "Gives highlights of refracted lamps the roughness below; off, they are as rough as refraction is",
        label="Separate Highlights",
        needs=(LAMPS_BY_LOBE, "direct_world"),
        limit=LOBE_SHAPES,
    ),
    Parameter(
        "Direct Roughness",
        "Direct Light",
        "FLOAT",
        0.0,
        "Size of separate highlights of refracted lamps",
        0.0,
        1.0,
        "FACTOR",
        label="Roughness",
        needs=("separate_direct_lobe",),
        limit=LOBE_SHAPES,
    ),
    Parameter(
        "Direct Distribution",
        "Direct Light",
        "MENU",
        "GGX",
        "Shape of separate highlights of refracted lamps; Multiscatter GGX is GGX here",
        choices=DISTRIBUTIONS,
        label="Distribution",
        needs=("separate_direct_lobe",),
        limit=LOBE_SHAPES,
    ),
    Parameter(
        "Direct Anisotropy",
        "Direct Light",
        "FLOAT",
        0.0,
        "Stretches separate highlights of refracted lamps across (positive) or along (negative) the tangent",
        -0.99,
        0.99,
        label="Anisotropy",
        needs=("separate_direct_lobe",),
        limit=LOBE_SHAPES,
    ),
    Parameter(
        "Direct Roughness Offset",
        "Direct Light",
        "FLOAT",
        0.05,
        "Makes highlights of refracted lamps larger and softer than refraction is, so that small lamps show",
        0.0,
        1.0,
        "FACTOR",
        label="Roughness Offset",
        needs=(LAMPS_BY_LOBE, "direct_world"),
        limit=LOBE_SHAPES,
    ),
    Parameter(
        "Direct Roughness Depth Multiplier",
        "Direct Light",
        "FLOAT",
        1.0,
        "Makes those highlights larger with every bounce before: their roughness is multiplied by this each time",
        0.0,
        10.0,
        label="Depth Multiplier",
        needs=(LAMPS_BY_LOBE, "direct_world"),
        limit=LOBE_SHAPES,
    ),
    Parameter(
        "Direct Roughness Depth Adder",
        "Direct Light",
        "FLOAT",
        0.0,
        "Makes those highlights larger with every bounce before: this is added to their roughness each time",
        0.0,
        1.0,
        "FACTOR",
        label="Depth Adder",
        needs=(LAMPS_BY_LOBE, "direct_world"),
        limit=LOBE_SHAPES,
    ),
    Parameter(
        "Direct Second Scale",
        "Direct Light",
        "FLOAT",
        0.0,
        "Share of those highlights' light in a second, wider glow around them",
        0.0,
        1.0,
        "FACTOR",
        label="Second Scale",
        needs=(LAMPS_BY_LOBE,),
        limit=LOBE_SHAPES,
    ),
    Parameter(
        "Direct Second Roughness Multiplier",
        "Direct Light",
        "FLOAT",
        2.0,
        "Size of the second glow over that of the highlight",
        0.0,
        100.0,
        label="Second Multiplier",
        needs=("direct_second_scale",),
        limit=LOBE_SHAPES,
    ),
    Parameter(
        "Direct World",
        "Direct Light",
        "BOOL",
        False,
        "Where the world is seen through the medium, it is as blurred as those highlights are",
        label="Blur World",
        limit=LOBES,
    ),
    Parameter(
        "Polarize",
        "Polarizing Filter",
        "BOOL",
        False,
        "Looks at the first surface through a polarizing filter, which takes away or keeps its reflections",
        limit=APART,
    ),
    Parameter(
        "Polarization Angle",
        "Polarizing Filter",
        "FLOAT",
        0.0,
        "Turns the filter, clockwise from the camera's vertical: at 0 reflections on level water vanish near 53 "
        "degrees",
        -1e4,
        1e4,
        "ANGLE",
        label="Angle",
        needs=("polarize",),
    ),
    Parameter(
        "Internal Reflections",
        "Sampling",
        "BOOL",
        True,
        "Shows weak reflections inside media. Off is darker and less noisy; total reflection stays",
        limit=APART,
    ),
    Parameter(
        "Max Interior Reflections",
        "Sampling",
        "INT",
        UNLIMITED_REFLECTIONS,
        "A path that has been reflected this often is not reflected inside media any more: fewer render faster, "
        "and sparkle less. Cycles' glossy bounces end it, too",
        0,
        UNLIMITED_REFLECTIONS,
        label="Max Reflections",
        limit=APART,
    ),
    Parameter(
        "Reflection Probability",
        "Sampling",
        "FLOAT",
        1.0,
        "How often weak reflections inside media are traced: less often is faster and noisier at the same "
        "brightness. 0 and 1 leave the choice to Cycles",
        0.0,
        1.0,
        "FACTOR",
        label="Probability",
        needs=("internal_reflections",),
        limit=Limit("leave the choice to Cycles, which changes the noise alone", decides=False),
    ),
    Parameter(
        "Energy Cutoff Exponent",
        "Sampling",
        "FLOAT",
        -20.0,
        "Gives up reflection or refraction that carries less than 10 to this power of the light, which darkens "
        "deep reflections. -20 gives up nothing",
        -20.0,
        0.0,
        label="Energy Cutoff",
        limit=Limit("give up nothing", alone=True),
    ),
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
        "Light of small lamps that direct refraction throws on other surfaces",
        label="Direct Refraction",
        needs=(LAMPS_BY_LOBE,),
        limit=LOBE_SHAPES,
    ),
    Parameter(
        "Caustic Direct Reflection",
        "Caustics",
        "BOOL",
        True,
        "Light of small lamps that direct reflection throws on other surfaces",
        label="Direct Reflection",
        needs=(LAMPS_BY_LOBE,),
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
        needs=(LAMPS_BY_LOBE, "direct_world"),
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
    Parameter(
        "Emission at Interfaces",
        "Emission",
        "SHADER",
        None,
        "Shader that glows wherever two media, or a medium and air, meet",
        label="At Interfaces",
        limit=GLOW,
    ),
    Parameter(
        "Emission at Entrances",
        "Emission",
        "SHADER",
        None,
        "Shader that glows where rays enter a medium from air",
        label="At Entrances",
        limit=GLOW,
    ),
    Parameter(
        "Emission at Exits",
        "Emission",
        "SHADER",
        None,
        "Shader that glows where rays leave all media into air",
        label="At Exits",
        limit=GLOW,
    ),
    Parameter(
        "Spectral Distribution",
        SPECTRUM_PANEL,
        "TEXT",
        "DAYLIGHT",
        "Light whose colours are split; its mix is always white: a word of the list below, a CIE illuminant such "
        "as `FL11`, or a CSV file of wavelength (nm) and power. Fluorescent lamps show bands, daylight all "
        "colours",
        label="Light",
        needs=("disperse",),
        limit=SPECTRUM,
    ),
    Parameter(
        "Spectral Gamut",
        SPECTRUM_PANEL,
        "MENU",
        "SCENE",
        "Colour space that split colours are made in: wider ones keep them purer",
        choices=spectra.GAMUTS,
        label="Gamut",
        needs=("disperse",),
        limit=SPECTRUM,
    ),
    Parameter(
        "Spectral Saturation",
        SPECTRUM_PANEL,
        "FLOAT",
        1.0,
        "Mixes split colours to greys of their brightness; 1 is physical",
        0.0,
        1.0,
        "FACTOR",
        label="Saturation",
        needs=("disperse",),
        limit=SPECTRUM,
    ),
    Parameter(
        "Clamp Negative",
        SPECTRUM_PANEL,
        "BOOL",
        True,
        "Cuts off what of split colours lies outside the gamut, which makes them paler; off, negative values "
        "reach the picture and come right in wider colour spaces",
        needs=("disperse",),
        limit=SPECTRUM,
    ),
)

BY_KEYWORD = {parameter.keyword: parameter for parameter in PARAMETERS}
BY_NAME = {parameter.name: parameter for parameter in PARAMETERS}

SOCKETS = tuple(parameter for parameter in PARAMETERS if parameter.panel != SPECTRUM_PANEL)
"""Parameters that are sockets of the node group."""

SETTINGS = tuple(parameter for parameter in PARAMETERS if parameter.panel == SPECTRUM_PANEL)
"""Parameters that a spectral table is baked from."""

NEIGHBOUR_PARAMETERS = (
    "Priority",
    "IOR",
    "Transmittance",
    "Transmittance Depth",
    *(parameter.name for parameter in PARAMETERS if parameter.panel == "Dispersion"),
)
"""Sockets whose values other media read while they render; a link into them is not seen by neighbours."""


def has_effect(parameter: Parameter, values: Mapping[str, Any]) -> bool:
    """Tell whether a parameter can show in the picture beside the values of others, by keyword; what is not among them may
    have any value.
    """
    return not parameter.needs or any(_is_at_work(need, values) for need in parameter.needs)


def limits_at_work(values: Mapping[str, Any], version: tuple[int, int, int]) -> dict[Limit, Parameter]:
    """Return for which parameters, beside the values of others as :func:`has_effect` takes them, a medium needs the shader in a
    version of Blender: of each limit the first.
    """
    found: dict[Limit, Parameter] = {}
    for parameter in SOCKETS:
        limit = parameter.limit
        if limit is None or not limit.decides or limit in found or (limit.before and version >= limit.before):
            continue
        neutral = parameter.default if limit.neutral is None else limit.neutral
        if parameter.keyword in values and values[parameter.keyword] == neutral:
            continue
        if has_effect(parameter, values) and (
            not limit.needs or any(_is_at_work(need, values) for need in limit.needs)
        ):
            found[limit] = parameter
    return found


def _is_at_work(keyword: str, values: Mapping[str, Any]) -> bool:
    parameter = BY_KEYWORD.get(keyword)
    if keyword in values:
        value = values[keyword]
        if parameter is not None and parameter.kind == "COLOR":
            value = tuple(value)[:3] != parameter.default
        if not value:
            return False
    return parameter is None or has_effect(parameter, values)


def check_keywords(keywords: dict[str, Any]) -> dict[Parameter, Any]:
    """Match keyword arguments to parameters and check their values; :class:`ParameterError` for the first that is
    wrong.
    """
    checked = {}
    for keyword, value in keywords.items():
        if keyword not in BY_KEYWORD:
            raise ParameterError(f"unknown parameter {keyword!r}; known are: {', '.join(BY_KEYWORD)}")
        parameter = BY_KEYWORD[keyword]
        checked[parameter] = parameter.check(value)
    return checked


def osl_limits() -> str:
    """The limits and defaults of sockets as macros of OSL: ``#define IOR_LIMITS 0.01, 100.0, 1.33``."""
    lines = []
    for parameter in SOCKETS:
        if parameter.limits is not None:
            limits = ", ".join(_osl(parameter, limit) for limit in parameter.limits)
            lines.append(f"#define {parameter.keyword.upper()}_LIMITS {limits}\n")
    return "".join(lines)


def _osl(parameter: Parameter, value: float | tuple[float, ...]) -> str:
    return f"{parameter.kind.lower()}{value}" if isinstance(value, tuple) else repr(value)


def _range(parameter: Parameter) -> str:
    low, high = parameter.minimum, parameter.maximum
    if low is None and high is None:
        return ""
    return f"{low:g} to {high:g}"
