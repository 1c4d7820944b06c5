"""The type of a parameter of the material."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite
from typing import Any

from .choice import Choice

GROUP_NAME = "Nested Dielectric"
"""Name of the node group and of the group node in a material; the shader reads neighbours' sockets by it."""

PRIORITY_PROPERTY = "nd_priority"
"""Custom property of an object that overrides the priority of its material."""

MAX_PRIORITY = 1000
"""Highest priority that sockets and properties take."""

LARGEST = 3.4e38
"""Number that is infinite to single precision, or nearly so."""

UNLIMITED_REFLECTIONS = 1024
"""A limit of reflections that is none: from here on Cycles' own limits are lower."""

BASICS = "Basics"
"""Panel of what artists change first; the node shows it without a heading, in the order of :data:`BASIC_KEYWORDS`."""

BASIC_KEYWORDS = ("transmittance", "transmittance_depth", "ior", "roughness", "priority")

SPECTRUM_PANEL = "Spectrum"
"""Panel of what a spectral table is baked from."""


class ParameterError(ValueError):
    """An unknown parameter, or a value that it cannot take. The text names both and the remedy."""


LIGHTS_BY_LOBE = "lights_by_lobe"
"""What a parameter needs if it shows only with lights that the lobes of direct refraction and reflection carry."""

TINTED_MEDIA = "tinted_media"
"""What a limit needs if it shows only where the medium, or one that it may touch, has a colour."""


@dataclass(frozen=True)
class Limit:
    """A difference between what Cycles' own nodes and the shader make of a parameter.

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
        """Return ``value`` as the type the parameter holds. Raise :class:`ParameterError` if it cannot hold it."""
        return _CHECKS[self.kind](self, value)

    def bounded(self, value: Any) -> Any:
        """Return what a socket's value counts as, as osl/bounds.h has it.

        Numbers count within the limits, and in place of what is no number the default. Values of parameters without limits
        stay as they are.
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
    """Return a finite number within the limits."""
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
        raise ParameterError(f"{parameter.keyword}={value!r} is outside {low:g} to {high:g}")
    return number


def _integer(parameter: Parameter, value: Any) -> int:
    """Return a whole number within the limits."""
    number = _number(parameter, value)
    if number != int(number):
        raise ParameterError(f"{parameter.keyword}={value!r}: a whole number is needed")
    return int(number)


def _boolean(parameter: Parameter, value: Any) -> bool:
    """Return True or False for these, 1 or 0."""
    if isinstance(value, (bool, int, float)) and value in (0, 1):
        return bool(value)
    raise ParameterError(f"{parameter.keyword}={value!r}: True or False is needed")


def _triple(parameter: Parameter, value: Any) -> tuple[float, float, float]:
    """Return three numbers within the limits; the alpha of a colour is dropped."""
    try:
        components = tuple(value)
    except TypeError:
        components = ()
    if isinstance(value, str) or len(components) not in ((3, 4) if parameter.kind == "COLOR" else (3,)):
        raise ParameterError(f"{parameter.keyword}={value!r}: three numbers are needed")
    return tuple(_number(parameter, component) for component in components[:3])


def _choice(parameter: Parameter, value: Any) -> Choice:
    """Return the choice of a keyword."""
    for choice in parameter.choices:
        if isinstance(value, str) and value == choice.keyword:
            return choice
    words = ", ".join(choice.keyword for choice in parameter.choices)
    raise ParameterError(f"{parameter.keyword}={value!r}: one of {words} is needed")


def _text(parameter: Parameter, value: Any) -> str:
    """Return a text that is not empty."""
    if not isinstance(value, str) or not value:
        raise ParameterError(f"{parameter.keyword}={value!r}: a word or the path of a file is needed")
    return value


def _shader(parameter: Parameter, value: Any) -> None:
    """Refuse any value: what a Shader socket shows is linked."""
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
"""By kinds: what returns a value as a parameter holds it, or raises :class:`ParameterError` with the remedy."""
