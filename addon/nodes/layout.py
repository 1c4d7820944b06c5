"""The places of nodes in the group `Nested Dielectric`."""

from __future__ import annotations

import bpy


def arrange(tree: bpy.types.NodeTree) -> None:
    """Lay the nodes out in columns from left to right, so that whoever opens the group can read it."""
    columns = {
        "NodeGroupInput": 0,
        "ShaderNodeAttribute": -2,
        "ShaderNodeVectorMath": -1,
        "GeometryNodeMenuSwitch": 1,
        "ShaderNodeBsdfDiffuse": 2,
        "ShaderNodeBsdfTransparent": 2,
        "ShaderNodeBsdfPrincipled": 2,
        "ShaderNodeBsdfRayPortal": 2,
        "ShaderNodeScript": 2,
        "ShaderNodeTexImage": 1,
        "ShaderNodeGroup": 1,
        "ShaderNodeSeparateColor": 1,
        "ShaderNodeLightPath": 1,
        "ShaderNodeMath": 2,
        "ShaderNodeCombineXYZ": 3,
        "ShaderNodeVolumeCoefficients": 3,
        "ShaderNodeMixShader": 3,
        "NodeGroupOutput": 4,
    }
    heights: dict[int, float] = {}
    for node in tree.nodes:
        column = columns.get(node.bl_idname, 2)
        node.location = (column * 260.0, heights.get(column, 0.0))
        heights[column] = node.location.y - (60.0 if column < 0 else 380.0)
        node.hide = column < 0
