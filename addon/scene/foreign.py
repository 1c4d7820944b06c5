"""Objects that are no media, and lights: what rays make of them inside a medium."""

from __future__ import annotations

import bpy
import numpy as np

from .ray_visibility import is_seen_by_all

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
    """Return whether an object that is no medium sends light on, rather than that all light ends at its surface.

    Light may start there, go through it or be scattered in it.
    """
    return (
        obj.type in ("CURVES", "POINTCLOUD", "VOLUME")
        or bool(obj.particle_systems)
        or not is_seen_by_all(obj)
        or any(is_clear(slot.material) or _shines(slot.material) for slot in obj.material_slots)
    )


def is_clear(material: bpy.types.Material | None) -> bool:
    """Return whether rays may go on behind a surface of a material."""
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
    """Return whether light may start at a surface of a material."""
    nodes = [] if material is None or material.node_tree is None else _nodes(material.node_tree)
    strengths = (node.inputs.get("Emission Strength") for node in nodes)
    return any(node.bl_idname in ("ShaderNodeEmission", "ShaderNodeBackground") for node in nodes) or any(
        strength is not None and (strength.is_linked or strength.default_value > 0.0) for strength in strengths
    )


def _nodes(tree: bpy.types.NodeTree) -> list[bpy.types.Node]:
    """Return all nodes of a tree, those in groups too.

    Unlike :func:`~nested_dielectric.nodes.mesh_reads.own_nodes` it looks into the extension's groups: one of a version that is
    not known here makes no medium, but lets light through.
    """
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


def light_box(light: bpy.types.Object) -> np.ndarray:
    """Return the (2, 3) lowest and highest corner of where a light is; nowhere for a sun, which is outside of all."""
    data = light.data
    if data.type == "SUN":
        return np.array([(np.inf,) * 3, (-np.inf,) * 3])
    size = max(data.size, data.size_y) / 2 if data.type == "AREA" else data.shadow_soft_size
    reach = 2.0**0.5 * size * max(map(abs, light.matrix_world.to_scale()))
    return np.array(light.matrix_world.translation) + np.array([[-reach], [reach]])
