"""Pictures of what overlaps: the glass of iced water, right and wrong, and the same meshes in other orders."""

from __future__ import annotations

from functools import partial
from math import radians

import bmesh
import bpy
import studio

import nested_dielectric as nd
from nested_dielectric.demo.iced_water import build_scene
from nested_dielectric.scene.materials import dielectric_node, medium_material
from nested_dielectric.scene.media import media

RED = {"transmittance": (0.85, 0.05, 0.03), "transmittance_depth": 0.8}
BLUE = {"transmittance": (0.05, 0.28, 0.75), "transmittance_depth": 0.8}
JUICE = {"transmittance": (0.95, 0.38, 0.05), "transmittance_depth": 1.0}
TUMBLER = (
    (0.0, 0.03, 0.0),
    (0.70, 0.03, 0.06),
    (0.78, 1.5, 0.03),
    (0.64, 1.5, 0.03),
    (0.58, 0.16, 0.08),
    (0.0, 0.16, 0.0),
)


def iced_water(size: int = 640, samples: int = 32) -> bpy.types.Scene:
    """The demo scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = build_scene()
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.cycles.samples = samples
    return scene


def plain_glass(size: int = 640, samples: int = 32) -> bpy.types.Scene:
    """The demo scene as Blender has it without the extension: Cycles' Glass of the same index on every body."""
    scene = iced_water(size, samples)
    for obj in media(scene):
        material = medium_material(obj)
        obj.active_material = bpy.data.materials.get(f"Plain {material.name}") or _glass(material)
    return scene


def _glass(material: bpy.types.Material) -> bpy.types.Material:
    ior = dielectric_node(material).inputs["IOR"].default_value
    glass = bpy.data.materials.new(f"Plain {material.name}")
    nodes, links = glass.node_tree.nodes, glass.node_tree.links
    shader = nodes.new("ShaderNodeBsdfGlass")
    shader.inputs["Roughness"].default_value = 0.0
    shader.inputs["IOR"].default_value = ior
    output = next(node for node in nodes if node.type == "OUTPUT_MATERIAL")
    links.new(shader.outputs["BSDF"], output.inputs["Surface"])
    return glass


def order(*places: str) -> bpy.types.Scene:
    """A clear ball with a red rod and a blue one through it; ``places`` names them as they win."""
    scene = studio.new_scene(320, 300, samples=32)
    red, blue = ((-0.95, -0.12, 0.36), (0.95, 0.12, 1.18)), ((0.95, -0.12, 0.36), (-0.95, 0.12, 1.18))
    studio.medium("Red", studio.rod(*red, 0.2), "glass", places.index("red"), **RED)
    studio.medium("Blue", studio.rod(*blue, 0.2), "glass", places.index("blue"), **BLUE)
    studio.medium("Ball", studio.ball((0.0, 0.0, 0.72), 0.66), "water", places.index("ball"))
    _room()
    studio.camera((0.0, -4.4, 1.5), (0.0, 0.0, 0.70), lens=58.0)
    return scene


def _room() -> None:
    studio.floor()
    studio.wall()
    studio.softbox((-2.6, -1.2, 3.6), (0.0, 0.0, 0.6), 230.0, size=2.4)
    studio.softbox((3.4, 1.5, 2.2), (0.0, 0.0, 0.6), 120.0, size=1.6, colour=studio.WARM)


def overlap(by: float) -> bpy.types.Scene:
    """A tumbler of juice that reaches into the glass by so much, or leaves a gap where that is negative."""
    scene = studio.new_scene(320, 320, samples=32)
    studio.medium("Glass", studio.turned(TUMBLER), "glass")
    corners = ((0.0, 0.16 - by, 0.0), (0.58 + by, 0.16 - by, 0.08), (0.62 + by, 1.05, 0.01), (0.0, 1.05, 0.0))
    studio.medium("Juice", studio.turned(corners), "water", **JUICE)
    _room()
    studio.camera((0.0, -4.6, 1.9), (0.0, 0.0, 0.82), lens=58.0)
    return scene


def red_wine() -> bpy.types.Scene:
    """What the five-minute start builds on Blender's default scene, number by number."""
    bpy.ops.wm.read_factory_settings()
    scene = bpy.context.scene
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    bpy.ops.mesh.primitive_cylinder_add(vertices=64, radius=1.0, depth=3.0)
    glass = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_mode(type="FACE")
    shape = bmesh.from_edit_mesh(glass.data)
    for face in shape.faces:
        face.select_set(face.normal.z > 0.9)
    bpy.ops.mesh.inset(thickness=0.1)
    bpy.ops.mesh.extrude_region_shrink_fatten(TRANSFORM_OT_shrink_fatten={"value": -2.8})
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.object.shade_auto_smooth()
    bpy.ops.mesh.primitive_cylinder_add(vertices=64, radius=0.92, depth=1.9, location=(0.0, 0.0, -0.37))
    wine = bpy.context.object
    bpy.ops.object.shade_auto_smooth()
    bpy.ops.mesh.primitive_cube_add(size=0.7, location=(0.3, 0.0, 0.55), rotation=(radians(17.0), radians(23.0), 0.0))
    ice = bpy.context.object
    bpy.ops.mesh.primitive_plane_add(size=100.0, location=(0.0, 0.0, -1.52))
    for obj, preset in ((glass, "glass"), (wine, "wine_red"), (ice, "ice")):
        nd.assign(obj, preset)
    world = scene.world.node_tree
    background = next(node for node in world.nodes if node.type == "BACKGROUND")
    world.links.new(world.nodes.new("ShaderNodeTexSky").outputs["Color"], background.inputs["Color"])
    background.inputs["Strength"].default_value = 0.12
    scene.render.resolution_percentage = 34
    scene.cycles.samples = 64
    return scene


PICTURES = {
    "iced_water": (1, {"": iced_water}),
    "wrong_right": (
        2,
        {
            "Cycles' Glass on the same meshes": partial(plain_glass, 420, 28),
            "Nested Dielectric": partial(iced_water, 420, 28),
        },
    ),
    "priorities": (
        3,
        {
            "Ball 0, red 1, blue 2": partial(order, "ball", "red", "blue"),
            "Red 0, ball 1, blue 2": partial(order, "red", "ball", "blue"),
            "Red 0, blue 1, ball 2": partial(order, "red", "blue", "ball"),
        },
    ),
    "overlap": (
        2,
        {
            "Too small: a film of air shows": partial(overlap, -0.02),
            "Overlapping: juice against glass": partial(overlap, 0.02),
        },
    ),
    "red_wine": (1, {"": red_wine}),
}
