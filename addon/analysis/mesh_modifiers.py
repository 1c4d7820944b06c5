"""What modifiers do to a mesh, and whether renders do the same."""

from __future__ import annotations

import bpy

from ..nodes.offset_group import is_offset_group

DETERMINISTIC_MODIFIERS = frozenset(
    (
        "ARRAY",
        "BEVEL",
        "CAST",
        "DECIMATE",
        "DISPLACE",
        "EDGE_SPLIT",
        "MIRROR",
        "REMESH",
        "SCREW",
        "SIMPLE_DEFORM",
        "SMOOTH",
        "LAPLACIANSMOOTH",
        "CORRECTIVE_SMOOTH",
        "SOLIDIFY",
        "SUBSURF",
        "TRIANGULATE",
        "WEIGHTED_NORMAL",
        "WELD",
    )
)
"""Modifiers whose result depends on the mesh and on numbers alone, the same in the viewport and in a render."""

SHADING_NODES = frozenset(
    (
        "FunctionNodeBooleanMath",
        "FunctionNodeCompare",
        "GeometryNodeInputEdgeSmooth",
        "GeometryNodeInputMeshEdgeAngle",
        "GeometryNodeInputShadeSmooth",
        "GeometryNodeSetShadeSmooth",
        "NodeGroupInput",
        "NodeGroupOutput",
        "NodeReroute",
        "ShaderNodeMath",
    )
)
"""Geometry Nodes that leave all points and faces where they are: those of *Smooth by Angle*, which *Shade Auto Smooth* adds."""

PASSING_NODES = frozenset(("GeometryNodeSetShadeSmooth", "NodeGroupOutput"))
"""Those of them that a mesh goes through."""


def is_deterministic(modifier: bpy.types.Modifier) -> bool:
    """Return whether what a modifier makes depends on the mesh and on numbers alone."""
    if keeps_mesh(modifier):
        return True
    return modifier.type in DETERMINISTIC_MODIFIERS and not any(
        prop.type == "POINTER" and isinstance(getattr(modifier, prop.identifier), bpy.types.ID)
        for prop in modifier.bl_rna.properties
    )


def keeps_mesh(modifier: bpy.types.Modifier) -> bool:
    """Return whether a modifier leaves faces and their materials: it shades them, or moves those in the same place apart."""
    tree = modifier.node_group if modifier.type == "NODES" else None
    if tree is None or is_offset(modifier):
        return tree is not None
    passed_on = [node.inputs[0].is_linked for node in tree.nodes if node.bl_idname in PASSING_NODES]
    shades = bool(passed_on) and all(passed_on) and all(node.bl_idname in SHADING_NODES for node in tree.nodes)
    return shades and tree.animation_data is None


def is_offset(modifier: bpy.types.Modifier) -> bool:
    """Return whether a modifier is the one that moves faces in the same place apart."""
    return modifier.type == "NODES" and is_offset_group(modifier.node_group)


def is_same_in_renders(modifier: bpy.types.Modifier) -> bool:
    """Return whether a modifier does the same in the viewport and in renders."""
    if modifier.show_viewport != modifier.show_render:
        return False
    if modifier.type == "SUBSURF":
        return modifier.levels == modifier.render_levels and not modifier.use_adaptive_subdivision
    return modifier.type != "SCREW" or modifier.steps == modifier.render_steps
