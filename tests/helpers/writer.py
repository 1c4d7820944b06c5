"""Write files of every kind again and again, until the process is killed: `python tests/helpers/writer.py FOLDER`.

Each line that is printed says what is about to be written.
"""

from __future__ import annotations

import itertools
import sys
from pathlib import Path

import bpy
from scenes import add_box, add_camera, new_scene

import nested_dielectric as nd
from nested_dielectric import cli
from nested_dielectric.model.presets import load_preset, renamed, save_preset
from nested_dielectric.scene.output import save_blend
from nested_dielectric.scene.rendering import render_frame


def main(folder: Path) -> None:
    """Write until the end."""
    scene = new_scene(64, with_group=True)
    scene.cycles.samples = 1
    bpy.context.preferences.filepaths.save_version = 1
    add_box("Glass", (-1, -1, 0), (1, 1, 1), nd.new_material("Glass", preset="glass"))
    add_box("Water", (-1, -1, -1), (1, 1, 0.5), nd.new_material("Water", preset="water"))
    add_camera((0.1, -6.0, 0.4), (0.0, 0.0, 0.0), angle=35)
    nd.prepare(scene, cut=True)
    nd.register()
    preset = renamed(load_preset("water"), "Mine")
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "saved.blend"))
    writers = (
        ("Blender's own save", lambda: bpy.ops.wm.save_mainfile()),
        ("a copy", lambda: save_blend(folder / "copy.blend")),
        ("a preset", lambda: save_preset(preset, folder / "presets")),
        ("a table", lambda: cli.main(["bake", "-o", str(folder / "table.exr")])),
        ("a picture", lambda: render_frame(scene, folder / "picture.png")),
    )
    for number in itertools.count():
        bpy.data.objects["Glass"].location.x = 0.01 * (number % 50)
        bpy.context.view_layer.update()
        for what, write in writers:
            print(f"writes {what}", flush=True)
            write()
        print("round", flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
