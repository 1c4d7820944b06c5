"""The command line, as a process of its own."""

import subprocess
import sys
from pathlib import Path

import bpy
from scenes import add_camera, add_sphere, new_scene, set_striped_world

import nested_dielectric as nd


def run(*arguments: object) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-m", "nested_dielectric", *map(str, arguments)], capture_output=True, text=True, check=False
    )


def assert_one_line(error: str, *words: str) -> None:
    lines = error.strip().splitlines()
    assert len(lines) == 1 and lines[0].startswith("nested-dielectric: error: ")
    assert all(word in lines[0] for word in words), lines[0]


def save_scene(folder: Path) -> Path:
    """Save a scene that still renders with EEVEE."""
    new_scene(24)
    set_striped_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=28)
    add_sphere("Glass", 1.0, nd.new_material("Glass", preset="glass"))
    bpy.context.scene.render.engine = "BLENDER_EEVEE"
    path = folder / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path
