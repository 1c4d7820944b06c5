"""Every parameter of the material, written down once.

Sockets of the node group, keyword arguments of :func:`nested_dielectric.new_material`, the names a preset file may
use, the inputs of the OSL shader and the manual's table all come from :data:`PARAMETERS`.

A spectral table is baked from the parameters of the panel `Spectrum`, so these are settings of a material and no
sockets.
"""

from __future__ import annotations

from dataclasses import dataclass
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


@dataclass(frozen=True)
class Parameter:
    """One parameter of the material.

    ``kind`` is one of ``INT``, ``FLOAT``, ``BOOL``, ``COLOR`` (scene-linear RGB), ``VECTOR``, ``MENU``, ``INDEX`` (a
    word in Python, its place among the choices in the socket: neighbours cannot read menus), ``TEXT`` and
    ``SHADER``; ``minimum`` and ``maximum`` are hard limits, ``unit`` the subtype of the socket (``FACTOR``,
    ``DISTANCE``, ``WAVELENGTH``, ``DIRECTION`` or empty).
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

SPECTRUM_PANEL = "Spectrum"

PARAMETERS: tuple[Parameter, ...] = (
    Parameter(
        "Priority",
        "Medium",
        "INT",
        0,
        "Where media overlap the lowest number wins; equal numbers are one medium. "
        "An object's own priority overrides this one",
        0,
        MAX_PRIORITY,
    ),
    Parameter(
        "IOR",
        "Medium",
        "FLOAT",
        1.33,
        "Index of refraction against vacuum, at 587.56 nm. Keep it unlinked: neighbours read its value",
        0.01,
        100.0,
    ),
    Parameter(
        "Transmittance",
        "Medium",
        "COLOR",
        (1.0, 1.0, 1.0),
        "Colour left of white light after it has travelled Transmittance Depth in the medium",
        0.0,
        1.0,
    ),
    Parameter(
        "Transmittance Depth",
        "Medium",
        "FLOAT",
        1.0,
        "Distance after which Transmittance is left, in scene units; 0 switches absorption off",
        0.0,
        1e6,
        "DISTANCE",
    ),
    Parameter(
        "Disperse",
        "Dispersion",
        "BOOL",
        False,
        "Light that enters or leaves this medium is split into its colours. Colours that are split already are bent by every "
        "medium's own dispersion, with or without this",
    ),
    Parameter(
        "Dispersion Model",
        "Dispersion",
        "INDEX",
        "ABBE",
        "How the index of refraction changes with the wavelength (in the node: 0 Abbe, 1 Sellmeier, 2 JF)",
        choices=DISPERSION_MODELS,
    ),
    Parameter(
        "Abbe",
        "Dispersion",
        "FLOAT",
        55.0,
        "Abbe number V_d of the Abbe model: the lower, the wider the colours spread; 0 is no dispersion",
        0.0,
        1e6,
    ),
    Parameter(
        "Sellmeier B",
        "Dispersion",
        "VECTOR",
        (1.03961212, 0.231792344, 1.01046945),
        "Strengths of the Sellmeier model's three terms. The curve is shifted to go through IOR",
        -1e4,
        1e4,
    ),
    Parameter(
        "Sellmeier C",
        "Dispersion",
        "VECTOR",
        (0.00600069867, 0.0200179144, 103.560653),
        "Squares of the Sellmeier model's three resonances, in square micrometres",
        0.0,
        1e6,
    ),
    Parameter(
        "Dispersion",
        "Dispersion",
        "FLOAT",
        0.03,
        "Spread of the JF model: the index at 370 nm above that at 780 nm",
        -10.0,
        10.0,
    ),
    Parameter(
        "Roughness",
        "Surface",
        "FLOAT",
        0.0,
        "Roughness of refraction, and of reflection unless that is separate (alpha is its square)",
        0.0,
        1.0,
        "FACTOR",
    ),
    Parameter(
        "Distribution",
        "Surface",
        "MENU",
        "MULTI_GGX",
        "Distribution of microfacet normals of a rough surface",
        choices=DISTRIBUTIONS,
    ),
    Parameter(
        "Anisotropy",
        "Surface",
        "FLOAT",
        0.0,
        "Stretches rough refraction and reflection across (positive) or along (negative) the tangent",
        -0.99,
        0.99,
    ),
    Parameter(
        "Separate Reflection",
        "Surface",
        "BOOL",
        False,
        "Reflection has a lobe of its own, by the three values below",
    ),
    Parameter(
        "Reflection Roughness",
        "Surface",
        "FLOAT",
        0.0,
        "Roughness of separate reflection",
        0.0,
        1.0,
        "FACTOR",
    ),
    Parameter(
        "Reflection Distribution",
        "Surface",
        "MENU",
        "MULTI_GGX",
        "Distribution of microfacet normals of separate reflection",
        choices=DISTRIBUTIONS,
    ),
    Parameter(
        "Reflection Anisotropy",
        "Surface",
        "FLOAT",
        0.0,
        "Stretches separate reflection across (positive) or along (negative) the tangent",
        -0.99,
        0.99,
    ),
    Parameter(
        "Tangent From",
        "Surface",
        "MENU",
        "TANGENT",
        "Direction along the surface that anisotropy refers to",
        choices=TANGENTS,
    ),
    Parameter(
        "Tangent",
        "Surface",
        "VECTOR",
        (0.0, 0.0, 0.0),
        "Tangent for anisotropy; without a link, around the object's Z axis",
        unit="DIRECTION",
    ),
    Parameter(
        "Blur Anisotropic Poles",
        "Surface",
        "FLOAT",
        0.0,
        "Makes anisotropic lobes round where the normal points along the axis of the tangents: 1 everywhere, 0 nowhere",
        0.0,
        1.0,
        "FACTOR",
    ),
    Parameter(
        "Normal",
        "Surface",
        "VECTOR",
        (0.0, 0.0, 0.0),
        "Normal or bump map; without a link, the surface's own normal",
        unit="DIRECTION",
    ),
    Parameter(
        "Thin Film Thickness",
        "Thin Film",
        "FLOAT",
        0.0,
        "Thickness of an interfering film on the surface, in nm; 0 is none",
        0.0,
        100000.0,
        "WAVELENGTH",
    ),
    Parameter("Thin Film IOR", "Thin Film", "FLOAT", 1.33, "Index of refraction of the film", 1.0, 100.0),
    Parameter(
        "Refraction Scale",
        "Reflection and Refraction",
        "FLOAT",
        1.0,
        "Scales all refraction; 1 is physical",
        0.0,
        1.0,
        "FACTOR",
    ),
    Parameter(
        "Specular Scale",
        "Reflection and Refraction",
        "FLOAT",
        1.0,
        "Scales all reflection; 1 is physical",
        0.0,
        1.0,
        "FACTOR",
    ),
    Parameter(
        "Refract Sky",
        "Reflection and Refraction",
        "BOOL",
        True,
        "Rays that leave all media see the world where they meet nothing else",
    ),
    Parameter(
        "Reflect Sky",
        "Reflection and Refraction",
        "BOOL",
        True,
        "Rays that the outside reflects see the world where they meet nothing else",
    ),
    Parameter(
        "Direct Refraction",
        "Direct Light",
        "FLOAT",
        1.0,
        "Scales the light of lamps that a lobe of its own refracts where light leaves all media. It carries the lamps "
        "whose Ray Visibility has Transmission off; all others are seen by rays",
        0.0,
        1.0,
        "FACTOR",
    ),
    Parameter(
        "Direct Reflection",
        "Direct Light",
        "FLOAT",
        1.0,
        "Scales the light of lamps that the lobe of reflection takes where light enters from air. It carries the lamps whose "
        "Ray Visibility has Glossy off",
        0.0,
        1.0,
        "FACTOR",
    ),
    Parameter(
        "Separate Direct Lobe",
        "Direct Light",
        "BOOL",
        False,
        "Direct refraction has a lobe by the three values below; off, it takes the refraction's",
    ),
    Parameter(
        "Direct Roughness",
        "Direct Light",
        "FLOAT",
        0.0,
        "Roughness of the separate direct lobe",
        0.0,
        1.0,
        "FACTOR",
    ),
    Parameter(
        "Direct Distribution",
        "Direct Light",
        "MENU",
        "GGX",
        "Distribution of microfacet normals of the separate direct lobe; Multiscatter GGX is GGX here",
        choices=DISTRIBUTIONS,
    ),
    Parameter(
        "Direct Anisotropy",
        "Direct Light",
        "FLOAT",
        0.0,
        "Stretches the separate direct lobe across (positive) or along (negative) the tangent",
        -0.99,
        0.99,
    ),
    Parameter(
        "Direct Roughness Offset",
        "Direct Light",
        "FLOAT",
        0.05,
        "Added to the roughness of direct refraction",
        0.0,
        1.0,
        "FACTOR",
    ),
    Parameter(
        "Direct Roughness Depth Multiplier",
        "Direct Light",
        "FLOAT",
        1.0,
        "The roughness of direct refraction is multiplied by this for every bounce before",
        0.0,
        10.0,
    ),
    Parameter(
        "Direct Roughness Depth Adder",
        "Direct Light",
        "FLOAT",
        0.0,
        "Added to the roughness of direct refraction for every bounce before",
        0.0,
        1.0,
        "FACTOR",
    ),
    Parameter(
        "Direct Second Scale",
        "Direct Light",
        "FLOAT",
        0.0,
        "Share of direct refraction in a second, wider lobe",
        0.0,
        1.0,
        "FACTOR",
    ),
    Parameter(
        "Direct Second Roughness Multiplier",
        "Direct Light",
        "FLOAT",
        2.0,
        "Roughness of the second lobe over that of the first",
        0.0,
        100.0,
    ),
    Parameter(
        "Direct World",
        "Direct Light",
        "BOOL",
        False,
        "Where refracted rays would see the world, they see it as rough as direct refraction is",
    ),
    Parameter(
        "Polarize",
        "Polarizing Filter",
        "BOOL",
        False,
        "The camera looks at the first surface through a polarizing filter",
    ),
    Parameter(
        "Polarization Angle",
        "Polarizing Filter",
        "FLOAT",
        0.0,
        "Angle of the filter's axis, clockwise from the camera's vertical",
        -1e4,
        1e4,
        "ANGLE",
    ),
    Parameter(
        "Internal Reflections",
        "Sampling",
        "BOOL",
        True,
        "Weak reflections inside media; total internal reflection stays when they are off",
    ),
    Parameter(
        "Max Interior Reflections",
        "Sampling",
        "INT",
        UNLIMITED_REFLECTIONS,
        "A path that has been reflected this often is not reflected inside media any more. Cycles' glossy bounces end it, "
        "too",
        0,
        UNLIMITED_REFLECTIONS,
    ),
    Parameter(
        "Reflection Probability",
        "Sampling",
        "FLOAT",
        1.0,
        "Weak reflections inside media are traced this often, and are brighter by as much: the picture keeps its "
        "brightness, the noise moves. 0 and 1 leave the choice to Cycles",
        0.0,
        1.0,
        "FACTOR",
    ),
    Parameter(
        "Energy Cutoff Exponent",
        "Sampling",
        "FLOAT",
        -20.0,
        "A surface gives up reflection or refraction that carries less than 10 to this power of the light on the ray; "
        "-20 gives up nothing",
        -20.0,
        0.0,
    ),
    Parameter(
        "Caustic Refraction",
        "Caustics",
        "BOOL",
        True,
        "Light that reaches diffuse surfaces on paths refracted by this medium",
    ),
    Parameter(
        "Caustic Reflection",
        "Caustics",
        "BOOL",
        True,
        "Light that reaches diffuse surfaces on paths reflected by the outside",
    ),
    Parameter(
        "Caustic Total Reflection",
        "Caustics",
        "BOOL",
        True,
        "Light that reaches diffuse surfaces on paths reflected totally inside",
    ),
    Parameter(
        "Caustic Internal Reflections",
        "Caustics",
        "BOOL",
        True,
        "Light that reaches diffuse surfaces on paths reflected weakly inside",
    ),
    Parameter(
        "Caustic Dispersion",
        "Caustics",
        "BOOL",
        True,
        "Light that reaches diffuse surfaces is split into its colours, also by shadow caustics",
    ),
    Parameter(
        "Caustic Direct Refraction",
        "Caustics",
        "BOOL",
        True,
        "Light of lamps that direct refraction sends to diffuse surfaces",
    ),
    Parameter(
        "Caustic Direct Reflection",
        "Caustics",
        "BOOL",
        True,
        "Light of lamps that direct reflection sends to diffuse surfaces",
    ),
    Parameter(
        "Caustic Roughness Offset",
        "Caustics",
        "FLOAT",
        0.1,
        "Added to the roughness of direct refraction on its way to diffuse surfaces",
        0.0,
        1.0,
        "FACTOR",
    ),
    Parameter(
        "Caustic Max Distance",
        "Caustics",
        "FLOAT",
        -1.0,
        "Light that reaches diffuse surfaces falls off linearly to nothing at this distance of the surface from the "
        "medium; below 0 it does not",
        -1.0,
        1e6,
        "DISTANCE",
    ),
    Parameter(
        "Shadow Mode",
        "Shadows",
        "MENU",
        "OUTSIDE_FRESNEL",
        "What light that goes straight through leaves in shadows",
        choices=SHADOW_MODES,
    ),
    Parameter(
        "Emission at Interfaces",
        "Emission",
        "SHADER",
        None,
        "Shader added at every interface between two media or a medium and air",
    ),
    Parameter("Emission at Entrances", "Emission", "SHADER", None, "Shader added where a ray enters a medium from air"),
    Parameter("Emission at Exits", "Emission", "SHADER", None, "Shader added where a ray leaves all media into air"),
    Parameter(
        "Spectral Distribution",
        SPECTRUM_PANEL,
        "TEXT",
        "DAYLIGHT",
        "Light that is split into colours; its mix is always white: a word of the list below, a CIE illuminant such as `FL11`, or a "
        "CSV file of wavelength (nm) and power",
    ),
    Parameter(
        "Spectral Gamut",
        SPECTRUM_PANEL,
        "MENU",
        "SCENE",
        "Colour space of the split colours",
        choices=spectra.GAMUTS,
    ),
    Parameter(
        "Spectral Saturation",
        SPECTRUM_PANEL,
        "FLOAT",
        1.0,
        "Mixes the split colours to greys of their luminance, before negative ones are clamped",
        0.0,
        1.0,
        "FACTOR",
    ),
    Parameter(
        "Clamp Negative",
        SPECTRUM_PANEL,
        "BOOL",
        True,
        "Cuts off the negative parts of split colours that lie outside the gamut; off, they reach the image",
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
