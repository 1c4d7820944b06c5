"""The cut of one frame is kept in renders and files until a medium changes."""

import bpy
import numpy as np
import pytest
from command_line import run
from crossing_blocks import add_crossing
from scenes import add_camera, new_scene, read_picture, render, set_striped_world

import nested_dielectric as nd
from nested_dielectric.cutting import baked_cut, cut_scene
from nested_dielectric.preparation import live


def add_view():
    set_striped_world()
    add_camera((2.1, -4.3, 1.7), (0, 0, 0))


def test_the_cut_of_one_frame_is_kept_until_a_medium_changes():
    scene = new_scene(24)
    add_view()
    add_crossing()
    nd.prepare(scene, cut=True)
    picture = render(8)
    assert live.bake_cut(scene) == "" and baked_cut.is_baked(scene)
    faces = [len(obj.data.polygons) for obj in scene.objects if obj.name.endswith("(cut)")]
    assert min(faces) > 0
    assert np.array_equal(render(8), picture) and baked_cut.is_baked(scene)
    scene.frame_set(scene.frame_current + 1)
    assert np.array_equal(render(8), picture)
    scene.objects["Water"].location.x += 0.1
    live.update_cut(scene)
    assert not baked_cut.is_baked(scene)
    assert not np.array_equal(render(8), picture)


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    new_scene(24)
    add_view()
    add_crossing()
    path = tmp_path_factory.mktemp("file") / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def test_the_command_line_cuts_unless_told_not_to_and_keeps_the_cut_in_a_file(file, tmp_path):
    whole = run("render", file, "-o", tmp_path / "whole.exr", "--samples", 64, "--no-cut")
    assert whole.returncode == 0 and "cut:" not in whole.stdout
    cut = run("render", file, "-o", tmp_path / "cut.exr", "--samples", 64)
    assert cut.returncode == 0 and "cut: cut where they cross: 'Block', 'Water'" in cut.stdout
    kept = run("prepare", file, "--cut", "-o", tmp_path / "kept.blend")
    assert kept.returncode == 0 and "the cut of frame 1 is in the file" in kept.stdout
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "kept.blend"))
    assert cut_scene.is_cut(bpy.context.scene) and baked_cut.is_baked(bpy.context.scene)
    back = run("prepare", tmp_path / "kept.blend", "--no-cut")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "kept.blend"))
    assert (
        back.returncode == 0 and not cut_scene.is_cut(bpy.context.scene) and not bpy.data.objects["Water"].hide_render
    )
    # The same picture within the noise of 64 samples, whose error in the mean of 24 x 24 pixels is below a thousandth.
    means = [read_picture(tmp_path / f"{name}.exr").mean() for name in ("whole", "cut")]
    assert means[0] == pytest.approx(means[1], rel=4e-3)
