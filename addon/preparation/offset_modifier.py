"""A Geometry Nodes modifier that moves points of a mesh by an attribute, in a render without the extension, too.

It names the attribute, so objects may share a mesh.
"""

from __future__ import annotations

from collections import Counter
from itertools import count

import bpy
import numpy as np

from ..analysis.mesh_modifiers import is_offset
from ..nodes.names import ATTRIBUTE_SOCKET, OFFSET_ATTRIBUTE, OFFSET_GROUP
from ..nodes.offset_group import is_offset_group


def add_offset(obj: bpy.types.Object, offset: np.ndarray, users: Counter[tuple[bpy.types.ID, str]]) -> None:
    """Move an object's points, from where they have been moved to before.

    :param offset: (n, 3), in the object's own space.
    :param users: number of modifiers that read an attribute of a mesh, by both; kept up to date.
    """
    mesh = obj.data
    modifier = next(filter(is_offset, obj.modifiers), None)
    if modifier is None:
        modifier = obj.modifiers.new(OFFSET_GROUP, "NODES")
    else:
        name = attribute_name(modifier)
        offset = offset + _offsets_of(mesh, name)
        users[mesh, name] -= 1
    modifier.node_group = ensure_offset_group()
    offset = offset.astype(np.float32)
    for number in count():
        name = f"{OFFSET_ATTRIBUTE}.{number:03d}" if number else OFFSET_ATTRIBUTE
        attribute = mesh.attributes.get(name)
        if attribute is None:
            attribute = mesh.attributes.new(name, "FLOAT_VECTOR", "POINT")
            break
        if _is_readable(attribute) and (not users[mesh, name] or np.array_equal(_offsets_of(mesh, name), offset)):
            break
    attribute.data.foreach_set("vector", offset.reshape(-1))
    _name_input(modifier).value = name
    users[mesh, name] += 1
    mesh.update_tag()
    obj.update_tag()


def _is_readable(attribute: bpy.types.Attribute) -> bool:
    """Return whether an attribute holds an offset of each point."""
    return (attribute.data_type, attribute.domain) == ("FLOAT_VECTOR", "POINT")


def _offsets_of(mesh: bpy.types.Mesh, name: str) -> np.ndarray:
    """Return the offsets of a mesh's points by an attribute, (n, 3) float32; 0 where there is none."""
    values = np.zeros((len(mesh.vertices), 3), dtype=np.float32)
    attribute = mesh.attributes.get(name)
    if attribute is not None and _is_readable(attribute):
        attribute.data.foreach_get("vector", values.reshape(-1))
        values[~np.isfinite(values)] = 0.0
    return values


def _name_input(modifier: bpy.types.NodesModifier) -> bpy.types.bpy_struct:
    """Return the property of a modifier that names its attribute."""
    socket = modifier.node_group.interface.items_tree[ATTRIBUTE_SOCKET]
    return getattr(modifier.properties.inputs, socket.identifier)


def attribute_name(modifier: bpy.types.NodesModifier) -> str:
    """Return the name of the attribute that a modifier reads; those of an old version name none."""
    if ATTRIBUTE_SOCKET not in modifier.node_group.interface.items_tree:
        return OFFSET_ATTRIBUTE
    return _name_input(modifier).value or OFFSET_ATTRIBUTE


def multiply_offsets(obj: bpy.types.Object, linear: np.ndarray) -> None:
    """Let what an object's modifier moves its points by be in a space that its own is mapped to.

    :param linear: (3, 3), from one space to the other.
    """
    for modifier in filter(is_offset, obj.modifiers):
        name = attribute_name(modifier)
        attribute = obj.data.attributes.get(name)
        if attribute is not None and _is_readable(attribute):
            moved = _offsets_of(obj.data, name) @ linear.T
            attribute.data.foreach_set("vector", moved.astype(np.float32).reshape(-1))


def ensure_offset_group() -> bpy.types.NodeTree:
    """Return the file's own group of such modifiers, made if need be; one of an old version gets an input for the name."""
    tree = next((tree for tree in bpy.data.node_groups if tree.library is None and is_offset_group(tree)), None)
    if tree is None:
        tree = bpy.data.node_groups.new(OFFSET_GROUP, "GeometryNodeTree")
        tree.is_modifier = True
        tree.description = "Moves points off faces of another medium in the same place"
        tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
        tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    elif ATTRIBUTE_SOCKET in tree.interface.items_tree:
        return tree
    tree.nodes.clear()
    tree.interface.new_socket(ATTRIBUTE_SOCKET, in_out="INPUT", socket_type="NodeSocketString")
    source, sink = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    unnamed = tree.nodes.new("FunctionNodeCompare")
    unnamed.data_type = "STRING"
    unnamed.operation = "EQUAL"
    name = tree.nodes.new("GeometryNodeSwitch")
    name.input_type = "STRING"
    name.inputs["True"].default_value = OFFSET_ATTRIBUTE
    offset = tree.nodes.new("GeometryNodeInputNamedAttribute")
    offset.data_type = "FLOAT_VECTOR"
    moved = tree.nodes.new("GeometryNodeSetPosition")
    text = [socket for socket in unnamed.inputs if socket.type == "STRING"]
    tree.links.new(source.outputs[ATTRIBUTE_SOCKET], text[0])
    tree.links.new(unnamed.outputs["Result"], name.inputs["Switch"])
    tree.links.new(source.outputs[ATTRIBUTE_SOCKET], name.inputs["False"])
    tree.links.new(name.outputs["Output"], offset.inputs["Name"])
    tree.links.new(source.outputs["Geometry"], moved.inputs["Geometry"])
    tree.links.new(offset.outputs["Attribute"], moved.inputs["Offset"])
    tree.links.new(moved.outputs["Geometry"], sink.inputs[0])
    for index, node in enumerate((source, unnamed, name, offset, moved, sink)):
        node.location = (220.0 * index, -160.0 if node in (unnamed, name, offset) else 0.0)
    return tree
