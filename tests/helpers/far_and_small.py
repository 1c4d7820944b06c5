"""Scenes whose picture does not depend on how large they are, where they are, or how far media reach into each other."""

from __future__ import annotations

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
from random_bodies import OUTSIDE, add_body, own_glass, stage
from random_media import Body, Medium, Place
from scenes import add, add_camera, add_mesh, add_sphere, cycles_glass

import nested_dielectric as nd

GLASS, WATER, BUBBLE = Medium(1.5), Medium(1.33), Medium(1.0)

DRINK = (
    Body("vessel", 1, Place(rotation=(0.3, 0.2, 0.1))),
    Body("box", 2, Place((0.05, 0.03, -0.1), (0.4, 0.1, 0.2), (0.5, 0.45, 0.55))),
    Body("ball", 0, Place((0.2, -0.1, 0.1), scale=(0.4, 0.4, 0.4))),
)
"""A tumbler, what crosses its wall, and a bubble in both."""


def drink(size: float = 1.0, offset=(0.0, 0.0, 0.0), glass: bool = False) -> bpy.types.Scene:
    """Three media that cross, so much larger, so far from the origin; the camera moves with them."""
    scene = stage()
    frame = add("Frame", None, offset)
    frame.scale = (size, size, size)
    # A camera that has a scale of its own would see otherwise, so it is placed by hand.
    bpy.data.objects.remove(scene.camera)
    location, target, angle = OUTSIDE
    placed = [[size * value + start for value, start in zip(point, offset)] for point in (location, target)]
    camera = add_camera(*placed, angle=angle)
    camera.data.clip_start, camera.data.clip_end = 1e-3 * size, 1e3 * size
    for index, body in enumerate(DRINK):
        medium = (BUBBLE, GLASS, WATER)[body.medium]
        if glass:
            material = own_glass(index, medium)
        else:
            material = nd.new_material(f"Medium {index}", ior=medium.ior, priority=body.medium)
        add_body(f"Body {index}", body, material).parent = frame
    bpy.context.view_layer.update()
    return scene


def overlapping_blocks(depth: float) -> bpy.types.Scene:
    """Water that stands on glass and reaches into it by `depth`, where the glass wins: none of that shows."""
    scene = stage()
    turn = (0.13, 0.21, 0.4)
    for name, ior, priority, low, high in (
        ("Glass", 1.5, 0, (-1.1, -1.1, -0.8), (1.1, 1.1, -0.1)),
        ("Water", 1.33, 1, (-0.8, -0.7, -0.1 - depth), (0.7, 0.8, 0.9)),
    ):
        middle = [(a + b) / 2.0 for a, b in zip(low, high)]
        half = [(b - a) / 2.0 for a, b in zip(low, high)]
        add_body(name, Body("box", 0, Place(middle, scale=half), Place(rotation=turn)), _nested(name, ior, priority))
    bpy.context.view_layer.update()
    return scene


def _nested(name: str, ior: float, priority: int) -> bpy.types.Material:
    return nd.new_material(name, ior=ior, priority=priority)


def thin_walled(thickness: float, kind: str) -> bpy.types.Scene:
    """A flat-shaded ball of glass with water in it to the middle of its wall.

    :param kind: "nested", of our media; "split", its interfaces by hand in Cycles' own Glass; "naive", Glass on the bodies as
        they are.
    """
    scene = stage()

    def ball(name: str, radius: float, material) -> bpy.types.Object:
        obj = add_sphere(name, radius, material, segments=32)
        obj.data.polygons.foreach_set("use_smooth", [False] * len(obj.data.polygons))
        return obj

    inner, middle = 1.0 - thickness, 1.0 - 0.5 * thickness
    if kind == "split":
        ball("Outside", 1.0, cycles_glass(1.5))
        ball("Inside", inner, cycles_glass(1.33 / 1.5))
        return scene
    nested = kind == "nested"

    def shell(bm: bmesh.types.BMesh) -> None:
        for radius in (1.0, inner):
            made = bmesh.ops.create_uvsphere(bm, u_segments=32, v_segments=16, radius=radius)
        bmesh.ops.reverse_faces(bm, faces=list({face for vertex in made["verts"] for face in vertex.link_faces}))

    add_mesh("Shell", shell, _nested("Glass", 1.5, 0) if nested else cycles_glass(1.5))
    ball("Water", middle, _nested("Water", 1.33, 1) if nested else cycles_glass(1.33))
    bpy.context.view_layer.update()
    return scene


def shells(count: int, kind: str) -> bpy.types.Scene:
    """Balls one in another, of two indices in turn; see :func:`thin_walled` for `kind`."""
    scene = stage()
    step = 0.9 / count
    materials = {}
    for index in range(count):
        ior = (1.5, 1.33)[index % 2]
        if kind == "split":
            ior /= (1.33, 1.5)[index % 2] if index else 1.0
        if kind == "nested":
            materials.setdefault(ior, nd.new_material(f"Index {ior}", ior=ior))
        else:
            materials.setdefault(ior, cycles_glass(ior))
        obj = add_sphere(f"Shell {index}", 1.2 - step * index, materials[ior], segments=24)
        obj.data.polygons.foreach_set("use_smooth", [False] * len(obj.data.polygons))
        if kind == "nested":
            nd.set_priority(obj, count - index)
    bpy.context.view_layer.update()
    return scene
