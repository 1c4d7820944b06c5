"""Whether an object's own mesh is what it shows, so that changing it mends what is seen."""

from __future__ import annotations

import bpy

from ..analysis.mesh_modifiers import keeps_mesh

CONVERT = "turn it into a mesh (Object > Convert > Mesh)"


def before_changing(obj: bpy.types.Object) -> list[str]:
    """Return what to do before an object's points can be moved, as requests; empty where they are those of its mesh."""
    first = []
    if obj.library is not None or obj.data.library is not None:
        first.append("make it local")
    if obj.type != "MESH":
        first.append(CONVERT)
    elif obj.data.shape_keys is not None:
        first.append("apply its shape keys")
    if obj.mode != "OBJECT":
        first.append("leave its mode for Object Mode")
    if not all(map(keeps_mesh, obj.modifiers)):
        first.append(
            "apply its modifiers" if obj.data.users == 1 else "make its mesh single-user and apply its modifiers"
        )
    return first


def can_change(obj: bpy.types.Object) -> bool:
    """Return whether what an object shows are the points and faces of a mesh of this file."""
    return obj.is_editable and not before_changing(obj) and obj.data.is_editable
