"""Media and other things of a scene as they are evaluated, in the world: what they are made of, what they hold."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ..analysis.solid_cache import EvaluatedMesh
from ..scene.materials import dielectric_node


@dataclass(frozen=True, eq=False)
class Shape:
    """An evaluated mesh at a place in the world.

    :param mesh: the same in its own space, one for all objects that show it.
    :param matrix: (4, 4) from there to the world.
    :param materials: nested dielectrics that its faces have.
    """

    obj: bpy.types.Object
    mesh: EvaluatedMesh
    matrix: np.ndarray
    materials: tuple[bpy.types.Material, ...]

    @cached_property
    def vertices(self) -> np.ndarray:
        """Return its points in the world, (n, 3) float64, scene units."""
        return self.mesh.vertices.astype(np.float64) @ self.matrix[:3, :3].T + self.matrix[:3, 3]

    @cached_property
    def triangles(self) -> np.ndarray:
        """Return the corners of its triangles, (m, 3), turned so that normals are those of the object."""
        return self.mesh.triangles[:, ::-1] if np.linalg.det(self.matrix[:3, :3]) < 0.0 else self.mesh.triangles

    @cached_property
    def box(self) -> np.ndarray:
        """Return its lowest and its highest corner in the world, (2, 3)."""
        return np.array([self.vertices.min(axis=0), self.vertices.max(axis=0)])

    @cached_property
    def size(self) -> float:
        """Return the diagonal of its box, scene units."""
        return float(np.linalg.norm(self.box[1] - self.box[0]))

    @cached_property
    def is_solid(self) -> bool:
        """Return whether it has faces, and all of it a place."""
        return len(self.mesh.triangles) > 0 and bool(np.isfinite(self.vertices).all())


def evaluated_shape(evaluated: bpy.types.Object, matrix: np.ndarray, mesh: EvaluatedMesh) -> Shape:
    """Return the shape of an evaluated object at a place in the world."""
    obj = evaluated.original
    materials = [slot.material.original if slot.material else None for slot in evaluated.material_slots]
    used = (materials[min(slot, len(materials) - 1)] for slot in mesh.slots) if materials else ()
    return Shape(obj, mesh, matrix, tuple(each for each in dict.fromkeys(used) if dielectric_node(each)))


_SAMPLES = 256
"""The most points of an object of which one must lie in a medium for the object to stand in it."""


def sample_points(shape: Shape) -> np.ndarray:
    """Return some points of a surface, (n, 3): corners and centres of triangles."""
    points = np.concatenate([shape.vertices, shape.vertices[shape.triangles].mean(axis=1)])
    return points[:: len(points) // _SAMPLES + 1]


class Containment:
    """Tests of which points lie in closed shapes; the tree of each shape is made once."""

    def __init__(self) -> None:
        self._trees: dict[int, BVHTree] = {}

    def any(self, shape: Shape, points: np.ndarray) -> bool:
        """Return whether a shape holds any of (n, 3) points."""
        low, high = shape.vertices.min(axis=0), shape.vertices.max(axis=0)
        near = points[((points >= low) & (points <= high)).all(axis=1)]
        return any(self._holds(shape, Vector(point)) for point in near)

    def _tree(self, shape: Shape) -> BVHTree:
        """Return the tree of a shape's triangles."""
        key = id(shape)
        if key not in self._trees:
            self._trees[key] = BVHTree.FromPolygons(
                shape.vertices.tolist(), shape.triangles.tolist(), all_triangles=True
            )
        return self._trees[key]

    def _holds(self, shape: Shape, point: Vector) -> bool:
        """Return whether a point lies in a shape, by the parity of crossings along a ray."""
        direction = Vector((0.3713, 0.4871, 0.7904)).normalized()
        crossings = 0
        while (hit := self._tree(shape).ray_cast(point, direction))[0] is not None:
            crossings += 1
            point = hit[0] + direction * 1e-5
        return crossings % 2 == 1
