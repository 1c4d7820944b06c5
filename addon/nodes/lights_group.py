"""The node group of the scene's lights."""

from __future__ import annotations

import bpy

from .material_version import MATERIAL_VERSION
from .names import LIGHTS_NAME, LIGHTS_VERSION_PROPERTY
from .shader_nodes import SOCKET_TYPES
from .wholeness import mark_whole

LIGHT_OUTPUTS = {"Kind": "FLOAT", "Total": "FLOAT"} | dict.fromkeys(
    ("Centre", "Axis", "EdgeX", "EdgeY", "Shape", "Strength", "Carried"), "VECTOR"
)
"""Outputs for the one light that was drawn, as osl/light.osl has it, with their kinds."""

EMITTER_OUTPUT = "Emitter"
"""Output for a weak emission."""

LIGHT_COUNT_OUTPUT = "Lamps"
"""Output for the number of lights."""

_LIGHTS_OUTPUTS = LIGHT_OUTPUTS | {EMITTER_OUTPUT: "SHADER", LIGHT_COUNT_OUTPUT: "INT"}


def find_lights() -> bpy.types.NodeTree | None:
    """Return this file's group of the scene's lights, or None if there is none yet."""
    found = [tree for tree in bpy.data.node_groups if tree.library is None and _lists_lights(tree)]
    return next((tree for tree in found if tree.name == LIGHTS_NAME), found[0] if found else None)


def _lists_lights(tree: bpy.types.NodeTree) -> bool:
    """Return whether a group is one of the scene's lights, whatever its name."""
    return tree.bl_idname == "ShaderNodeTree" and all(
        getattr(tree.interface.items_tree.get(name), "socket_type", "") == SOCKET_TYPES[kind]
        for name, kind in _LIGHTS_OUTPUTS.items()
    )


def ensure_lights() -> bpy.types.NodeTree:
    """Return this file's group of the scene's lights, made empty on first use."""
    tree = find_lights()
    if tree is None:
        tree = bpy.data.node_groups.new(LIGHTS_NAME, "ShaderNodeTree")
        tree[LIGHTS_VERSION_PROPERTY] = MATERIAL_VERSION
        tree.description = "Lights that direct refraction and direct reflection carry; made by Prepare"
        for name, kind in _LIGHTS_OUTPUTS.items():
            tree.interface.new_socket(name, in_out="OUTPUT", socket_type=SOCKET_TYPES[kind])
        tree.nodes.new("NodeGroupOutput")
        mark_whole(tree)
    return tree
