"""The flagship picture: a tumbler of iced water with a straw, in the sun.

:func:`build_scene` models everything from numbers; the same call gives the same scene. One unit is 10 cm. Every
medium is a closed mesh that overlaps its neighbours a little, as nested dielectrics want it: the water reaches into
the glass, the ice and the straw stand in the water, bubbles are bodies of air inside water and ice.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import exp, hypot
from random import Random

import bpy
from mathutils import Euler, Matrix, Vector
from mathutils.bvhtree import BVHTree

from ..scene.media import assign
from ..scene.new_materials import new_material
from .glassware import (
    CLEARANCE,
    ICE_SIZE,
    OVERLAP,
    TUMBLER_INSIDE,
    TUMBLER_OUTSIDE,
    ice_mesh,
    inner_radius,
    lathe,
    rounded,
    spheres,
    straw_mesh,
)
from .studio import add_camera, add_light, add_object, add_table, set_render

WATER_LEVEL = 0.74
CAPILLARY_LENGTH = 0.027
MENISCUS_RISE = 0.024
"""Height of the water above its level where it wets a wall."""

WATER_RING_STEP = 0.006
"""Distance of the rings of the water's surface: a few to each capillary length."""

ICE: tuple[tuple[Vector, Euler, int], ...] = (
    (Vector((-0.108, -0.173, 0.652)), Euler((0.090, -0.045, -0.030)), 1),
    (Vector((0.198, -0.061, 0.666)), Euler((0.192, -0.101, -0.024)), 2),
    (Vector((-0.102, 0.171, 0.666)), Euler((0.546, 0.368, 1.783)), 3),
)
"""Centre, rotation and seed of each cube. They float, a fifth of each above the water, off the glass and each other."""

STRAW_FOOT = Vector((-0.2, 0.18, 0.177))

STRAW_LEAN = Vector((0.349, 0.165, 1.0))
"""A point of the straw's axis that it passes on its way up."""

CLINGING_BUBBLES = 90
"""Number of bubbles in the water."""

FROZEN_BUBBLES = 50
"""Number of bubbles in each cube."""

FOCUS = Vector((0.0, -0.3, WATER_LEVEL))
"""Where the picture is sharp: the tumbler's front at the height of the water."""


def build_scene() -> bpy.types.Scene:
    """Return a new scene ``Iced Water`` with its camera, lights and render settings; nothing else in the file changes.

    The caller runs :func:`nested_dielectric.prepare` on it before rendering.
    """
    scene = bpy.data.scenes.new("Iced Water")
    tumbler = add_object(scene, "Tumbler", lathe(rounded(TUMBLER_OUTSIDE + TUMBLER_INSIDE)))
    ice = [_ice_cube(scene, index, *placement) for index, placement in enumerate(ICE, 1)]
    straw = add_object(scene, "Straw", straw_mesh())
    straw.matrix_world = Matrix.LocRotScale(STRAW_FOOT, (STRAW_LEAN - STRAW_FOOT).to_track_quat("Z", "Y"), None)
    trees = {obj: _tree(obj) for obj in (tumbler, *ice, straw)}
    water = add_object(scene, "Water", water_mesh([trees[obj] for obj in (*ice, straw)]))
    water_bubbles = add_object(scene, "Bubbles in Water", spheres(_clinging_bubbles(trees, Random(4))))
    ice_bubbles = add_object(
        scene, "Bubbles in Ice", spheres(_frozen_bubbles({cube: trees[cube] for cube in ice}, Random(5)))
    )

    bodies = {"glass": [tumbler], "water": [water], "ice": ice, "air_bubble": [water_bubbles, ice_bubbles]}
    for preset, objects in bodies.items():
        material = _medium(preset)
        for obj in objects:
            assign(obj, material)

    add_table(scene)
    add_light(scene)
    add_camera(scene, FOCUS)
    set_render(scene)
    return scene


def _medium(preset: str) -> bpy.types.Material:
    """Return a new material of a preset, whose shadows are left to caustics."""
    return new_material(f"Iced {preset.replace('_', ' ').title()}", preset=preset, shadow_mode="BLACK")


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


def _clinging_bubbles(trees: Mapping[bpy.types.Object, BVHTree], random: Random) -> list[tuple[Vector, float]]:
    """Return bubbles under water, centre and radius, that sit on the surfaces of the tumbler, the ice and the straw."""
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
    """Return bubbles, centre and radius, in the heart of each cube, where the last water froze."""
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
    """Return whether a bubble keeps clear of others."""
    return all((centre - other).length > radius + size + CLEARANCE for other, size in bubbles)


def _outside_distance(tree: BVHTree, point: Vector) -> float:
    """Return the distance of a point from a closed mesh, negative inside."""
    nearest, normal, _, distance = tree.find_nearest(point)
    return distance if (point - nearest).dot(normal) > 0.0 else -distance


def _tree(obj: bpy.types.Object) -> BVHTree:
    """Return a tree of an object's faces in world space."""
    mesh = obj.data
    matrix = obj.matrix_world
    vertices = [matrix @ vertex.co for vertex in mesh.vertices]
    return BVHTree.FromPolygons(vertices, [tuple(face.vertices) for face in mesh.polygons])


def _ice_cube(scene: bpy.types.Scene, index: int, centre: Vector, rotation: Euler, seed: int) -> bpy.types.Object:
    """Return a new ice cube of a scene."""
    cube = add_object(scene, f"Ice Cube {index}", ice_mesh(seed))
    cube.matrix_world = Matrix.LocRotScale(centre, rotation, None)
    return cube
