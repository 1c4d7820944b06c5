"""Shapes as vertices and triangles: moved, turned, joined, cut."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, pi, radians, sin

import bpy  # before bmesh and mathutils, which live inside it

import bmesh  # isort: skip
import numpy as np
from mathutils import Euler, Matrix, Vector

from nested_dielectric.demo import glassware
from nested_dielectric.scene.shapes import mesh_triangles


def mesh_arrays(mesh: bpy.types.Mesh, matrix: Matrix | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a mesh, placed by a matrix."""
    vertices, triangles = mesh_triangles(mesh)
    vertices = vertices.astype(np.float64)
    if matrix is not None:
        placed = np.array(matrix, np.float64)
        vertices = vertices @ placed[:3, :3].T + placed[:3, 3]
    return vertices, triangles.astype(np.int64)


def mesh_of(name: str, vertices: np.ndarray, triangles: np.ndarray, smooth: bool = False) -> bpy.types.Mesh:
    """A mesh of vertices and triangles; much faster than from_pydata."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(vertices, np.float32).ravel())
    mesh.loops.add(triangles.size)
    mesh.loops.foreach_set("vertex_index", np.ascontiguousarray(triangles, np.int32).ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", np.arange(0, triangles.size, 3, dtype=np.int32))
    if not smooth:
        sharp = mesh.attributes.new("sharp_face", "BOOLEAN", "FACE")
        sharp.data.foreach_set("value", np.ones(len(triangles), bool))
    mesh.update()
    return mesh


def taken_arrays(mesh: bpy.types.Mesh, matrix: Matrix | None = None) -> tuple[np.ndarray, np.ndarray]:
    """:func:`mesh_arrays` of a mesh that nothing else needs."""
    arrays = mesh_arrays(mesh, matrix)
    bpy.data.meshes.remove(mesh)
    return arrays


def built(build: Callable[[bmesh.types.BMesh], None]) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of what `build(bm)` makes."""
    shape = bmesh.new()
    build(shape)
    bmesh.ops.recalc_face_normals(shape, faces=shape.faces)
    mesh = bpy.data.meshes.new("Shape")
    shape.to_mesh(mesh)
    shape.free()
    return taken_arrays(mesh)


def ball(subdivisions: int) -> tuple[np.ndarray, np.ndarray]:
    """A unit icosphere of 20 * 4 ** (subdivisions - 1) triangles."""
    return built(lambda bm: bmesh.ops.create_icosphere(bm, subdivisions=subdivisions, radius=1.0))


def box(low: Sequence[float], high: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """A box between two corners."""
    low, high = Vector(low), Vector(high)
    matrix = Matrix.Translation((low + high) / 2.0) @ Matrix.Diagonal((*(high - low), 1.0))
    return built(lambda bm: bmesh.ops.create_cube(bm, size=1.0, matrix=matrix))


def moved(shape: tuple[np.ndarray, np.ndarray], offset: Sequence[float], size: float | Sequence[float] = 1.0):
    """A shape scaled, then moved. The triangles stay the same array."""
    vertices, triangles = shape
    return vertices * np.asarray(size) + np.asarray(offset), triangles


def turned(shape: tuple[np.ndarray, np.ndarray], rotation: Euler):
    """A shape turned around the origin."""
    vertices, triangles = shape
    return vertices @ np.array(rotation.to_matrix(), np.float64).T, triangles


def joined(shapes: Sequence[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """One shape of many."""
    starts = np.cumsum([0] + [len(vertices) for vertices, _ in shapes[:-1]])
    triangles = [triangles + start for (_, triangles), start in zip(shapes, starts, strict=True)]
    return np.concatenate([vertices for vertices, _ in shapes]), np.concatenate(triangles)


def turned_profile(corners: Sequence[glassware.Corner]) -> tuple[np.ndarray, np.ndarray]:
    """The body that a rounded profile makes turned around Z."""
    return taken_arrays(glassware.lathe(without_straight_points(glassware.rounded(corners))))


def without_straight_points(profile: Sequence[glassware.Point]) -> list[glassware.Point]:
    """A profile without the points on straight lines between others, which flat shading does not need."""
    points = np.array(profile)
    points = points[np.concatenate([[True], np.any(np.abs(np.diff(points, axis=0)) > 1e-9, axis=1)])]
    before, after = np.diff(points[:-1], axis=0), np.diff(points[1:], axis=0)
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    bent = np.abs(turn) > 1e-3 * np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    return [tuple(point) for point in points[np.concatenate([[True], bent, [True]])]]


Facet = tuple[float, float, float]
"""Angle from the horizontal, negative below the girdle; azimuth, both in degrees; distance of its plane."""


def cut(facets: Sequence[Facet], girdle: int) -> tuple[np.ndarray, np.ndarray]:
    """A stone of radius 1 cut along planes from a prism with that many sides."""

    def build(bm):
        bmesh.ops.create_cone(
            bm, cap_ends=True, segments=girdle, radius1=1.0, radius2=1.0, depth=4.0, matrix=Matrix.Identity(4)
        )
        for slope, azimuth, distance in facets:
            a, b = radians(abs(slope)), radians(azimuth)
            normal = Vector((sin(a) * cos(b), sin(a) * sin(b), cos(a) if slope >= 0.0 else -cos(a)))
            geometry = bm.verts[:] + bm.edges[:] + bm.faces[:]
            bmesh.ops.bisect_plane(
                bm, geom=geometry, dist=1e-5, plane_co=normal * distance, plane_no=normal, clear_outer=True
            )
            bmesh.ops.holes_fill(bm, edges=bm.edges, sides=0)

    return built(build)


def ring(slope: float, count: int, turn: float, radius: float, height: float) -> list[Facet]:
    """Facets around a stone, every one through the point at that radius and height; `turn` in steps."""
    a = radians(abs(slope))
    distance = radius * sin(a) + (height if slope >= 0.0 else -height) * cos(a)
    return [(slope, 360.0 * (step + turn) / count, distance) for step in range(count)]


HALF_GIRDLE = 0.025


def brilliant() -> tuple[np.ndarray, np.ndarray]:
    """The round brilliant: table, 8 stars, 8 bezels, 16 upper and 16 lower halves, 8 pavilion mains."""
    facets = [(0.0, 0.0, 0.33)]
    facets += ring(34.5, 8, 0.0, 1.0, HALF_GIRDLE)
    facets += ring(22.0, 8, 0.5, 0.775, 0.205)
    facets += ring(40.5, 16, 0.5, 1.0, HALF_GIRDLE)
    facets += ring(-40.8, 8, 0.0, 1.0, -HALF_GIRDLE)
    facets += ring(-42.2, 16, 0.5, 1.0, -HALF_GIRDLE)
    return cut(facets, 64)


def step_cut() -> tuple[np.ndarray, np.ndarray]:
    """An octagon of steps, three above and three below the girdle."""
    facets = [(0.0, 0.0, 0.3)]
    for slope, radius, height in ((48.0, 1.0, HALF_GIRDLE), (38.0, 0.85, 0.19), (27.0, 0.75, 0.255)):
        facets += ring(slope, 8, 0.5, radius * cos(pi / 8), height)
    for slope, radius, height in ((-58.0, 1.0, -HALF_GIRDLE), (-48.0, 0.85, -0.25), (-40.0, 0.6, -0.51)):
        facets += ring(slope, 8, 0.5, radius * cos(pi / 8), height)
    return cut(facets, 8)
