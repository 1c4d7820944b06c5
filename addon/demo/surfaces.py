"""Materials of the demo that are no media: paint and oak."""

from __future__ import annotations

from math import radians

import bpy

GRAIN_ANGLE = radians(-65.0)
"""Turn of the table's texture; at 0 the grain runs along X."""


def plain_material(name: str, colour: tuple[float, float, float], roughness: float) -> bpy.types.Material:
    """Return a new opaque material of one colour, linear RGB."""
    material = bpy.data.materials.new(name)
    shader = first_node(material.node_tree, "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (*colour, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    return material


def first_node(tree: bpy.types.NodeTree, kind: str) -> bpy.types.Node:
    """Return the node of a kind that Blender puts into a new tree."""
    return next(node for node in tree.nodes if node.type == kind)


def oak_material() -> bpy.types.Material:
    """Return a material like oak: noise stretched along the grain for the colour, finer noise for the pores."""
    material = plain_material("Oak", (0.5, 0.4, 0.3), roughness=0.42)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = first_node(material.node_tree, "BSDF_PRINCIPLED")
    turned = nodes.new("ShaderNodeVectorRotate")
    turned.rotation_type = "Z_AXIS"
    turned.inputs["Angle"].default_value = GRAIN_ANGLE
    links.new(nodes.new("ShaderNodeTexCoord").outputs["Object"], turned.inputs["Vector"])
    place = turned.outputs["Vector"]

    def grain(scale: tuple[float, float, float], detail: float, distortion: float) -> bpy.types.NodeSocket:
        mapping = nodes.new("ShaderNodeMapping")
        mapping.inputs["Scale"].default_value = scale
        links.new(place, mapping.inputs["Vector"])
        texture = nodes.new("ShaderNodeTexNoise")
        texture.inputs["Scale"].default_value = 1.0
        texture.inputs["Detail"].default_value = detail
        texture.inputs["Distortion"].default_value = distortion
        links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
        return texture.outputs["Fac"]

    def ramp(value: bpy.types.NodeSocket, *stops: tuple[float, tuple[float, float, float]]) -> bpy.types.NodeSocket:
        node = nodes.new("ShaderNodeValToRGB")
        for element, (position, colour) in zip(node.color_ramp.elements, stops, strict=True):
            element.position = position
            element.color = (*colour, 1.0)
        links.new(value, node.inputs["Fac"])
        return node.outputs["Color"]

    tone = ramp(grain((0.45, 3.5, 1.0), 6.0, 0.8), (0.32, (0.10, 0.050, 0.024)), (0.68, (0.265, 0.145, 0.072)))
    pores = ramp(grain((5.0, 90.0, 1.0), 2.0, 0.0), (0.36, (0.62, 0.55, 0.5)), (0.5, (1.0, 1.0, 1.0)))
    mix = nodes.new("ShaderNodeMix")
    mix.data_type = "RGBA"
    mix.blend_type = "MULTIPLY"
    mix.inputs["Factor"].default_value = 0.8
    links.new(tone, mix.inputs["A"])
    links.new(pores, mix.inputs["B"])
    links.new(mix.outputs["Result"], shader.inputs["Base Color"])
    bump = nodes.new("ShaderNodeBump")
    bump.inputs["Strength"].default_value = 0.15
    bump.inputs["Distance"].default_value = 0.01
    links.new(pores, bump.inputs["Height"])
    links.new(bump.outputs["Normal"], shader.inputs["Normal"])
    return material
