"""Presets as Blender's menus want them: their names with pictures."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from zlib import crc32

import numpy as np

from ...model.presets import PRESET_FOLDER, Preset
from ...scene.preset_library import Catalogue, catalogue
from ..pictures import drawn_picture, loaded_picture

PICTURE_FOLDER = PRESET_FOLDER / "previews"
"""Pictures of the extension's presets; ``make assets`` renders them."""

DRAWN_SIZE = 96
"""Width and height in pixels of a picture that is drawn instead of rendered."""

Item = tuple[str, str, str, int, int]


def forget_items() -> None:
    """Forget the items of menus, which hold numbers of pictures."""
    for kept in (_items, _searched_items, _own_items):
        kept.cache_clear()


def picture_path(key: str) -> Path:
    """Return where the rendered picture of a preset of the extension's lies."""
    return PICTURE_FOLDER / f"{key}.jpg"


def picture(preset: Preset) -> int:
    """Return the icon that shows a preset: its rendered picture, or a ball of its colour; 0 while there are none."""
    path = picture_path(preset.key)
    if preset.key not in catalogue().own and path.is_file():
        return loaded_picture(preset.key, path)
    colour = tuple(preset.parameters.get("transmittance", (1.0, 1.0, 1.0)))
    return drawn_picture(f"colour {colour}", lambda: _ball(colour))


def _ball(colour: tuple[float, float, float]) -> np.ndarray:
    """Return a ball of a colour: (size, size, 4) float32 as a screen shows it, the lowest row first."""
    y, x = np.mgrid[-1.0 : 1.0 : DRAWN_SIZE * 1j, -1.0 : 1.0 : DRAWN_SIZE * 1j] / 0.9
    radius = np.hypot(x, y)
    way = np.sqrt(np.clip(1.0 - radius**2, 0.0, 1.0))[..., None]
    linear = 0.9 * np.clip(colour, 1e-3, 1.0) ** way
    linear += 0.8 * np.exp(-(((x + 0.4) ** 2 + (y - 0.45) ** 2) / 0.02))[..., None]
    alpha = np.clip((1.0 - radius) * DRAWN_SIZE / 2.0, 0.0, 1.0)[..., None]
    return np.concatenate([np.clip(linear, 0.0, 1.0) ** (1.0 / 2.2) * alpha, alpha], axis=-1).astype(np.float32)


def items() -> tuple[Item, ...]:
    """Return all presets."""
    return _items(catalogue())


def searched_items() -> tuple[Item, ...]:
    """Return all presets, each with the words behind its name that a search finds it by."""
    return _searched_items(catalogue())


def own_items() -> tuple[Item, ...]:
    """Return the user's presets."""
    return _own_items(catalogue())


# Blender does not hold on to the strings of a menu itself, so the last ones are kept.


@lru_cache(maxsize=4)
def _items(found: Catalogue) -> tuple[Item, ...]:
    return tuple(_item(preset, preset.name) for members in found.groups().values() for preset in members)


@lru_cache(maxsize=4)
def _searched_items(found: Catalogue) -> tuple[Item, ...]:
    presets = (preset for members in found.groups().values() for preset in members)
    return tuple(_item(each, f"{each.name}  ({', '.join(each.tags)})" if each.tags else each.name) for each in presets)


@lru_cache(maxsize=4)
def _own_items(found: Catalogue) -> tuple[Item, ...]:
    return tuple(_item(preset, preset.name) for key, preset in found.presets.items() if key in found.own)


def _item(preset: Preset, text: str) -> Item:
    """Return a row of a menu, with a number that stays as other presets come and go."""
    return preset.key, text, preset.description.rstrip("."), picture(preset), crc32(preset.key.encode()) >> 1
