"""Processes of their own: the command line, and Blenders that render a saved file."""

import subprocess
import sys
from pathlib import Path

import numpy as np
from scenes import read_picture

RENDER = """
import bpy
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
bpy.context.scene.render.filepath = sys.argv[2]
bpy.ops.render.render(write_still=True)
"""
WITH_EXTENSION = "import sys\nimport nested_dielectric\nnested_dielectric.register()" + RENDER
WITHOUT_EXTENSION = 'import sys\nsys.modules["nested_dielectric"] = None  # any import of it fails' + RENDER


def render_in_fresh_process(program: str, file: Path, picture: Path) -> np.ndarray:
    """Blender orders objects by where they lie in memory, so only processes that do the same agree to the last bit."""
    subprocess.run([sys.executable, "-c", program, str(file), str(picture)], check=True, capture_output=True)
    return read_picture(picture)
