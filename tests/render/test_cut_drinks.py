"""Surfaces that are cut show what stands in them and on them."""

import bpy  # before bmesh, which lives inside it
import pytest
from cut import NODE, add_labels, add_rod, assert_cut_is_as_told, drink, now
from scenes import add, add_camera, add_emission_port, add_point_light, add_sphere, diffuse, mostly_again


def add_dirt(material: bpy.types.Material, masked: bool) -> None:
    """A film of dirt over the whole surface, or as far as it exists."""
    tree = material.node_tree
    surface = tree.get_output_node("CYCLES").inputs["Surface"]
    mix, dirt = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeBsdfDiffuse")
    mix.inputs[0].default_value = 0.3
    if masked:
        share = tree.nodes.new("ShaderNodeMath")
        share.operation = "MULTIPLY"
        share.inputs[1].default_value = 0.3
        tree.links.new(tree.nodes[NODE].outputs["Surface Exists"], share.inputs[0])
        tree.links.new(share.outputs[0], mix.inputs[0])
    tree.links.new(surface.links[0].from_socket, mix.inputs[1])
    tree.links.new(dirt.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], surface)


def show_output(material: bpy.types.Material, name: str) -> None:
    """Light of the strength that an output tells, 0.2 for each 1, from 0.2 at -1 to nothing at less."""
    tree = material.node_tree
    surface = tree.get_output_node("CYCLES").inputs["Surface"]
    scaled, shader, both = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("Math", "Emission", "AddShader"))
    scaled.operation = "MULTIPLY_ADD"
    scaled.inputs[1].default_value = scaled.inputs[2].default_value = 0.2
    tree.links.new(tree.nodes[NODE].outputs[name], scaled.inputs[0])
    tree.links.new(scaled.outputs[0], shader.inputs["Strength"])
    tree.links.new(surface.links[0].from_socket, both.inputs[0])
    tree.links.new(shader.outputs[0], both.inputs[1])
    tree.links.new(both.outputs[0], surface)


def everywhere(change) -> None:
    for material in [
        material for material in bpy.data.materials if material.node_tree and NODE in material.node_tree.nodes
    ]:
        change(material)


GUESTS = {
    "a spoon": add_rod,
    "a light": lambda: add_point_light((0.3, -0.2, -0.3), 30, 0.1),
    "the camera": lambda: add_camera((0.3, -0.2, -0.3), (-0.3, 0.1, 0.6), angle=90),
    "the camera where media overlap": lambda: add_camera((0.875, 0, -0.3), (-0.3, 0.1, 0.6), angle=90),
}


@pytest.mark.parametrize("guest", mostly_again(GUESTS, 2))
def test_tinted_media_that_are_cut_absorb_on_the_way_to_what_stands_in_them(guest):
    drink()
    GUESTS[guest]()
    assert_cut_is_as_told("Glass", "Water", "Ice")


FINISHES = {
    "labels": lambda: add_labels(*(bpy.data.objects[name] for name in ("Glass", "Water", "Ice"))),
    "dirt": lambda: everywhere(lambda material: add_dirt(material, False)),
    "the priority outside": lambda: everywhere(lambda material: show_output(material, "Priority Outside")),
    "light of three ports": lambda: [
        add_emission_port(bpy.data.materials[name], f"Emission at {port}", 0.2)
        for name, port in (("Glass", "Interfaces"), ("Water", "Exits"), ("Ice", "Entrances"))
    ],
}


@pytest.mark.parametrize("finish", mostly_again(FINISHES, 2))
def test_what_stands_on_surfaces_stands_on_surfaces_that_are_cut(finish):
    drink()
    FINISHES[finish]()
    assert_cut_is_as_told("Glass", "Water", "Ice")


def test_dirt_that_asks_where_the_surface_exists():
    drink()
    everywhere(lambda material: add_dirt(material, True))
    assert_cut_is_as_told("Glass", "Water", "Ice")


def test_an_instanced_spoon_in_tinted_media():
    drink()
    shelf = bpy.data.collections.new("Shelf")
    rod = add_sphere("Rod", 0.2, diffuse(0.6), location=(0.4, 0.0, 0.0))
    shelf.objects.link(rod)
    now().collection.objects.unlink(rod)
    empty = add("Empty", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", shelf
    assert_cut_is_as_told("Glass", "Water", "Ice")
