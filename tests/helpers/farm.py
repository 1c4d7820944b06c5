"""Render files where the extension is not installed: ``python tests/helpers/farm.py SAMPLES PERCENTAGE FOLDER FILE...``.

Writes FOLDER/NAME.exr.
"""

import sys
from pathlib import Path

sys.modules["nested_dielectric"] = None  # any import of it fails

import bpy  # noqa: E402

samples, percentage = map(int, sys.argv[1:3])
folder = Path(sys.argv[3])
for file in map(Path, sys.argv[4:]):
    bpy.ops.wm.open_mainfile(filepath=str(file))
    scene = bpy.context.scene
    scene.cycles.samples = samples
    scene.render.resolution_percentage = percentage
    scene.render.filepath = str(folder / f"{file.stem}.exr")
    bpy.ops.render.render(write_still=True)
