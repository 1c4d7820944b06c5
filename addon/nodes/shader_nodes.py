"""Nodes of shaders."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

Socket = bpy.types.NodeSocket

SOCKET_TYPES = {
    "INT": "NodeSocketInt",
    "FLOAT": "NodeSocketFloat",
    "BOOL": "NodeSocketBool",
    "COLOR": "NodeSocketColor",
    "RGBA": "NodeSocketColor",
    "VECTOR": "NodeSocketVector",
    "MENU": "NodeSocketMenu",
    "INDEX": "NodeSocketInt",
    "SHADER": "NodeSocketShader",
}
"""By the kinds of parameters and of nodes."""


def math_node(tree: bpy.types.NodeTree, operation: str, *operands: Socket | float) -> Socket:
    """Add a Math node on sockets and numbers; return its result."""
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = operation
    for socket, operand in zip(node.inputs, operands):
        plug(tree, operand, socket)
    return node.outputs[0]


def vector_math(tree: bpy.types.NodeTree, operation: str, *operands: Socket | Sequence[float] | float) -> Socket:
    """Add a Vector Math node; return its result, which is a number for operations such as DOT_PRODUCT."""
    node = tree.nodes.new("ShaderNodeVectorMath")
    node.operation = operation
    for socket, operand in zip((socket for socket in node.inputs if socket.enabled), operands):
        plug(tree, operand, socket)
    return next(socket for socket in node.outputs if socket.enabled)


def plug(tree: bpy.types.NodeTree, source: Socket | Sequence[float] | float, socket: Socket) -> None:
    """Link a socket into another, or give that one a value."""
    if isinstance(source, bpy.types.NodeSocket):
        tree.links.new(source, socket)
    else:
        socket.default_value = source


def mix_shaders(tree: bpy.types.NodeTree, factor: Socket, first: Socket | None, second: Socket | None) -> Socket:
    """Add a Mix Shader; return what it shows, which is the first shader where nothing drives its factor."""
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = 0.0
    for source, socket in zip((factor, first, second), mix.inputs):
        if source is not None:
            tree.links.new(source, socket)
    return mix.outputs[0]


def mix_values(
    tree: bpy.types.NodeTree, kind: str, factor: Socket, first: Socket | float, second: Socket | float
) -> Socket:
    """Add a Mix node (FLOAT, VECTOR or RGBA); return the first value where a factor is 0, the second where it is 1."""
    mix = tree.nodes.new("ShaderNodeMix")
    mix.data_type = kind
    mix.clamp_factor = False
    factors, *values = (socket for socket in mix.inputs if socket.enabled)
    factors.default_value = 0.0
    for source, socket in zip((factor, first, second), (factors, *values)):
        plug(tree, source, socket)
    return next(socket for socket in mix.outputs if socket.enabled)


def attribute(tree: bpy.types.NodeTree, kind: str, name: str) -> bpy.types.ShaderNodeAttribute:
    """Add an Attribute node: of GEOMETRY, an OBJECT or the VIEW_LAYER. What is not there reads 0, its alpha, too."""
    node = tree.nodes.new("ShaderNodeAttribute")
    node.attribute_type = kind
    node.attribute_name = name
    return node


def view_layer_attribute(tree: bpy.types.NodeTree, path: str) -> bpy.types.ShaderNodeAttribute:
    """Add a node that reads a property of the rendered scene: a constant to Cycles, which leaves out what it makes needless."""
    return attribute(tree, "VIEW_LAYER", path)


def lazily(
    tree: bpy.types.NodeTree,
    kind: str,
    condition: Socket,
    otherwise: Socket | Sequence[float] | float | None,
    chosen: Socket | Sequence[float] | float | None,
) -> Socket:
    """Return `chosen` where a condition is 1, else `otherwise`: values of a kind (FLOAT, INT, VECTOR, RGBA or SHADER).

    It is a Repeat Zone of one iteration or none. Blender follows only the way that counts when it hands nodes to an engine, so
    the other costs nothing. The condition has to follow from unlinked sockets, else it is taken for 0.
    """
    start = tree.nodes.new("GeometryNodeRepeatInput")
    end = tree.nodes.new("GeometryNodeRepeatOutput")
    start.pair_with_output(end)
    end.repeat_items.clear()
    end.repeat_items.new(kind, "Value")
    tree.links.new(condition, start.inputs[0])
    for source, socket in ((otherwise, start.inputs[1]), (chosen, end.inputs[0])):
        if source is not None:
            plug(tree, source, socket)
    return end.outputs[0]
