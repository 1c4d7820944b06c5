"""The extension's asset library among those that Blender's preferences list."""

from __future__ import annotations

from pathlib import Path

import bpy

from ..model.folders import ROOT

NAME = "Nested Dielectric"

FOLDER = ROOT / "library"
"""Where ``make extension`` puts the file of all media."""

FILE = FOLDER / "nested_dielectric.blend"


def is_there() -> bool:
    """Return whether the extension came with its library."""
    return FILE.is_file()


def follow(wanted: bool) -> None:
    """List the extension's library, or take it out; libraries of the user's stay as they are."""
    libraries = bpy.context.preferences.filepaths.asset_libraries
    listed = [library for library in libraries if _is_ours(library)]
    keep = 1 if wanted and is_there() else 0
    for library in reversed(listed[keep:]):
        libraries.remove(library)
    if keep and not listed:
        libraries.new(name=NAME, directory=str(FOLDER)).import_method = "APPEND"
    elif keep and listed[0].path != str(FOLDER):
        listed[0].path = str(FOLDER)


def _is_ours(library: bpy.types.UserAssetLibrary) -> bool:
    """Return whether a library is this one, or one that another installation of the extension has left."""
    path = Path(library.path)
    left = library.name.startswith(NAME) and path.parts[-2:] == FOLDER.parts[-2:] and not path.is_dir()
    return left or path.resolve() == FOLDER
