"""What the group tells nodes of the artist's own: where a surface exists, and what it parts."""

import bpy
import numpy as np
import pytest
from places_of_nodes import GROUP, output_of, plug
from references import reference_batches
from scenes import (
    add_box,
    add_camera,
    add_mesh,
    batches,
    cycles_glass,
    mostly_again,
    new_scene,
    render,
    set_striped_world,
    set_world,
)
from significance import assert_same_picture

import nested_dielectric as nd

# Sums over the front and the back of the water: where its front is in the glass, where it is alone, and where it wins.
FACTS = {
    "Surface Exists": (0 + 1, 1 + 1, 1 + 1),
    "Is Entrance": (0 + 0, 1 + 0, 0 + 0),
    "Is Exit": (0 + 1, 0 + 1, 0 + 1),
    "Priority Inside": (5 + 5, 2 + 2, 0 + 0),
    "Priority Outside": (-1 - 1, -1 - 1, 1 - 1),
}


@pytest.mark.parametrize("prepared", mostly_again((True, False)))
def test_a_surface_tells_whether_it_exists_and_what_it_parts(prepared):
    """Without a change of index nothing reflects, so the camera sees the sum of the faces of a box. Its material shows all
    that it tells at once, as digits of red, and in green and blue.
    """
    new_scene(15)
    set_world((0, 0, 0))
    water = nd.new_material("Water", ior=1.0, priority=2)
    glass = nd.new_material("Glass", ior=1.0, priority=1)
    for x, own in ((-10, 5), (0, None), (10, 0)):
        add_box("Water", (x - 1.5, -0.5, -1.5), (x + 1.5, 1, 1.5), water, own)
        if own is not None:
            add_box("Glass", (x - 2, -1, -2), (x + 2, 0, 2), glass)
    add_camera((0.13, -5, 0.21), (0.13, 0, 0.21), width=30)  # a pixel is 2 wide
    tree = water.node_tree
    node, glow, both = tree.nodes[GROUP], tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeAddShader")
    red, colour = tree.nodes.new("ShaderNodeVectorMath"), tree.nodes.new("ShaderNodeCombineColor")
    facts = tree.nodes.new("ShaderNodeCombineXYZ")
    red.operation, red.inputs[1].default_value = "DOT_PRODUCT", (1.0, 4.0, 16.0)
    for name, socket in zip(FACTS, (*facts.inputs, *list(colour.inputs)[1:])):
        tree.links.new(node.outputs[name], socket)
    tree.links.new(facts.outputs[0], red.inputs[0])
    tree.links.new(red.outputs["Value"], colour.inputs[0])
    tree.links.new(colour.outputs[0], glow.inputs["Color"])
    tree.links.new(node.outputs["Surface"], both.inputs[0])
    tree.links.new(glow.outputs[0], both.inputs[1])
    plug(water, both.outputs[0])
    if prepared:
        assert nd.prepare(bpy.context.scene).problems == ()
    seen = render(4)[7, [2, 7, 12]]
    for pixel, (exists, entrance, leaves, inside, outside) in zip(seen, zip(*FACTS.values())):
        assert pixel == pytest.approx((exists + 4 * entrance + 16 * leaves, inside, outside), abs=1e-4)


def test_dirt_masked_by_a_surface_that_exists_shows_on_that_alone():
    """Against Cycles' own Glass with the surfaces split by hand."""
    half, red = 0.5, (0.8, 0.1, 0.1, 1.0)

    def dirt(material: bpy.types.Material, clean: bpy.types.NodeSocket, mask: bpy.types.NodeSocket | None) -> None:
        tree = material.node_tree
        mix, paint = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeBsdfDiffuse")
        paint.inputs["Color"].default_value = red
        mix.inputs[0].default_value = half
        if mask is not None:
            scale = tree.nodes.new("ShaderNodeMath")
            scale.operation = "MULTIPLY"
            scale.inputs[1].default_value = half
            tree.links.new(mask, scale.inputs[0])
            tree.links.new(scale.outputs[0], mix.inputs[0])
        tree.links.new(clean, mix.inputs[1])
        tree.links.new(paint.outputs[0], mix.inputs[2])
        plug(material, mix.outputs[0])

    def stage() -> None:
        new_scene(32)
        set_striped_world()
        add_camera((1.5, -6, 1.2), (0.03, 0.5, 0.02), angle=26)

    stage()
    clean, dirty, between = cycles_glass(1.5), cycles_glass(1.33), cycles_glass(1.5 / 1.33)
    dirt(dirty, output_of(dirty).inputs["Surface"].links[0].from_socket, None)

    def split(bm) -> None:
        """A pane, and a box behind it that stands in it: its hidden faces are left out."""
        (x, back, front, end), inner = (1.2, 0.2, -0.2, 1.5), 0.9
        outer = [bm.verts.new((i, j, k)) for j in (front, back) for i, k in ((-x, -x), (x, -x), (x, x), (-x, x))]
        square = (-inner, -inner), (inner, -inner), (inner, inner), (-inner, inner)
        hole = [bm.verts.new((i, j, k)) for j in (back, end) for i, k in square]
        faces = [(outer[:4], 0), (hole[7:3:-1], 1), (hole[3::-1], 2)]
        for i in range(4):
            j = (i + 1) % 4
            faces.append(((outer[i], outer[i + 4], outer[j + 4], outer[j]), 0))
            faces.append(((outer[i + 4], hole[i], hole[j], outer[j + 4]), 0))
            faces.append(((hole[i], hole[i + 4], hole[j + 4], hole[j]), 1))
        for vertices, index in faces:
            bm.faces.new(vertices).material_index = index

    obj = add_mesh("Split", split, clean)
    obj.data.materials.append(dirty)
    obj.data.materials.append(between)
    reference = reference_batches(256, 16)

    stage()
    # Cycles' own Glass lets no straight shadow rays through.
    glass = nd.new_material("Glass", ior=1.5, priority=1, shadow_mode="BLACK")
    water = nd.new_material("Water", ior=1.33, priority=2, shadow_mode="BLACK")
    node = water.node_tree.nodes[GROUP]
    dirt(water, node.outputs["Surface"], node.outputs["Surface Exists"])
    add_box("Glass", (-1.2, -0.2, -1.2), (1.2, 0.2, 1.2), glass)
    add_box("Water", (-0.9, 0.0, -0.9), (0.9, 1.5, 0.9), water)
    assert nd.prepare(bpy.context.scene).problems == ()
    assert_same_picture(batches(256, 16), reference)


@pytest.mark.parametrize("mask", mostly_again(("Surface Exists", "Is Entrance")))
def test_dirt_on_a_medium_that_disperses_counts_once(mask):
    """Light that is split meets a surface twice. Half of a glow on a box in the dark is half as bright as the glow."""
    new_scene(4)
    set_world((0, 0, 0))
    material = nd.new_material("Prism", ior=1.5, abbe=20.0, disperse=True)
    tree = material.node_tree
    node, mix, glow = tree.nodes[GROUP], tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeEmission")
    half, side = tree.nodes.new("ShaderNodeMath"), tree.nodes.new("ShaderNodeNewGeometry")
    half.operation, half.inputs[1].default_value = "MULTIPLY", 0.5
    front = tree.nodes.new("ShaderNodeMath")
    front.operation, front.use_clamp = "SUBTRACT", True
    tree.links.new(node.outputs[mask], half.inputs[0])
    tree.links.new(half.outputs[0], front.inputs[0])
    tree.links.new(side.outputs["Backfacing"], front.inputs[1])
    tree.links.new(front.outputs[0], mix.inputs[0])
    tree.links.new(node.outputs["Surface"], mix.inputs[1])
    tree.links.new(glow.outputs[0], mix.inputs[2])
    plug(material, mix.outputs[0])
    add_box("Box", (-1, -1, -1), (1, 1, 1), material)
    add_camera((0.03, -5, 0.02), (0.03, 0, 0.02), width=0.1)
    assert nd.prepare(bpy.context.scene).problems == ()
    assert render(64) == pytest.approx(0.5, abs=1e-5)


def test_dirt_behind_a_tinted_medium_is_seen_through_it_with_the_arriving_light():
    """Beer-Lambert through the box, and Fresnel's 4 % at its front."""
    new_scene(8)
    set_world((0, 0, 0))
    tint = (0.8, 0.5, 0.3)
    material = nd.new_material("Wine", ior=1.5, transmittance=tint, transmittance_depth=1.0)
    tree = material.node_tree
    node, mix, label = tree.nodes[GROUP], tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeEmission")
    tree.links.new(node.outputs["Is Exit"], mix.inputs[0])
    tree.links.new(node.outputs["Arriving Light"], label.inputs["Color"])
    tree.links.new(node.outputs["Surface"], mix.inputs[1])
    tree.links.new(label.outputs[0], mix.inputs[2])
    plug(material, mix.outputs[0])
    add_box("Box", (-1, -1, -1), (1, 1, 1), material)
    add_camera((0.03, -5, 0.02), (0.03, 0, 0.02), width=0.1)
    assert nd.prepare(bpy.context.scene).problems == ()
    # Smooth dielectrics have no noise but the choice of 4 % of the rays, which see black.
    picture = render(1024).mean(axis=(0, 1))
    assert picture == pytest.approx(0.96 * np.array(tint) ** 2.0, rel=4e-3)
