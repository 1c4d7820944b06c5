"""Reads of a mesh by a material's nodes."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from .material_version import is_dielectric


def own_nodes(tree: bpy.types.NodeTree) -> Iterator[bpy.types.Node]:
    """Yield an artist's nodes of a tree, those in groups too."""
    for node in tree.nodes:
        yield node
        if node.type == "GROUP" and node.node_tree is not None and not is_dielectric(node):
            yield from own_nodes(node.node_tree)


def read_attributes(material: bpy.types.Material) -> set[str]:
    """Return the names of a mesh's attributes that a material reads; empty stands for its active colours."""
    nodes = list(own_nodes(material.node_tree))
    names = {node.attribute_name for node in nodes if node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY"}
    return names | {node.layer_name for node in nodes if node.type == "VERTEX_COLOR"}


_WHOLE = {"OBJECT_INFO": {"Random"}, "NEW_GEOMETRY": {"Pointiness", "Random Per Island"}}
"""Outputs of nodes that depend on an object's name, or on all of its mesh."""


def reads_whole_mesh(material: bpy.types.Material) -> str:
    """Return the name of a node or output by which a material looks another way on part of a mesh, or nothing."""
    for node in own_nodes(material.node_tree):
        if node.type in ("BEVEL", "AMBIENT_OCCLUSION", "WIREFRAME"):
            return node.bl_label
        for output in node.outputs if node.type in _WHOLE else ():
            if output.is_linked and output.name in _WHOLE[node.type]:
                return output.name
    return ""


def reads_generated(material: bpy.types.Material) -> bool:
    """Return whether a material reads Generated coordinates, as textures do by themselves."""
    return any(
        (node.type == "TEX_COORD" and node.outputs["Generated"].is_linked)
        or (node.type.startswith("TEX_") and "Vector" in node.inputs and not node.inputs["Vector"].is_linked)
        for node in own_nodes(material.node_tree)
    )
