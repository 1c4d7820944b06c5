"""Presets: readable files of parameter values with the sources they come from."""

from __future__ import annotations

import json
import re
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from .files import replacing
from .folders import ROOT
from .parameter import ParameterError
from .parameters import BY_KEYWORD, check_keywords

PRESET_FOLDER = ROOT / "presets"

GROUPS = (
    "Glass",
    "Water and Ice",
    "Drinks",
    "Liquids",
    "Gems and Crystals",
    "Plastics and Resins",
    "Bubbles and Films",
    "Laboratory Glass",
)
"""Groups of presets, in the order of menus."""

LONGEST_KEY = 60
"""Letters of a key: file systems end at 255 bytes."""

_RESERVED = re.compile(r"con|prn|aux|nul|(com|lpt)\d?")
"""Names that Windows gives no file."""


@dataclass(frozen=True)
class Preset:
    """One preset.

    :param key: its name in Python: the file's.
    :param name: the material's name.
    :param group: one of :data:`GROUPS`; a user's own may have another.
    :param tags: words by which artists look for it.
    :param description: what it is, in a sentence.
    :param source: where its numbers come from.
    :param parameters: keyword arguments of :func:`nested_dielectric.new_material`. Lengths are in metres; ``transmittance`` is
        scene-linear RGB with the primaries of Rec.709 (sRGB): the colour left of white light after ``transmittance_depth``,
        the size at which people know the medium.
    """

    key: str
    name: str
    group: str
    tags: tuple[str, ...]
    description: str
    source: str
    parameters: dict[str, Any]

    @property
    def has_colour(self) -> bool:
        """Whether it takes some of the light, so that how it looks hangs on how thick it is."""
        return tuple(self._value("transmittance")) != (1.0, 1.0, 1.0) and self.depth > 0.0

    @property
    def depth(self) -> float:
        """Way through it after which its Transmittance is left, in metres."""
        return self._value("transmittance_depth")

    def _value(self, keyword: str) -> Any:
        return self.parameters.get(keyword, BY_KEYWORD[keyword].default)


def preset_names(folder: Path = PRESET_FOLDER) -> tuple[str, ...]:
    """Return the names of all presets in a folder, in alphabetical order.

    Hidden files are none: a program that was killed may have left them half written.
    """
    return tuple(sorted(path.stem for path in folder.glob("*.toml") if not path.name.startswith(".")))


def all_presets(folder: Path = PRESET_FOLDER) -> tuple[Preset, ...]:
    """Return all presets, by group in the order of :data:`GROUPS` and by name within a group.

    :raises ParameterError: as :func:`load_preset` does.
    """
    presets = [load_preset(key, folder) for key in preset_names(folder)]
    return tuple(sorted(presets, key=lambda preset: (GROUPS.index(preset.group), preset.name)))


def load_preset(key: str, folder: Path = PRESET_FOLDER) -> Preset:
    """Read one preset and check its values.

    :raises ParameterError: names the preset that is unknown or wrong.
    """
    path = folder / f"{key}.toml"
    if key != path.stem or not path.is_file():
        raise ParameterError(f"unknown preset {key!r}; known are: {', '.join(preset_names(folder))}")
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        name, group, description, source = (_text(data, word) for word in ("name", "group", "description", "source"))
        tags, parameters = data["tags"], data["parameters"]
        if not name or not isinstance(parameters, dict):
            raise ParameterError("a preset needs a name and a table of parameters")
        if not isinstance(tags, list) or not all(isinstance(tag, str) for tag in tags):
            raise ParameterError("tags must be a list of words")
        check_keywords(parameters)
    except KeyError as error:
        raise ParameterError(f"preset file {path}: {error} is missing") from None
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError, RecursionError, ParameterError) as error:
        raise ParameterError(f"preset file {path}: {error}") from None
    return Preset(key, name, group, tuple(tags), description, source, parameters)


def _text(data: dict[str, Any], word: str) -> str:
    if not isinstance(data[word], str):
        raise ParameterError(f"{word} must be a text")
    return data[word]


def save_preset(preset: Preset, folder: Path) -> Path:
    """Write a preset to its file in a folder, whole or not at all, and return where that is.

    :raises ParameterError: if its values are wrong.
    :raises WriteError: if it cannot be written there.
    """
    check_keywords(preset.parameters)
    path = folder / f"{preset.key}.toml"
    with replacing(path) as draft:
        draft.write_text(preset_text(preset), encoding="utf-8")
    return path


def preset_text(preset: Preset) -> str:
    """Return a preset as the text of its file."""
    words = ("name", "group", "tags", "description", "source")
    lines = [f"{word} = {_toml(getattr(preset, word))}" for word in words]
    lines += ["", "[parameters]", *(f"{keyword} = {_toml(value)}" for keyword, value in preset.parameters.items())]
    return "\n".join(lines) + "\n"


def _toml(value: Any) -> str:
    """Return a value as TOML has it, which takes what JSON makes of texts and bare numbers."""
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_toml, value))}]"
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def key_of(name: str) -> str:
    """Return the key of a preset of that name: a file's name on every system, which leads into no other folder.

    :raises ParameterError: for a name without letters and digits.
    """
    key = re.sub(r"\W+", "_", name.casefold())[:LONGEST_KEY].strip("_")
    if not key:
        raise ParameterError(f"{name!r} cannot name a preset; it needs a letter or a digit")
    return f"{key}_preset" if _RESERVED.fullmatch(key) else key


def renamed(preset: Preset, name: str) -> Preset:
    """Return a preset under another name.

    :raises ParameterError: for one that cannot name a preset.
    """
    return replace(preset, key=key_of(name), name=name.strip())
