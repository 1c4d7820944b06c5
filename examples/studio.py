"""The studio of a product shot: a backdrop without a horizon, softboxes and a camera, on a rig that turns.

The studio turns round the product, so that media stand still and are cut once. Lengths are in metres.
"""

from __future__ import annotations

from math import cos, pi, sin
from types import SimpleNamespace

import bpy
import numpy as np
from bodies import MM
from mathutils import Vector

SOFTBOXES = (
    ((-2.6, 0.2, 1.4), 0.8, 3.0),
    ((2.4, 1.2, 1.2), 0.5, 3.0),
    ((0.0, 0.3, 3.6), 2.4, 1.6),
)
"""Place, width and height of each, the vessel's height being 1: at the left, at the right and above."""


def add(name: str, data: bpy.types.ID | None, parent: bpy.types.Object | None = None) -> bpy.types.Object:
    """Put an object into the scene."""
    obj = bpy.data.objects.new(name, data)
    obj.parent = parent
    bpy.context.scene.collection.objects.link(obj)
    return obj


def glow(material: bpy.types.Material, centre: Vector, reach: float, colour: list[float], strength: float) -> None:
    """Let a material shine in a colour, brightest at a point of its object and fading to nothing at a distance."""
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    distance = nodes.new("ShaderNodeVectorMath")
    distance.operation = "DISTANCE"
    distance.inputs[1].default_value = centre
    fade = nodes.new("ShaderNodeMapRange")
    fade.interpolation_type = "SMOOTHERSTEP"
    fade.inputs["From Max"].default_value = reach
    fade.inputs["To Min"].default_value, fade.inputs["To Max"].default_value = strength, 0.0
    links.new(nodes.new("ShaderNodeTexCoord").outputs["Object"], distance.inputs[0])
    links.new(distance.outputs["Value"], fade.inputs["Value"])
    links.new(fade.outputs["Result"], shader.inputs["Emission Strength"])
    shader.inputs["Emission Color"].default_value = (*colour, 1.0)


def surface(name: str, colour: list[float], roughness: float) -> bpy.types.Material:
    """Return a material of something that is no medium."""
    material = bpy.data.materials.new(name)
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (*colour, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    return material


def add_backdrop(size: float, distance: float, light: SimpleNamespace, rig: bpy.types.Object) -> None:
    """Hang up a sheet that is table in front and wall behind, without a horizon, with a glow behind the product."""
    bend = [(3 + 2 * sin(angle), 2 - 2 * cos(angle)) for angle in np.linspace(0, pi / 2, 24)]
    side = [(-1.5 * max(5, distance / size), 0), (0, 0), *bend, (5, 12)]
    vertices = [(x * size, y * size, z * size) for x in (-12, 12) for y, z in side]
    faces = [(i, i + len(side), i + len(side) + 1, i + 1) for i in range(len(side) - 1)]
    sheet = bpy.data.meshes.new("Backdrop")
    sheet.from_pydata(vertices, [], faces)
    sheet.shade_smooth()
    material = surface("Backdrop", [0.12 * channel for channel in light.backdrop], 0.3)
    glow(material, Vector((0, 5, 0.9)) * size, 3.4 * size, light.backdrop, 4 * light.glow)
    material.cycles.emission_sampling = "NONE"  # so wide that rays find it by themselves
    sheet.materials.append(material)
    add("Backdrop", sheet, rig)


def add_softbox(
    place: Vector, aim: Vector, width: float, height: float, strength: float, rig: bpy.types.Object
) -> None:
    """Put up a panel that shines towards a point, brightest in its middle, so that glass mirrors it with soft edges."""
    mesh = bpy.data.meshes.new("Softbox")
    corners = [(-width, -height, 0), (width, -height, 0), (width, height, 0), (-width, height, 0)]
    mesh.from_pydata([(x / 2, y / 2, z) for x, y, z in corners], [], [(0, 1, 2, 3)])
    material = surface("Softbox", [0, 0, 0], 1.0)
    glow(material, Vector(), 0.62 * max(width, height), [1, 1, 1], strength)
    mesh.materials.append(material)
    panel = add("Softbox", mesh, rig)
    panel.location = place
    panel.rotation_euler = (aim - place).to_track_quat("Z", "Y").to_euler()
    panel.visible_camera = False


def add_studio(shot: SimpleNamespace) -> None:
    """Put backdrop, softboxes and camera on a rig, around a vessel that they are as large for as it is high."""
    size = max(height for _, height, _ in shot.vessel.outside) * MM
    middle = Vector((0, 0, 0.5 * size))
    rig = add("Studio", None)
    add_backdrop(size, shot.camera.distance * MM, shot.light, rig)
    for place, width, height in SOFTBOXES:
        add_softbox(Vector(place) * size, middle, width * size, height * size, 16 * shot.light.softboxes, rig)
    add_camera(shot.camera, middle if shot.camera.aim is None else Vector((0, 0, shot.camera.aim * MM)), rig)
    world = bpy.data.worlds.new("Dark")
    next(node for node in world.node_tree.nodes if node.type == "BACKGROUND").inputs["Strength"].default_value = 0.0
    bpy.context.scene.world = world


def add_camera(camera: SimpleNamespace, aim: Vector, rig: bpy.types.Object) -> None:
    """Put the camera on the rig, and let the rig turn once in the frames of the shot."""
    data = bpy.data.cameras.new("Camera")
    data.lens = camera.focal_length
    data.clip_start = 0.01
    obj = add("Camera", data, rig)
    obj.location = (0, -camera.distance * MM, camera.height * MM)
    obj.rotation_euler = (obj.location - aim).to_track_quat("Z", "Y").to_euler()
    scene = bpy.context.scene
    scene.camera = obj
    scene.frame_start, scene.frame_end = 1, camera.frames
    # Blender computes this without Python, so it turns where scripts in files may not run.
    driver = rig.driver_add("rotation_euler", 2).driver
    driver.expression = f"{2 * pi!r} * (frame - 1) / {camera.frames}"


def set_render(render: SimpleNamespace) -> None:
    """Set what the picture is made with: light through glass neither blurred nor clamped, and noise taken out."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = render.resolution
    scene.render.resolution_percentage = 100
    scene.render.use_persistent_data = True  # what does not move is kept from frame to frame
    scene.view_settings.view_transform = "AgX"
    scene.view_settings.look = "AgX - High Contrast"
    cycles = scene.cycles
    cycles.samples = render.samples
    cycles.use_adaptive_sampling = False
    cycles.diffuse_bounces = 2
    cycles.blur_glossy = 0.0
    cycles.sample_clamp_indirect = 0.0
    cycles.use_denoising = True
