"""Closed meshes of the demo: turned bodies, ice, a straw, bubbles. One unit is 10 cm."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from math import copysign, cos, pi, radians, sin, tan

import bmesh
import bpy
from mathutils import Matrix, Vector, noise

from .surfaces import plain_material

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

ICE_SIZE = 0.28
ICE_ROUNDING = 0.045
ICE_CUTS = 28

ICE_WAVES = ((0.010, 6.0), (0.003, 22.0))
"""Height and spatial frequency of each layer of the melted surface's unevenness."""

STRAW_RADIUS = 0.032
STRAW_WALL = 0.005
STRAW_LENGTH = 1.55
STRAW_STRIPES = 2

STRAW_TURNS = 5.0
"""Turns of each stripe on the straw's whole length."""


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
    """Return the points of a polyline and those that divide its stretches into pieces no longer than :data:`STEP`."""
    profile = [tuple(points[0])]
    for start, end in pairwise(points):
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
    return smooth_mesh("Turned", vertices, faces)


def inner_radius(z: float) -> float:
    """Return the radius of the tumbler's inside on its straight wall at height ``z``."""
    (top, high, _), (bottom, low, _) = TUMBLER_INSIDE[:2]
    return bottom + (top - bottom) * (z - low) / (high - low)


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
    mesh = smooth_mesh("Straw", vertices, faces)
    mesh.materials.append(plain_material("Straw White", (0.85, 0.82, 0.76), roughness=0.35))
    mesh.materials.append(plain_material("Straw Stripe", (0.62, 0.035, 0.03), roughness=0.35))
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
    return smooth_mesh("Bubbles", vertices, faces)


def smooth_mesh(name: str, vertices: Sequence, faces: Sequence) -> bpy.types.Mesh:
    """Return a new mesh that is shaded smooth."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.shade_smooth()
    return mesh
