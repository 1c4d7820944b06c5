"""Links between nodes, followed through reroutes, mixes, muted nodes and groups."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from .material_version import is_dielectric

Place = tuple[bpy.types.Node, ...]
"""A nested dielectric's node behind the nodes of the groups that it stands in, the outermost first."""


def reaches_output(material: bpy.types.Material, target: str, socket: str, output: str) -> bool:
    """Return whether an output of a nested dielectric reaches a socket of a material's output."""
    return any(name == output for _, name in shown_dielectrics(material, target, socket))


def shown_dielectrics(material: bpy.types.Material, target: str, socket: str) -> Iterator[tuple[Place, str]]:
    """Return the nested dielectrics behind a socket of a material's output, with the names of their outputs."""
    return ((place, name) for place, name in shader_sources(material, target, socket) if is_dielectric(place[-1]))


def shader_sources(material: bpy.types.Material, target: str, socket: str) -> Iterator[tuple[Place, str]]:
    """Yield the nodes that make what a socket of a material's output gets, with the names of their outputs."""
    output = None if material.node_tree is None else material.node_tree.get_output_node(target)
    if output is not None:
        yield from _behind(output.inputs[socket], (), set())


def _behind(socket: bpy.types.NodeSocket | None, groups: Place, seen: set) -> Iterator[tuple[Place, str]]:
    """Yield the nodes that make what a socket gets within these groups, with the names of their outputs."""
    for link in active_links(socket):
        yield from _from(link.from_node, link.from_socket, groups, seen)


def _from(node: bpy.types.Node, output: bpy.types.NodeSocket, groups: Place, seen: set) -> Iterator[tuple[Place, str]]:
    """Yield the nodes that make what an output of a node gives, unless it has been seen; the node itself if it makes that."""
    key = *(group.as_pointer() for group in groups), output.as_pointer()
    if key in seen:
        return
    seen.add(key)
    if node.mute:
        for link in node.internal_links:
            if link.to_socket == output:
                yield from _behind(link.from_socket, groups, seen)
    elif is_dielectric(node):
        yield (*groups, node), output.name
    elif node.type == "GROUP":
        sink = _group_output(node.node_tree)
        if sink is not None:
            yield from _behind(twin(sink.inputs, output), (*groups, node), seen)
    elif node.type == "GROUP_INPUT":
        if groups:
            yield from _behind(twin(groups[-1].inputs, output), groups[:-1], seen)
    elif inputs := _let_through(node):
        for socket in inputs:
            yield from _behind(socket, groups, seen)
    else:
        yield (*groups, node), output.name


def _let_through(node: bpy.types.Node) -> list[bpy.types.NodeSocket]:
    """Return the inputs of a node whose light it passes on."""
    if node.type == "MIX_SHADER" and not active_links(node.inputs[0]):
        factor, *shaders = node.inputs
        if factor.default_value in (0.0, 1.0):
            return [shaders[int(factor.default_value)]]
    return [socket for socket in node.inputs if socket.type == "SHADER" or node.type == "REROUTE"]


def active_links(socket: bpy.types.NodeSocket | None) -> list[bpy.types.NodeLink]:
    """Return the links into a socket that are not muted."""
    if socket is None or not socket.is_linked:
        return []
    return [link for link in socket.links if not link.is_muted]


def _group_output(tree: bpy.types.NodeTree | None) -> bpy.types.Node | None:
    """Return the node that holds a group's outputs, or None if there is none."""
    nodes = () if tree is None else tree.nodes
    return next((node for node in nodes if node.type == "GROUP_OUTPUT" and node.is_active_output), None)


def twin(sockets: Iterator[bpy.types.NodeSocket], other: bpy.types.NodeSocket) -> bpy.types.NodeSocket | None:
    """Return the socket of a group's node that stands for one of the group's own ends inside, or the other way round."""
    return next((socket for socket in sockets if socket.identifier == other.identifier), None)
