"""What a fix may change, by name, and why it may not be changed: sentences that name the object and the remedy."""

from __future__ import annotations

from math import isfinite

import bpy

from ..analysis.mesh_modifiers import keeps_mesh
from ..checking.finding import Fix
from ..model.parameter import ParameterError
from ..scene.materials import dielectric_node
from ..scene.media import all_objects

FOLLOWING_MODIFIERS = frozenset(
    (
        "ARMATURE",
        "BEVEL",
        "CAST",
        "CORRECTIVE_SMOOTH",
        "LAPLACIANSMOOTH",
        "LATTICE",
        "SHRINKWRAP",
        "SIMPLE_DEFORM",
        "SMOOTH",
        "SUBSURF",
        "TRIANGULATE",
        "WEIGHTED_NORMAL",
    )
)
"""Modifiers whose result is closed, and turned, as the mesh is that they are given."""


def shown_object(scene: bpy.types.Scene, name: str) -> bpy.types.Object:
    """Return an object of a scene, or of what it instances, by its name; where several have it, the file's own.

    :raises ParameterError: if there is none.
    """
    found = [obj for obj in all_objects(scene) if obj.name == name]
    if not found:
        raise ParameterError(f"{name!r} is gone; check the scene again")
    return min(found, key=lambda obj: obj.library is not None)


def own_object(scene: bpy.types.Scene, name: str) -> bpy.types.Object:
    """Return an object that may be changed.

    :raises ParameterError: if it is gone, linked, or in another mode than Object Mode.
    """
    obj = shown_object(scene, name)
    _require_own(obj)
    if obj.mode != "OBJECT":
        raise ParameterError(f"{name!r} is being edited; leave its mode for Object Mode first")
    return obj


def own_data(obj: bpy.types.Object) -> bpy.types.ID:
    """Return what an object shows, which may be changed.

    :raises ParameterError: if it is linked, or being edited.
    """
    data = obj.data
    if data is None:
        raise ParameterError(f"{obj.name!r} has no shape to change")
    if not data.is_editable:
        raise ParameterError(
            f"{obj.name!r} has its shape from {_library_of(data)}; make it local first (Object > Relations > Make Local)"
        )
    if getattr(data, "is_editmode", False):
        raise ParameterError(f"{obj.name!r} is being edited; leave Edit Mode first")
    return data


def own_mesh(obj: bpy.types.Object) -> bpy.types.Mesh:
    """Return an object's mesh, which may be changed.

    :raises ParameterError: if it is linked or being edited, or the object has none.
    """
    if obj.type != "MESH":
        raise ParameterError(f"{obj.name!r} is no mesh; turn it into one first (Object > Convert > Mesh)")
    return own_data(obj)


def require_followers(mesh: bpy.types.Mesh) -> None:
    """Hold the users of a mesh to modifiers whose result is closed, and turned, as the mesh is.

    :raises ParameterError: if one has others.
    """
    for obj in users_of(mesh):
        others = [each.name for each in obj.modifiers if not keeps_mesh(each) and each.type not in FOLLOWING_MODIFIERS]
        if others:
            raise ParameterError(
                f"{obj.name!r} gets its faces from the modifier {others[0]!r}; apply it first, or mend what it makes"
            )


def require_plain_points(obj: bpy.types.Object) -> None:
    """Hold an object to a mesh whose points are those of the evaluated one, but for what our own modifier moves.

    :raises ParameterError: if there is more to them.
    """
    mesh = own_mesh(obj)
    if mesh.shape_keys is not None:
        raise ParameterError(f"{obj.name!r} has shape keys; apply them first")
    others = [each.name for each in obj.modifiers if not keeps_mesh(each)]
    if others:
        raise ParameterError(f"{obj.name!r} gets its points from the modifier {others[0]!r}; apply it first")


def users_of(data: bpy.types.ID) -> list[bpy.types.Object]:
    """Return the objects of the file that show some data."""
    return [obj for obj in bpy.data.objects if obj.data == data]


def shared(obj: bpy.types.Object) -> str:
    """Return whom a change of an object's data changes as well, for the end of a sentence."""
    others = len(users_of(obj.data)) - 1
    return f", which {others} other object{'s' * (others != 1)} share{'s' * (others == 1)}" if others else ""


def own_material(name: str) -> bpy.types.Material:
    """Return a nested dielectric that may be changed.

    :raises ParameterError: if it is gone, linked, or none.
    """
    found = [material for material in bpy.data.materials if material.name == name]
    if not found:
        raise ParameterError(f"Material {name!r} is gone; check the scene again")
    material = min(found, key=lambda each: each.library is not None)
    _require_own(material)
    return material


def require_dielectric(material: bpy.types.Material) -> bpy.types.ShaderNodeGroup:
    """Return the node that neighbours read a material by.

    :raises ParameterError: if they read none.
    """
    node = dielectric_node(material)
    if node is None:
        raise ParameterError(
            f"{material.name!r} is no nested dielectric that neighbours can read; mend its nodes first"
        )
    return node


def length_in(fix: Fix) -> float:
    """Return the distance that a fix needs, scene units.

    :raises ParameterError: if it holds none.
    """
    if isinstance(fix.value, bool) or not isinstance(fix.value, (int, float)) or not isfinite(fix.value):
        raise ParameterError(f"{fix.action.value} needs a distance; check the scene again")
    if fix.value <= 0.0:
        raise ParameterError(f"{fix.action.value} needs a distance above 0; check the scene again")
    return float(fix.value)


def _require_own(data: bpy.types.ID) -> None:
    if not data.is_editable:
        raise ParameterError(f"{data.name!r} comes from {_library_of(data)}; mend it there, or make it local first")


def _library_of(data: bpy.types.ID) -> str:
    return "another file" if data.library is None else repr(data.library.filepath)
