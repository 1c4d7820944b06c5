"""Parting media whose faces lie in the same place, which rays cannot tell apart.

Of two faces in one place a ray meets either, and a probe finds only one. The weaker medium's are moved into the stronger one,
where they are not seen: outwards where the faces look against each other, inwards where they look the same way. So what is
seen keeps its shape. Only where the stronger one's lie on part of a larger face are they moved themselves, outwards. A
Geometry Nodes modifier moves them by an attribute of the mesh, in a render without the extension too.
"""

from __future__ import annotations

import bpy
import numpy as np

from .analysis import Coincidence, coincidences, is_offset, triangles_of
from .checks import Problem
from .meshes import is_closed, same_places
from .node_group import OFFSET_ATTRIBUTE, OFFSET_GROUP, is_offset_group

PARTING = 1e-4
"""Distance between parted faces, in diagonals of the weaker object: ten times what counts as the same place."""

ROUNDING = 4e-6
"""The same in coordinates far from the origin, where single precision is coarser than that."""

FLATTEST = 0.02
"""Part of the largest below which a spread of normals is rounding, not another direction."""


def part_coincident(scene: bpy.types.Scene) -> tuple[list[str], list[Problem]]:
    """Part what coincides in a scene as it is evaluated now. Return what was changed, in sentences, and what could not be."""
    changes, problems = [], []
    for found in coincidences(scene):
        if not _is_movable(found.obj):
            problems.append(
                Problem(
                    found.obj.name,
                    f"has faces in the same place as {found.others}",
                    "let them overlap, or apply its modifiers and make its mesh single-user: then they are parted"
                    if found.obj.type == "MESH"
                    else "let them overlap, or turn it into a mesh (Object > Convert > Mesh): then they are parted",
                )
            )
            continue
        distance = (PARTING * found.size + ROUNDING * found.reach) * found.rank
        _move(found, distance)
        changes.append(
            f"{found.obj.name}: {distance:.2g} parted from {found.others}, which has faces in the same place "
            f"(modifier {OFFSET_GROUP!r})"
        )
    return changes, problems


def _is_movable(obj: bpy.types.Object) -> bool:
    """Whether the points of the mesh are those of the evaluated one, and no other object's."""
    mesh = obj.data
    return (
        isinstance(mesh, bpy.types.Mesh)
        and obj.library is None
        and mesh.library is None
        and mesh.users == 1
        and mesh.shape_keys is None
        and obj.mode == "OBJECT"
        and all(map(is_offset, obj.modifiers))
    )


def offsets(count: int, corners: np.ndarray, normals: np.ndarray, heights: np.ndarray) -> np.ndarray:
    """Return how far to move points so that triangles rise by their heights along their normals.

    The shortest vector that does so best: the least squares of each point's triangles.

    :param count: number of points.
    :param corners: (m, 3) indices of points.
    :param normals: (m, 3) unit vectors.
    :param heights: (m,).
    :returns: (count, 3); 0 for points of no triangle.
    """
    squares = np.zeros((count, 3, 3))
    sums = np.zeros((count, 3))
    for corner in corners.T:
        np.add.at(squares, corner, normals[:, :, None] * normals[:, None, :])
        np.add.at(sums, corner, heights[:, None] * normals)
    used = np.unique(corners)
    result = np.zeros((count, 3))
    inverse = np.linalg.pinv(squares[used], rcond=FLATTEST, hermitian=True)
    result[used] = np.einsum("nij,nj->ni", inverse, sums[used])
    return result


def _move(found: Coincidence, distance: float) -> None:
    mesh = found.obj.data
    world = offsets(len(mesh.vertices), found.corners, found.normals, distance * found.sides)
    vertices, triangles = triangles_of(mesh)
    if not is_closed(triangles):
        world = world[same_places(vertices)]  # both sides of a seam
    local = world @ np.linalg.inv(found.matrix[:3, :3]).T
    attribute = mesh.attributes.get(OFFSET_ATTRIBUTE)
    if attribute is not None and (attribute.data_type, attribute.domain) != ("FLOAT_VECTOR", "POINT"):
        mesh.attributes.remove(attribute)
        attribute = None
    if attribute is None:
        attribute = mesh.attributes.new(OFFSET_ATTRIBUTE, "FLOAT_VECTOR", "POINT")
    before = np.zeros(local.size, dtype=np.float32)
    if any(map(is_offset, found.obj.modifiers)):
        attribute.data.foreach_get("vector", before)
        before[~np.isfinite(before)] = 0.0
    attribute.data.foreach_set("vector", before + local.reshape(-1).astype(np.float32))
    if not any(map(is_offset, found.obj.modifiers)):
        found.obj.modifiers.new(OFFSET_GROUP, "NODES").node_group = _ensure_group()
    mesh.update_tag()


def _ensure_group() -> bpy.types.NodeTree:
    for found in bpy.data.node_groups:
        if found.library is None and is_offset_group(found):
            return found
    tree = bpy.data.node_groups.new(OFFSET_GROUP, "GeometryNodeTree")
    tree.is_modifier = True
    tree.description = "Moves points off faces of another medium in the same place"
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    source, sink = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    offset = tree.nodes.new("GeometryNodeInputNamedAttribute")
    offset.data_type = "FLOAT_VECTOR"
    offset.inputs["Name"].default_value = OFFSET_ATTRIBUTE
    moved = tree.nodes.new("GeometryNodeSetPosition")
    tree.links.new(source.outputs[0], moved.inputs["Geometry"])
    tree.links.new(offset.outputs["Attribute"], moved.inputs["Offset"])
    tree.links.new(moved.outputs[0], sink.inputs[0])
    for index, node in enumerate((source, offset, moved, sink)):
        node.location = (220.0 * index, -160.0 if node == offset else 0.0)
    return tree
