"""Scenes to be written to files: one that takes no time, and one that takes hours."""

from pathlib import Path

import bpy
from scenes import add_camera, add_sphere, new_scene, set_striped_world

import nested_dielectric as nd
from nested_dielectric.scene.output import save_blend
from nested_dielectric.scene.passes import file_outputs


def stripes(resolution: int = 32) -> bpy.types.Scene:
    """A scene that takes no time."""
    scene = new_scene(resolution)
    set_striped_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=28)
    scene.cycles.samples = 1
    return scene


def with_passes(folder: Path, scene: bpy.types.Scene) -> bpy.types.CompositorNodeOutputFile:
    add_sphere("Ball", 1.0, nd.new_material("Glass"))
    scene.render.filepath = f"{folder}/{{blend_name}}/shot_####.png"
    nd.add_passes(scene)
    (writer,) = file_outputs(scene)
    return writer


def save_long_file(folder: Path) -> Path:
    """Save a scene that renders for hours."""
    scene = stripes(64)
    add_sphere("Glass", 1.0, nd.new_material("Glass", preset="glass"))
    scene.cycles.samples = 10_000_000
    path = folder / "scene.blend"
    save_blend(path)
    return path
