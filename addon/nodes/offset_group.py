"""The group of Geometry Nodes that moves a mesh's points by an attribute."""

from __future__ import annotations

import bpy

from .names import OFFSET_ATTRIBUTE


def is_offset_group(tree: bpy.types.NodeTree | None) -> bool:
    """Return whether a group, whatever its name, does nothing but move points by an attribute that its modifier names.

    In files of older versions the attribute is :data:`OFFSET_ATTRIBUTE`.
    """
    if tree is None or tree.bl_idname != "GeometryNodeTree":
        return False
    nodes = {node.bl_idname: node for node in tree.nodes if not node.mute}
    attribute = nodes.get("GeometryNodeInputNamedAttribute")
    if len(nodes) != len(tree.nodes) or attribute is None or attribute.data_type != "FLOAT_VECTOR":
        return False
    ways = {(link.from_node.bl_idname, link.to_node.bl_idname, link.to_socket.name) for link in tree.links}
    if attribute.inputs["Name"].is_linked:
        return ways == _OFFSET_WAYS | _NAME_WAYS
    return ways == _OFFSET_WAYS and attribute.inputs["Name"].default_value == OFFSET_ATTRIBUTE


_OFFSET_WAYS = {
    ("NodeGroupInput", "GeometryNodeSetPosition", "Geometry"),
    ("GeometryNodeInputNamedAttribute", "GeometryNodeSetPosition", "Offset"),
    ("GeometryNodeSetPosition", "NodeGroupOutput", "Geometry"),
}

_NAME_WAYS = {
    ("NodeGroupInput", "FunctionNodeCompare", "A"),
    ("FunctionNodeCompare", "GeometryNodeSwitch", "Switch"),
    ("NodeGroupInput", "GeometryNodeSwitch", "False"),
    ("GeometryNodeSwitch", "GeometryNodeInputNamedAttribute", "Name"),
}
"""Links of the group: nodes, and the socket that each leads into."""
