"""Presets: readable files of parameter values with the sources they come from."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .parameters import ParameterError, check_keywords

PRESET_FOLDER = Path(__file__).resolve().parent.parent / "presets"

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


@dataclass(frozen=True)
class Preset:
    """One preset.

    :param key: its name in Python: the file's.
    :param name: the material's name.
    :param group: one of :data:`GROUPS`.
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


def preset_names(folder: Path = PRESET_FOLDER) -> tuple[str, ...]:
    """Return the names of all presets, in alphabetical order."""
    return tuple(sorted(path.stem for path in folder.glob("*.toml")))


def all_presets(folder: Path = PRESET_FOLDER) -> tuple[Preset, ...]:
    """Return all presets, by group in the order of :data:`GROUPS` and by name within a group. Raises as
    :func:`load_preset` does.
    """
    presets = [load_preset(key, folder) for key in preset_names(folder)]
    return tuple(sorted(presets, key=lambda preset: (GROUPS.index(preset.group), preset.name)))


def load_preset(key: str, folder: Path = PRESET_FOLDER) -> Preset:
    """Read one preset and check its values. Raises :class:`ParameterError` naming the preset that is unknown or
    wrong.
    """
    path = folder / f"{key}.toml"
    if not path.is_file():
        raise ParameterError(f"unknown preset {key!r}; known are: {', '.join(preset_names(folder))}")
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        words = (data[word] for word in ("name", "group", "tags", "description", "source"))
        name, group, tags, description, source = words
        preset = Preset(key, name, group, tuple(tags), description, source, data["parameters"])
        check_keywords(preset.parameters)
    except (tomllib.TOMLDecodeError, KeyError, ParameterError) as error:
        raise ParameterError(f"preset file {path}: {error}") from None
    return preset
