"""Evaluated meshes as solids, kept while nothing changes them."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

import bpy
import numpy as np

from ..geometry import meshes
from ..geometry.solids import Solid
from ..scene.shapes import evaluated_triangles

_by_owner: dict[int, Solid] = {}
"""Evaluated meshes, by the session's number of the mesh, or of the object where modifiers make it its own."""

_by_content: dict[bytes, Solid] = {}
"""The same by what is in them."""


def solid_of(obj: bpy.types.Object, evaluated: bpy.types.Object) -> Solid:
    """Return an object's evaluated mesh, kept under its mesh, or under the object where modifiers make it its own."""
    is_shared = isinstance(obj.data, bpy.types.Mesh) and not obj.modifiers and not obj.data.shape_keys
    owner = (obj.data if is_shared else obj).session_uid
    solid = _by_owner.get(owner)
    if solid is None:
        solid = _by_owner[owner] = _make_solid(evaluated)
    return solid


def _make_solid(evaluated: bpy.types.Object) -> Solid:
    """Return an evaluated mesh as a solid, the same one for equal content."""
    vertices, triangles = evaluated_triangles(evaluated)
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
    solid = _make_solid(evaluated)
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
    """Drop all solids but some."""
    kept = {id(solid) for solid in solids}
    for cached in (_by_owner, _by_content):
        for key in [key for key, solid in cached.items() if id(solid) not in kept]:
            del cached[key]
