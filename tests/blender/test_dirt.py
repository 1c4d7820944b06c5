"""Dirt that does not ask where its surface exists is named where media win over it."""

import bpy
from places_of_nodes import GROUP, plug
from scenes import add_box, new_scene

import nested_dielectric as nd


def test_dirt_that_does_not_ask_where_its_surface_exists_is_named_where_media_win_over_it():
    new_scene()
    water = nd.new_material("Water", ior=1.33, priority=2)
    obj = add_box("Water", (-1, 0, -1), (1, 1, 1), water)
    tree = water.node_tree
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(tree.nodes[GROUP].outputs["Surface"], mix.inputs[1])
    hole = tree.nodes.new("ShaderNodeBsdfTransparent")
    tree.links.new(hole.outputs[0], mix.inputs[2])
    plug(water, mix.outputs[0])
    add_box("Glass", (-2, -1, -2), (2, 0.5, 2), nd.new_material("Glass", ior=1.5, priority=1))
    assert nd.prepare(bpy.context.scene).problems == ()  # what lets light through shows nowhere
    tree.links.new(tree.nodes.new("ShaderNodeBsdfDiffuse").outputs[0], mix.inputs[2])
    (found,) = nd.prepare(bpy.context.scene).problems
    assert str(found).startswith("'Water' mixes other shaders") and "Surface Exists" in found.remedy
    nd.set_priority(obj, 0)
    assert nd.prepare(bpy.context.scene).problems == ()
    tree.nodes[GROUP].inputs["Disperse"].default_value = True
    (found,) = nd.prepare(bpy.context.scene).problems
    assert "count twice where light is split" in found.text
    nd.set_priority(obj, None)
    tree.links.new(tree.nodes[GROUP].outputs["Surface Exists"], mix.inputs[0])
    assert nd.prepare(bpy.context.scene).problems == ()
