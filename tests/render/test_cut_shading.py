"""Surfaces that are cut are shaded and treated as their objects."""

import math

import bpy  # before bmesh, which lives inside it
import numpy as np
import pytest
from cut import NODE, assert_cut_is_right, inputs_of, medium, shade, stage, two_bodies
from scenes import add_plane, add_point_light, add_sphere, diffuse, mostly_again


def unwrap(body: bpy.types.Object) -> None:
    corners = body.data.uv_layers.new(name="UVMap").data
    for loop, corner in zip(body.data.loops, corners):
        place = body.data.vertices[loop.vertex_index].co
        corner.uv = place.x + 0.3 * place.z, place.y


def two_smooth_balls() -> None:
    """5,000 triangles each."""
    stage()
    for name, place, ior, priority in (("Ball", (0.0, 0.0, 0.3), 1.5, 1), ("Block", (0.5, 0.3, -0.3), 1.3, 2)):
        ball = add_sphere(name, 0.8, medium(name, ior, priority), segments=72)
        ball.location, ball.rotation_euler, ball.scale = place, (0.3, 0.5, 0.6), (1.0, 1.1, 0.9)


def coordinates(name: str) -> None:
    for body in two_bodies(smooth=True):
        unwrap(body)
        shade(body, "ShaderNodeTexCoord", name)


def bump() -> None:
    for body in two_bodies(smooth=True):
        tree = body.data.materials[0].node_tree
        place, noise, bumps = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "TexNoise", "Bump"))
        noise.inputs["Scale"].default_value = 3.0
        bumps.inputs["Distance"].default_value = 0.2
        tree.links.new(place.outputs["Generated"], noise.inputs["Vector"])
        tree.links.new(noise.outputs["Fac"], bumps.inputs["Height"])
        tree.links.new(bumps.outputs[0], tree.nodes[NODE].inputs["Normal"])


def sharp_edges() -> None:
    ball, block = two_bodies(smooth=True)
    block.data.polygons.foreach_set("use_smooth", [True] * len(block.data.polygons))
    for mesh in (ball.data, block.data):
        mesh.set_sharp_from_angle(angle=math.radians(4.0))


def object_linked_slots() -> None:
    ball, _ = two_bodies()
    ball.material_slots[0].link = "OBJECT"
    ball.material_slots[0].material = medium("Other", 1.7, 1)


SHADINGS = {
    "smooth balls": two_smooth_balls,
    "bump of Generated": bump,
    "Generated": lambda: coordinates("Generated"),
    "Object": lambda: coordinates("Object"),
    "UV": lambda: coordinates("UV"),
    "sharp edges": sharp_edges,
    "object-linked slots": object_linked_slots,
}


@pytest.mark.parametrize("shading", mostly_again(SHADINGS, 3))
def test_shading_stays_what_it_is_on_surfaces_that_are_cut(shading):
    SHADINGS[shading]()
    assert_cut_is_right("Ball", "Block")


def hide_from(ray: str) -> None:
    for body in two_bodies():
        setattr(body, f"visible_{ray}", False)
    add_plane("Floor", 8.0, (0, 0, -1.1), (0, 0, 1), diffuse(0.7))


def link_light(kind: str) -> None:
    """A light that lights, or is shadowed by, all but the ball."""
    ball, block = two_bodies()
    floor = add_plane("Floor", 8.0, (0, 0, -1.1), (0, 0, 1), diffuse(0.7))
    for body in (ball, block):
        inputs_of(body)["Roughness"].default_value = 0.4
    add_point_light((2.0, -2.0, 3.0), 500.0, 0.3)
    lit = bpy.data.collections.new("Lit")
    for body in (block, floor):
        lit.objects.link(body)
    setattr(bpy.data.objects["Lamp"].light_linking, f"{kind}_collection", lit)


def holdout() -> None:
    two_bodies()[0].is_holdout = True


def shadow_catcher() -> None:
    two_bodies()[1].is_shadow_catcher = True


def custom_property() -> None:
    for body, value in zip(two_bodies(), (0.9, 0.4)):
        body["amount"] = value
        tree = body.data.materials[0].node_tree
        node = tree.nodes.new("ShaderNodeAttribute")
        node.attribute_type, node.attribute_name = "OBJECT", "amount"
        tree.links.new(node.outputs["Fac"], tree.nodes[NODE].inputs["Refraction Scale"])


TREATMENTS = {
    "no camera rays": lambda: hide_from("camera"),
    "a custom property": custom_property,
    "no shadow rays": lambda: hide_from("shadow"),
    "no diffuse rays": lambda: hide_from("diffuse"),
    "lit by some lights": lambda: link_light("receiver"),
    "shadows of some": lambda: link_light("blocker"),
    "holdout": holdout,
    "shadow catcher": shadow_catcher,
}


@pytest.mark.parametrize("treatment", mostly_again(TREATMENTS, 2))
def test_surfaces_that_are_cut_are_treated_as_their_objects(treatment):
    TREATMENTS[treatment]()
    assert_cut_is_right("Ball", "Block")


def test_an_attribute_of_one_name_on_faces_here_and_on_points_there():
    for body, domain in zip(two_bodies(), ("FACE", "POINT")):
        data = body.data.attributes.new("shade", "FLOAT", domain).data
        values = np.arange(len(data)) % 2 if domain == "FACE" else np.ones(len(data))
        data.foreach_set("value", values.astype(np.float32) * 0.9)
        tree = body.data.materials[0].node_tree
        node = tree.nodes.new("ShaderNodeAttribute")
        node.attribute_name = "shade"
        tree.links.new(node.outputs["Fac"], tree.nodes[NODE].inputs["Refraction Scale"])
    assert_cut_is_right("Ball", "Block")


def custom_normals() -> None:
    ball, _ = two_bodies(smooth=True)
    normals = [(vertex.co * 1.0 + vertex.co.cross((0.0, 0.0, 0.3))).normalized() for vertex in ball.data.vertices]
    ball.data.normals_split_custom_set_from_vertices(normals)


def colours() -> None:
    for body in two_bodies():
        layer = body.data.color_attributes.new("Col", "FLOAT_COLOR", "POINT")
        for vertex, each in zip(body.data.vertices, layer.data):
            each.color = (abs(vertex.co.x), abs(vertex.co.y), abs(vertex.co.z), 1.0)
        tree = body.data.materials[0].node_tree
        node = tree.nodes.new("ShaderNodeAttribute")
        node.attribute_name = "Col"
        tree.links.new(node.outputs["Color"], tree.nodes[NODE].inputs["Refraction Scale"])


@pytest.mark.parametrize("build", [custom_normals, colours])
def test_shading_of_points(build):
    """The solver leaves attributes of points at 0 where it makes new ones."""
    build()
    assert_cut_is_right("Ball", "Block")
