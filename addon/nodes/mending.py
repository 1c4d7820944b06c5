"""Repairs of a material's nodes."""

from __future__ import annotations

import bpy

from ..model.parameter import GROUP_NAME
from ..model.parameters import SOCKETS
from .material_version import is_dielectric
from .names import PREVIEW_OUTPUT, VOLUME_OUTPUT
from .places import dielectric_places, is_plugged, lacks_preview, socket_value, value_socket


def repair_nodes(material: bpy.types.Material) -> list[str]:
    """Let other media read the nested dielectric that is plugged in; return what was changed, in sentences.

    Where several are plugged in, or the material belongs to a library, nothing is changed.
    """
    places = dielectric_places(material) if material.node_tree is not None and material.is_editable else []
    if len(places) != 1:
        return []
    (place,) = places
    node = place[-1]
    nodes = material.node_tree.nodes
    readable = nodes.get(GROUP_NAME)
    if len(place) == 1:
        if readable == node:
            return []
        before = node.name
        if readable is not None:
            readable.name = f"{GROUP_NAME} Other"
        node.name = GROUP_NAME
        return [f"{material.name}: the node {before!r}, which is plugged in, is named {GROUP_NAME!r}"]
    changes = []
    if not is_dielectric(readable) or is_plugged(readable):
        if readable is not None:
            readable.name = f"{GROUP_NAME} Other"
        readable = nodes.new("ShaderNodeGroup")
        readable.name = GROUP_NAME
        readable.label = f"Read by neighbours: {place[0].name}"
        readable.location = place[0].location[0], place[0].location[1] + 260.0
        changes = [f"{material.name}: a node {GROUP_NAME!r} lets neighbours read what stands in {place[0].name!r}"]
    if readable.node_tree != node.node_tree:
        readable.node_tree = node.node_tree
    for parameter in SOCKETS:
        source = value_socket(place, parameter.name) if parameter.kind != "SHADER" else None
        target = readable.inputs.get(parameter.name)
        if source is not None and target is not None and socket_value(source) != socket_value(target):
            target.default_value = socket_value(source)
            changes = changes or [f"{material.name}: neighbours read what stands in {place[0].name!r} again"]
    return changes


def complete_nodes(material: bpy.types.Material) -> list[str]:
    """Plug in what a nested dielectric that was added by hand lacks; return what was changed, in sentences.

    That is its absorption and its look in EEVEE. What else is plugged in stays.
    """
    if not material.is_editable or len(dielectric_places(material)) != 1:
        return []
    tree = material.node_tree
    node = tree.nodes.get(GROUP_NAME)
    output = tree.get_output_node("CYCLES")
    if not is_dielectric(node) or not {VOLUME_OUTPUT, PREVIEW_OUTPUT} <= set(node.outputs.keys()):
        return []
    changes = []
    if not output.inputs["Volume"].is_linked:
        tree.links.new(node.outputs[VOLUME_OUTPUT], output.inputs["Volume"])
        changes.append(f"{material.name}: {VOLUME_OUTPUT} plugged in")
    if lacks_preview(material):
        preview = tree.get_output_node("EEVEE")
        if preview in (None, output):
            output.target = "CYCLES"
            preview = tree.nodes.new("ShaderNodeOutputMaterial")
            preview.target = "EEVEE"
            preview.location = output.location[0], output.location[1] - 160.0
        tree.links.new(node.outputs[PREVIEW_OUTPUT], preview.inputs["Surface"])
        changes.append(f"{material.name}: {PREVIEW_OUTPUT} plugged into an output for EEVEE")
    return changes
