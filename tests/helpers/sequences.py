"""A ball that sinks into water frame by frame, and `render` on it in this process."""

import json
from pathlib import Path

import bpy
from cut import key
from scenes import add_box, add_camera, add_sphere, new_scene, set_striped_world

import nested_dielectric as nd
from nested_dielectric import cli


def save_sinking_ball(folder: Path, resolution: int = 24) -> Path:
    """Save a scene whose frame 1 is the current one; on frame 1 the ball is out of the water, from frame 3 on it crosses it."""
    scene = new_scene(resolution, with_group=True)
    set_striped_world()
    add_box("Water", (-1, -1, -1), (1, 1, 0), nd.new_material("Water", preset="water"))
    ball = add_sphere("Ball", 0.5, nd.new_material("Glass", preset="glass"))
    key(ball, "location", (0.0, 0.0, 0.9), (0.1, 0.2, 0.1))
    add_camera((0.1, -5, 0.4), (0, 0, 0), angle=28)
    scene.cycles.samples = 4
    scene.frame_set(1)
    path = folder / "ball.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def render(file: Path, output: Path, *arguments: object) -> int:
    """Run `render` in this process and return its exit code."""
    return cli.main(["render", str(file), "-o", str(output), *map(str, arguments)])


def report_of(text: str) -> dict:
    """Read the JSON that `render` wrote, which is all that there may be."""
    return json.loads(text)
