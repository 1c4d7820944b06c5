"""What matters of the materials of nested dielectrics."""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from ..model.parameters import BY_NAME
from ..nodes.names import VOLUME_OUTPUT
from ..nodes.places import is_plugged
from ..nodes.sockets import EXTERIOR_VALUES, has_analysis
from ..scene.materials import absorption_coefficients, dielectric_node, has_own_volume
from ..scene.media import material_priority

ABSORPTION_VALUES = ("Transmittance", "Transmittance Depth")
"""Inputs of the node on which absorption depends."""


@dataclass(frozen=True)
class MaterialFacts:
    """What matters of a nested dielectric's material.

    :param values: IOR, transmittance and its depth; None if they may change from frame to frame.
    :param priority: None if it may change.
    :param displaces: it moves the surface of its objects.
    :param can_be_told: what an analysis finds can stand in its sockets.
    :param coefficients: what it absorbs of each colour per length; None if it may change.
    :param has_volume: its absorption is a volume to Cycles, the same everywhere.
    :param has_own_volume: the artist has added a volume, which may scatter rays before they come to a surface.
    """

    values: tuple | None
    priority: int | None
    displaces: bool
    can_be_told: bool
    coefficients: tuple[float, float, float] | None
    has_volume: bool
    has_own_volume: bool


def all_material_facts() -> dict[bpy.types.Material, MaterialFacts]:
    """Return what matters of every nested dielectric in the file."""
    return {material: _facts_of(material) for material in bpy.data.materials if dielectric_node(material) is not None}


def _facts_of(material: bpy.types.Material) -> MaterialFacts:
    """Return what matters of a nested dielectric."""
    tree = material.node_tree
    node = dielectric_node(material)
    still = tree.animation_data is None and material.animation_data is None
    values = None
    if (
        still
        and not node.inputs["Disperse"].default_value
        and not any(node.inputs[n].is_linked for n in EXTERIOR_VALUES)
    ):
        values = tuple(BY_NAME[name].bounded(node.inputs[name].default_value) for name in EXTERIOR_VALUES)
    priority = node.inputs["Priority"]
    output = tree.get_output_node("CYCLES")
    linked = any(node.inputs[name].is_linked for name in ABSORPTION_VALUES)
    return MaterialFacts(
        values,
        material_priority(material) if still and not priority.is_linked else None,
        output is not None and output.inputs["Displacement"].is_linked and material.displacement_method != "BUMP",
        has_analysis(node) and is_plugged(node),
        absorption_coefficients(node) if still and not linked else None,
        output is not None and not linked and _adds_to(node.outputs[VOLUME_OUTPUT], output.inputs["Volume"]),
        has_own_volume(material),
    )


def _adds_to(source: bpy.types.NodeSocket, target: bpy.types.NodeSocket) -> bool:
    """Return whether the whole of a shader goes into a socket."""
    return any(
        link.to_socket == target
        or (
            link.to_node.bl_idname in ("ShaderNodeAddShader", "NodeReroute")
            and not link.to_node.mute
            and _adds_to(link.to_node.outputs[0], target)
        )
        for link in source.links
        if not link.is_muted
    )
