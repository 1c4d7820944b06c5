"""Preset files as text."""

from __future__ import annotations

import json
from typing import Any

from .colours import colour_at_depth
from .recipe import Recipe

HEAD = '# Written by "make presets" from the tables in presets/build/media: change it there.\n'


def parameters(medium: Recipe) -> dict[str, Any]:
    """The material's parameters, in the order of the file."""
    values: dict[str, Any] = {"priority": medium.priority, **medium.index.parameters()}
    if medium.disperse:
        values["disperse"] = True
    if medium.absorption:
        values["transmittance"] = list(colour_at_depth(medium.absorption, medium.depth))
        values["transmittance_depth"] = medium.depth
    return values | dict(medium.others)


def preset_text(medium: Recipe) -> str:
    """The preset file of a medium."""
    tags = [tag.strip() for tag in medium.tags.split(",")]
    head = {
        "name": medium.name,
        "group": medium.group,
        "tags": tags,
        "description": medium.description,
        "source": medium.source,
    }
    lines = [f"{key} = {_toml(value)}" for key, value in head.items()]
    lines += ["", "[parameters]", *(f"{key} = {_number(key, value)}" for key, value in parameters(medium).items())]
    return HEAD + "\n".join(lines) + "\n"


def _number(key: str, value: Any) -> str:
    return f"{value:.7f}" if key == "ior" and round(value, 5) != value else _toml(value)


def _toml(value: Any) -> str:
    """A value as TOML has it. JSON writes strings, lists and truth values alike."""
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    return json.dumps(value, ensure_ascii=False)
