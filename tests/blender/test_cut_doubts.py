"""What a cut would change asks the scene."""

import bpy  # before bmesh, which lives inside it
import pytest
from cut import NODE, inputs_of, key, medium, now, shade, stage, two_bodies
from scenes import add_sphere, native

import nested_dielectric as nd


def test_a_scene_of_which_nothing_is_cut_is_prepared():
    stage()
    add_sphere("Ball", 1.0, medium("Dense", 1.5, 1))
    assert nd.prepare(now(), cut=True).cut.media == ()


def one_material_in_two_slots(ball):
    ball.data.materials.append(ball.data.materials[0])


def a_label_inside_another_of_its_medium(ball):
    drop = add_sphere("Drop", 0.6, ball.data.materials[0], segments=24)
    drop.location = (-0.3, -0.1, 0.5)
    drop.data.materials.append(native("Red", "ShaderNodeBsdfDiffuse"))


def twisted_with_generated_coordinates(ball):
    modifier = ball.modifiers.new("Twist", "SIMPLE_DEFORM")
    modifier.deform_method, modifier.angle, modifier.deform_axis = "TWIST", 2.0, "Z"
    shade(ball, "ShaderNodeTexCoord", "Generated")


def reading(kind, name):
    def read(ball):
        tree = ball.data.materials[0].node_tree
        tree.links.new(tree.nodes.new(f"ShaderNode{kind}").outputs[name], tree.nodes[NODE].inputs["Refraction Scale"])

    read.__name__ = name
    return read


def a_priority_that_is_keyframed(ball):
    key(inputs_of(ball)["Priority"], "default_value", 2, 0)


def in_a_second_scene(ball):
    bpy.data.scenes.new("Other").collection.objects.link(ball)


def blurring(ball):
    key(ball, "location", (0, 0, 0), (1, 0, 0))
    now().render.use_motion_blur = True


@pytest.mark.parametrize(
    "change",
    [
        one_material_in_two_slots,
        a_label_inside_another_of_its_medium,
        twisted_with_generated_coordinates,
        reading("ObjectInfo", "Random"),
        reading("NewGeometry", "Random Per Island"),
        reading("NewGeometry", "Pointiness"),
        a_priority_that_is_keyframed,
        in_a_second_scene,
        blurring,
    ],
)
def test_what_a_cut_would_change_asks_with_all_that_it_may_meet(change):
    ball, block = two_bodies()
    change(ball)
    cut = nd.prepare(now(), cut=True).cut
    assert not cut.media and {"Ball", "Block"} <= {name for name, _ in cut.asking}
    assert not ball.hide_render and not block.hide_render
