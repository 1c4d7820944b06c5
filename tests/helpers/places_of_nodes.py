"""Where artists put the node of a nested dielectric."""

import bpy

from nested_dielectric.nodes.places import socket_value

GROUP = "Nested Dielectric"


def output_of(material: bpy.types.Material) -> bpy.types.Node:
    return material.node_tree.get_output_node("CYCLES")


def plug(material: bpy.types.Material, socket: bpy.types.NodeSocket) -> None:
    material.node_tree.links.new(socket, output_of(material).inputs["Surface"])


def renamed(material) -> None:
    material.node_tree.nodes[GROUP].name = "Glass Node"


def duplicated(material) -> None:
    """The copy is plugged in; the first node is not, and has other values."""
    tree = material.node_tree
    old = tree.nodes[GROUP]
    copy = tree.nodes.new("ShaderNodeGroup")
    copy.node_tree = old.node_tree
    copy_values(old, copy)
    tree.links.new(copy.outputs["Volume"], output_of(material).inputs["Volume"])
    plug(material, copy.outputs["Surface"])
    old.inputs["IOR"].default_value, old.inputs["Priority"].default_value = 2.5, 9


def copy_values(old: bpy.types.Node, new: bpy.types.Node) -> None:
    for source, target in zip(old.inputs, new.inputs):
        if hasattr(source, "default_value"):
            target.default_value = socket_value(source)


def grouped(material, name: str = GROUP, exposed=("IOR",)) -> None:
    """The node is put into a group (Ctrl+G), some of whose values are the group's own sockets."""
    tree = material.node_tree
    old = tree.nodes[name]
    own = bpy.data.node_groups.new("My Glass", "ShaderNodeTree")
    inside = own.nodes.new("ShaderNodeGroup")
    inside.node_tree, inside.name = old.node_tree, old.name
    copy_values(old, inside)
    source, sink = own.nodes.new("NodeGroupInput"), own.nodes.new("NodeGroupOutput")
    outputs = [socket.name for socket in old.outputs if socket.is_linked]
    for output in outputs:
        own.interface.new_socket(output, in_out="OUTPUT", socket_type="NodeSocketShader")
        own.links.new(inside.outputs[output], sink.inputs[output])
    for socket in exposed:
        kind = old.inputs[socket].bl_idname
        plain = kind.removesuffix("Factor").removesuffix("Distance")
        own.interface.new_socket(socket, in_out="INPUT", socket_type=plain)
        reroute = own.nodes.new("NodeReroute")
        own.links.new(source.outputs[socket], reroute.inputs[0])
        own.links.new(reroute.outputs[0], inside.inputs[socket])
    group = tree.nodes.new("ShaderNodeGroup")
    group.node_tree, group.name = own, "My Glass"
    for socket in exposed:
        group.inputs[socket].default_value = old.inputs[socket].default_value
        inside.inputs[socket].default_value = 3.0  # nobody's value
    for output in outputs:
        for link in list(old.outputs[output].links):
            tree.links.new(group.outputs[output], link.to_socket)
    tree.nodes.remove(old)


def twice_grouped(material) -> None:
    grouped(material)
    grouped(material, "My Glass")
