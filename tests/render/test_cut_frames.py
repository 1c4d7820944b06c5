"""Surfaces are cut as the scene is on each frame."""

import subprocess
import sys
from pathlib import Path

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import pytest
from cut import (
    BATCHES,
    NODE,
    SAMPLES,
    asking_picture,
    assert_frame_five_is_right,
    assert_same,
    inputs_of,
    key,
    now,
    two_bodies,
)
from mathutils import Matrix
from scenes import SUBPIXELS, mostly_again, read_picture, split_into_batches

import nested_dielectric as nd


def move(ball, block) -> None:
    key(ball, "location", (0.0, 0.0, 3.0), (0.1, 0.2, 0.3))


def change_the_medium(ball, block) -> None:
    key(inputs_of(block)["IOR"], "default_value", 1.3, 1.7)
    key(inputs_of(block)["Transmittance"], "default_value", (1.0, 1.0, 1.0, 1.0), (0.3, 0.6, 0.9, 1.0))


def drive(ball, block) -> None:
    ball.location.x = -0.6
    driver = ball.driver_add("location", 0).driver
    driver.type = "SCRIPTED"
    driver.expression = "-0.6 + frame / 10"


def deform(ball, block) -> None:
    ball.shape_key_add(name="Basis")
    long = ball.shape_key_add(name="Long")
    for point in long.points:
        point.co.x *= 1.6
    key(long, "value", 0.0, 1.0)


def open_up(ball, block) -> None:
    """Half of the ball goes, which leaves it open."""
    mask = ball.modifiers.new("Mask", "MASK")
    mask.vertex_group = ball.vertex_groups.new(name="Lower").name
    ball.vertex_groups["Lower"].add([v.index for v in ball.data.vertices if v.co.z < 0.1], 1.0, "REPLACE")
    key(mask, "show_render", False, True)
    for layer in ball.animation_data.action.layers[0].strips[0].channelbags[0].fcurves:
        for point in layer.keyframe_points:
            point.interpolation = "CONSTANT"
    mask.show_viewport = False


CHANGES = (move, change_the_medium, drive, deform, open_up)


@pytest.mark.parametrize("change", mostly_again(CHANGES, 2))
def test_what_changes_until_a_frame_is_cut_as_it_is_then(change):
    change(*two_bodies())
    assert_frame_five_is_right()


def swap_mesh(scene: bpy.types.Scene, *_: object) -> None:
    """As add-ons for fluids do."""
    ball = bpy.data.objects["Ball"]
    mesh = bpy.data.meshes.new("Ball")
    bm = bmesh.new()
    matrix = Matrix.Translation((0.4 * (scene.frame_current - 5), 0.0, 0.0))
    bmesh.ops.create_icosphere(bm, subdivisions=3, radius=0.9, matrix=matrix)
    bm.to_mesh(mesh)
    bm.free()
    mesh.materials.append(ball.data.materials[0])
    ball.data = mesh


def test_meshes_that_a_script_exchanges_are_cut():
    two_bodies()
    bpy.app.handlers.frame_change_post.append(swap_mesh)
    try:
        assert_frame_five_is_right()
    finally:
        bpy.app.handlers.frame_change_post.remove(swap_mesh)


def test_frames_of_a_file_are_cut_where_the_extension_is_not_installed(tmp_path):
    ball, block = two_bodies()
    move(ball, block)
    now().frame_set(1)
    assert set(nd.prepare(now(), cut=True).cut.media) == {"Ball", "Block"}
    now().frame_set(5)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    farm = Path(__file__).parents[1] / "helpers" / "farm.py"
    samples, percentage = str(SAMPLES // SUBPIXELS**2), str(100 * SUBPIXELS)
    subprocess.run(
        [sys.executable, farm, samples, percentage, tmp_path, tmp_path / "scene.blend"], check=True, timeout=300
    )
    cut = split_into_batches(read_picture(tmp_path / "scene.exr"), BATCHES)
    assert_same(cut, asking_picture())


@pytest.mark.again
def test_visibility_that_changes_until_a_frame_is_that_of_the_surface():
    ball, _ = two_bodies()
    key(ball, "visible_camera", True, False)
    assert_frame_five_is_right()


def test_a_custom_property_that_is_keyframed():
    for body in two_bodies():
        body["amount"] = 0.9
        body.keyframe_insert('["amount"]', frame=1)
        body["amount"] = 0.1
        body.keyframe_insert('["amount"]', frame=5)
        tree = body.data.materials[0].node_tree
        node = tree.nodes.new("ShaderNodeAttribute")
        node.attribute_type, node.attribute_name = "OBJECT", "amount"
        tree.links.new(node.outputs["Fac"], tree.nodes[NODE].inputs["Refraction Scale"])
    assert_frame_five_is_right()
