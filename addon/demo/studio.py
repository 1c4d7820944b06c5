"""The studio that the demo is photographed in. One unit is 10 cm."""

from __future__ import annotations

from math import radians

import bpy
from mathutils import Vector

from .glassware import smooth_mesh
from .surfaces import first_node, oak_material

SUN_FROM = Vector((-0.5, 0.8, 0.85))
"""Direction towards the sun."""

SUN_ANGLE = radians(8.0)
"""Apparent diameter: softer than the real sun, so that few samples find the caustics."""

GLOW_DIRECTION = Vector((-0.3, 1.0, -0.1))
"""Direction towards the glow of the world."""

GLOW_RADIUS = 0.58
"""Reach of the glow on the unit sphere of directions."""


def add_object(scene: bpy.types.Scene, name: str, data: bpy.types.ID | None) -> bpy.types.Object:
    """Return a new object of a scene."""
    obj = bpy.data.objects.new(name, data)
    scene.collection.objects.link(obj)
    return obj


def add_table(scene: bpy.types.Scene) -> None:
    """Give a scene a table of oak, whose top is the plane z = 0."""
    mesh = smooth_mesh("Table", [(-9, -7, 0), (9, -7, 0), (9, 2.6, 0), (-9, 2.6, 0)], [(0, 1, 2, 3)])
    mesh.materials.append(oak_material())
    add_object(scene, "Table", mesh)


def add_light(scene: bpy.types.Scene) -> None:
    """Give a scene a low sun, a softbox and a world."""
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy = 8.5
    sun.angle = SUN_ANGLE
    sun.color = (1.0, 0.84, 0.64)
    obj = add_object(scene, "Sun", sun)
    obj.rotation_euler = SUN_FROM.to_track_quat("Z", "Y").to_euler()

    soft = bpy.data.lights.new("Softbox", "AREA")
    soft.shape = "RECTANGLE"
    soft.size, soft.size_y = 2.0, 4.0
    soft.energy = 190.0
    soft.color = (0.9, 0.95, 1.0)
    obj = add_object(scene, "Softbox", soft)
    obj.location = (3.6, -0.6, 2.4)
    obj.rotation_euler = (obj.location - Vector((0.0, 0.0, 0.4))).to_track_quat("Z", "Y").to_euler()

    scene.world = _backdrop()


def _backdrop() -> bpy.types.World:
    """Return a world like a dusky room with a wide glow behind the table: the field that glass edges stand dark against."""
    world = bpy.data.worlds.new("Iced Water")
    nodes, links = world.node_tree.nodes, world.node_tree.links
    glow = nodes.new("ShaderNodeTexGradient")
    glow.gradient_type = "QUADRATIC_SPHERE"
    mapping = nodes.new("ShaderNodeMapping")
    mapping.vector_type = "POINT"
    mapping.inputs["Location"].default_value = -GLOW_DIRECTION.normalized() / GLOW_RADIUS
    mapping.inputs["Scale"].default_value = (1.0 / GLOW_RADIUS,) * 3
    links.new(nodes.new("ShaderNodeTexCoord").outputs["Generated"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], glow.inputs["Vector"])
    ramp = nodes.new("ShaderNodeValToRGB")
    ramp.color_ramp.elements[0].color = (0.010, 0.040, 0.056, 1.0)
    ramp.color_ramp.elements[1].color = (1.0, 0.83, 0.62, 1.0)
    links.new(glow.outputs["Fac"], ramp.inputs["Fac"])
    background = first_node(world.node_tree, "BACKGROUND")
    background.inputs["Strength"].default_value = 1.3
    links.new(ramp.outputs["Color"], background.inputs["Color"])
    return world


def add_camera(scene: bpy.types.Scene, focus: Vector) -> None:
    """Give a scene its camera.

    :param focus: the point where the picture is sharp.
    """
    camera = bpy.data.cameras.new("Camera")
    camera.lens = 72.0
    obj = add_object(scene, "Camera", camera)
    obj.location = (0.0, -4.3, 1.75)
    target = Vector((0.12, 0.0, 0.49))
    obj.rotation_euler = (obj.location - target).to_track_quat("Z", "Y").to_euler()
    camera.dof.use_dof = True
    camera.dof.focus_distance = (obj.location - focus).length
    camera.dof.aperture_fstop = 1.4
    scene.camera = obj


def set_render(scene: bpy.types.Scene) -> None:
    """Set a scene to 720 x 720 pixels and to paths that find the sun through glass: unblurred, unclamped and guided."""
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = 720
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "AgX"
    scene.view_settings.look = "AgX - Medium High Contrast"
    cycles = scene.cycles
    cycles.samples = 24
    cycles.use_adaptive_sampling = False
    cycles.diffuse_bounces = 1
    cycles.blur_glossy = 0.0
    cycles.sample_clamp_indirect = 0.0
    cycles.use_guiding = True
    cycles.use_deterministic_guiding = True
    cycles.guiding_training_samples = 24
    cycles.use_denoising = True
    cycles.denoiser = "OPENIMAGEDENOISE"
