"""The flagship picture: a tumbler of iced water with a straw, in the sun.

:func:`build_scene` models everything from numbers; the same call gives the same scene. One unit is 10 cm. Every
medium is a closed mesh that overlaps its neighbours a little, as nested dielectrics want it: the water reaches into
the glass, the ice and the straw stand in the water, bubbles are bodies of air inside water and ice.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import copysign, cos, exp, hypot, pi, radians, sin, tan
from random import Random

import bmesh
import bpy
from mathutils import Euler, Matrix, Vector, noise
from mathutils.bvhtree import BVHTree

from ..scene.materials import new_material
from ..scene.media import assign

Corner = tuple[float, float, float]
"""Corner of a profile: distance from the axis, height, and the radius it is rounded with."""

Point = tuple[float, float]
"""Point of a profile: distance from the axis, height."""

SEGMENTS = 192
"""Steps around a turned body."""

STEP = 0.03
"""Longest stretch of a profile between two rings; short ones keep smooth shading close to the true shape."""

CLEARANCE = 0.002
"""Gap that keeps the tumbler off the table and bubbles off what they cling to."""

OVERLAP = 0.008
"""How far the water reaches into the glass."""

TUMBLER_OUTSIDE: tuple[Corner, ...] = (
    (0.0, 0.03, 0.0),
    (0.29, 0.03, 0.05),
    (0.335, CLEARANCE, 0.02),
    (0.398, CLEARANCE, 0.05),
    (0.46, 1.0, 0.0155),
)
TUMBLER_INSIDE: tuple[Corner, ...] = ((0.428, 1.0, 0.0155), (0.372, 0.16, 0.075), (0.0, 0.15, 0.0))

WATER_LEVEL = 0.74
CAPILLARY_LENGTH = 0.027
MENISCUS_RISE = 0.024
WATER_RING_STEP = 0.006
"""Distance of the rings of the water's surface: a few to each capillary length."""

ICE_SIZE = 0.28
ICE_ROUNDING = 0.045
ICE_CUTS = 28
ICE_WAVES = ((0.010, 6.0), (0.003, 22.0))
"""Height and spatial frequency of each layer of the melted surface's unevenness."""

ICE: tuple[tuple[Vector, Euler, int], ...] = (
    (Vector((-0.108, -0.173, 0.652)), Euler((0.090, -0.045, -0.030)), 1),
    (Vector((0.198, -0.061, 0.666)), Euler((0.192, -0.101, -0.024)), 2),
    (Vector((-0.102, 0.171, 0.666)), Euler((0.546, 0.368, 1.783)), 3),
)
"""Centre, rotation and seed of each cube. They float, a fifth of each above the water, off the glass and each other."""

STRAW_RADIUS = 0.032
STRAW_WALL = 0.005
STRAW_LENGTH = 1.55
STRAW_STRIPES = 2
STRAW_TURNS = 5.0
"""Turns of each stripe on the straw's whole length."""

STRAW_FOOT = Vector((-0.2, 0.18, 0.177))
STRAW_LEAN = Vector((0.349, 0.165, 1.0))
"""A point of the straw's axis that it passes on its way up."""

CLINGING_BUBBLES = 90
FROZEN_BUBBLES = 50
"""Bubbles in each cube."""

SUN_FROM = Vector((-0.5, 0.8, 0.85))
SUN_ANGLE = radians(8.0)
"""Apparent diameter: softer than the real sun, so that few samples find the caustics."""

GRAIN_ANGLE = radians(-65.0)
"""Turn of the table's texture; at 0 the grain runs along X."""

FOCUS = Vector((0.0, -0.3, WATER_LEVEL))
"""Where the picture is sharp: the tumbler's front at the height of the water."""

GLOW_DIRECTION = Vector((-0.3, 1.0, -0.1))
GLOW_RADIUS = 0.58
"""Reach of the glow on the unit sphere of directions."""


def build_scene() -> bpy.types.Scene:
    """Return a new scene ``Iced Water`` with its camera, lights and render settings; nothing else in the file changes.

    The caller runs :func:`nested_dielectric.prepare` on it before rendering.
    """
    scene = bpy.data.scenes.new("Iced Water")
    tumbler = _object(scene, "Tumbler", lathe(rounded(TUMBLER_OUTSIDE + TUMBLER_INSIDE)))
    ice = [_ice_cube(scene, index, *placement) for index, placement in enumerate(ICE, 1)]
    straw = _object(scene, "Straw", straw_mesh())
    straw.matrix_world = Matrix.LocRotScale(STRAW_FOOT, (STRAW_LEAN - STRAW_FOOT).to_track_quat("Z", "Y"), None)
    trees = {obj: _tree(obj) for obj in (tumbler, *ice, straw)}
    water = _object(scene, "Water", water_mesh([trees[obj] for obj in (*ice, straw)]))
    water_bubbles = _object(scene, "Bubbles in Water", spheres(_clinging_bubbles(trees, Random(4))))
    ice_bubbles = _object(
        scene, "Bubbles in Ice", spheres(_frozen_bubbles({cube: trees[cube] for cube in ice}, Random(5)))
    )

    bodies = {"glass": [tumbler], "water": [water], "ice": ice, "air_bubble": [water_bubbles, ice_bubbles]}
    for preset, objects in bodies.items():
        material = _medium(preset)
        for obj in objects:
            assign(obj, material)

    _add_table(scene)
    _add_light(scene)
    _add_camera(scene)
    _set_render(scene)
    return scene


def _medium(preset: str) -> bpy.types.Material:
    """A preset's material whose shadows are left to caustics."""
    return new_material(f"Iced {preset.replace('_', ' ').title()}", preset=preset, shadow_mode="BLACK")


# Shapes -------------------------------------------------------------------------------------------------------------


def rounded(corners: Sequence[Corner], arc_steps: int = 10) -> list[Point]:
    """Return a profile whose corners are arcs, in points at most :data:`STEP` apart."""
    points = [Vector(corners[0][:2])]
    for before, (r, z, radius), after in zip(corners, corners[1:], corners[2:]):
        corner = Vector((r, z))
        back = (Vector(before[:2]) - corner).normalized()
        ahead = (Vector(after[:2]) - corner).normalized()
        half = back.angle(ahead) / 2.0
        centre = corner + (back + ahead).normalized() * (radius / sin(half))
        arm = corner + back * (radius / tan(half)) - centre
        sweep = copysign(pi - 2.0 * half, back.angle_signed(ahead))
        points += [centre + Matrix.Rotation(sweep * step / arc_steps, 2) @ arm for step in range(arc_steps + 1)]
    points.append(Vector(corners[-1][:2]))
    return _divided(points)


def _divided(points: Sequence[Vector]) -> list[Point]:
    profile = [tuple(points[0])]
    for start, end in zip(points, points[1:]):
        pieces = max(1, round((end - start).length / STEP + 0.5))
        profile += [tuple(start.lerp(end, piece / pieces)) for piece in range(1, pieces + 1)]
    return profile


def lathe(profile: Sequence[Point]) -> bpy.types.Mesh:
    """Return the body that a profile makes turned around Z: from the axis, outside on its right hand, to the axis."""
    bottom, *rings, top = profile
    angles = [2.0 * pi * segment / SEGMENTS for segment in range(SEGMENTS)]
    vertices = [(0.0, 0.0, bottom[1])]
    vertices += [(r * cos(angle), r * sin(angle), z) for r, z in rings for angle in angles]
    vertices.append((0.0, 0.0, top[1]))
    last = len(vertices) - 1
    faces: list[tuple[int, ...]] = []
    for segment in range(SEGMENTS):
        here, there = 1 + segment, 1 + (segment + 1) % SEGMENTS
        faces.append((0, there, here))
        for ring in range(0, (len(rings) - 1) * SEGMENTS, SEGMENTS):
            faces.append((here + ring, there + ring, there + ring + SEGMENTS, here + ring + SEGMENTS))
        ring = (len(rings) - 1) * SEGMENTS
        faces.append((here + ring, there + ring, last))
    return _smooth_mesh("Turned", vertices, faces)


def inner_radius(z: float) -> float:
    """Radius of the tumbler's inside on its straight wall at height ``z``."""
    (top, high, _), (bottom, low, _) = TUMBLER_INSIDE[:2]
    return bottom + (top - bottom) * (z - low) / (high - low)


def water_mesh(solids: Iterable[BVHTree]) -> bpy.types.Mesh:
    """Return the water: the tumbler's inside grown by :data:`OVERLAP`, its surface drawn up along what it wets."""
    _, (corner_r, corner_z, rounding), (_, floor, _) = TUMBLER_INSIDE
    rim = inner_radius(WATER_LEVEL) + OVERLAP
    body = rounded(
        (
            (0.0, floor - OVERLAP, 0.0),
            (corner_r + OVERLAP, corner_z - OVERLAP, rounding + OVERLAP),
            (rim, WATER_LEVEL, 0.0),
        )
    )
    count = round(rim / WATER_RING_STEP)
    surface = [(rim * (count - ring) / count, WATER_LEVEL) for ring in range(1, count + 1)]
    mesh = lathe(body + surface)
    for vertex in mesh.vertices:
        if vertex.co.z > WATER_LEVEL - 1e-5:
            vertex.co.z += meniscus(vertex.co, solids)
    return mesh


def meniscus(point: Vector, solids: Iterable[BVHTree]) -> float:
    """Return how far the water rises above its level: falling off from each solid by the capillary length."""
    distances = [max(inner_radius(WATER_LEVEL) - hypot(point.x, point.y), 0.0)]
    distances += [max(_outside_distance(solid, point), 0.0) for solid in solids]
    return MENISCUS_RISE * sum(exp(-distance / CAPILLARY_LENGTH) for distance in distances)


def ice_mesh(seed: int) -> bpy.types.Mesh:
    """Return a cube with melted edges and a slightly wavy surface."""
    core = ICE_SIZE / 2.0 - ICE_ROUNDING
    offset = Vector((17.0 * seed, 5.0 * seed, 0.0))
    shape = bmesh.new()
    bmesh.ops.create_cube(shape, size=ICE_SIZE)
    bmesh.ops.subdivide_edges(shape, edges=shape.edges, cuts=ICE_CUTS, use_grid_fill=True)
    for vertex in shape.verts:
        inner = Vector(max(-core, min(core, value)) for value in vertex.co)
        outward = (vertex.co - inner).normalized()
        waves = sum(height * noise.noise(vertex.co * frequency + offset) for height, frequency in ICE_WAVES)
        vertex.co = inner + outward * (ICE_ROUNDING + waves)
    mesh = bpy.data.meshes.new("Ice Cube")
    shape.to_mesh(mesh)
    shape.free()
    mesh.shade_smooth()
    return mesh


def straw_mesh(segments: int = 64, rings: int = 160) -> bpy.types.Mesh:
    """Return a closed tube along Z with stripes wound around it; the second material is the stripe's."""
    outline = [(STRAW_RADIUS, 0.0)]
    outline += [(STRAW_RADIUS, STRAW_LENGTH * ring / rings) for ring in range(1, rings + 1)]
    outline += [(STRAW_RADIUS - STRAW_WALL, z) for _, z in reversed(outline)]
    vertices = []
    for r, z in outline:
        twist = STRAW_TURNS * z / STRAW_LENGTH
        for segment in range(segments):
            angle = 2.0 * pi * (segment / segments + twist)
            vertices.append((r * cos(angle), r * sin(angle), z))
    faces, stripes = [], []
    for ring in range(len(outline)):
        below, above = ring * segments, (ring + 1) % len(outline) * segments
        for segment in range(segments):
            following = (segment + 1) % segments
            faces.append((below + segment, below + following, above + following, above + segment))
            stripes.append(segment * 2 * STRAW_STRIPES // segments % 2)
    mesh = _smooth_mesh("Straw", vertices, faces)
    mesh.materials.append(_surface("Straw White", (0.85, 0.82, 0.76), roughness=0.35))
    mesh.materials.append(_surface("Straw Stripe", (0.62, 0.035, 0.03), roughness=0.35))
    mesh.polygons.foreach_set("material_index", stripes)
    mesh.set_sharp_from_angle(angle=radians(50.0))
    return mesh


def spheres(bubbles: Iterable[tuple[Vector, float]]) -> bpy.types.Mesh:
    """Return one mesh of separate spheres, each given by centre and radius."""
    shape = bmesh.new()
    bmesh.ops.create_icosphere(shape, subdivisions=4, radius=1.0)
    directions = [vertex.co.copy() for vertex in shape.verts]
    triangles = [tuple(vertex.index for vertex in face.verts) for face in shape.faces]
    shape.free()
    vertices, faces = [], []
    for centre, radius in bubbles:
        first = len(vertices)
        vertices += [centre + radius * direction for direction in directions]
        faces += [tuple(first + index for index in triangle) for triangle in triangles]
    return _smooth_mesh("Bubbles", vertices, faces)


def _clinging_bubbles(trees: Mapping[bpy.types.Object, BVHTree], random: Random) -> list[tuple[Vector, float]]:
    """Bubbles under water that sit on the surfaces of the tumbler, the ice and the straw."""
    hosts = list(trees)
    floor = TUMBLER_INSIDE[-1][1]
    bubbles: list[tuple[Vector, float]] = []
    while len(bubbles) < CLINGING_BUBBLES:
        host = random.choice(hosts)
        face = random.choice(host.data.polygons)
        radius = 0.004 + 0.011 * random.random() ** 3
        centre = host.matrix_world @ (face.center + face.normal * (radius + CLEARANCE))
        wet = floor < centre.z < WATER_LEVEL - 0.05 and hypot(centre.x, centre.y) < inner_radius(centre.z)
        free = all(_outside_distance(tree, centre) > radius + CLEARANCE / 2.0 for tree in trees.values())
        if wet and free and _apart(centre, radius, bubbles):
            bubbles.append((centre, radius))
    return bubbles


def _frozen_bubbles(cubes: Mapping[bpy.types.Object, BVHTree], random: Random) -> list[tuple[Vector, float]]:
    """Bubbles in the heart of each cube, where the last water froze."""
    bubbles: list[tuple[Vector, float]] = []
    for cube, tree in cubes.items():
        target = len(bubbles) + FROZEN_BUBBLES
        while len(bubbles) < target:
            centre = cube.matrix_world @ Vector(random.gauss(0.0, 0.14 * ICE_SIZE) for _ in range(3))
            radius = 0.003 + 0.010 * random.random() ** 3
            if _outside_distance(tree, centre) < -radius - 0.015 and _apart(centre, radius, bubbles):
                bubbles.append((centre, radius))
    return bubbles


def _apart(centre: Vector, radius: float, bubbles: Iterable[tuple[Vector, float]]) -> bool:
    return all((centre - other).length > radius + size + CLEARANCE for other, size in bubbles)


def _outside_distance(tree: BVHTree, point: Vector) -> float:
    """Distance of a point from a closed mesh, negative inside."""
    nearest, normal, _, distance = tree.find_nearest(point)
    return distance if (point - nearest).dot(normal) > 0.0 else -distance


def _tree(obj: bpy.types.Object) -> BVHTree:
    mesh = obj.data
    matrix = obj.matrix_world
    vertices = [matrix @ vertex.co for vertex in mesh.vertices]
    return BVHTree.FromPolygons(vertices, [tuple(face.vertices) for face in mesh.polygons])


def _smooth_mesh(name: str, vertices: Sequence, faces: Sequence) -> bpy.types.Mesh:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.shade_smooth()
    return mesh


def _object(scene: bpy.types.Scene, name: str, data: bpy.types.ID | None) -> bpy.types.Object:
    obj = bpy.data.objects.new(name, data)
    scene.collection.objects.link(obj)
    return obj


def _ice_cube(scene: bpy.types.Scene, index: int, centre: Vector, rotation: Euler, seed: int) -> bpy.types.Object:
    cube = _object(scene, f"Ice Cube {index}", ice_mesh(seed))
    cube.matrix_world = Matrix.LocRotScale(centre, rotation, None)
    return cube


# Surroundings -------------------------------------------------------------------------------------------------------


def _surface(name: str, colour: tuple[float, float, float], roughness: float) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    shader = _node(material.node_tree, "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (*colour, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    return material


def _node(tree: bpy.types.NodeTree, kind: str) -> bpy.types.Node:
    """The node of a kind that Blender puts into a new tree."""
    return next(node for node in tree.nodes if node.type == kind)


def _add_table(scene: bpy.types.Scene) -> None:
    mesh = _smooth_mesh("Table", [(-9, -7, 0), (9, -7, 0), (9, 2.6, 0), (-9, 2.6, 0)], [(0, 1, 2, 3)])
    mesh.materials.append(_wood())
    _object(scene, "Table", mesh)


def _wood() -> bpy.types.Material:
    """Oak: noise stretched along the grain for the colour, finer noise for the pores."""
    material = _surface("Oak", (0.5, 0.4, 0.3), roughness=0.42)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = _node(material.node_tree, "BSDF_PRINCIPLED")
    turned = nodes.new("ShaderNodeVectorRotate")
    turned.rotation_type = "Z_AXIS"
    turned.inputs["Angle"].default_value = GRAIN_ANGLE
    links.new(nodes.new("ShaderNodeTexCoord").outputs["Object"], turned.inputs["Vector"])
    place = turned.outputs["Vector"]

    def grain(scale: tuple[float, float, float], detail: float, distortion: float) -> bpy.types.NodeSocket:
        mapping = nodes.new("ShaderNodeMapping")
        mapping.inputs["Scale"].default_value = scale
        links.new(place, mapping.inputs["Vector"])
        texture = nodes.new("ShaderNodeTexNoise")
        texture.inputs["Scale"].default_value = 1.0
        texture.inputs["Detail"].default_value = detail
        texture.inputs["Distortion"].default_value = distortion
        links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
        return texture.outputs["Fac"]

    def ramp(value: bpy.types.NodeSocket, *stops: tuple[float, tuple[float, float, float]]) -> bpy.types.NodeSocket:
        node = nodes.new("ShaderNodeValToRGB")
        for element, (position, colour) in zip(node.color_ramp.elements, stops, strict=True):
            element.position = position
            element.color = (*colour, 1.0)
        links.new(value, node.inputs["Fac"])
        return node.outputs["Color"]

    tone = ramp(grain((0.45, 3.5, 1.0), 6.0, 0.8), (0.32, (0.10, 0.050, 0.024)), (0.68, (0.265, 0.145, 0.072)))
    pores = ramp(grain((5.0, 90.0, 1.0), 2.0, 0.0), (0.36, (0.62, 0.55, 0.5)), (0.5, (1.0, 1.0, 1.0)))
    mix = nodes.new("ShaderNodeMix")
    mix.data_type = "RGBA"
    mix.blend_type = "MULTIPLY"
    mix.inputs["Factor"].default_value = 0.8
    links.new(tone, mix.inputs["A"])
    links.new(pores, mix.inputs["B"])
    links.new(mix.outputs["Result"], shader.inputs["Base Color"])
    bump = nodes.new("ShaderNodeBump")
    bump.inputs["Strength"].default_value = 0.15
    bump.inputs["Distance"].default_value = 0.01
    links.new(pores, bump.inputs["Height"])
    links.new(bump.outputs["Normal"], shader.inputs["Normal"])
    return material


def _add_light(scene: bpy.types.Scene) -> None:
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy = 8.5
    sun.angle = SUN_ANGLE
    sun.color = (1.0, 0.84, 0.64)
    obj = _object(scene, "Sun", sun)
    obj.rotation_euler = SUN_FROM.to_track_quat("Z", "Y").to_euler()

    soft = bpy.data.lights.new("Softbox", "AREA")
    soft.shape = "RECTANGLE"
    soft.size, soft.size_y = 2.0, 4.0
    soft.energy = 190.0
    soft.color = (0.9, 0.95, 1.0)
    obj = _object(scene, "Softbox", soft)
    obj.location = (3.6, -0.6, 2.4)
    obj.rotation_euler = (obj.location - Vector((0.0, 0.0, 0.4))).to_track_quat("Z", "Y").to_euler()

    scene.world = _backdrop()


def _backdrop() -> bpy.types.World:
    """A dusky room with a wide glow behind the table: the field that glass edges stand dark against."""
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
    background = _node(world.node_tree, "BACKGROUND")
    background.inputs["Strength"].default_value = 1.3
    links.new(ramp.outputs["Color"], background.inputs["Color"])
    return world


def _add_camera(scene: bpy.types.Scene) -> None:
    camera = bpy.data.cameras.new("Camera")
    camera.lens = 72.0
    obj = _object(scene, "Camera", camera)
    obj.location = (0.0, -4.3, 1.75)
    target = Vector((0.12, 0.0, 0.49))
    obj.rotation_euler = (obj.location - target).to_track_quat("Z", "Y").to_euler()
    camera.dof.use_dof = True
    camera.dof.focus_distance = (obj.location - FOCUS).length
    camera.dof.aperture_fstop = 1.4
    scene.camera = obj


def _set_render(scene: bpy.types.Scene) -> None:
    """720 x 720 pixels, and paths that find the sun through glass: unblurred, unclamped and guided."""
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
