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
import numpy as np

package, folder, *shadings = sys.argv[sys.argv.index("--") + 1 :]
sys.path.insert(0, package)

SAMPLES = 12
"""Of viewports."""

SAME = 4
"""Pictures of a window that are the same one after another: nothing is drawn any more."""

MOST = 240
"""Pictures after which one of them has to do."""

SECONDS = 1.0
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
            same = same + 1 if last is not None and np.array_equal(last, picture) else 0
            if same == SAME:
                break
            last = picture
            yield SECONDS


def viewports() -> Iterator[bpy.types.SpaceView3D]:
    window = bpy.context.window_manager.windows[0]
    return (area.spaces.active for area in window.screen.areas if area.type == "VIEW_3D")


def take(path: Path) -> np.ndarray:
    """Save a picture of the screen, and return its pixels. On virtual screens Blender's own pictures may be black: ImageMagick's
    are taken where it is there.
    """
    if shutil.which("import") and "DISPLAY" in os.environ:
        subprocess.run(["import", "-window", "root", str(path)], check=True)
    else:
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
            bpy.ops.screen.screenshot(filepath=str(path))
    image = bpy.data.images.load(str(path))
    pixels = np.zeros(len(image.pixels), dtype=np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels


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
