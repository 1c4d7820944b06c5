"""Meshes of a scene as they are evaluated, for checks: their triangles, whether they are closed, what they hold."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ..geometry import meshes
from ..scene.materials import dielectric_node
from ..scene.shapes import mesh_triangles


@dataclass(frozen=True)
class Shape:
    """An evaluated mesh in world space.

    :param mesh: the same in its own space, one for all objects that show it.
    :param vertices: (n, 3), scene units; triangles: (m, 3) indices, turned so that normals are those of the object.
    :param materials: nested dielectrics that its faces have.
    """

    obj: bpy.types.Object
    mesh: EvaluatedMesh
    vertices: np.ndarray
    triangles: np.ndarray
    materials: tuple[bpy.types.Material, ...]


@dataclass(frozen=True, eq=False)
class EvaluatedMesh:
    """An evaluated mesh in its own space, and what is wrong with it.

    :param vertices: (n, 3); triangles: (m, 3) indices of vertices.
    :param slots: material slots of its faces, each once.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    slots: np.ndarray

    @cached_property
    def open_edges(self) -> int:
        """Count edges that are not between two faces turned alike; a seam is none."""
        edges = meshes.open_edge_count(self.triangles)
        return edges and meshes.open_edge_count(meshes.same_places(self.vertices)[self.triangles])

    @cached_property
    def is_inverted(self) -> bool:
        """Return whether its normals point inwards."""
        return meshes.signed_volume(self.vertices.astype(np.float64), self.triangles) < 0.0


def evaluated_shape(
    evaluated: bpy.types.Object, matrix: np.ndarray, known: dict[int, EvaluatedMesh] | None = None
) -> Shape | None:
    """Return the shape of an evaluated object at a place in the world; None if it has no mesh.

    :param known: meshes that objects show as they are, by the session's numbers of the meshes; brought up to date.
    """
    obj = evaluated.original
    shared = known is not None and obj.type == "MESH" and not obj.modifiers and obj.data.shape_keys is None
    mesh = known.get(obj.data.session_uid) if shared else None
    if mesh is None:
        mesh = _evaluated_mesh(evaluated)
        if mesh is None:
            return None
        if shared:
            known[obj.data.session_uid] = mesh
    world = mesh.vertices.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    triangles = mesh.triangles[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0.0 else mesh.triangles
    materials = [slot.material.original if slot.material else None for slot in evaluated.material_slots]
    used = (materials[min(slot, len(materials) - 1)] for slot in mesh.slots) if materials else ()
    return Shape(obj, mesh, world, triangles, tuple(each for each in dict.fromkeys(used) if dielectric_node(each)))


def _evaluated_mesh(evaluated: bpy.types.Object) -> EvaluatedMesh | None:
    """Return the mesh of an evaluated object; None if it has none."""
    try:
        mesh = evaluated.to_mesh()
    except RuntimeError:
        return None
    if mesh is None:
        return None
    try:
        slots = np.zeros(len(mesh.polygons), dtype=np.int32)
        mesh.polygons.foreach_get("material_index", slots)
        return EvaluatedMesh(*mesh_triangles(mesh), np.unique(slots))
    finally:
        evaluated.to_mesh_clear()


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

    def overlap(self, one: Shape, other: Shape) -> bool:
        """Return whether two shapes cross, or one holds the other."""
        if self._tree(one).overlap(self._tree(other)):
            return True
        return self.any(one, other.vertices[other.triangles[:1, 0]]) or self.any(
            other, one.vertices[one.triangles[:1, 0]]
        )

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
