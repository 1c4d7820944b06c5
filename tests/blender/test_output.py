"""Files are written whole or not at all, where the path says, and nothing beside them."""

import os
import shutil
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest
from disk import full_disk, names
from scenes import mostly_again, new_scene, oiio
from stripes import save_long_file, stripes, with_passes

import nested_dielectric as nd
from nested_dielectric import cli
from nested_dielectric.model import files
from nested_dielectric.model.files import WriteError
from nested_dielectric.scene.output import check_picture, save_blend
from nested_dielectric.scene.passes import file_outputs
from nested_dielectric.scene.rendering import RenderError, render_frame


@pytest.fixture(scope="module")
def long_file(tmp_path_factory):
    return save_long_file(tmp_path_factory.mktemp("long"))


@pytest.mark.parametrize("ending", mostly_again(["png", "exr", "jpg", "tif", "webp", "hdr"], 2))
def test_a_picture_that_was_cut_off_is_not_taken_for_whole(ending, tmp_path):
    path = tmp_path / f"x.{ending}"
    pixels = np.random.default_rng(0).random((32, 24, 3), dtype=np.float32)
    picture = oiio.ImageBuf(oiio.ImageSpec(24, 32, 3, oiio.FLOAT if ending in ("exr", "hdr") else oiio.UINT8))
    picture.set_pixels(oiio.ROI(), pixels)
    assert picture.write(str(path))
    check_picture(path, "given.png", (24, 32), 3)
    for size, channels in (((32, 24), 3), ((24, 32), 4)):
        with pytest.raises(WriteError, match=r"given\.png: was written with"):
            check_picture(path, "given.png", size, channels)
    whole = path.read_bytes()
    for left in (0, 10, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:left])
        with pytest.raises(WriteError, match=r"given\.png: was not written whole"):
            check_picture(path, "given.png")
    path.unlink()
    with pytest.raises(WriteError, match=r"given\.png: was not written whole"):
        check_picture(path, "given.png")


@pytest.mark.parametrize("limits", [{"frame": 10**12}, {"frame": -(10**7)}, {"samples": 2**31}, {"samples": 0}])
def test_numbers_out_of_range_are_errors_rather_than_others(limits, tmp_path):
    with pytest.raises(RenderError, match="must be"):
        render_frame(stripes(), tmp_path / "x.png", **limits)
    assert not names(tmp_path)


def test_a_blender_that_cannot_read_pictures_back_says_so_before_rendering(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "OpenImageIO", None)  # as Debian's Blender is built
    with pytest.raises(nd.UnsupportedError, match=r"no OpenImageIO for Python.*use the build from blender"):
        render_frame(stripes(), tmp_path / "x.png")
    assert not names(tmp_path)


def test_a_folder_that_blender_cannot_name_is_an_error_before_rendering(tmp_path):
    deep = tmp_path.joinpath(*["n" * 200] * 5)
    for folder in (deep, tmp_path / "back\\slash"):
        with pytest.raises(WriteError, match="too long for Blender, or with a backslash"):
            render_frame(stripes(), folder / "x.png")
    assert not names(tmp_path)


def test_nodes_in_groups_write_passes_that_are_held_back_too_and_muted_ones_none(tmp_path):
    scene = stripes()
    writer = with_passes(tmp_path, scene)
    outer = bpy.data.node_groups.new("Outer", "CompositorNodeTree")
    node = outer.nodes.new("CompositorNodeGroup")
    node.node_tree = writer.id_data
    if hasattr(scene, "compositor_effects"):
        scene.compositor_effects[0].node_group = outer
    else:
        scene.compositing_node_group = outer
    assert file_outputs(scene) == [writer]
    writer.mute = True
    assert file_outputs(scene) == []


def test_passes_of_a_picture_without_a_folder_lie_beside_it_not_at_the_root():
    scene = stripes()
    for filepath, directory in (("shot.png", "./"), ("/shot.png", "/"), ("//shot.png", "//"), ("out/shot.png", "out/")):
        new_scene()
        scene = bpy.context.scene
        scene.render.filepath = filepath
        nd.add_passes(scene)
        tree = bpy.data.node_groups["Compositor Nodes"]
        (writer,) = (node for node in tree.nodes if node.bl_idname == "CompositorNodeOutputFile")
        assert (writer.directory, writer.file_name) == (directory, "shot_passes")


@pytest.mark.parametrize(
    "name", mostly_again(["{blend_name}.blend", "é ##.BLEND", "a\udcff.blend", "n" * 248 + ".blend"])
)
def test_a_saved_file_lies_where_the_path_says_and_what_was_there_becomes_its_first_version(name, tmp_path):
    new_scene()
    bpy.context.preferences.filepaths.save_version = 2
    path = tmp_path / name
    written = []
    for index in range(4):
        bpy.context.scene.name = f"Version {index}"
        assert save_blend(path) == path
        written.append(path.read_bytes())
    assert names(tmp_path) == [name, f"{name}1", f"{name}2"]
    assert [path.with_name(f"{name}{number}").read_bytes() for number in (1, 2)] == written[2:0:-1]
    assert bpy.data.filepath == ""
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert bpy.context.scene.name == "Version 3"
    new_scene()


def test_paths_in_a_saved_file_lead_to_the_same_place_from_another_folder(tmp_path):
    new_scene()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "first.blend"))
    bpy.data.images.new("Picture", 1, 1).filepath = "//picture.png"
    bpy.data.images["Picture"].use_fake_user = True
    for place, _path in (("second.blend", "//picture.png"), ("deep/third.blend", "//../picture.png")):
        save_blend(tmp_path / place)
        assert bpy.data.images["Picture"].filepath == "//picture.png"
        with bpy.data.libraries.load(str(tmp_path / place)) as (_, wanted):
            wanted.images = ["Picture"]
        assert bpy.path.abspath(wanted.images[0].filepath, library=wanted.images[0].library).endswith("picture.png")
        assert Path(os.path.normpath(bpy.path.abspath(wanted.images[0].filepath))) == tmp_path / "picture.png"
    new_scene()


@pytest.mark.parametrize("share", mostly_again([0.5, 0.1, 0.95]))
def test_a_file_for_which_the_disk_is_too_full_leaves_the_old_one(share, tmp_path):
    """Blender 5.2 calls it saved."""
    new_scene()
    noise = bpy.data.meshes.new("Noise")  # which does not compress
    noise.vertices.add(20_000)
    noise.vertices.foreach_set("co", np.random.default_rng(0).random(60_000, dtype=np.float32))
    noise.use_fake_user = True
    save_blend(tmp_path / "x.blend")
    old = (tmp_path / "x.blend").read_bytes()
    with full_disk(int(share * len(old))), pytest.raises(WriteError, match=r"x\.blend: was not written whole"):
        save_blend(tmp_path / "x.blend")
    assert names(tmp_path) == ["x.blend"] and (tmp_path / "x.blend").read_bytes() == old


def test_tables_and_plots_for_which_the_disk_is_too_full_leave_the_old_ones(tmp_path, capsys):
    table, plot = tmp_path / "t.exr", tmp_path / "p.svg"
    arguments = ["bake", "-o", str(table), "--plot", str(plot)]
    assert cli.main(arguments) == 0
    old = table.read_bytes(), plot.read_bytes()
    arguments += ["--distribution", "FL2"]
    for left, culprit in ((len(old[0]) // 2, table), (1000, plot)):
        capsys.readouterr()
        with full_disk(left):
            assert cli.main(arguments if culprit == plot else [*arguments[:3], *arguments[5:]]) == 1
        error = capsys.readouterr().err.splitlines()[-1]
        assert error.startswith("nested-dielectric: error: ") and culprit.name in error and files.MARK not in error
        assert names(tmp_path) == ["p.svg", "t.exr"] and (table.read_bytes(), plot.read_bytes()) == old


def test_prepare_and_update_leave_the_file_for_another_and_keep_it_when_the_disk_is_full(long_file, tmp_path, capsys):
    shutil.copy(long_file, tmp_path / "in.blend")
    old = (tmp_path / "in.blend").read_bytes()
    for command in ("prepare", "update"):
        assert cli.main([command, str(tmp_path / "in.blend"), "-o", str(tmp_path / f"{{{command}}}.blend")]) == 0
    assert names(tmp_path) == ["in.blend", "{prepare}.blend", "{update}.blend"]
    with full_disk(len(old) // 2):
        assert cli.main(["prepare", str(tmp_path / "in.blend")]) == 1
    assert "in.blend" in capsys.readouterr().err.splitlines()[-1]
    assert (tmp_path / "in.blend").read_bytes() == old and "in.blend1" not in names(tmp_path)
    assert cli.main(["prepare", str(tmp_path / "in.blend"), "-o", str(tmp_path / "out.png")]) == 2
    assert cli.main(["prepare", str(tmp_path / "in.blend")]) == 0
    assert (tmp_path / "in.blend1").read_bytes() == old
    new_scene()
