"""Presets: readable files of parameter values with the sources they come from."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .parameters import ParameterError, check_keywords

PRESET_FOLDER = Path(__file__).resolve().parent.parent / "presets"


@dataclass(frozen=True)
class Preset:
    """One preset: the material's name, what it is, where its numbers come from, and keyword arguments."""

    key: str
    name: str
    description: str
    source: str
    parameters: dict[str, Any]


def preset_names(folder: Path = PRESET_FOLDER) -> tuple[str, ...]:
    """Return the names of all presets, in alphabetical order."""
    return tuple(sorted(path.stem for path in folder.glob("*.toml")))


def load_preset(key: str, folder: Path = PRESET_FOLDER) -> Preset:
    """Read one preset and check its values. Raises :class:`ParameterError` naming the preset that is unknown or
    wrong.
    """
    path = folder / f"{key}.toml"
    if not path.is_file():
        raise ParameterError(f"unknown preset {key!r}; known are: {', '.join(preset_names(folder))}")
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        preset = Preset(key, data["name"], data["description"], data["source"], data["parameters"])
        check_keywords(preset.parameters)
    except (tomllib.TOMLDecodeError, KeyError, ParameterError) as error:
        raise ParameterError(f"preset file {path}: {error}") from None
    return preset
