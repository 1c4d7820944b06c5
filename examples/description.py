"""Descriptions of product shots: JSON that is read, checked and completed before anything is built.

Each rule below says what a value may be and what it is when it is left out; :func:`read_shot` applies them. Lengths are in
millimetres, as on drawings.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Mapping
from difflib import get_close_matches
from pathlib import Path
from types import SimpleNamespace
from typing import Any

REQUIRED = object()
"""Default of a value that must be given."""

Rule = tuple[Any, Callable[[str, Any], Any]]
"""What a value is when it is left out, and the function of its place and itself that returns it checked."""


class DescriptionError(ValueError):
    """A description that cannot be built. The text names the key and what is allowed."""


def number(low: float, high: float, default: Any = REQUIRED, whole: bool = False) -> Rule:
    """Return the rule of a number within limits."""

    def check(place: str, value: Any) -> float:
        kinds = int if whole else (int, float)
        if not isinstance(value, kinds) or isinstance(value, bool) or not low <= value <= high:
            kind = "whole number" if whole else "number"
            raise DescriptionError(f"{place}: {value!r} must be a {kind} from {low:g} to {high:g}")
        return value

    return default, check


def numbers(count: int, low: float, high: float, default: Any = REQUIRED, whole: bool = False) -> Rule:
    """Return the rule of a list of so many numbers within limits."""
    _, check_number = number(low, high, whole=whole)

    def check(place: str, value: Any) -> list[float]:
        if not isinstance(value, list) or len(value) != count:
            raise DescriptionError(f"{place}: {value!r} must be a list of {count} numbers from {low:g} to {high:g}")
        return [check_number(f"{place}[{index}]", each) for index, each in enumerate(value)]

    return default, check


def profile() -> Rule:
    """Return the rule of half a vessel's outline: corners [radius, height, rounding] from the axis to the rim."""

    def check(place: str, value: Any) -> list[tuple[float, float, float]]:
        corners = value if isinstance(value, list) else []
        if len(corners) < 3:
            raise DescriptionError(f"{place}: must be a list of 3 or more corners [radius, height, rounding]")
        for index, corner in enumerate(corners):
            if not isinstance(corner, list) or len(corner) not in (2, 3):
                raise DescriptionError(f"{place}[{index}]: {corner!r} must be [radius, height] or with a rounding")
            numbers(len(corner), 0, 2000)[1](f"{place}[{index}]", corner)
        if corners[0][0] != 0 or min(corner[0] for corner in corners[1:]) <= 0:
            raise DescriptionError(f"{place}: only the first corner must be on the axis, with a radius of 0")
        return [(*corner, 0.0)[:3] for corner in corners]

    return REQUIRED, check


def vessel(names: Collection[str]) -> Rule:
    """Return the rule of a vessel: by its outline, or a straight one by its measures, whose outline is made here."""
    glass = preset(names, "drinking_glass")
    _, outlined = group({"preset": glass, "outside": profile(), "inside": profile()})
    measures = {
        "radius": number(1, 1000),
        "height": number(1, 2000),
        "wall": number(0.2, 50, 2),
        "base": number(0.2, 200, 8),
    }
    _, straight = group({"preset": glass, **measures})

    def check(place: str, value: Any) -> SimpleNamespace:
        if isinstance(value, dict) and value.keys() & {"outside", "inside"}:
            return outlined(place, value)
        found = straight(place, value)
        radius, height, wall, base = found.radius, found.height, found.wall, found.base
        if wall >= radius or base >= height:
            raise DescriptionError(
                f"{place}: wall {wall} and base {base} must leave room in a radius of {radius} and a height of {height}"
            )
        inner, lip = radius - wall, 0.45 * wall
        found.outside = [(0, 0, 0), (radius, 0, min(2 * wall, 0.4 * radius)), (radius, height, lip)]
        found.inside = [(0, base, 0), (inner, base, min(2 * wall, 0.4 * inner)), (inner, height, lip)]
        return found

    return REQUIRED, check


def preset(names: Collection[str], default: Any = REQUIRED) -> Rule:
    """Return the rule of a medium's preset."""

    def check(place: str, value: Any) -> str:
        if value not in names:
            near = get_close_matches(str(value), names, 3, 0.5) or ["glass", "water", "ice"]
            raise DescriptionError(
                f"{place}: {value!r} is no preset, such as {', '.join(near)}; nd.preset_names() are all"
            )
        return value

    return default, check


def group(rules: Mapping[str, Rule], default: Any = REQUIRED) -> Rule:
    """Return the rule of an object with named values, none of them unknown."""

    def check(place: str, value: Any) -> SimpleNamespace:
        if not isinstance(value, dict):
            raise DescriptionError(f"{place or 'the description'}: must be an object with {', '.join(rules)}")
        inside = f"{place}." if place else ""
        for key in value:
            if key not in rules:
                raise DescriptionError(f"{inside}{key}: is unknown; allowed are {', '.join(rules)}")
        checked = {}
        for key, (otherwise, check_value) in rules.items():
            if key not in value and otherwise is REQUIRED:
                raise DescriptionError(f"{inside}{key}: is missing")
            checked[key] = check_value(f"{inside}{key}", value[key]) if key in value else otherwise
        return SimpleNamespace(**checked)

    return check("", default) if isinstance(default, dict) else default, check


def several(rule: Rule, most: int) -> Rule:
    """Return the rule of a list of values of one rule; none unless they are given."""

    def check(place: str, value: Any) -> list[Any]:
        if not isinstance(value, list) or len(value) > most:
            raise DescriptionError(f"{place}: must be a list of at most {most}")
        return [rule[1](f"{place}[{index}]", each) for index, each in enumerate(value)]

    return [], check


def shot_rules(presets: Collection[str]) -> dict[str, Rule]:
    """Return the rules of a whole description.

    :param presets: the names of all presets of media.
    """
    colour = {"colour": numbers(3, 0, 1, None), "depth": number(0.01, 1e6, None)}
    liquid = {"preset": preset(presets, "water"), "level": number(0.02, 0.96), **colour}
    ice = {
        "preset": preset(presets, "ice"),
        "count": number(0, 30, 0, whole=True),
        "size": number(2, 200, 24),
        "seed": number(0, 10**6, 1, whole=True),
    }
    camera = {
        "frames": number(1, 10000, 1, whole=True),
        "distance": number(10, 20000, 600),
        "height": number(-1000, 10000, 150),
        "aim": number(0, 2000, None),
        "focal_length": number(10, 500, 85),
    }
    light = {
        "backdrop": numbers(3, 0, 1, [0.1, 0.3, 0.4]),
        "glow": number(0, 20, 1.0),
        "softboxes": number(0, 20, 1.0),
    }
    render = {
        "resolution": numbers(2, 4, 16384, [720, 900], whole=True),
        "samples": number(1, 65536, 128, whole=True),
    }
    return {
        "vessel": vessel(presets),
        "liquids": several(group(liquid), 5),
        "ice": group(ice, {}),
        "camera": group(camera, {}),
        "light": group(light, {}),
        "render": group(render, {}),
    }


def read_shot(file: Path, presets: Collection[str]) -> SimpleNamespace:
    """Return a description, checked and completed.

    :raises DescriptionError: names the file, the key and what is allowed.
    """
    try:
        shot = group(shot_rules(presets))[1]("", json.loads(file.read_text(encoding="utf-8-sig")))
        _check_together(shot)
    except OSError as error:
        raise DescriptionError(f"{file}: cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise DescriptionError(f"{file}: is no text in UTF-8") from None
    except json.JSONDecodeError as error:
        raise DescriptionError(f"{file}: line {error.lineno}: is no JSON: {error.msg}") from None
    except DescriptionError as error:
        raise DescriptionError(f"{file}: {error}") from None
    return shot


def _check_together(shot: SimpleNamespace) -> None:
    """Check what more than one value decides."""
    heights = [height for _, height, _ in shot.vessel.inside]
    if heights != sorted(heights):
        raise DescriptionError("vessel.inside: heights must not fall from the axis to the rim, or air would be caught")
    if shot.vessel.inside[0][1] <= shot.vessel.outside[0][1]:
        raise DescriptionError("vessel.inside: must begin above vessel.outside, which is the base")
    if shot.ice.count and not shot.liquids:
        raise DescriptionError("ice.count: needs one of liquids, for the ice to stand in")
    levels = [liquid.level for liquid in shot.liquids]
    if levels != sorted(set(levels)):
        raise DescriptionError(f"liquids: their levels {levels} must rise, from the lowest liquid to the highest")
    for index, liquid in enumerate(shot.liquids):
        if liquid.colour is not None and liquid.depth is None:
            raise DescriptionError(f"liquids[{index}].colour: needs depth, the millimetres after which light has it")
