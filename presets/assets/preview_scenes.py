"""What previews of presets show: a body of the medium that holds another or stands in it, on a chequered ground.

One unit is 10 cm. Colours are fitted to the bodies, as they are wherever a preset is assigned.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations
from math import cos, pi, radians, sin, tan
from random import Random

import bmesh
import bpy
import numpy as np
from mathutils import Euler, Matrix, Vector

from nested_dielectric.demo import glassware
from nested_dielectric.model.presets import Preset
from nested_dielectric.scene.media import assign

CAMERA = Vector((0.0, -2.9, 1.55))
LIQUID_LEVEL = 0.7
GLASS, WATER, AIR = "glass", "water", "air_bubble"
"""Presets of what previewed media meet."""

CROWN, PAVILION, STAR = radians(34.5), radians(40.75), radians(23.0)
GIRDLE, TABLE = 0.05, 0.53
"""A round brilliant of Tolkowsky's proportions, of radius 1."""


def kind_of(preset: Preset) -> str:
    """Return which scene suits a preset."""
    words = {*preset.tags, *preset.name.lower().split()}
    if preset.group == "Water and Ice" and words & {"ice", "snow", "glacier", "icicle"}:
        return "ice"
    if preset.group == "Bubbles and Films":
        if not preset.parameters.get("thin_film_thickness"):
            return "air"
        if preset.parameters["ior"] > 1.1:
            return "puddle"
        return "bubble" if "bubble" in preset.name.lower() else "film"
    return {
        "Glass": "vessel",
        "Gems and Crystals": "gem",
        "Plastics and Resins": "block",
        "Laboratory Glass": "ball",
    }.get(preset.group, "drink")


def build(preset: Preset) -> bpy.types.Scene:
    """Fill an empty file with the scene of a preset's preview, and return it."""
    scene = bpy.context.scene
    _add_ground(scene)
    _add_light(scene)
    _add_camera(scene)
    _KINDS[kind_of(preset)](scene, preset.key)
    return scene


# Bodies ---------------------------------------------------------------------------------------------------------------


def _vessel(scene: bpy.types.Scene, key: str) -> None:
    _tumbler(scene, key, WATER)


def _drink(scene: bpy.types.Scene, key: str) -> None:
    _tumbler(scene, GLASS, key)


def _tumbler(scene: bpy.types.Scene, glass: str, liquid: str) -> None:
    """A straw stands in a liquid, which reaches into the glass that holds it."""
    profile = glassware.rounded(glassware.TUMBLER_OUTSIDE + glassware.TUMBLER_INSIDE)
    assign(_add(scene, "Tumbler", glassware.lathe(profile)), glass)
    _, (corner_r, corner_z, rounding), (_, floor, _) = glassware.TUMBLER_INSIDE
    grown = glassware.OVERLAP
    rim = glassware.inner_radius(LIQUID_LEVEL) + grown
    body = (
        (0.0, floor - grown, 0.0),
        (corner_r + grown, corner_z - grown, rounding + grown),
        (rim, LIQUID_LEVEL, 0.0),
        (0.0, LIQUID_LEVEL, 0.0),
    )
    assign(_add(scene, "Liquid", glassware.lathe(glassware.rounded(body))), liquid)
    straw = _add(scene, "Straw", glassware.straw_mesh())
    straw.matrix_world = (
        Matrix.Translation((-0.17, 0.05, 0.175)) @ Matrix.Rotation(radians(17), 4, "Y") @ Matrix.Scale(1.5, 4)
    )
    straw.scale.z = 0.95


def _ball(scene: bpy.types.Scene, key: str) -> None:
    """A ball with a bubble of air."""
    assign(_add(scene, "Ball", glassware.spheres([(Vector((0.0, 0.0, 0.52)), 0.52)])), key)
    assign(_add(scene, "Bubble", glassware.spheres([(Vector((0.16, -0.12, 0.66)), 0.14)])), AIR)


def _air(scene: bpy.types.Scene, key: str) -> None:
    """Bubbles in a ball of glass."""
    assign(_add(scene, "Ball", glassware.spheres([(Vector((0.0, 0.0, 0.52)), 0.52)])), GLASS)
    bubbles = [((0.0, 0.0, 0.55), 0.24), ((0.27, -0.1, 0.3), 0.1), ((-0.25, -0.1, 0.35), 0.07)]
    bubbles.append(((0.2, 0.0, 0.83), 0.06))
    assign(_add(scene, "Bubbles", glassware.spheres((Vector(place), radius) for place, radius in bubbles)), key)


def _bubble(scene: bpy.types.Scene, key: str) -> None:
    """A bubble in the air, and a small one that touches it."""
    _add_panel(scene, Vector((1.6, -3.4, 1.8)), Vector((0.0, 0.0, 0.5)))
    bubbles = [((-0.04, 0.0, 0.53), 0.5), ((0.42, -0.22, 0.2), 0.16)]
    assign(_add(scene, "Bubbles", glassware.spheres((Vector(place), radius) for place, radius in bubbles)), key)


def _film(scene: bpy.types.Scene, key: str) -> None:
    """A film in a ring that is held upright."""
    centre, panel = Vector((0.0, 0.0, 0.5)), Vector((-2.4, -1.4, 2.6))
    _add_panel(scene, panel, centre)
    half_way = (CAMERA - centre).normalized() + (panel - centre).normalized()
    turn = Matrix.Translation(centre) @ half_way.to_track_quat("Z", "Y").to_matrix().to_4x4()
    shape = bmesh.new()
    bmesh.ops.create_cone(shape, cap_ends=True, segments=128, radius1=0.46, radius2=0.46, depth=0.002)
    film = _add(scene, "Film", _mesh(shape))
    film.matrix_world = turn
    assign(film, key)
    ring = bpy.data.curves.new("Ring", "CURVE")
    ring.dimensions, ring.bevel_depth, ring.resolution_u = "3D", 0.03, 48
    spline = ring.splines.new("BEZIER")
    spline.bezier_points.add(3)
    for index, point in enumerate(spline.bezier_points):
        point.co = Matrix.Rotation(index * pi / 2.0, 3, "Z") @ Vector((0.46, 0.0, 0.0))
        point.handle_left_type = point.handle_right_type = "AUTO"
    spline.use_cyclic_u = True
    ring.materials.append(_matt("Ring", (0.62, 0.035, 0.03)))
    _add(scene, "Ring", ring).matrix_world = turn


def _puddle(scene: bpy.types.Scene, key: str) -> None:
    """A puddle with a ball of glass in it."""
    _add_panel(scene, Vector((0.2, 3.0, 2.0)), Vector((0.0, 0.0, 0.0)), 50.0)
    profile = ((0.0, 0.003, 0.0), (0.9, 0.003, 0.0), (0.96, 0.03, 0.012), (0.9, 0.055, 0.03), (0.0, 0.06, 0.0))
    puddle = _add(scene, "Puddle", glassware.lathe(glassware.rounded(profile)))
    puddle.scale = (1.0, 0.8, 1.0)
    assign(puddle, key)
    assign(_add(scene, "Ball", glassware.spheres([(Vector((0.1, 0.1, 0.27)), 0.26)])), GLASS)


def _block(scene: bpy.types.Scene, key: str) -> None:
    """A cube with rounded edges and a bubble of air."""
    shape = bmesh.new()
    bmesh.ops.create_cube(shape, size=0.78)
    bmesh.ops.bevel(shape, geom=shape.edges[:], offset=0.09, segments=8, profile=0.5, affect="EDGES")
    block = _add(scene, "Block", _mesh(shape, smooth=True))
    block.matrix_world = Matrix.Translation((0.0, 0.0, 0.392)) @ Matrix.Rotation(radians(32), 4, "Z")
    assign(block, key)
    assign(_add(scene, "Bubble", glassware.spheres([(Vector((0.08, -0.1, 0.47)), 0.13)])), AIR)


def _ice(scene: bpy.types.Scene, key: str) -> None:
    """A cube with bubbles in its heart, and a piece that leans on it."""
    for index, (place, turn, size) in enumerate(
        (((-0.1, 0.06, 0.36), (0.0, 0.0, 0.55), 2.55), ((0.42, -0.3, 0.175), (0.0, 0.0, 1.25), 1.25))
    ):
        cube = _add(scene, "Ice", glassware.ice_mesh(index + 1))
        cube.matrix_world = Matrix.LocRotScale(Vector(place), Euler(turn), Vector((size,) * 3))
        assign(cube, key)
    random = Random(3)
    bubbles = []
    for _ in range(22):
        place = Vector((random.gauss(-0.1, 0.09), random.gauss(0.06, 0.09), random.gauss(0.36, 0.1)))
        bubbles.append((place, 0.008 + 0.03 * random.random() ** 2))
    assign(_add(scene, "Bubbles", glassware.spheres(bubbles)), AIR)


def _gem(scene: bpy.types.Scene, key: str) -> None:
    """A round brilliant that lies on its side, in light from the front, which its facets send back."""
    _add_panel(scene, Vector((1.6, -3.6, 3.4)), Vector((0.0, 0.0, 0.4)), 320.0)
    gem = _add(scene, "Gem", brilliant())
    turn = Matrix.Rotation(radians(42), 4, "X") @ Matrix.Rotation(radians(8), 4, "Z") @ Matrix.Scale(0.56, 4)
    lowest = min((turn @ vertex.co).z for vertex in gem.data.vertices)
    gem.matrix_world = Matrix.Translation((0.0, 0.1, 0.004 - lowest)) @ turn
    assign(gem, key)


def brilliant() -> bpy.types.Mesh:
    """Return a round brilliant of radius 1 around Z: the body that the planes of its facets cut out."""
    planes = [(Vector((0.0, 0.0, 1.0)), Vector((0.0, 0.0, GIRDLE / 2.0 + (1.0 - TABLE) * tan(CROWN))))]
    table = planes[0][1].z

    def facets(count: int, first: float, angle: float, radius: float, height: float, side: float) -> None:
        for index in range(count):
            turn = first + 2.0 * pi * index / count
            normal = Vector((sin(angle) * cos(turn), sin(angle) * sin(turn), side * cos(angle)))
            planes.append((normal, Vector((radius * cos(turn), radius * sin(turn), height))))

    facets(8, 0.0, CROWN, 1.0, GIRDLE / 2.0, 1.0)
    facets(8, pi / 8.0, STAR, TABLE * cos(pi / 8.0), table, 1.0)
    facets(16, pi / 16.0, CROWN + radians(5.0), 1.0, GIRDLE / 2.0, 1.0)
    facets(32, pi / 32.0, pi / 2.0, 1.0, 0.0, 1.0)
    facets(8, 0.0, PAVILION, 1.0, -GIRDLE / 2.0, -1.0)
    facets(16, pi / 16.0, PAVILION + radians(1.6), 1.0, -GIRDLE / 2.0, -1.0)
    normals = np.array([normal for normal, _ in planes])
    offsets = np.array([normal.dot(point) for normal, point in planes])
    triples = np.array(list(combinations(range(len(planes)), 3)))
    sides = normals[triples]
    proper = np.abs(np.linalg.det(sides)) > 1e-6
    corners = np.linalg.solve(sides[proper], offsets[triples[proper]][..., None])[..., 0]
    inside = corners[np.all(corners @ normals.T <= offsets + 1e-7, axis=1)]
    shape = bmesh.new()
    for corner in inside:
        shape.verts.new(corner)
    bmesh.ops.remove_doubles(shape, verts=shape.verts[:], dist=1e-5)
    hull = bmesh.ops.convex_hull(shape, input=shape.verts[:])
    bmesh.ops.delete(shape, geom=[each for each in hull["geom_interior"] if each.is_valid], context="VERTS")
    bmesh.ops.dissolve_limit(shape, angle_limit=radians(0.2), verts=shape.verts[:], edges=shape.edges[:])
    return _mesh(shape)


_KINDS: dict[str, Callable[[bpy.types.Scene, str], None]] = {
    "vessel": _vessel,
    "drink": _drink,
    "ball": _ball,
    "air": _air,
    "bubble": _bubble,
    "film": _film,
    "puddle": _puddle,
    "block": _block,
    "ice": _ice,
    "gem": _gem,
}


def _mesh(shape: bmesh.types.BMesh, smooth: bool = False) -> bpy.types.Mesh:
    mesh = bpy.data.meshes.new("Body")
    shape.to_mesh(mesh)
    shape.free()
    if smooth:
        mesh.shade_smooth()
    return mesh


def _matt(name: str, colour: tuple[float, float, float]) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (*colour, 1.0)
    return material


def _add(scene: bpy.types.Scene, name: str, data: bpy.types.ID) -> bpy.types.Object:
    obj = bpy.data.objects.new(name, data)
    scene.collection.objects.link(obj)
    return obj


# Surroundings ---------------------------------------------------------------------------------------------------------


def _add_ground(scene: bpy.types.Scene) -> None:
    mesh = bpy.data.meshes.new("Ground")
    mesh.from_pydata([(-9, -6, 0), (9, -6, 0), (9, 1.9, 0), (-9, 1.9, 0)], [], [(0, 1, 2, 3)])
    material = bpy.data.materials.new("Ground")
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Roughness"].default_value = 0.6
    mapping = nodes.new("ShaderNodeMapping")
    mapping.inputs["Rotation"].default_value = (0.0, 0.0, radians(24.0))
    links.new(nodes.new("ShaderNodeTexCoord").outputs["Object"], mapping.inputs["Vector"])
    checker = nodes.new("ShaderNodeTexChecker")
    checker.inputs["Scale"].default_value = 2.6
    checker.inputs["Color1"].default_value = (0.66, 0.64, 0.60, 1.0)
    checker.inputs["Color2"].default_value = (0.16, 0.19, 0.23, 1.0)
    links.new(mapping.outputs["Vector"], checker.inputs["Vector"])
    links.new(checker.outputs["Color"], shader.inputs["Base Color"])
    mesh.materials.append(material)
    _add(scene, "Ground", mesh)


def _add_light(scene: bpy.types.Scene) -> None:
    for name, place, size, power, colour in (
        ("Key", (-2.2, -1.0, 3.2), (1.6, 1.6), 110.0, (1.0, 0.95, 0.88)),
        ("Back", (1.8, 3.0, 2.2), (2.2, 1.4), 90.0, (0.92, 0.96, 1.0)),
    ):
        lamp = bpy.data.lights.new(name, "AREA")
        lamp.shape = "RECTANGLE"
        lamp.size, lamp.size_y = size
        lamp.energy, lamp.color = power, colour
        obj = _add(scene, name, lamp)
        obj.location = place
        obj.rotation_euler = (obj.location - Vector((0.0, 0.0, 0.4))).to_track_quat("Z", "Y").to_euler()
    world = bpy.data.worlds.new("Studio")
    nodes, links = world.node_tree.nodes, world.node_tree.links
    split = nodes.new("ShaderNodeSeparateXYZ")
    links.new(nodes.new("ShaderNodeTexCoord").outputs["Generated"], split.inputs[0])
    ramp = nodes.new("ShaderNodeValToRGB")
    ramp.color_ramp.elements[0].color = (0.30, 0.345, 0.40, 1.0)
    ramp.color_ramp.elements[1].color = (0.09, 0.115, 0.15, 1.0)
    ramp.color_ramp.elements[1].position = 0.7
    links.new(split.outputs["Z"], ramp.inputs["Fac"])
    background = next(node for node in nodes if node.type == "BACKGROUND")
    background.inputs["Strength"].default_value = 1.25
    links.new(ramp.outputs["Color"], background.inputs["Color"])
    scene.world = world


def _add_panel(scene: bpy.types.Scene, place: Vector, aim: Vector, power: float = 260.0) -> None:
    """A bright wall that shows in films and facets and lights nothing else."""
    lamp = bpy.data.lights.new("Panel", "AREA")
    lamp.shape = "RECTANGLE"
    lamp.size, lamp.size_y = 3.6, 2.4
    lamp.energy = power
    lamp.use_shadow = False
    panel = _add(scene, "Panel", lamp)
    panel.location = place
    panel.rotation_euler = (place - aim).to_track_quat("Z", "Y").to_euler()
    panel.visible_diffuse = False


def _add_camera(scene: bpy.types.Scene) -> None:
    data = bpy.data.cameras.new("Camera")
    data.lens = 70.0
    camera = _add(scene, "Camera", data)
    camera.location = CAMERA
    aim = CAMERA - Vector((0.0, 0.0, 0.47))
    camera.rotation_euler = aim.to_track_quat("Z", "Y").to_euler()
    scene.camera = camera
