"""Groups by which objects show their faces of the cut."""

from __future__ import annotations

import bpy

from .bodies import as_outside_in, evaluated_triangles, is_among
from .builder import GEOMETRY, Builder, enabled_input, enabled_output, find_tree, new_tree
from .names import (
    BODY,
    BODY_INPUT,
    CUT_INPUT,
    END_INPUT,
    FRAME_INPUT,
    KEPT_GROUP,
    NORMAL,
    OWN_INPUT,
    PART_GROUP,
    SURFACE_GROUP,
)

PART = 32
"""Media whose faces stand in one part: an object that picks the faces of one medium looks at all of a part."""

SURFACE_INPUTS = {OWN_INPUT: "NodeSocketObject", CUT_INPUT: "NodeSocketObject", BODY_INPUT: "NodeSocketInt"}


def ensure_surface_tree() -> bpy.types.NodeTree:
    """Return the group by which an object shows one medium's faces of the cut.

    One point of the medium stands before them: the mesh that comes first brings its slots and its texture space.
    """
    tree = find_tree(SURFACE_GROUP)
    if tree is not None:
        return tree
    inputs = GEOMETRY | SURFACE_INPUTS
    tree = new_tree(
        SURFACE_GROUP, inputs, GEOMETRY, "A medium's surface as far as it exists, cut where others cross it"
    )
    tree.is_modifier = True
    build = Builder(tree)
    own = evaluated_triangles(build, build.inputs.outputs[OWN_INPUT])
    first = build.node("GeometryNodeSeparateGeometry", properties={"domain": "POINT"}, Geometry=own)
    build.put(
        first.inputs["Selection"], build.compare(build.tree.nodes.new("GeometryNodeInputIndex").outputs[0], "EQUAL", 0)
    )
    cut = _cut_by(build)
    picked = _picked(build, cut, build.compare(build.attribute(BODY, "INT"), "EQUAL", build.inputs.outputs[BODY_INPUT]))
    faces = build.node("GeometryNodeRealizeInstances", Geometry=picked).outputs[0]
    shown = build.joined([first.outputs["Selection"], as_outside_in(build, cut, faces)])
    smooth = build.count(shown, "FACE", build.tree.nodes.new("GeometryNodeInputShadeSmooth").outputs[0])
    build.returns(
        Geometry=build.switch(
            build.compare(smooth, "GREATER_THAN", 0.5, "FLOAT"), shown, _with_normals(build, shown, cut)
        )
    )
    return tree


def ensure_kept_tree() -> bpy.types.NodeTree:
    """Return the group by which an object shows its own mesh on one frame, and on others what :func:`ensure_surface_tree` does.

    It is another group because whatever asks for the frame is evaluated anew, and taken for another mesh, in every render.
    """
    tree = find_tree(KEPT_GROUP)
    if tree is not None:
        return tree
    inputs = GEOMETRY | SURFACE_INPUTS | {FRAME_INPUT: "NodeSocketInt"}
    tree = new_tree(
        KEPT_GROUP, inputs, GEOMETRY, "A medium's surface, cut where others cross it, that is kept for one frame"
    )
    tree.is_modifier = True
    build = Builder(tree)
    sockets = {name: build.inputs.outputs[name] for name in (*GEOMETRY, *SURFACE_INPUTS)}
    shown = build.node("GeometryNodeGroup", properties={"node_tree": ensure_surface_tree()}, **sockets).outputs[0]
    frame = enabled_output(build.tree.nodes.new("GeometryNodeInputSceneTime"), "Frame")
    then = build.node("FunctionNodeCompare", properties={"data_type": "FLOAT", "operation": "EQUAL"}, A=frame)
    build.put(enabled_input(then, "B"), build.inputs.outputs[FRAME_INPUT])
    enabled_input(then, "Epsilon").default_value = 1e-3
    build.returns(Geometry=build.switch(then.outputs[0], shown, build.inputs.outputs["Geometry"]))
    return tree


def ensure_part_tree() -> bpy.types.NodeTree:
    """Return the group by which an object holds the faces of some media of the cut, from one number to before another."""
    tree = find_tree(PART_GROUP)
    if tree is not None:
        return tree
    inputs = {CUT_INPUT: "NodeSocketObject", BODY_INPUT: "NodeSocketInt", END_INPUT: "NodeSocketInt"}
    tree = new_tree(PART_GROUP, inputs, GEOMETRY, "Surfaces of some media, cut where they cross")
    tree.is_modifier = True
    build = Builder(tree)
    build.returns(
        Geometry=_picked(
            build, _cut_by(build), is_among(build, *(build.inputs.outputs[name] for name in (BODY_INPUT, END_INPUT)))
        )
    )
    return tree


def _cut_by(build: Builder) -> bpy.types.Node:
    """Add a node that reads what the object that cuts shows, seen from this one's space."""
    return build.node(
        "GeometryNodeObjectInfo", properties={"transform_space": "RELATIVE"}, Object=build.inputs.outputs[CUT_INPUT]
    )


def _picked(build: Builder, cut: bpy.types.Node, selection) -> bpy.types.NodeSocket:
    """Take the selected instances, one a medium, of what the object that cuts shows."""
    node = build.node(
        "GeometryNodeSeparateGeometry", properties={"domain": "INSTANCE"}, Geometry=cut.outputs["Geometry"]
    )
    build.put(node.inputs["Selection"], selection)
    return node.outputs["Selection"]


def _with_normals(build: Builder, geometry, cut: bpy.types.Node) -> bpy.types.NodeSocket:
    """Shade a mesh as before it was cut: new corners would have normals of their own."""
    matrix = build.node("FunctionNodeInvertMatrix", Matrix=cut.outputs["Transform"]).outputs[0]
    normal = build.node(
        "FunctionNodeTransformDirection",
        Direction=build.attribute(NORMAL, "FLOAT_VECTOR"),
        Transform=build.node("FunctionNodeTransposeMatrix", Matrix=matrix).outputs[0],
    )
    shaded = build.node("GeometryNodeSetMeshNormal", properties={"mode": "FREE", "domain": "CORNER"}, Mesh=geometry)
    build.put(enabled_input(shaded, "Custom Normal"), normal.outputs[0])
    return shaded.outputs[0]
