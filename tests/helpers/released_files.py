"""Files of releases."""

from pathlib import Path

import bpy

from nested_dielectric.nodes import compatibility

FILES = Path(__file__).parents[1] / "files"

FIRST = FILES / "released_0.1.0.blend"
FRONT_IOR = compatibility.shows_front_ior()


def open_file(path: Path) -> bpy.types.Scene:
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return bpy.context.scene
