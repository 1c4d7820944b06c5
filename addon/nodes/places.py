"""The place of a nested dielectric in a material's nodes.

Other media read the sockets of the node `Nested Dielectric` at the top of the material's tree, whatever else is there. So the
node that is plugged in must have that name. Where it stands in a group of the artist's, a node of that name at the top, whose
surface is plugged into nothing, holds its values.
"""

from __future__ import annotations

from typing import Any

import bpy

from .links import Place, active_links, reaches_output, shader_sources, shown_dielectrics, twin
from .material_version import is_dielectric
from .names import CYCLES_OUTPUT, PREVIEW_OUTPUT

MASKS = ("Surface Exists", "Is Entrance", "Is Exit")
"""Outputs that tell where a surface exists."""


def is_plugged(node: bpy.types.Node) -> bool:
    """Return whether the surface of a nested dielectric's node goes anywhere: if not, it stands in for one in a group."""
    return any(output.is_linked for output in node.outputs if output.name == CYCLES_OUTPUT)


def shows_dielectric(material: bpy.types.Material) -> bool:
    """Return whether the light of a nested dielectric reaches the output that Cycles renders."""
    return any(name == CYCLES_OUTPUT for _, name in shown_dielectrics(material, "CYCLES", "Surface"))


def dielectric_places(material: bpy.types.Material) -> list[Place]:
    """Return the nested dielectrics whose light reaches the output that Cycles renders.

    Light goes through reroutes, mixes that let it through, muted nodes and groups.
    """
    return [place for place, name in shown_dielectrics(material, "CYCLES", "Surface") if name == CYCLES_OUTPUT]


def ignores_masks(material: bpy.types.Material) -> bool:
    """Return whether other shaders are mixed with a nested dielectric by nodes that do not ask it where its surface exists."""
    sources = list(shader_sources(material, "CYCLES", "Surface"))
    dielectrics = [place[-1] for place, name in sources if name == CYCLES_OUTPUT and is_dielectric(place[-1])]
    asked = any(output.is_linked for node in dielectrics for output in node.outputs if output.name in MASKS)
    return bool(dielectrics) and shows_others(material) and not asked


def shows_others(material: bpy.types.Material) -> bool:
    """Return whether shaders at which light may end reach the output that Cycles renders beside a nested dielectric."""
    sources = shader_sources(material, "CYCLES", "Surface")
    return any(not is_dielectric(place[-1]) and place[-1].type != "BSDF_TRANSPARENT" for place, _ in sources)


def shows_other_volume(material: bpy.types.Material) -> bool:
    """Return whether a volume that is no nested dielectric's reaches the output that Cycles renders."""
    return any(not is_dielectric(place[-1]) for place, _ in shader_sources(material, "CYCLES", "Volume"))


def value_socket(place: Place, name: str) -> bpy.types.NodeSocket | None:
    """Return the socket that holds the value of a nested dielectric's parameter; None where other nodes make the value.

    It is the node's own, or one of a group around it.
    """
    *groups, node = place
    first = socket = node.inputs.get(name)
    while links := active_links(socket):
        node = links[0].from_node
        if node.type == "REROUTE" and active_links(node.inputs[0]):
            socket = node.inputs[0]
        elif node.type == "GROUP_INPUT" and groups:
            socket = twin(groups.pop().inputs, links[0].from_socket)
        else:
            return None
    return socket if hasattr(socket, "default_value") and socket.type == first.type else None


def socket_value(socket: bpy.types.NodeSocket) -> Any:
    """Return the value of a socket as numbers, words and tuples that compare."""
    value = socket.default_value
    return value if isinstance(value, (int, float, str)) else tuple(value)


def lacks_preview(material: bpy.types.Material) -> bool:
    """Return whether EEVEE would show what is for Cycles, or nothing; an output for EEVEE alone is the artist's own."""
    output, preview = map(material.node_tree.get_output_node, ("CYCLES", "EEVEE"))
    if preview is None or preview == output:
        return not reaches_output(material, "EEVEE", "Surface", PREVIEW_OUTPUT)
    return not preview.inputs["Surface"].is_linked
