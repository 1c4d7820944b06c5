"""Glass with water and a bubble in it."""

from scenes import add_camera, add_sphere, new_scene, set_striped_world

import nested_dielectric as nd


def build_scene() -> None:
    new_scene(48)
    add_content()


def add_content() -> None:
    set_striped_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=28)
    tint = {"transmittance": (0.9, 0.5, 0.3), "transmittance_depth": 0.8}
    add_sphere("Glass", 1.0, nd.new_material("Glass", preset="glass", **tint), 2)
    add_sphere("Water", 0.7, nd.new_material("Water", preset="water"), 1, (0.5, -0.2, 0.1))
    add_sphere("Bubble", 0.3, nd.new_material("Bubble", preset="air_bubble"), None, (0.2, -0.1, 0.0))
