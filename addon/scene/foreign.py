"""Objects that are no media, and lamps: what rays make of them inside a medium."""

from __future__ import annotations

import bpy
import numpy as np

from .rays import is_seen_by_all

_OPAQUE = {
    "ShaderNodeBsdfDiffuse",
    "ShaderNodeBsdfAnisotropic",
    "ShaderNodeBsdfMetallic",
    "ShaderNodeBsdfSheen",
    "ShaderNodeBsdfToon",
    "ShaderNodeBsdfTranslucent",
    "ShaderNodeEmission",
    "ShaderNodeBackground",
    "ShaderNodeSubsurfaceScattering",
    "ShaderNodeAddShader",
    "ShaderNodeMixShader",
}
"""Nodes with a shader as output behind which every ray ends, or which pass on what is plugged in."""


def sends_light_on(obj: bpy.types.Object) -> bool:
    """Whether light may start at an object that is no medium, go through it or be scattered in it, rather than end at its
    surface.
    """
    return (
        obj.type in ("CURVES", "POINTCLOUD", "VOLUME")
        or bool(obj.particle_systems)
        or not is_seen_by_all(obj)
        or any(is_clear(slot.material) or _shines(slot.material) for slot in obj.material_slots)
    )


def is_clear(material: bpy.types.Material | None) -> bool:
    """Whether rays may go on behind a surface of a material."""
    if material is None or material.node_tree is None:
        return False
    output = material.node_tree.get_output_node("CYCLES")
    if output is None:
        return False
    return (
        output.inputs["Volume"].is_linked
        or not output.inputs["Surface"].is_linked
        or any(_is_clear_node(node) for node in _nodes(material.node_tree))
    )


def _shines(material: bpy.types.Material | None) -> bool:
    """Whether light may start at a surface of a material."""
    nodes = [] if material is None or material.node_tree is None else _nodes(material.node_tree)
    strengths = (node.inputs.get("Emission Strength") for node in nodes)
    return any(node.bl_idname in ("ShaderNodeEmission", "ShaderNodeBackground") for node in nodes) or any(
        strength is not None and (strength.is_linked or strength.default_value > 0.0) for strength in strengths
    )


def _nodes(tree: bpy.types.NodeTree) -> list[bpy.types.Node]:
    """All nodes of a tree, those in groups too."""
    groups = {node.node_tree for node in tree.nodes if node.type == "GROUP" and node.node_tree is not None}
    return list(tree.nodes) + [node for group in groups for node in _nodes(group)]


def _is_clear_node(node: bpy.types.Node) -> bool:
    if node.bl_idname == "ShaderNodeBsdfPrincipled":
        alpha, transmission = node.inputs["Alpha"], node.inputs["Transmission Weight"]
        return (
            alpha.is_linked or transmission.is_linked or alpha.default_value < 1.0 or transmission.default_value > 0.0
        )
    makes_shader = any(socket.type == "SHADER" for socket in node.outputs)
    return makes_shader and node.type not in ("GROUP", "GROUP_INPUT", "REROUTE") and node.bl_idname not in _OPAQUE


def lamp_box(lamp: bpy.types.Object) -> np.ndarray:
    """Return the (2, 3) lowest and highest corner of where a lamp is; nowhere for a sun, which is outside of all."""
    light = lamp.data
    if light.type == "SUN":
        return np.array([(np.inf,) * 3, (-np.inf,) * 3])
    size = max(light.size, light.size_y) / 2 if light.type == "AREA" else light.shadow_soft_size
    reach = 2.0**0.5 * size * max(map(abs, lamp.matrix_world.to_scale()))
    return np.array(lamp.matrix_world.translation) + np.array([[-reach], [reach]])
