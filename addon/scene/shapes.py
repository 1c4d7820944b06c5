"""Shapes of objects as Blender evaluates them: triangles, and how thick a body is."""

from __future__ import annotations

from hashlib import sha256

import bpy
import numpy as np

from ..geometry import meshes


def evaluated_triangles(evaluated: bpy.types.Object) -> tuple[np.ndarray, np.ndarray]:
    """Return what :func:`mesh_triangles` returns of an evaluated object; no triangles if it shows nothing."""
    try:
        mesh = evaluated.to_mesh()
    except RuntimeError:
        mesh = None
    if mesh is None:
        return np.empty((0, 3), dtype=np.float32), np.empty((0, 3), dtype=np.int32)
    try:
        return mesh_triangles(mesh)
    finally:
        evaluated.to_mesh_clear()


def evaluated_faces(evaluated: bpy.types.Object) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return what :func:`mesh_triangles` returns of an evaluated object, and what its faces are.

    :returns: beside vertices and triangles, (m,) the polygon of each triangle, and material slots of polygons, each once.
    """
    try:
        mesh = evaluated.to_mesh()
    except RuntimeError:
        mesh = None
    if mesh is None:
        none = np.empty(0, dtype=np.int32)
        return np.empty((0, 3), dtype=np.float32), none.reshape(0, 3), none, none
    try:
        vertices, triangles = mesh_triangles(mesh)
        faces = np.arange(len(triangles), dtype=np.int32)
        if len(triangles) != len(mesh.polygons):
            mesh.loop_triangle_polygons.foreach_get("value", faces)
        slots = np.zeros(len(mesh.polygons), dtype=np.int32)
        mesh.polygons.foreach_get("material_index", slots)
        return vertices, triangles, faces, np.unique(slots)
    finally:
        evaluated.to_mesh_clear()


def mesh_triangles(mesh: bpy.types.Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Return a mesh's vertices, (n, 3) float32, and the corners of its triangles, (m, 3) int32."""
    mesh.calc_loop_triangles()
    vertices = np.empty((len(mesh.vertices), 3), dtype=np.float32)
    triangles = np.empty((len(mesh.loop_triangles), 3), dtype=np.int32)
    if len(vertices):  # without them it has no attribute
        mesh.attributes["position"].data.foreach_get("vector", vertices.reshape(-1))
    if 0 < len(triangles) == len(mesh.polygons):  # all are triangles, and the attribute is read fifty times as fast
        mesh.attributes[".corner_vert"].data.foreach_get("value", triangles.reshape(-1))
    else:
        mesh.loop_triangles.foreach_get("vertices", triangles.reshape(-1))
    return vertices, triangles


_NUMBERS = {"FLOAT": np.float32, "INT": np.int32, "BOOLEAN": np.bool_}


def mesh_digest(mesh: bpy.types.Mesh) -> bytes:
    """Return a digest of all numbers that a mesh carries, SHA-256."""
    digest = sha256()
    for attribute in mesh.attributes:
        if not len(attribute.data) or attribute.name.startswith((".select", ".hide")):
            continue
        value = next(prop for prop in attribute.data[0].bl_rna.properties if prop.identifier != "rna_type")
        if value.type in _NUMBERS:
            numbers = np.empty(len(attribute.data) * max(value.array_length, 1), dtype=_NUMBERS[value.type])
            attribute.data.foreach_get(value.identifier, numbers)
            digest.update(attribute.name.encode())
            digest.update(numbers)
    return digest.digest()


def thickness(obj: bpy.types.Object) -> float:
    """Return how thick a body is as it stands in the scene, in scene units: the mean length of the ways through it.

    For what is not closed it is the smallest side of its box. 0 for what has no extent.
    """
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    # What is in no view layer has not been placed yet.
    place = evaluated.matrix_world if evaluated.is_evaluated or obj.parent else obj.matrix_basis
    matrix = np.array(place, dtype=np.float64)[:3, :3]
    vertices, triangles = evaluated_triangles(evaluated)
    if not meshes.is_closed(triangles):
        triangles = meshes.same_places(vertices)[triangles]
    if len(triangles) and meshes.is_closed(triangles):
        return meshes.mean_chord(vertices.astype(np.float64) @ matrix.T, triangles)
    box = np.array([tuple(corner) for corner in evaluated.bound_box])
    sides = matrix * (box.max(axis=0) - box.min(axis=0))
    return float(np.linalg.norm(sides, axis=0).min())
