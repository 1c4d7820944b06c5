"""Cycles' closures as far as they differ between versions of Blender."""

from __future__ import annotations

import bpy

from .compatibility import FRONT_IOR_SIGNS
from .names import DISPERSER_NODE
from .numbers import Number
from .shader_nodes import Socket, view_layer_attribute


def add_front_ior_test(tree: bpy.types.NodeTree) -> Number:
    """Return 1 where Cycles' closures take an index as it is met from the front, and turn it on back faces themselves.

    A file that is rendered without the extension can only tell by what else came with that Blender: an attribute that is
    not there has an alpha of 0.
    """
    first, second = (Number(tree, view_layer_attribute(tree, path).outputs["Alpha"]) for path in FRONT_IOR_SIGNS)
    return first.math("MAXIMUM", second)


def add_disperser(tree: bpy.types.NodeTree) -> Socket:
    """Add the closure that makes Cycles split light in others; it is folded away where the medium does not disperse."""
    disperser = tree.nodes.new("ShaderNodeBsdfPrincipled")
    disperser.name = disperser.label = DISPERSER_NODE
    arm_dispersion(tree)
    return disperser.outputs[0]


def arm_dispersion(tree: bpy.types.NodeTree) -> None:
    """Let Cycles' closures split light, which Blender 5.2 and files from it do not know of."""
    socket = tree.nodes[DISPERSER_NODE].inputs.get("Transmission Dispersion Scale")
    if socket is not None and socket.default_value != 1.0:
        socket.default_value = 1.0
        tree.nodes[DISPERSER_NODE].inputs["Transmission Weight"].default_value = 1.0
