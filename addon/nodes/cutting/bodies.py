"""Nodes that read the media which are to be cut."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ..stored import stored_list
from ..wholeness import is_whole
from .builder import GEOMETRY, Builder, new_tree
from .names import ATTRIBUTES, BODY, BODY_GROUP, BODY_INPUT, NORMAL, OWN_INPUT
from .plan import Plan

CHUNK = 24
"""Most bodies of one node group, as the time to add a node grows with the nodes of its tree."""


def is_among(build: Builder, first, end) -> bpy.types.NodeSocket:
    """Return whether the number of a body is one from the first to before the end."""
    number = build.attribute(BODY, "INT")
    return build.all_of((build.compare(number, "GREATER_EQUAL", first), build.compare(number, "LESS_THAN", end)))


def numbered(build: Builder, geometry, first: int, end: int) -> bpy.types.NodeSocket:
    """Return the faces of the bodies from one number to before another."""
    return build.faces(geometry, is_among(build, first, end))


def evaluated_triangles(build: Builder, obj) -> bpy.types.NodeSocket:
    """Read what another object shows, seen from this one's space."""
    info = build.node("GeometryNodeObjectInfo", properties={"transform_space": "RELATIVE"}, Object=obj)
    mesh = build.node("GeometryNodeRealizeInstances", Geometry=info.outputs["Geometry"]).outputs[0]
    return as_outside_in(build, info, mesh)


def as_outside_in(build: Builder, info: bpy.types.Node, mesh) -> bpy.types.NodeSocket:
    """Turn a mesh's faces outwards again where the way from the other object's space mirrors them."""
    determinant = build.node("FunctionNodeMatrixDeterminant", Matrix=info.outputs["Transform"]).outputs[0]
    return build.switch(build.compare(determinant, "LESS_THAN", 0.0, "FLOAT"), mesh, build.flipped(mesh))


def _ensure_body_tree(attributes: tuple[str, ...]) -> bpy.types.NodeTree:
    """Return the group that reads one medium: its faces with its number and normals, and whether it is closed.

    :param attributes: of points, which the solver leaves at 0 where it makes new ones; those of corners are interpolated.
    """
    marked = list(attributes) or [""]
    for tree in bpy.data.node_groups:
        if tree.library is None and is_whole(tree) and stored_list(tree, ATTRIBUTES) == marked:
            return tree
    tree = new_tree(
        BODY_GROUP,
        {OWN_INPUT: "NodeSocketObject", BODY_INPUT: "NodeSocketInt"},
        GEOMETRY | {"Closed": "NodeSocketBool"},
        "A medium that is to be cut",
    )
    tree[ATTRIBUTES] = marked
    build = Builder(tree)
    mesh = evaluated_triangles(build, build.inputs.outputs[OWN_INPUT])
    for name in attributes:
        mesh = _by_corner(build, mesh, name)
    smooth = build.count(mesh, "FACE", build.tree.nodes.new("GeometryNodeInputShadeSmooth").outputs[0])
    normal = build.tree.nodes.new("GeometryNodeInputNormal").outputs["Normal"]
    with_normals = build.stored(mesh, NORMAL, normal, "FLOAT_VECTOR", "CORNER")
    mesh = build.switch(build.compare(smooth, "GREATER_THAN", 0.5, "FLOAT"), mesh, with_normals)
    neighbours = build.tree.nodes.new("GeometryNodeInputMeshEdgeNeighbors").outputs[0]
    loose = build.count(mesh, "EDGE", build.compare(neighbours, "NOT_EQUAL", 2))
    build.returns(
        Geometry=build.stored(mesh, BODY, build.inputs.outputs[BODY_INPUT], "INT"),
        Closed=build.compare(loose, "LESS_THAN", 0.5, "FLOAT"),
    )
    return tree


def _by_corner(build: Builder, mesh, name: str) -> bpy.types.NodeSocket:
    """Move an attribute of a mesh from its points to its corners, as a colour."""
    capture = build.node("GeometryNodeCaptureAttribute", properties={"domain": "CORNER"}, Geometry=mesh)
    capture.capture_items.new("RGBA", name)
    build.put(capture.inputs[name], build.attribute(name, "FLOAT_COLOR"))
    removed = build.node("GeometryNodeRemoveAttribute", Geometry=capture.outputs["Geometry"], Name=name).outputs[0]
    return build.stored(removed, name, capture.outputs[name], "FLOAT_COLOR", "CORNER")


def _bodies_tree(plan: Plan, bodies: Sequence[tuple[bpy.types.Object, int]], overlapping: bool) -> bpy.types.NodeTree:
    """Make a group that reads some media, as one body where they overlap."""
    tree = new_tree(f"{BODY_GROUP}s", {}, GEOMETRY | {"Closed": "NodeSocketBool"}, "Media that are to be cut")
    build = Builder(tree)
    read = [_body(build, plan, obj, number) for obj, number in bodies]
    geometries = [geometry for geometry, _ in read]
    build.returns(
        Geometry=united_where_they_meet(build, geometries) if overlapping else build.joined(geometries),
        Closed=build.all_of([closed for _, closed in read]),
    )
    return tree


def _body(
    build: Builder, plan: Plan, obj: bpy.types.Object, number: int
) -> tuple[bpy.types.NodeSocket, bpy.types.NodeSocket]:
    """Read one medium: its faces, and whether it is closed."""
    node = build.node("GeometryNodeGroup", properties={"node_tree": _ensure_body_tree(plan.attributes.get(obj, ()))})
    node.inputs[OWN_INPUT].default_value = obj
    node.inputs[BODY_INPUT].default_value = number
    return node.outputs["Geometry"], node.outputs["Closed"]


def read_bodies(
    build: Builder, plan: Plan, bodies: Sequence[tuple[bpy.types.Object, int]], overlapping: bool = False
) -> tuple[list[bpy.types.NodeSocket], list[bpy.types.NodeSocket]]:
    """Return geometries of media, many of them in one, and whether each of these is closed."""
    if len(bodies) <= CHUNK:
        pairs = [_body(build, plan, *body) for body in bodies]
    else:
        trees = [
            _bodies_tree(plan, bodies[start : start + CHUNK], overlapping) for start in range(0, len(bodies), CHUNK)
        ]
        nodes = [build.node("GeometryNodeGroup", properties={"node_tree": tree}) for tree in trees]
        pairs = [(node.outputs["Geometry"], node.outputs["Closed"]) for node in nodes]
    return [geometry for geometry, _ in pairs], [closed for _, closed in pairs]


def united_where_they_meet(build: Builder, geometries: Sequence[bpy.types.NodeSocket]) -> bpy.types.NodeSocket:
    """Unite the media of one layer where their boxes meet."""
    geometries = list(geometries)
    while len(geometries) > 1:
        pairs = list(zip(geometries[::2], geometries[1::2]))
        rest = geometries[len(pairs) * 2 :]
        geometries = [
            build.switch(
                build.meet(build.box(first), build.box(second)),
                build.joined([first, second]),
                build.united(first, second),
            )
            for first, second in pairs
        ] + rest
    return geometries[0]
