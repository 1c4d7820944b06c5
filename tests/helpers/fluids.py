"""A bead that lies still, and a liquid that scripts move through it."""

from collections.abc import Callable

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
from mathutils import Matrix
from scenes import add_camera, add_mesh, add_sphere, new_scene, set_striped_world

import nested_dielectric as nd

FRAMES = (1, 2, 3)

# The same samples meet the same surfaces; only the last bits of sums may differ, and where those decide, single samples.
SAME = 1e-3


def differs(picture: np.ndarray, other: np.ndarray) -> float:
    return float(np.sqrt(((picture - other) ** 2).mean()))


def build_scene() -> bpy.types.Scene:
    """A bead that lies still, and a liquid that scripts move through it."""
    scene = new_scene(24, with_group=True)
    set_striped_world()
    add_sphere("Bead", 0.5, nd.new_material("Glass", ior=1.5), 1)
    fluid = add_mesh("Fluid", sphere(-2.0), nd.new_material("Water", ior=1.33), 2)
    fluid.location.x = 0.0
    add_camera((0.1, -8, 0.3), (0.05, 0, 0), angle=26)
    scene.frame_start, scene.frame_end = FRAMES[0], FRAMES[-1]
    scene.cycles.samples = 16
    return scene


def sphere(x: float) -> Callable[[bmesh.types.BMesh], None]:
    def build(bm: bmesh.types.BMesh) -> None:
        bmesh.ops.create_icosphere(bm, subdivisions=3, radius=0.9, matrix=Matrix.Translation((x, 0.0, 0.0)))

    return build


def place(scene: bpy.types.Scene) -> float:
    return -2.0 + 0.9 * (scene.frame_current - 1)


@bpy.app.handlers.persistent
def move_object(scene: bpy.types.Scene, *_: object) -> None:
    bpy.data.objects["Fluid"].location.x = place(scene) + 2.0


@bpy.app.handlers.persistent
def change_the_index(scene: bpy.types.Scene, *_: object) -> None:
    bpy.data.objects["Fluid"].location.x = 2.1
    inputs = bpy.data.materials["Water"].node_tree.nodes["Nested Dielectric"].inputs
    inputs["IOR"].default_value = 1.2 + 0.1 * scene.frame_current
