"""A ball of glass in a white world."""

import bpy  # before bmesh, which lives inside it
from scenes import add_camera, add_sphere, new_scene, set_world

import nested_dielectric as nd


def ball_in_furnace() -> bpy.types.Object:
    new_scene(16)
    set_world()
    add_camera((0, -5, 0), (0, 0, 0), angle=10)
    return add_sphere("Ball", 1.0, nd.new_material("Glass", preset="glass"))
