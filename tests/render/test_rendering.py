"""Pictures are written whole or not at all, where the path says, and nothing beside them."""

import shutil
import signal
import subprocess
import sys

import bpy
import numpy as np
import pytest
from disk import OLD, full_disk, names
from scenes import mostly_again, read_picture
from stripes import save_long_file, stripes, with_passes

from nested_dielectric.model import files
from nested_dielectric.model.files import WriteError
from nested_dielectric.scene.output import check_picture
from nested_dielectric.scene.rendering import RenderError, render_frame


@pytest.fixture(scope="module")
def long_file(tmp_path_factory):
    return save_long_file(tmp_path_factory.mktemp("long"))


@pytest.mark.parametrize(
    "name", mostly_again(["{blend_name}.png", "{a/b}_##.EXR", "é#.jpeg", "a\udcff/x.tif", "x.webp", "x.hdr"])
)
def test_a_picture_lies_where_the_path_says(name, tmp_path):
    scene = stripes()
    assert render_frame(scene, f"/{tmp_path}/{name}") == tmp_path / name
    assert [each for each in names(tmp_path) if (tmp_path / each).is_file()] == [name]
    check_picture(tmp_path / name, name, (32, 32), 3)


def test_a_picture_is_bit_for_bit_what_blender_writes(tmp_path):
    scene = stripes()
    scene.render.filepath = str(tmp_path / "blender.exr")
    bpy.ops.render.render(write_still=True)
    render_frame(scene, tmp_path / "ours.exr")
    np.testing.assert_array_equal(read_picture(tmp_path / "ours.exr"), read_picture(tmp_path / "blender.exr"))


SETTINGS = ("media_type", "file_format", "color_mode", "color_depth")


def settings_of(scene: bpy.types.Scene) -> list:
    settings = [getattr(scene.render.image_settings, name) for name in SETTINGS]
    return [*settings, scene.render.filepath, scene.cycles.samples, scene.frame_current, scene.frame_subframe]


@pytest.mark.parametrize(
    "output",
    mostly_again(
        [("VIDEO", "FFMPEG", "RGB", "8"), ("MULTI_LAYER_IMAGE", "OPEN_EXR_MULTILAYER", "RGBA", "32"),
         ("IMAGE", "OPEN_EXR", "RGBA", "32"), ("IMAGE", "TIFF", "BW", "16")], 2
    ),
)  # fmt: skip
@pytest.mark.parametrize("fails", [False, True])
def test_a_scene_has_its_own_settings_and_frame_again(output, fails, tmp_path):
    scene = stripes()
    for name, value in zip(SETTINGS, output, strict=True):
        setattr(scene.render.image_settings, name, value)
    scene.render.filepath = "//{blend_name}/shot_##"
    scene.frame_set(7, subframe=0.25)
    before = settings_of(scene)
    handlers = len(bpy.app.handlers.render_stats)
    (tmp_path / "x.webp").write_bytes(OLD)
    if fails:
        with full_disk(20), pytest.raises(RuntimeError):
            render_frame(scene, tmp_path / "x.webp", samples=2, frame=3)
        assert (tmp_path / "x.webp").read_bytes() == OLD
    else:
        render_frame(scene, tmp_path / "x.webp", samples=2, frame=3)
        check_picture(tmp_path / "x.webp", "x.webp", (32, 32), 3)
    assert settings_of(scene) == before and len(bpy.app.handlers.render_stats) == handlers
    assert names(tmp_path) == ["x.webp"]


@pytest.mark.parametrize("ending", mostly_again([".png", ".exr", ".jpg", ".tiff", ".webp", ".hdr"], 2))
def test_a_picture_for_which_the_disk_is_too_full_leaves_the_old_one(ending, tmp_path):
    scene = stripes()
    render_frame(scene, tmp_path / f"x{ending}")
    old = (tmp_path / f"x{ending}").read_bytes()
    scene.cycles.seed = 1
    left = len(old) // 2 if ending != ".webp" else 30
    with full_disk(left), pytest.raises(RuntimeError, match="x" + ending) as caught:
        render_frame(scene, tmp_path / f"x{ending}")
    assert files.MARK not in str(caught.value) and "Error" not in str(caught.value)
    assert names(tmp_path) == [f"x{ending}"] and (tmp_path / f"x{ending}").read_bytes() == old


@pytest.mark.parametrize(
    "change, words",
    [
        (lambda scene: setattr(scene.render, "use_multiview", True), "Stereo 3D"),
        (lambda scene: setattr(scene, "camera", None), "no camera"),
        (lambda scene: setattr(scene.view_layers[0], "use", False), "no view layer"),
    ],
)
def test_what_cannot_be_rendered_is_named_and_writes_nothing(change, words, tmp_path):
    scene = stripes()
    change(scene)
    with pytest.raises(RenderError, match=words):
        render_frame(scene, tmp_path / "x.exr")
    assert not names(tmp_path)


def test_another_scene_than_the_open_one_is_rendered(tmp_path):
    first = stripes(16)
    second = first.copy()
    second.render.resolution_x = 24
    render_frame(second, tmp_path / "x.png")
    check_picture(tmp_path / "x.png", "x.png", (24, 16))


def test_passes_that_were_there_stay_until_new_ones_are_whole(tmp_path):
    scene = stripes()
    writer = with_passes(tmp_path, scene)
    directory = writer.directory
    render_frame(scene, tmp_path / "x.exr")
    assert names(tmp_path) == ["Unsaved", "Unsaved/shot_passes.exr", "x.exr"]
    old = (tmp_path / "Unsaved" / "shot_passes.exr").read_bytes()
    scene.cycles.seed = 1
    with full_disk(len(old) - 100), pytest.raises(WriteError, match=r"Unsaved/shot_passes\.exr: was not written whole"):
        render_frame(scene, tmp_path / "x.jpg")
    assert (tmp_path / "Unsaved" / "shot_passes.exr").read_bytes() == old and writer.directory == directory
    assert names(tmp_path) == ["Unsaved", "Unsaved/shot_passes.exr", "x.exr", "x.jpg"]
    render_frame(scene, tmp_path / "x.jpg")
    assert (tmp_path / "Unsaved" / "shot_passes.exr").read_bytes() != old
    shutil.rmtree(tmp_path / "Unsaved")
    (tmp_path / "Unsaved").write_bytes(OLD)
    with pytest.raises(WriteError, match="Unsaved is no folder"):  # of which Blender says nothing
        render_frame(scene, tmp_path / "x.jpg")
    writer.directory, writer.file_name = f"{tmp_path}/", "{nobody_knows}"
    with pytest.raises(WriteError, match="'File Output' of the compositor wrote no file"):
        render_frame(scene, tmp_path / "x.jpg")
    assert names(tmp_path) == ["Unsaved", "x.exr", "x.jpg"]


@pytest.mark.parametrize("number", mostly_again([signal.SIGINT, signal.SIGTERM, signal.SIGKILL], 2))
def test_a_render_ends_at_once_and_leaves_the_picture_that_was_there(number, long_file, tmp_path):
    picture = tmp_path / "x.png"
    picture.write_bytes(OLD)
    process = subprocess.Popen(
        [sys.executable, "-m", "nested_dielectric", "render", str(long_file), "-o", str(picture)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    while "rendering: 0 of" not in (line := process.stderr.readline()):
        assert line, process.communicate()
    process.send_signal(number)
    out, error = process.communicate(timeout=10)  # a machine at work for others; else a tenth of a second
    assert process.returncode == -number
    assert error.endswith("nested-dielectric: interrupted\n") == (number == signal.SIGINT)
    assert "Shading" in out or "nothing to change" in out or "changed" in out
    assert names(tmp_path) == ["x.png"] and picture.read_bytes() == OLD
