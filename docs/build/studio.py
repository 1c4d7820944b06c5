"""The room that the manual's pictures are taken in: a tiled floor, a soft box, a wall that goes from dark to light.

One unit is 10 cm. Objects become media by ``nd.assign()`` and scenes ready by ``nd.prepare()``, as with the buttons.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import bmesh
import bpy
from mathutils import Matrix, Vector

import nested_dielectric as nd
from nested_dielectric.demo.glassware import lathe, rounded

Colour = tuple[float, float, float]

WARM: Colour = (1.0, 0.86, 0.70)
COOL: Colour = (0.80, 0.90, 1.0)
GREY: Colour = (0.5, 0.5, 0.5)


def new_scene(width: int, height: int, samples: int) -> bpy.types.Scene:
    """Empty the file and return its scene, with settings for a small, denoised picture."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "AgX"
    scene.view_settings.look = "AgX - Medium High Contrast"
    cycles = scene.cycles
    cycles.samples = samples
    cycles.use_adaptive_sampling = False
    cycles.diffuse_bounces = 2
    cycles.blur_glossy = 0.0
    cycles.sample_clamp_indirect = 10.0
    cycles.caustics_reflective = cycles.caustics_refractive = False
    cycles.use_denoising = True
    cycles.denoiser = "OPENIMAGEDENOISE"
    return scene


# Objects ------------------------------------------------------------------------------------------------------------


def add(name: str, data: bpy.types.ID | None) -> bpy.types.Object:
    """Put an object into the scene."""
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def medium(
    name: str, mesh: bpy.types.Mesh, preset: str, priority: int | None = None, **values: Any
) -> bpy.types.Object:
    """Put a medium into the scene: a mesh, a preset and what differs from it."""
    obj = add(name, mesh)
    nd.assign(obj, nd.new_material(name, preset=preset, **values), priority)
    return obj


def smooth(mesh: bpy.types.Mesh, angle: float | None = None) -> bpy.types.Mesh:
    """Shade a mesh smoothly, but for edges sharper than an angle in radians."""
    mesh.shade_smooth()
    if angle is not None:
        mesh.set_sharp_from_angle(angle=angle)
    return mesh


def _mesh(name: str, build: Callable[[bmesh.types.BMesh], None]) -> bpy.types.Mesh:
    shape = bmesh.new()
    build(shape)
    mesh = bpy.data.meshes.new(name)
    shape.to_mesh(mesh)
    shape.free()
    return mesh


def ball(centre: Sequence[float], radius: float) -> bpy.types.Mesh:
    """Return a sphere."""
    place = Matrix.Translation(centre)

    def build(shape: bmesh.types.BMesh) -> None:
        bmesh.ops.create_icosphere(shape, subdivisions=6, radius=radius, matrix=place)

    return smooth(_mesh("Ball", build))


def rod(start: Sequence[float], end: Sequence[float], radius: float) -> bpy.types.Mesh:
    """Return a closed cylinder from one point to another."""
    start, end = Vector(start), Vector(end)
    turn = (end - start).to_track_quat("Z", "Y").to_matrix().to_4x4()
    place = Matrix.Translation((start + end) / 2.0) @ turn
    depth = (end - start).length

    def build(shape: bmesh.types.BMesh) -> None:
        bmesh.ops.create_cone(
            shape, cap_ends=True, segments=96, radius1=radius, radius2=radius, depth=depth, matrix=place
        )
        rims = [edge for edge in shape.edges if len(edge.link_faces) == 2 and edge.calc_face_angle() > 1.0]
        bmesh.ops.bevel(shape, geom=rims, offset=radius * 0.15, segments=4, profile=0.5, affect="EDGES")

    return smooth(_mesh("Rod", build), 0.6)


def box(centre: Sequence[float], size: Sequence[float], bevel: float) -> bpy.types.Mesh:
    """Return a block with rounded edges."""
    place = Matrix.LocRotScale(Vector(centre), None, Vector(size))

    def build(shape: bmesh.types.BMesh) -> None:
        bmesh.ops.create_cube(shape, size=1.0, matrix=place)
        bmesh.ops.bevel(shape, geom=list(shape.edges), offset=bevel, segments=6, profile=0.5, affect="EDGES")

    return smooth(_mesh("Box", build))


def column(outline: Sequence[tuple[float, float]], low: float, high: float) -> bpy.types.Mesh:
    """Return an upright body of flat faces from an outline of (x, y), counted anticlockwise."""
    count = len(outline)
    mesh = bpy.data.meshes.new("Column")
    vertices = [(x, y, z) for z in (low, high) for x, y in outline]
    sides = [(i, (i + 1) % count, (i + 1) % count + count, i + count) for i in range(count)]
    mesh.from_pydata(vertices, [], [tuple(reversed(range(count))), tuple(range(count, 2 * count)), *sides])
    return mesh


def turned(corners: Iterable[tuple[float, float, float]]) -> bpy.types.Mesh:
    """Return the body that corners (radius, height, rounding) make turned around Z, outside on their right hand."""
    return lathe(rounded(tuple(corners)))


# Room ---------------------------------------------------------------------------------------------------------------


def surface(name: str, colour: Colour, roughness: float) -> bpy.types.Material:
    """Return a material that is no medium."""
    material = bpy.data.materials.new(name)
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (*colour, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    return material


def floor(light: Colour = (0.62, 0.60, 0.57), dark: Colour = (0.36, 0.37, 0.39), tile: float = 0.5) -> bpy.types.Object:
    """Lay a floor of two kinds of tiles, to see through what stands on it."""
    mesh = bpy.data.meshes.new("Floor")
    mesh.from_pydata([(-12, -12, 0), (12, -12, 0), (12, 7, 0), (-12, 7, 0)], [], [(0, 1, 2, 3)])
    material = surface("Tiles", GREY, 0.6)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Specular IOR Level"].default_value = 0.0
    checker = nodes.new("ShaderNodeTexChecker")
    checker.inputs["Color1"].default_value = (*light, 1.0)
    checker.inputs["Color2"].default_value = (*dark, 1.0)
    checker.inputs["Scale"].default_value = 1.0 / tile
    mapping = nodes.new("ShaderNodeMapping")
    mapping.inputs["Rotation"].default_value = (0.0, 0.0, 0.5)
    mapping.inputs["Location"].default_value = (0.0, 0.0, 0.1)
    links.new(nodes.new("ShaderNodeTexCoord").outputs["Object"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], checker.inputs["Vector"])
    links.new(checker.outputs["Color"], shader.inputs["Base Color"])
    mesh.materials.append(material)
    return add("Floor", mesh)


def wall(strength: float = 0.9) -> bpy.types.World:
    """Surround the scene with a wall that is light behind it and dark at the sides and above."""
    world = bpy.data.worlds.new("Wall")
    bpy.context.scene.world = world
    nodes, links = world.node_tree.nodes, world.node_tree.links
    glow = nodes.new("ShaderNodeTexGradient")
    glow.gradient_type = "QUADRATIC_SPHERE"
    mapping = nodes.new("ShaderNodeMapping")
    mapping.inputs["Location"].default_value = -Vector((-0.35, 1.0, 0.12)).normalized()
    ramp = nodes.new("ShaderNodeValToRGB")
    ramp.color_ramp.elements[0].color = (0.015, 0.03, 0.045, 1.0)
    ramp.color_ramp.elements[1].color = (0.95, 0.9, 0.82, 1.0)
    ramp.color_ramp.elements[1].position = 0.9
    background = next(node for node in nodes if node.type == "BACKGROUND")
    background.inputs["Strength"].default_value = strength
    links.new(nodes.new("ShaderNodeTexCoord").outputs["Generated"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], glow.inputs["Vector"])
    links.new(glow.outputs["Fac"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], background.inputs["Color"])
    return world


def plain_world(colour: Colour, strength: float) -> bpy.types.World:
    """Surround the scene with one colour."""
    world = bpy.data.worlds.new("Plain")
    bpy.context.scene.world = world
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (*colour, 1.0)
    background.inputs["Strength"].default_value = strength
    return world


def softbox(
    place: Sequence[float], target: Sequence[float], power: float, size: float, colour: Colour = COOL
) -> bpy.types.Object:
    """Hang up a square lamp."""
    light = bpy.data.lights.new("Softbox", "AREA")
    light.shape = "SQUARE"
    light.size = size
    light.energy = power
    light.color = colour
    lamp = add("Softbox", light)
    lamp.location = place
    lamp.rotation_euler = (lamp.location - Vector(target)).to_track_quat("Z", "Y").to_euler()
    return lamp


def sun(towards: Sequence[float], strength: float) -> bpy.types.Object:
    """Let the sun shine from a direction, somewhat larger than the real one."""
    light = bpy.data.lights.new("Sun", "SUN")
    light.energy = strength
    light.angle = 0.05
    light.color = WARM
    lamp = add("Sun", light)
    lamp.rotation_euler = Vector(towards).to_track_quat("Z", "Y").to_euler()
    return lamp


def camera(place: Sequence[float], target: Sequence[float], lens: float) -> bpy.types.Object:
    """Aim the scene's camera."""
    obj = add("Camera", bpy.data.cameras.new("Camera"))
    obj.data.lens = lens
    obj.location = place
    obj.rotation_euler = (obj.location - Vector(target)).to_track_quat("Z", "Y").to_euler()
    bpy.context.scene.camera = obj
    return obj
