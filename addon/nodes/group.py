"""The node group `Nested Dielectric`, with sockets for artists around the OSL shader, the native body and a look for EEVEE."""

from __future__ import annotations

import bpy

from ..model.parameter import GROUP_NAME
from ..model.shader_source import inlined_source
from .material_version import MATERIAL_VERSION, find_group
from .names import VERSION_PROPERTY
from .osl import COORDINATE_FILE, MASK_FILE, SHADER_FILE, make_script
from .sockets import NODE_WIDTH, add_sockets
from .wholeness import mark_whole
from .wiring import add_nodes


def ensure_group() -> bpy.types.NodeTree:
    """Return this file's group of this version, made on first use.

    A group of another version is left to the materials that use it. Raise
    :class:`~nested_dielectric.nodes.compatibility.UnsupportedError` when this Blender compiles no OSL; nothing has been made
    then.
    """
    found = find_group()
    if found is not None:
        return found
    scripts = {name: make_script(name, inlined_source(name)) for name in (SHADER_FILE, COORDINATE_FILE, MASK_FILE)}
    tree = bpy.data.node_groups.new(GROUP_NAME, "ShaderNodeTree")
    tree[VERSION_PROPERTY] = MATERIAL_VERSION
    tree.description = "A dielectric that knows the media it touches"
    tree.default_group_node_width = NODE_WIDTH
    add_sockets(tree)
    add_nodes(tree, scripts)
    mark_whole(tree)
    return tree
