"""Evaluated meshes, and the solids that they bound: read once for all that looks at them, kept while nothing changes them."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import bpy
import numpy as np

from ..geometry import meshes
from ..geometry.solids import Solid
from ..scene.shapes import evaluated_faces, evaluated_triangles


@dataclass(frozen=True, eq=False)
class EvaluatedMesh:
    """An evaluated mesh in its own space.

    :param vertices: (n, 3) float32; triangles: (m, 3) int32, indices of vertices.
    :param faces: (m,) the polygon of each triangle; slots: material slots of its polygons, each once.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    faces: np.ndarray
    slots: np.ndarray

    @cached_property
    def solid(self) -> Solid:
        """Return the solid that it bounds, the same one for equal content."""
        return _make_solid(self.vertices, self.triangles)

    @cached_property
    def open_edges(self) -> int:
        """Count edges that are not between two faces turned alike; a seam is none."""
        edges = meshes.open_edge_count(self.triangles)
        return edges and meshes.open_edge_count(meshes.same_places(self.vertices)[self.triangles])

    @cached_property
    def is_inverted(self) -> bool:
        """Return whether its normals point inwards."""
        return meshes.signed_volume(self.vertices.astype(np.float64), self.triangles) < 0.0


_by_owner: dict[int, EvaluatedMesh] = {}
"""Evaluated meshes, by the session's number of the mesh, or of the object where modifiers make it its own."""

_by_content: dict[bytes, Solid] = {}
"""Their solids, by what is in them."""


def mesh_of(obj: bpy.types.Object, evaluated: bpy.types.Object) -> EvaluatedMesh:
    """Return an object's evaluated mesh, kept under its mesh, or under the object where modifiers make it its own."""
    is_shared = isinstance(obj.data, bpy.types.Mesh) and not obj.modifiers and not obj.data.shape_keys
    owner = (obj.data if is_shared else obj).session_uid
    mesh = _by_owner.get(owner)
    if mesh is None:
        mesh = _by_owner[owner] = EvaluatedMesh(*evaluated_faces(evaluated))
    return mesh


def solid_of(obj: bpy.types.Object, evaluated: bpy.types.Object) -> Solid:
    """Return the solid that an object's evaluated mesh bounds."""
    return mesh_of(obj, evaluated).solid


def _make_solid(vertices: np.ndarray, triangles: np.ndarray) -> Solid:
    """Return a mesh as a solid, the same one for equal content."""
    if not meshes.is_closed(triangles):
        triangles = meshes.same_places(vertices)[triangles]
    content = hashlib.sha256(vertices)
    content.update(triangles)
    key = content.digest()
    if key not in _by_content:
        _by_content[key] = Solid(vertices.astype(np.float64), triangles)
    return _by_content[key]


def is_one_closed_surface(evaluated: bpy.types.Object) -> str:
    """Return why an evaluated object bounds no volume once and for all; empty if it does."""
    solid = _make_solid(*evaluated_triangles(evaluated))
    if not solid.closed:
        return "is not closed"
    return "crosses itself" if solid.overlaps_itself else ""


def forget(data: bpy.types.ID) -> None:
    """Read the mesh of an object, or a mesh, anew the next time."""
    _by_owner.pop(data.session_uid, None)


def forget_all() -> None:
    """Read all meshes anew the next time."""
    _by_owner.clear()


def keep_only(solids: Iterable[Solid]) -> None:
    """Drop all solids but some, and the meshes of those that are dropped."""
    kept = {id(solid) for solid in solids}
    for key in [key for key, mesh in _by_owner.items() if id(vars(mesh).get("solid")) not in kept]:
        del _by_owner[key]
    for key in [key for key, solid in _by_content.items() if id(solid) not in kept]:
        del _by_content[key]
