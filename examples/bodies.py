"""Closed bodies of a product shot: what is turned round an axis, and ice that stands in it.

Outlines are arrays of (radius, height), in millimetres as all lengths here; meshes are in metres.
"""

from __future__ import annotations

from itertools import pairwise
from math import cos, pi, sin
from random import Random
from types import SimpleNamespace

import bmesh
import bpy
import numpy as np
from description import DescriptionError
from mathutils import Euler, Matrix, Vector, noise
from mathutils.bvhtree import BVHTree

MM = 0.001
SEGMENTS = 160
"""Steps around a turned body."""

OVERLAP = 0.3
"""How far liquids reach into the glass and each other: what touches overlaps."""

MENISCUS, CAPILLARY_LENGTH = 1.8, 2.7
"""How far a liquid rises where it wets the wall, and how fast that falls off."""

CORE, EDGE = 0.32, 0.17
"""Half the side of a cube's flat part, and the radius of its melted edges, of its size."""

BOX = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
"""Faces of a box whose corners stand in the order of their coordinates."""


def rounded(corners: list[tuple[float, float, float]], step: float = 2.5) -> np.ndarray:
    """Return corners (radius, height, rounding) as points at most a step apart; rounded ones become curves."""
    points = [np.array(corners[0][:2])]
    for before, (r, z, rounding), after in zip(corners, corners[1:], corners[2:]):
        corner = np.array((r, z))
        arms = [np.array(other[:2]) - corner for other in (before, after)]
        back, ahead = (arm * min(rounding / np.linalg.norm(arm), 0.5) for arm in arms)
        points += [corner + back * (1 - t) ** 2 + ahead * t**2 for t in np.linspace(0, 1, 10 if rounding else 1)]
    points.append(np.array(corners[-1][:2]))
    lengths = [np.linalg.norm(b - a) for a, b in pairwise(points)]
    ways = zip(points, points[1:], lengths)
    pieces = [np.linspace(a, b, int(length / step) + 1, endpoint=False) for a, b, length in ways if length > 1e-6]
    return np.concatenate([*pieces, points[-1:]])


def turned(name: str, outline: np.ndarray) -> bpy.types.Mesh:
    """Return the closed body that an outline makes around Z; outside is on its right hand. One vertex closes each end."""
    rings = len(outline) - 2
    angles = np.linspace(0, 2 * pi, SEGMENTS, endpoint=False)
    around = np.stack((np.cos(angles), np.sin(angles), np.ones(SEGMENTS)), axis=-1)
    vertices = [around * (r, r, z) for r, z in outline[1:-1]]
    vertices = np.concatenate([[(0, 0, outline[0, 1])], *vertices, [(0, 0, outline[-1, 1])]])
    here = 1 + np.arange(SEGMENTS)
    there = np.roll(here, -1)
    last = (rings - 1) * SEGMENTS
    faces = [(0, b, a) for a, b in zip(here, there)]
    for ring in range(0, last, SEGMENTS):
        faces += list(zip(here + ring, there + ring, there + ring + SEGMENTS, here + ring + SEGMENTS))
    faces += [(a, b, len(vertices) - 1) for a, b in zip(here + last, there + last)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices * MM, [], faces)
    mesh.shade_smooth()
    return mesh


def height_at(inside: np.ndarray, level: float) -> float:
    """Return the height of a level, 0 at the vessel's floor, 1 at its rim."""
    return inside[0, 1] + level * (inside[-1, 1] - inside[0, 1])


def liquid_outline(inside: np.ndarray, low: float | None, high: float) -> np.ndarray:
    """Return the outline of a liquid: the vessel's inside, grown by the overlap, with a meniscus on top.

    :param low: height of the liquid below, into which it reaches; None where it stands on the floor.
    :param high: height of its own surface.
    """
    along = np.gradient(inside, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    grown = inside + OVERLAP * np.stack((along[:, 1], -along[:, 0]), axis=-1)
    bottom = grown[0, 1] if low is None else low - OVERLAP
    meniscus = min(MENISCUS, 0.5 * (inside[-1, 1] - high))
    brim = high + meniscus
    foot, rim = np.interp((bottom, brim), grown[:, 1], grown[:, 0])
    disc = np.linspace((0, bottom), (foot, bottom), 16)[1 if low is not None else 16 :]
    wall = grown[1:][(grown[1:, 1] >= bottom) & (grown[1:, 1] < brim)]
    from_wall = rim * np.linspace(0, 1, 40) ** 2
    rise = meniscus * np.exp(-np.maximum(from_wall - OVERLAP, 0) / CAPILLARY_LENGTH)
    return np.concatenate(([(0, bottom)], disc, wall, np.stack((rim - from_wall, high + rise), axis=-1)))


def ice_cube(size: float, seed: int) -> bpy.types.Mesh:
    """Return a cube with melted edges and a slightly uneven surface, within its size."""
    shape = bmesh.new()
    bmesh.ops.create_cube(shape, size=1)
    bmesh.ops.subdivide_edges(shape, edges=shape.edges, cuts=24, use_grid_fill=True)
    offset = Vector((17.3 * seed, 5.1 * seed, 0))
    for vertex in shape.verts:
        core = Vector(max(-CORE, min(CORE, value)) for value in vertex.co)
        waves = 0.022 * noise.noise(2.2 * vertex.co + offset) + 0.007 * noise.noise(7 * vertex.co + offset)
        vertex.co = (core + (0.82 * EDGE + waves) * (vertex.co - core).normalized()) * size * MM
    mesh = bpy.data.meshes.new("Ice")
    shape.to_mesh(mesh)
    shape.free()
    mesh.shade_smooth()
    return mesh


def ice_places(inside: np.ndarray, surface: float, ice: SimpleNamespace) -> list[Matrix]:
    """Return where cubes float: in the liquid's surface, below where that is full; off the glass and each other.

    The same seed gives the same places.

    :param inside: outline of the vessel's inside.
    :param surface: height of the liquid's.
    :raises DescriptionError: if they do not fit.
    """
    random, size, floor = Random(ice.seed), ice.size, inside[0, 1]
    grid = [Vector((x, y, z)) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)]
    corners = [size * 0.5 * point for point in grid if 0 not in point]
    hull = [size * (CORE * point + EDGE * point.normalized()) for point in grid]
    places, boxes = [], []
    tries = 1000 * ice.count
    for attempt in range(tries):
        turn = Euler((random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), random.uniform(0, pi)))
        reach, angle = inside[:, 0].max() * random.random() ** 0.5, random.uniform(0, 2 * pi)
        height = surface - size * random.uniform(-0.15, 0.25) - (surface - floor) * attempt / tries
        place = Matrix.LocRotScale((reach * cos(angle), reach * sin(angle), height), turn, None)
        points = [place @ point for point in hull]
        room = np.interp([point.z for point in points], inside[:, 1], inside[:, 0])
        if any(point.z < floor or point.xy.length > r - 1 for point, r in zip(points, room)):
            continue
        box = BVHTree.FromPolygons([place @ point for point in corners], BOX)
        if all(not box.overlap(other) for other in boxes):
            places.append(place)
            boxes.append(box)
        if len(places) == ice.count:
            return [Matrix.Translation(place.translation * MM) @ place.to_3x3().to_4x4() for place in places]
    raise DescriptionError(f"ice.count: {ice.count} cubes of {size:g} mm do not fit into the liquid; {len(places)} do")
