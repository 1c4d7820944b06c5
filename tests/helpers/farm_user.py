"""What a user of a farm does who may write nowhere but into one folder: `python tests/helpers/farm_user.py FOLDER`."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import bpy

import nested_dielectric as nd
from nested_dielectric import cli
from nested_dielectric.preparation import guard
from nested_dielectric.scene.preset_library import catalogue, user_folder


def main(folder: Path) -> None:
    """Make media, compile shaders, prepare, save and render; say what cannot be written."""
    installed = Path(nd.__file__).resolve().parents[1]
    for place in (installed, installed / "osl", installed / "presets", Path.home()):
        try:
            (place / "probe").touch()
        except OSError:
            continue
        sys.exit(f"{place} can be written")
    bpy.ops.wm.read_factory_settings()
    nd.register()
    cube = bpy.data.objects["Cube"]
    bpy.context.view_layer.objects.active = cube
    nd.assign(cube, nd.new_material("Prism", preset="bk7", disperse=True))
    nd.prepare(bpy.context.scene, cut=True)
    assert len(catalogue().presets) > 50 and not user_folder().is_dir()
    try:
        bpy.ops.nested_dielectric.save_preset(name="Mine")
    except RuntimeError as error:
        print(error)
    render = bpy.context.scene.render
    render.resolution_x = render.resolution_y = 16
    file, picture = str(folder / "a.blend"), str(folder / "a.png")
    bpy.ops.wm.save_as_mainfile(filepath=file)
    codes = [
        cli.main(["prepare", file]),
        cli.main(["render", file, "-o", picture, "--samples", "1"]),
        cli.main(["bake", "-o", str(folder / "table.exr")]),
        cli.main(["prepare", file, "-o", str(installed / "a.blend")]),
        cli.main(["bake", "-o", str(Path.home() / "table.exr")]),
    ]
    assert guard.faults() == (), guard.faults()
    nd.unregister()
    print("codes", codes, sorted(os.listdir(folder)))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
