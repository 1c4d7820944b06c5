"""Within a Blender application: save a picture of its window for each kind of shading, and quit (see real_blender.py).

``blender FILE --python real_window.py -- PACKAGE FOLDER SHADING...``
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path

import bpy

package, folder, *shadings = sys.argv[sys.argv.index("--") + 1 :]
sys.path.insert(0, package)

SAMPLES = 6
"""Of viewports."""

SAME = 4
"""Pictures of a window that are the same one after another: nothing is drawn any more."""

MOST = 120
"""Pictures after which one of them has to do."""

SECONDS = 2.0
"""Between two pictures."""


def steps() -> Iterator[float]:
    """Do one thing after another, and yield the seconds to wait before the next."""
    import nested_dielectric as nd

    nd.register()
    bpy.context.scene.cycles.preview_samples = bpy.context.scene.eevee.taa_samples = SAMPLES
    for shading in shadings:
        for space in viewports():
            space.shading.type = shading
            space.overlay.show_overlays = False
        yield 3.0
        last, same = None, 0
        for _ in range(MOST):
            picture = take(Path(folder, f"{shading.lower()}.png"))
            same = same + 1 if picture == last else 0
            if same == SAME:
                break
            last = picture
            yield SECONDS


def viewports() -> Iterator[bpy.types.SpaceView3D]:
    window = bpy.context.window_manager.windows[0]
    return (area.spaces.active for area in window.screen.areas if area.type == "VIEW_3D")


def take(path: Path) -> bytes:
    """Save a picture of the screen, and return what is written; to load it here would draw the window anew. On virtual screens
    Blender's own pictures may be black: ImageMagick's are taken where it is there.
    """
    part = path.with_suffix(".part.png")
    if shutil.which("import") and "DISPLAY" in os.environ:
        without_time = ["-strip", "-define", "png:exclude-chunks=date,time"]
        subprocess.run(["import", "-window", "root", *without_time, str(part)], check=True)
    else:
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
            bpy.ops.screen.screenshot(filepath=str(part))
    part.replace(path)
    return path.read_bytes()


def run(step: Callable[[], float]) -> float | None:
    try:
        return step()
    except StopIteration:
        pass
    except Exception:
        traceback.print_exc()
    bpy.ops.wm.quit_blender()
    return None


waits = steps()
bpy.app.timers.register(lambda: run(waits.__next__), first_interval=2.0)
