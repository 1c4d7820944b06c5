"""Files that are written: whole or not at all, where the path says, and nothing beside them."""

import os
import resource
import shutil
import signal
import stat
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np
import pytest
from scenes import add_camera, add_sphere, mostly_again, new_scene, oiio, read_picture, set_striped_world

import nested_dielectric as nd
from nested_dielectric import cli
from nested_dielectric.model import files
from nested_dielectric.model.files import WriteError, replacing, replacing_in
from nested_dielectric.scene.output import check_picture, save_blend
from nested_dielectric.scene.passes import file_outputs
from nested_dielectric.scene.rendering import RenderError, render_frame

OLD = b"what was there before"


def names(folder: Path) -> list[str]:
    """All files and folders, hidden ones too."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


@contextmanager
def full_disk(left: int):
    """Let files grow to some bytes at most. Python ignores the signal for more, so writing fails as on a full disk."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (left, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)


def stripes(resolution: int = 32) -> bpy.types.Scene:
    """A scene that takes no time."""
    scene = new_scene(resolution)
    set_striped_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=28)
    scene.cycles.samples = 1
    return scene


@pytest.mark.pure
@pytest.mark.parametrize("name", ["{blend_name}.png", "shot_##.png", "é 漢\n.png", "a\udcff.png", "n" * 251 + ".png"])
def test_a_name_stands_for_itself(name, tmp_path):
    with replacing(f"/{tmp_path}/new/{name}") as draft:
        draft.write_bytes(b"new")
        assert names(tmp_path) == ["new", f"new/{draft.name}"]
    assert names(tmp_path) == ["new", f"new/{name}"] and (tmp_path / "new" / name).read_bytes() == b"new"


@pytest.mark.pure
def test_a_block_that_fails_leaves_the_old_file_and_nothing_else(tmp_path):
    (tmp_path / "old.png").write_bytes(OLD)
    with pytest.raises(KeyError), replacing(tmp_path / "old.png") as draft:
        draft.write_bytes(b"new")
        Path(f"{draft}@").write_bytes(b"as Blender makes beside a .blend")
        raise KeyError
    with pytest.raises(WriteError, match="old.png"), replacing(tmp_path / "old.png"):
        pass  # wrote nothing
    with pytest.raises(KeyError), replacing(tmp_path / "new" / "deep" / "x.png"):
        raise KeyError
    assert names(tmp_path) == ["old.png"] and (tmp_path / "old.png").read_bytes() == OLD


@pytest.mark.pure
def test_a_new_file_keeps_the_mode_of_the_old_one_and_links_to_it(tmp_path):
    (tmp_path / "old.png").write_bytes(OLD)
    (tmp_path / "old.png").chmod(0o640)
    (tmp_path / "link.png").symlink_to("old.png")
    with replacing(tmp_path / "link.png") as draft:
        draft.write_bytes(b"new")
    assert (tmp_path / "link.png").is_symlink() and (tmp_path / "old.png").read_bytes() == b"new"
    assert stat.S_IMODE((tmp_path / "old.png").stat().st_mode) == 0o640


@pytest.mark.pure
@pytest.mark.parametrize(
    "name, words",
    [
        ("folder.png", "is a folder"),
        ("file/x.png", "file is no folder"),
        ("file/deep/x.png", "file is no folder|Not a directory"),
        ("device.png", "is no file"),
        ("n" * 252 + ".png", "name too long"),
        ("loop.png", "symbolic links"),
    ],
)
def test_what_cannot_be_written_is_named_before_any_work_is_done(name, words, tmp_path):
    (tmp_path / "folder.png").mkdir()
    (tmp_path / "file").write_bytes(OLD)
    (tmp_path / "device.png").symlink_to("/dev/full")
    (tmp_path / "loop.png").symlink_to("loop.png")
    before = names(tmp_path)
    with pytest.raises(WriteError, match=f"(?s){name[:8]}.*({words})"), replacing(tmp_path / name):
        pytest.fail("the work was begun")
    assert names(tmp_path) == before


@pytest.mark.pure
@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write everywhere")
def test_write_protection_holds(tmp_path):
    (tmp_path / "old.png").write_bytes(OLD)
    (tmp_path / "old.png").chmod(0o440)
    with pytest.raises(WriteError, match="write-protected"), replacing(tmp_path / "old.png"):
        pytest.fail("the work was begun")
    tmp_path.chmod(0o550)
    with pytest.raises(WriteError, match="Permission denied"), replacing(tmp_path / "new.png"):
        pytest.fail("the work was begun")
    tmp_path.chmod(0o750)


@pytest.mark.pure
def test_files_of_a_folder_take_their_places_together(tmp_path):
    (tmp_path / "a").write_bytes(OLD)
    with replacing_in(tmp_path) as folder:
        (folder / "deep").mkdir()
        (folder / "a").write_bytes(b"a")
        (folder / "deep" / "b").write_bytes(b"b")
        assert (tmp_path / "a").read_bytes() == OLD
    assert names(tmp_path) == ["a", "deep", "deep/b"] and (tmp_path / "a").read_bytes() == b"a"


WAITING = """
import pathlib, sys, time
sys.path.insert(0, sys.argv[1])
import files
try:
    with files.ending_at_once(), files.replacing(sys.argv[2]) as draft:
        draft.write_bytes(b"half")
        print("begun", flush=True)
        time.sleep(30)
finally:
    pathlib.Path(sys.argv[2] + ".finally").touch()
"""


@pytest.mark.pure
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
def test_a_process_that_is_ended_ends_as_of_the_signal_and_leaves_the_old_file(number, tmp_path):
    path = tmp_path / "old.png"
    path.write_bytes(OLD)
    addon = Path(files.__file__).resolve().parent
    process = subprocess.Popen(
        [sys.executable, "-c", WAITING, addon, path], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "begun\n"
    process.send_signal(number)
    error = process.communicate(timeout=20)[1]
    assert process.returncode == -number  # 128 more than the signal's number in shells: 130 after Ctrl-C
    assert error == ("nested-dielectric: interrupted\n" if number == signal.SIGINT else "")
    assert path.read_bytes() == OLD
    left = [name for name in names(tmp_path) if name != "old.png"]
    assert len(left) == (number == signal.SIGKILL) and all(name.startswith(files.MARK) for name in left)


@pytest.mark.pure
def test_signals_that_the_caller_handles_or_ignores_stay_his():
    def handler(*_):
        caught.append(True)

    caught = []
    before = signal.signal(signal.SIGTERM, handler), signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with files.ending_at_once():
            signal.raise_signal(signal.SIGTERM)
            signal.raise_signal(signal.SIGHUP)
        assert caught == [True]
        assert signal.getsignal(signal.SIGTERM) is handler and signal.getsignal(signal.SIGHUP) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGTERM, before[0])
        signal.signal(signal.SIGHUP, before[1])


@pytest.mark.pure
def test_afterwards_signals_are_handled_as_before():
    handlers = [signal.getsignal(number) for number in files._REQUESTS]
    actions = [files._get_action(number) for number in files._REQUESTS]
    with files.ending_at_once():
        assert signal.getsignal(signal.SIGINT) not in handlers
        with files.ending_at_once():
            pass
    assert [signal.getsignal(number) for number in files._REQUESTS] == handlers
    assert [files._get_action(number) for number in files._REQUESTS] == actions
    assert signal.set_wakeup_fd(-1) == -1


@pytest.mark.quick
@pytest.mark.parametrize("ending", mostly_again(["png", "exr", "jpg", "tif", "webp", "hdr"], 2))
def test_a_picture_that_was_cut_off_is_not_taken_for_whole(ending, tmp_path):
    path = tmp_path / f"x.{ending}"
    pixels = np.random.default_rng(0).random((32, 24, 3), dtype=np.float32)
    picture = oiio.ImageBuf(oiio.ImageSpec(24, 32, 3, oiio.FLOAT if ending in ("exr", "hdr") else oiio.UINT8))
    picture.set_pixels(oiio.ROI(), pixels)
    assert picture.write(str(path))
    check_picture(path, "given.png", (24, 32), 3)
    for size, channels in (((32, 24), 3), ((24, 32), 4)):
        with pytest.raises(WriteError, match="given.png: was written with"):
            check_picture(path, "given.png", size, channels)
    whole = path.read_bytes()
    for left in (0, 10, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:left])
        with pytest.raises(WriteError, match="given.png: was not written whole"):
            check_picture(path, "given.png")
    path.unlink()
    with pytest.raises(WriteError, match="given.png: was not written whole"):
        check_picture(path, "given.png")


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


@pytest.mark.quick
@pytest.mark.parametrize("limits", [{"frame": 10**12}, {"frame": -(10**7)}, {"samples": 2**31}, {"samples": 0}])
def test_numbers_out_of_range_are_errors_rather_than_others(limits, tmp_path):
    with pytest.raises(RenderError, match="must be"):
        render_frame(stripes(), tmp_path / "x.png", **limits)
    assert not names(tmp_path)


@pytest.mark.quick
def test_a_folder_that_blender_cannot_name_is_an_error_before_rendering(tmp_path):
    deep = tmp_path.joinpath(*["n" * 200] * 5)
    for folder in (deep, tmp_path / "back\\slash"):
        with pytest.raises(WriteError, match="too long for Blender, or with a backslash"):
            render_frame(stripes(), folder / "x.png")
    assert not names(tmp_path)


def test_another_scene_than_the_open_one_is_rendered(tmp_path):
    first = stripes(16)
    second = first.copy()
    second.render.resolution_x = 24
    render_frame(second, tmp_path / "x.png")
    check_picture(tmp_path / "x.png", "x.png", (24, 16))


def with_passes(folder: Path, scene: bpy.types.Scene) -> bpy.types.CompositorNodeOutputFile:
    add_sphere("Ball", 1.0, nd.new_material("Glass"))
    scene.render.filepath = f"{folder}/{{blend_name}}/shot_####.png"
    nd.add_passes(scene)
    (writer,) = file_outputs(scene)
    return writer


def test_passes_that_were_there_stay_until_new_ones_are_whole(tmp_path):
    scene = stripes()
    writer = with_passes(tmp_path, scene)
    directory = writer.directory
    render_frame(scene, tmp_path / "x.exr")
    assert names(tmp_path) == ["Unsaved", "Unsaved/shot_passes.exr", "x.exr"]
    old = (tmp_path / "Unsaved" / "shot_passes.exr").read_bytes()
    scene.cycles.seed = 1
    with full_disk(len(old) - 100), pytest.raises(WriteError, match="Unsaved/shot_passes.exr: was not written whole"):
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


@pytest.mark.quick
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


# .blend files -------------------------------------------------------------------------------------------------------


@pytest.mark.quick
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


@pytest.mark.quick
def test_paths_in_a_saved_file_lead_to_the_same_place_from_another_folder(tmp_path):
    new_scene()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "first.blend"))
    bpy.data.images.new("Picture", 1, 1).filepath = "//picture.png"
    bpy.data.images["Picture"].use_fake_user = True
    for place, path in (("second.blend", "//picture.png"), ("deep/third.blend", "//../picture.png")):
        save_blend(tmp_path / place)
        assert bpy.data.images["Picture"].filepath == "//picture.png"
        with bpy.data.libraries.load(str(tmp_path / place)) as (_, wanted):
            wanted.images = ["Picture"]
        assert bpy.path.abspath(wanted.images[0].filepath, library=wanted.images[0].library).endswith("picture.png")
        assert Path(os.path.normpath(bpy.path.abspath(wanted.images[0].filepath))) == tmp_path / "picture.png"
    new_scene()


@pytest.mark.quick
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
    with full_disk(int(share * len(old))), pytest.raises(WriteError, match="x.blend: was not written whole"):
        save_blend(tmp_path / "x.blend")
    assert names(tmp_path) == ["x.blend"] and (tmp_path / "x.blend").read_bytes() == old


# The command line ---------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def long_file(tmp_path_factory) -> Path:
    """A scene that renders for hours."""
    scene = stripes(64)
    add_sphere("Glass", 1.0, nd.new_material("Glass", preset="glass"))
    scene.cycles.samples = 10_000_000
    path = tmp_path_factory.mktemp("long") / "scene.blend"
    save_blend(path)
    return path


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


@pytest.mark.quick
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


@pytest.mark.quick
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
