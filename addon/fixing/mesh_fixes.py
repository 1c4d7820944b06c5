"""Fixes of the meshes of media: faces turned outwards, holes closed, caps filled."""

from __future__ import annotations

from collections.abc import Callable

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np

from ..checking.finding import Fix
from ..model.parameter import ParameterError
from .access import own_data, own_mesh, own_object, require_followers, shared
from .turning import is_consistent, islands_of, turned_islands

KEPT_NORMALS = "nd_kept_normals"
"""Attribute that carries custom normals through a change of faces."""

FLATTEST = 1e-6
"""Thickness of a mesh, in its size, up to which it is flat."""


def recalculate_normals(scene: bpy.types.Scene, fix: Fix) -> list[str]:
    """Let the faces of objects' own meshes look out of the medium, each part of a mesh on its own."""
    objects = [own_object(scene, name) for name in fix.names]
    for mesh in dict.fromkeys(map(own_mesh, objects)):
        require_followers(mesh)
    changes = []
    for obj in objects:
        turned = _change_faces(obj.data, _turn_outwards)
        if turned:
            faces = f"{turned} face{'s' * (turned != 1)}"
            changes.append(f"{obj.name}: {faces} turned to look outwards{shared(obj)}")
    return changes


def close_holes(scene: bpy.types.Scene, fix: Fix) -> list[str]:
    """Fill the holes of objects' own meshes, and let all faces look out of the medium."""
    objects = [own_object(scene, name) for name in fix.names]
    for obj in objects:
        mesh = own_mesh(obj)
        require_followers(mesh)
        if mesh.shape_keys is not None:
            raise ParameterError(f"{obj.name!r} has shape keys; apply them, and close its holes after that")
    changes = []
    made = {mesh: _closed(mesh) for mesh in dict.fromkeys(obj.data for obj in objects)}
    try:
        for obj in objects:
            why = made[obj.data][1]
            if why:
                raise ParameterError(f"{obj.name!r} {why}")
        for obj in objects:
            mesh = obj.data
            if mesh not in made:
                continue  # another object has shown it
            bm, _, filled = made.pop(mesh)
            _write(mesh, bm)
            if filled:
                changes.append(f"{obj.name}: {filled} hole{'s' * (filled != 1)} closed{shared(obj)}")
    finally:
        for bm, *_ in made.values():
            bm.free()
    return changes


def fill_caps(scene: bpy.types.Scene, fix: Fix) -> list[str]:
    """Close curves at their ends, and texts at their fronts and backs."""
    objects = [own_object(scene, name) for name in fix.names]
    for obj in objects:
        if obj.type not in ("CURVE", "FONT"):
            raise ParameterError(f"{obj.name!r} is neither a curve nor a text, which alone have caps; close it by hand")
        own_data(obj)
    changes = []
    for obj in objects:
        data = obj.data
        if obj.type == "CURVE" and not data.use_fill_caps:
            data.use_fill_caps = True
            changes.append(f"{obj.name}: Fill Caps on{shared(obj)}")
        if obj.type == "FONT" and data.fill_mode != "BOTH":
            data.fill_mode = "BOTH"
            changes.append(f"{obj.name}: Fill Mode Both{shared(obj)}")
    return changes


def _closed(mesh: bpy.types.Mesh) -> tuple[bmesh.types.BMesh, str, int]:
    """Return a mesh with its holes filled, why that is not enough, if so, and how many were filled; nothing is changed."""
    bm = bmesh.new()
    _read(mesh, bm)
    open_edges = [edge for edge in bm.edges if len(edge.link_faces) == 1]
    seams = set(map(_ends, open_edges))
    bmesh.ops.remove_doubles(bm, verts=list({vertex for edge in open_edges for vertex in edge.verts}), dist=0.0)
    for edge in bm.edges:
        if len(edge.link_faces) == 2 and _ends(edge) in seams:
            edge.smooth = False  # its sides were shaded apart
    holes = [edge for edge in bm.edges if len(edge.link_faces) == 1]
    filled = bmesh.ops.holes_fill(bm, edges=holes, sides=0)["faces"]
    for face in filled:
        beside = next(other for edge in face.edges for other in edge.link_faces if other is not face)
        face.material_index = beside.material_index
        face.smooth = False
    _turn_outwards(bm)
    vertices, triangles = _arrays(bm)
    why = ""
    if _is_flat(vertices):
        why = "is flat and would enclose nothing; give it a thickness, or another material"
    elif not is_consistent(vertices, triangles):
        why = "stays open where its faces do not meet edge to edge; close it by hand in Edit Mode"
    return bm, why, len(filled)


def _ends(edge: bmesh.types.BMEdge) -> frozenset[tuple[float, ...]]:
    """Return where an edge ends."""
    return frozenset(tuple(vertex.co) for vertex in edge.verts)


def _is_flat(vertices: np.ndarray) -> bool:
    """Return whether all points lie in one plane, or there are none."""
    if len(vertices) < 4:
        return True
    away = vertices.astype(np.float64) - vertices.mean(axis=0)
    spread = np.linalg.eigvalsh(away.T @ away)
    return bool(spread[0] <= FLATTEST**2 * spread[2])


def _turn_outwards(bm: bmesh.types.BMesh) -> int:
    """Turn the faces of a mesh so that all look out of the medium; return how many have been turned."""
    bm.verts.index_update()
    bm.faces.index_update()
    vertices, before = _arrays(bm)
    if not len(before):
        return 0
    first = [(face.loops[0].vert, face.loops[0].link_loop_next.vert) for face in bm.faces]
    owners = np.array([corners[0].face.index for corners in bm.calc_loop_triangles()])
    islands = islands_of(vertices, before)
    if not is_consistent(vertices, before):
        bmesh.ops.recalc_face_normals(bm, faces=list(bm.faces))
    turned = np.array([_is_turned(face, *pair) for face, pair in zip(bm.faces, first)], dtype=bool)
    after = np.where(turned[owners, None], before[:, ::-1], before)
    again = turned_islands(vertices, before, after, islands)
    faces = np.unique(owners[again[islands]])
    if len(faces):
        bm.faces.ensure_lookup_table()
        bmesh.ops.reverse_faces(bm, faces=[bm.faces[index] for index in faces], flip_multires=True)
        turned[faces] ^= True
    return int(np.count_nonzero(turned))


def _is_turned(face: bmesh.types.BMFace, first: bmesh.types.BMVert, second: bmesh.types.BMVert) -> bool:
    """Return whether a face no longer goes from one corner to another that followed it."""
    return not any(loop.vert is first and loop.link_loop_next.vert is second for loop in face.loops)


def _arrays(bm: bmesh.types.BMesh) -> tuple[np.ndarray, np.ndarray]:
    """Return the vertices of a mesh, (n, 3) float32, and the corners of its triangles, (m, 3)."""
    bm.verts.index_update()
    vertices = np.array([vertex.co for vertex in bm.verts], dtype=np.float32).reshape(-1, 3)
    corners = [[loop.vert.index for loop in triangle] for triangle in bm.calc_loop_triangles()]
    return vertices, np.array(corners, dtype=np.int32).reshape(-1, 3)


def _change_faces(mesh: bpy.types.Mesh, change: Callable[[bmesh.types.BMesh], int]) -> int:
    """Change the faces of a mesh if there is something to change; return how many have been."""
    bm = bmesh.new()
    _read(mesh, bm)
    count = change(bm)
    if count:
        _write(mesh, bm)
    else:
        bm.free()
    return count


def _read(mesh: bpy.types.Mesh, bm: bmesh.types.BMesh) -> None:
    """Read a mesh, with its custom normals in a layer of the corners."""
    bm.from_mesh(mesh, face_normals=True, vertex_normals=False)
    if mesh.has_custom_normals:
        layer = bm.loops.layers.float_vector.new(KEPT_NORMALS)
        normals = mesh.corner_normals
        for face in bm.faces:
            for loop in face.loops:
                loop[layer] = normals[loop.index].vector


def _write(mesh: bpy.types.Mesh, bm: bmesh.types.BMesh) -> None:
    """Give a mesh other faces, and end with the other mesh. Where points are by shape keys they stay as they are."""
    places = None
    if mesh.shape_keys is not None:
        places = np.empty(3 * len(mesh.vertices), dtype=np.float32)
        mesh.vertices.foreach_get("co", places)
    bm.to_mesh(mesh)
    bm.free()
    if places is not None:
        mesh.vertices.foreach_set("co", places)
    restore_normals(mesh)
    mesh.update()
    mesh.update_tag()


def keep_normals(mesh: bpy.types.Mesh) -> None:
    """Let a mesh carry its custom normals while its faces are turned, or its points move."""
    if mesh.has_custom_normals:
        attribute = mesh.attributes.new(KEPT_NORMALS, "FLOAT_VECTOR", "CORNER")
        normals = np.empty(3 * len(mesh.loops), dtype=np.float32)
        mesh.corner_normals.foreach_get("vector", normals)
        attribute.data.foreach_set("vector", normals)


def restore_normals(mesh: bpy.types.Mesh, linear: np.ndarray | None = None) -> None:
    """Let a mesh have the custom normals that it carries, on the side of the faces that they are now on.

    Corners without one are shaded as the mesh's edges say.

    :param linear: (3, 3) by what its points have been multiplied meanwhile.
    """
    attribute = mesh.attributes.get(KEPT_NORMALS)
    if attribute is None:
        return
    normals = np.empty((len(mesh.loops), 3), dtype=np.float32)
    attribute.data.foreach_get("vector", normals.reshape(-1))
    mesh.attributes.remove(attribute)
    if linear is not None:
        normals = normals @ np.linalg.inv(linear)
    faces = np.empty((len(mesh.polygons), 3), dtype=np.float32)
    mesh.polygon_normals.foreach_get("vector", faces.reshape(-1))
    sizes = np.empty(len(mesh.polygons), dtype=np.int32)
    mesh.polygons.foreach_get("loop_total", sizes)
    away = np.einsum("ij,ij->i", normals, faces.repeat(sizes, axis=0)) < 0.0
    normals[away] *= -1.0
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    mesh.normals_split_custom_set(normals.tolist())
