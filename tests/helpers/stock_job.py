"""Render a .blend as stock jobs of farms do, where the extension is not: ``python tests/helpers/stock_job.py JOBS.json``.

Each job opens its file, changes settings as the farm pleases, and renders a frame or an animation. Prints what each file needs
besides itself.
"""

import json
import sys
from pathlib import Path

sys.modules["nested_dielectric"] = None  # any import of it fails

import bpy  # noqa: E402


def run(
    file: str, output: str, settings: dict[str, object], frame: int | None = None, frames: list[int] | None = None
) -> None:
    """Do one job.

    :param settings: values of the scene's properties, by their paths.
    :param frames: the first, the last and the step of an animation.
    """
    bpy.ops.wm.open_mainfile(filepath=file)
    scene = bpy.context.scene
    for path, value in settings.items():
        owner, _, name = path.rpartition(".")
        setattr(scene.path_resolve(owner) if owner else scene, name, value)
    scene.render.filepath = output
    if frames is not None:
        scene.frame_start, scene.frame_end, scene.frame_step = frames
        bpy.ops.render.render(animation=True)
    else:
        if frame is not None:
            scene.frame_set(frame)
        bpy.ops.render.render(write_still=True)
    needed = {path for paths in bpy.data.file_path_map(include_libraries=True).values() for path in paths}
    for path in needed | {library.filepath for library in bpy.data.libraries}:
        print("NEEDS", path)


for job in json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")):
    run(**job)
