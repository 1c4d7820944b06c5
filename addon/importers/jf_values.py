"""The values of one JF node, checked, with JF's defaults and notes on what is not carried over."""

from __future__ import annotations

import re
from math import isfinite
from typing import Any

from ..model.parameters import BY_KEYWORD
from .jf_parameters import JF_PARAMETERS, JfError
from .jf_reader import SWITCHES, JfNode, is_number

_ALIASES = {
    "fluorescent": "flourescent",
    "anisotropicraytangent": "ward_rayTangent",  # these two: builds after 1.0.5
    "anisotropicusertangent": "ward_userTangent",
}
"""Other spellings of words, without case, blanks, hyphens and underscores."""

_TRIPLES = ("RGB", "VECTOR")
"""Kinds of three numbers."""


class NodeValues:
    """The values of one node, with JF's defaults, and the notes on it.

    :ivar name: of the node.
    :ivar values: of all parameters; given: names of those that the node has.
    :ivar notes: pairs of a parameter and what happened to it.
    """

    def __init__(self, node: JfNode) -> None:
        self.name = node.name
        self.notes: list[tuple[str, str]] = []
        self.values = {parameter: default for parameter, (_, default) in JF_PARAMETERS.items()}
        self.given = set(node.parameters)
        if "name" in node.repeated:
            self.note("name", "stands there more than once; the last one is used")
        for parameter, value in node.parameters.items():
            if parameter in node.repeated:
                self.note(parameter, f"stands there more than once; the last value, {text_of(value)}, is used")
            if parameter in JF_PARAMETERS:
                self._take(parameter, value)
            elif parameter.partition(".")[0] in JF_PARAMETERS:
                self.note(parameter, "a single component is not carried over")
            else:
                self.note(parameter, f"unknown; {text_of(value)} is left out")

    def note(self, parameter: str, text: str) -> None:
        """Note what happened to a parameter."""
        self.notes.append((parameter, text))

    def fail(self, parameter: str, value: Any, needed: str) -> JfError:
        """Return an error that says what a parameter needs instead of a value."""
        return JfError(f"{self.name}: {parameter}={text_of(value)}: {needed} is needed")

    def _take(self, parameter: str, value: Any) -> None:
        """Take a value of the node for a parameter, if it is of its kind; note a link, which is not carried over."""
        kind, default = JF_PARAMETERS[parameter]
        if isinstance(kind, tuple):
            self.values[parameter] = self._word(parameter, value, kind)
        elif kind == "TEXT":
            self.values[parameter] = value
        elif kind == "BOOL" and isinstance(value, str) and value.lower() in SWITCHES:
            self.values[parameter] = SWITCHES[value.lower()]
        elif isinstance(value, str) and re.match(r"[^\W\d]|[/|:]", value):
            self.note(parameter, f"the link to {value!r} is not carried over; the default, {text_of(default)}, is used")
        elif kind == "BOOL":
            if value not in (True, False):
                raise self.fail(parameter, value, "on or off")
            self.values[parameter] = bool(value)
        elif kind in _TRIPLES:
            if not isinstance(value, tuple) or len(value) != 3:
                raise self.fail(parameter, value, "a list of three numbers")
            self.values[parameter] = tuple(self._number(parameter, component) for component in value)
        else:
            number = self._number(parameter, value)
            if kind == "INT" and number != int(number):
                raise self.fail(parameter, value, "a whole number")
            self.values[parameter] = int(number) if kind == "INT" else number

    def _number(self, parameter: str, value: Any) -> float:
        """Return a value as a finite number."""
        try:
            if is_number(value) and isfinite(value):
                return float(value)
        except OverflowError:
            pass
        raise self.fail(parameter, value, "a finite number")

    def _word(self, parameter: str, value: Any, words: tuple[str, ...]) -> str:
        """Return the word of an enumeration that a value stands for: a number, or the word in some spelling."""
        if type(value) is int and 0 <= value < len(words):
            return words[value]
        if isinstance(value, str):
            plain = _plain(value)
            plain = _plain(_ALIASES.get(plain, plain))
            for word in words:
                if _plain(word) == plain:
                    return word
        raise self.fail(parameter, value, f"one of {', '.join(words)}, or a number from 0 to {len(words) - 1},")


def _plain(word: str) -> str:
    """Return a word without case, blanks, hyphens and underscores."""
    return re.sub(r"[\s_-]", "", word).lower()


def text_of(value: Any) -> str:
    """Return a value as text for a note; of long lists the first eight values."""
    if isinstance(value, tuple):
        shown = " ".join(map(text_of, value[:8]))
        return shown if len(value) <= 8 else f"{shown} ..."
    return f"{value:g}" if isinstance(value, float) else str(value)


def within_limits(source: NodeValues, parameter: str, value: Any, keyword: str) -> Any:
    """Return a value within the limits of a keyword; note where it was not."""
    if isinstance(value, (bool, str)):
        return value
    limits = BY_KEYWORD[keyword]
    low, high = limits.minimum, limits.maximum

    def clamped(number: float) -> float:
        number = number if low is None else max(number, type(number)(low))
        return number if high is None else min(number, type(number)(high))

    fitted = tuple(map(clamped, value)) if isinstance(value, tuple) else clamped(value)
    if fitted != value:
        source.note(parameter, f"{text_of(value)} -> {text_of(fitted)}, the limit of {limits.name}")
    return fitted
