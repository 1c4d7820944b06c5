"""A ball in front of stripes, and lights that shine on it."""

import bpy
from scenes import add, add_camera, add_sphere, new_scene, set_striped_world

import nested_dielectric as nd


def add_light(location, **visibility):
    """An area light that shines on the middle of the scene."""
    light = bpy.data.lights.new("Lamp", "AREA")
    light.energy = 300.0
    light = add("Lamp", light, location)
    light.rotation_euler = (-light.location).to_track_quat("-Z", "Y").to_euler()
    for attribute, value in visibility.items():
        setattr(light, attribute, value)
    return light


def glass_before_stripes(resolution=16):
    """A camera that sees nothing but a rough glass sphere in a striped world."""
    scene = new_scene(resolution, with_group=True)
    set_striped_world()
    add_sphere("Ball", 1.0, nd.new_material("Glass", ior=1.5, roughness=0.3, shadow_mode="BLACK"))
    add_camera((0.1, -5, 0.3), (0.03, 0, 0.02), width=1.2)
    return scene
