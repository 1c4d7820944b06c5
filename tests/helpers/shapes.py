"""Shapes that show a wrong transform, and meshes of several parts."""

import bpy  # noqa: F401  before bmesh and mathutils, which live inside it

import bmesh  # isort: skip
from mathutils import Matrix

SHAPE = Matrix.LocRotScale((0.1, 0.2, -0.1), Matrix.Rotation(0.4, 3, "X").to_quaternion(), (0.9, 0.7, 0.8))


def egg(bm) -> None:
    """An asymmetric closed shape, so that a wrong transform shows."""
    bmesh.ops.create_icosphere(bm, subdivisions=3, radius=1.0)
    for vertex in bm.verts:
        vertex.co *= 1.0 + 0.15 * vertex.co.x
