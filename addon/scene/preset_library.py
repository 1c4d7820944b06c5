"""All presets that there are: those of the extension, and the user's own in a folder that updates leave alone."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import bpy

from ..model import presets
from ..model.folders import PACKAGE
from ..model.parameter import ParameterError
from ..model.presets import GROUPS, PRESET_FOLDER, Preset

USER_GROUP = "My Presets"
"""Group of the user's presets that name none of the extension's."""


@dataclass(frozen=True, eq=False)
class Catalogue:
    """Presets as menus show them.

    :param presets: by their keys, in alphabetical order.
    :param own: keys of the user's.
    :param problems: files in the user's folder that are no presets, each with the remedy.
    """

    presets: dict[str, Preset]
    own: frozenset[str]
    problems: tuple[str, ...]

    def group_of(self, key: str) -> str:
        """Return the group that a preset is shown in."""
        group = self.presets[key].group
        return group if group in GROUPS else USER_GROUP

    def groups(self) -> dict[str, list[Preset]]:
        """Return the presets of each group that has any, in the order of menus, by their names."""
        found = {group: [] for group in (*GROUPS, USER_GROUP)}
        for preset in sorted(self.presets.values(), key=lambda preset: preset.name.casefold()):
            found[self.group_of(preset.key)].append(preset)
        return {group: members for group, members in found.items() if members}

    def search(self, words: str) -> list[Preset]:
        """Return the presets in whose name, tags, group or description all of the words stand, first those in whose name."""
        wanted = words.casefold().split()
        found = []
        for preset in sorted(self.presets.values(), key=lambda preset: preset.name.casefold()):
            text = " ".join((preset.name, *preset.tags, preset.group, preset.description)).casefold()
            if all(word in text for word in wanted):
                found.append(preset)
        return sorted(found, key=lambda preset: not all(word in preset.name.casefold() for word in wanted))


def user_folder() -> Path:
    """Return the folder of the user's presets, which may not be there yet.

    It is the one that the preferences name, or else one of the extension's own.
    """
    addon = bpy.context.preferences.addons.get(PACKAGE)
    chosen = getattr(addon and addon.preferences, "preset_folder", "")
    if chosen:
        return Path(bpy.path.abspath(chosen))
    if PACKAGE.startswith("bl_ext."):
        return Path(bpy.utils.extension_path_user(PACKAGE, path="presets"))
    return Path(bpy.utils.user_resource("DATAFILES", path="nested_dielectric/presets"))


def preset_names() -> tuple[str, ...]:
    """Return the names of all presets, in alphabetical order."""
    return tuple(catalogue().presets)


def load_preset(key: str) -> Preset:
    """Return a preset.

    :raises ParameterError: names the preset that is unknown or wrong.
    """
    if key in presets.preset_names():
        return presets.load_preset(key)
    found = catalogue()
    if key in found.presets:
        return found.presets[key]
    if key in presets.preset_names(user_folder()):
        return presets.load_preset(key, user_folder())  # which says what is wrong with it
    raise ParameterError(f"unknown preset {key!r}; known are: {', '.join(found.presets)}")


def catalogue() -> Catalogue:
    """Return all presets as the files have them now. A wrong file of the user's is told, and keeps nothing else away."""
    global _read
    stamp = tuple(map(_stamp, (PRESET_FOLDER, user_folder())))
    if _read is None or _read[0] != stamp:
        _read = stamp, _catalogue()
    return _read[1]


_read: tuple[tuple, Catalogue] | None = None
"""The catalogue, and the files that it was read from."""


def _stamp(folder: Path) -> tuple:
    return folder, *sorted((path.name, _moment(path)) for path in folder.glob("*.toml"))


def _moment(path: Path) -> int:
    """Return when a file was written, 0 where a link leads nowhere or nobody may know."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0


def _catalogue() -> Catalogue:
    found, problems = _read_all(PRESET_FOLDER, "install the extension again")
    folder = user_folder()
    readable, unreadable = _read_all(folder, "correct the file or delete it")
    problems += unreadable
    own = {}
    for key, preset in readable.items():
        if _has(found.values(), key, preset.name):
            remedy = "rename the file and its preset"
            problems.append(f"preset file {folder / key}.toml: {preset.name} is built in; {remedy}")
        else:
            own[key] = preset
    return Catalogue(dict(sorted((found | own).items())), frozenset(own), tuple(problems))


def _read_all(folder: Path, remedy: str) -> tuple[dict[str, Preset], list[str]]:
    """Return the presets of a folder by their keys, and what is wrong with its other files."""
    found, problems = {}, []
    for key in presets.preset_names(folder):
        try:
            found[key] = presets.load_preset(key, folder)
        except ParameterError as error:
            problems.append(f"{error}; {remedy}")
    return found, problems


def is_built_in(key: str, name: str) -> bool:
    """Return whether a preset of the extension's has a key or a name."""
    found = catalogue()
    return _has((preset for preset in found.presets.values() if preset.key not in found.own), key, name)


def _has(members: Iterable[Preset], key: str, name: str) -> bool:
    return any(key == preset.key or name.casefold() == preset.name.casefold() for preset in members)


def save_user_preset(preset: Preset) -> Path:
    """Write a preset of the user's, in place of one of its key, and return its path.

    :raises ParameterError: if its name is taken by a preset of the extension's.
    """
    if is_built_in(preset.key, preset.name):
        raise ParameterError(f"{preset.name!r} is a preset of the extension's; choose another name")
    return presets.save_preset(preset, user_folder())


def delete_user_preset(key: str) -> None:
    """Remove a preset of the user's.

    :raises ParameterError: if it is none, or its file cannot be removed.
    """
    if key not in catalogue().own:
        own = ", ".join(sorted(catalogue().own)) or "none"
        raise ParameterError(f"{key!r} is no preset of yours; yours are: {own}")
    path = user_folder() / f"{key}.toml"
    try:
        path.unlink()
    except OSError as error:
        raise ParameterError(f"{path}: cannot be removed ({error.strerror}); remove it by hand") from None
