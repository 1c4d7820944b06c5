"""Media that absorb, with things in them."""

from __future__ import annotations

import random

import bpy  # before mathutils, which lives inside it
import numpy as np
from scenes import (
    add,
    add_box,
    add_camera,
    add_plane,
    add_sphere,
    cycles_glass,
    diffuse,
    emission,
    native,
    new_scene,
    set_world,
)
from slabs import AIM, tinted

import nested_dielectric as nd


def see_through(opacity: float, behind: bpy.types.Material | None = None) -> bpy.types.Material:
    """A card that lets light on, and is black for the rest."""
    material = behind or diffuse(0.0)
    tree = material.node_tree
    output = tree.get_output_node("CYCLES")
    opaque = output.inputs["Surface"].links[0].from_socket
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = opacity
    tree.links.new(tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[1])
    tree.links.new(opaque, mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    return material


def with_volume(kind: str, density: float, color=(1.0, 1.0, 1.0)) -> bpy.types.Material:
    """Nothing but a volume."""
    material = native("Smoke", kind, Density=density, Color=(*color, 1.0))
    tree = material.node_tree
    output = tree.get_output_node("CYCLES")
    link = output.inputs["Surface"].links[0]
    tree.links.new(link.from_socket, output.inputs["Volume"])
    tree.links.remove(output.inputs["Surface"].links[0])
    return material


LAMP = (AIM[0], AIM[1], 1.0)


def add_light(kind: str) -> None:
    """Small, at a height of 1 above the floor."""
    if kind == "MESH":
        add_sphere("Bulb", 0.0005, emission(1.5e6), None, LAMP, 16)
        return
    light = bpy.data.lights.new("Lamp", kind)
    light.energy = 100.0
    if kind == "AREA":
        light.size = 0.001
    else:
        light.shadow_soft_size = 0.0005
    add("Lamp", light, LAMP)


def lit_floor(kind: str, *boxes: tuple[float, float]) -> None:
    """A floor straight under a light, seen from close by; a tinted box, and one that wins over it, each from a height to
    another.
    """
    new_scene(8, with_group=True)
    set_world((0, 0, 0))
    add_plane("Floor", 20, (0, 0, 0), (0, 0, 1), diffuse())
    add_light(kind)
    materials = [
        tinted("Tint", 1.0, shadow_mode="TRANSMISSION"),
        nd.new_material("Ice", ior=1.0, shadow_mode="TRANSMISSION"),
    ]
    for priority, (material, (low, high)) in enumerate(zip(materials, boxes)):
        size = 3 + priority
        add_box(material.name, (-size, -size, low), (size, size, high), material, 2 - priority)
    bpy.context.scene.cycles.max_bounces = 0
    add_camera((AIM[0], AIM[1], 0.2), AIM, width=0.001)


COLOR = (0.9, 0.5, 0.2)
SHADOWS = {"shadow_mode": "TRANSMISSION"}


def cycles_volume() -> bpy.types.Material:
    """What Cycles itself makes of that tint without a surface."""
    material = native("Tea", "ShaderNodeBsdfTransparent")
    tree = material.node_tree
    volume = tree.nodes.new("ShaderNodeVolumeCoefficients")
    volume.inputs["Scatter Coefficients"].default_value = (0.0, 0.0, 0.0)
    volume.inputs["Absorption Coefficients"].default_value = [-np.log(channel) for channel in COLOR]
    tree.links.new(volume.outputs[0], tree.get_output_node("CYCLES").inputs["Volume"])
    return material


def scattering_domain() -> None:
    add_box("Smoke", (-1.2, -1.2, -0.6), (1.2, 1.2, 0.1), with_volume("ShaderNodeVolumeScatter", 0.5))


def glass_marble() -> None:
    add_sphere("Marble", 0.4, cycles_glass(1.5), None, (0.0, 0.1, -0.3), 32)


def leaf_over_a_spoon() -> None:
    add_plane("Leaf", 3.0, (0.1, 0, 0), (0.1, 0.1, 1), see_through(0.4, diffuse(0.5)))


def hair() -> None:
    dice = random.Random(1)
    curves = bpy.data.hair_curves.new("Hair")
    curves.add_curves([2] * 100)
    points = []
    for _ in range(100):
        x, y = dice.uniform(-1, 1), dice.uniform(-1, 1)
        points += [x, y, -0.9, x + dice.uniform(-0.3, 0.3), y + dice.uniform(-0.3, 0.3), 0.0]
    curves.attributes["position"].data.foreach_set("vector", points)
    curves.attributes.new("radius", "FLOAT", "POINT").data.foreach_set("value", [0.02] * 200)
    curves.materials.append(diffuse(0.6))
    add("Hair", curves)


def tea_with_a_bubble(ours: bool, build, volume=None) -> None:
    """A box of tea with a box of air cut out of its top; of index 1, so that Cycles needs no surface."""
    new_scene(16)
    set_world()
    bpy.context.scene.cycles.volume_bounces = 8
    bpy.context.scene.cycles.volume_biased = volume is not None  # without it Cycles looks at two million points first
    low, high = (-2, -2, -1), (2, 2, 1)
    if ours:
        tea = nd.new_material("Tea", ior=1.0, transmittance=COLOR, transmittance_depth=1.0, **SHADOWS)
        add_box("Tea", low, high, tea, 2)
        add_box("Bubble", (-0.7, -0.6, 0.2), (0.3, 0.9, 1.4), nd.new_material("Air", ior=1.0, **SHADOWS), 1)
    else:
        tea = cycles_volume()
        cut = add_box("Tea", low, high, tea).modifiers.new("Cut", "BOOLEAN")
        cut.object = add_box("Bubble", (-0.7, -0.6, 0.2), (0.3, 0.9, 1.4))
        cut.object.hide_render = cut.object.hide_viewport = True
    add_plane("Spoon", 1.5, (0.2, 0.2, -0.7), (0, 0.2, 1), diffuse(0.8))
    if build is not None:
        build()
    if volume is not None:
        volume(tea)
    add_camera((1.013, -3.007, 5), (0.013, 0.007, 0), angle=25)


def add_scattering(material: bpy.types.Material) -> None:
    """What an artist adds to a liquid's volume, with the mask where there is one."""
    tree = material.node_tree
    output = tree.get_output_node("CYCLES")
    volume = tree.nodes.new("ShaderNodeVolumeScatter")
    volume.inputs["Density"].default_value = 0.5
    volume.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    node = tree.nodes.get("Nested Dielectric")
    if node is not None:
        density = tree.nodes.new("ShaderNodeMath")
        density.operation = "MULTIPLY"
        density.inputs[1].default_value = 0.5
        tree.links.new(node.outputs["Volume Mask"], density.inputs[0])
        tree.links.new(density.outputs[0], volume.inputs["Density"])
    both = tree.nodes.new("ShaderNodeAddShader")
    tree.links.new(output.inputs["Volume"].links[0].from_socket, both.inputs[0])
    tree.links.new(volume.outputs[0], both.inputs[1])
    tree.links.new(both.outputs[0], output.inputs["Volume"])
