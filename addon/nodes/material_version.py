"""The version of the material that a node group is."""

from __future__ import annotations

import bpy

from .lookups import cached_by_nodes
from .names import (
    COORDINATE_NODE,
    DISPERSER_NODE,
    LIGHTS_NAME,
    NATIVE_GROUP,
    SHADER_NODE,
    SOURCE_HASH,
    TABLES_NODE,
    VERSION_PROPERTY,
)
from .sockets import input_types
from .wholeness import is_whole

MATERIAL_VERSION = 3
"""Of the group and of all that stands in a file with it. A release that changes any of it counts on."""

FRONT_IOR_VERSION = 2
"""The first whose shader knows both ways in which Cycles' closures take an index."""

DAMAGED = 0
"""Version of a group that nobody can tell by its number, its nodes or its sockets any more."""


@cached_by_nodes
def group_version(tree: bpy.types.NodeTree | None) -> int | None:
    """Return which version of the material a group is; None if it is another group.

    It is :data:`DAMAGED` if others have taken from it what it needs.
    """
    if tree is None or tree.bl_idname != "ShaderNodeTree":
        return None
    version = tree.get(VERSION_PROPERTY, 1 if SOURCE_HASH in tree else None)
    if version == MATERIAL_VERSION:
        return version if _is_whole(tree) else DAMAGED
    if isinstance(version, int) and version > DAMAGED:
        return version
    return None if version is None and SHADER_NODE not in tree.nodes else DAMAGED


def _is_whole(tree: bpy.types.NodeTree) -> bool:
    """Return whether a group has the nodes and sockets that Python looks for in it, its shaders, and all else of it."""
    if not is_whole(tree):
        return False
    kinds = {
        SHADER_NODE: "SCRIPT",
        COORDINATE_NODE: "SCRIPT",
        TABLES_NODE: "TEX_IMAGE",
        LIGHTS_NAME: "GROUP",
        DISPERSER_NODE: "BSDF_PRINCIPLED",
        NATIVE_GROUP: "GROUP",
    }
    for name, kind in kinds.items():
        node = tree.nodes.get(name)
        if node is None or node.type != kind:
            return False
        if kind == "SCRIPT" and (node.mode != "INTERNAL" or not node.bytecode_hash):
            return False
    if tree.nodes[LIGHTS_NAME].node_tree is None or tree.nodes[NATIVE_GROUP].node_tree is None:
        return False
    sockets = {
        item.name: item.socket_type
        for item in tree.interface.items_tree
        if item.item_type == "SOCKET" and item.in_out == "INPUT"
    }
    return all(sockets.get(name) == kind for name, kind in input_types().items())


def find_group() -> bpy.types.NodeTree | None:
    """Return this file's group of this version, or None if there is none yet."""
    groups = (tree for tree in bpy.data.node_groups if tree.library is None)
    return next((tree for tree in groups if group_version(tree) == MATERIAL_VERSION), None)


def is_dielectric(node: bpy.types.Node | None) -> bool:
    """Return whether a node shows a group of the extension's, of whichever version."""
    return node is not None and node.type == "GROUP" and group_version(node.node_tree) is not None
