"""Frames of animations are each what a run of its own would show, and are written whole, in their places."""

from contextlib import nullcontext

import bpy
import numpy as np
import pytest
from command_line import assert_one_line, run
from disk import OLD, full_disk, names
from scenes import add_camera, mostly_again, oiio, read_picture
from sequences import render, report_of, save_sinking_ball
from stripes import stripes, with_passes, with_writer

from nested_dielectric.model.frames import FIRST_FRAME, LAST_FRAME
from nested_dielectric.model.manifest import manifest
from nested_dielectric.scene import devices, frame_sequences
from nested_dielectric.scene.chosen_view import layer_alone, through_camera
from nested_dielectric.scene.frame_sequences import Frame, render_frames
from nested_dielectric.scene.output import check_picture, save_blend
from nested_dielectric.scene.render_error import RenderError


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    return save_sinking_ball(tmp_path_factory.mktemp("ball"))


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A file of stripes, two cameras and two view layers, that takes no time; its second scene has no camera."""
    scene = stripes(16)
    other = add_camera((3, -5, 0.3), (0, 0, 0), angle=50)
    other.name = "Other"
    scene.camera = bpy.data.objects["Camera"]
    scene.timeline_markers.new("Cut", frame=3).camera = scene.camera
    scene.view_layers.new("Second")
    bpy.data.scenes.new("Empty")
    return save_blend(tmp_path_factory.mktemp("small") / "small.blend")


@pytest.mark.parametrize("way", mostly_again([((), False), ((), True), (("--backend", "native"), True)]))
def test_each_frame_of_a_sequence_is_that_of_a_run_of_its_own(way, ball, tmp_path):
    """Also where Cycles keeps what it has of a scene from one frame to the next."""
    arguments, keeps_data = way
    file = tmp_path / "ball.blend"
    bpy.ops.wm.open_mainfile(filepath=str(ball))
    bpy.context.scene.render.use_persistent_data = keeps_data
    save_blend(file)
    assert render(file, tmp_path / "all_##.exr", "--frames", "1-5:2,4", *arguments) == 0
    assert names(tmp_path) == [*(f"all_0{frame}.exr" for frame in (1, 3, 4, 5)), "ball.blend"]
    for frame in (4, 5):
        assert render(file, tmp_path / "one_##.exr", "--frame", frame, *arguments) == 0
    pictures = {path.name: read_picture(path) for path in tmp_path.glob("*.exr")}
    for frame in (4, 5):
        np.testing.assert_array_equal(pictures[f"all_0{frame}.exr"], pictures[f"one_0{frame}.exr"])
    assert np.abs(pictures["all_04.exr"] - pictures["all_05.exr"]).mean() > 0.005


def test_a_line_for_each_frame_says_where_it_is_and_how_long_the_others_take(small, tmp_path):
    done = run("render", small, "-o", tmp_path / "x_####.png", "--frames=-1,2")
    assert done.returncode == 0, done.stderr
    first, second = (line for line in done.stdout.splitlines() if line.startswith("frame "))
    assert first.startswith(f"frame -1 (1 of 2): {tmp_path}/x_-0001.png, ") and first.endswith(" s left")
    assert second.startswith(f"frame 2 (2 of 2): {tmp_path}/x_0002.png, ") and second.endswith(" s")
    assert "samples" not in done.stderr


def test_frames_that_are_there_are_skipped_and_broken_ones_rendered_anew(small, tmp_path, capfd):
    assert render(small, tmp_path / "x_#.png", "--frames", "1-3") == 0
    whole = (tmp_path / "x_1.png").read_bytes()
    times = {number: (tmp_path / f"x_{number}.png").stat().st_mtime_ns for number in (1, 2, 3)}
    (tmp_path / "x_2.png").write_bytes(whole[:-30])
    capfd.readouterr()
    assert render(small, tmp_path / "x_#.png", "--frames", "4,1-3", "--skip-existing", "--json") == 0
    report = report_of(capfd.readouterr().out)
    states = [(frame["frame"], frame["state"]) for frame in report["frames"]]
    assert states == [(4, "written"), (1, "skipped"), (2, "written"), (3, "skipped")]
    for number in (1, 3):
        assert (tmp_path / f"x_{number}.png").stat().st_mtime_ns == times[number]
    check_picture(tmp_path / "x_2.png", "x_2.png", (16, 16))
    assert render(small, tmp_path / "x_#.png", "--frames", "1-4", "--skip-existing") == 0
    assert "4 of 4 frames are there already and are skipped" in capfd.readouterr().out


def test_json_tells_of_the_file_its_problems_and_each_frame(ball, tmp_path):
    done = run("render", ball, "-o", tmp_path / "x_#.png", "--frames", "1,2", "--samples", 1, "--json")
    assert done.returncode == 0, done.stderr
    report = report_of(done.stdout)
    assert report["schema"] == 1 and report["version"] == manifest()["version"]
    assert (report["file"], report["scene"], report["error"]) == (str(ball), "Scene", None)
    assert report["blender"] == bpy.app.version_string and report["problems"] == report["changes"] == []
    for frame, number in zip(report["frames"], (1, 2), strict=True):
        assert frame.pop("seconds") > 0.0
        assert frame == {"frame": number, "path": f"{tmp_path}/x_{number}.png", "state": "written"}
    assert "Ready to render" in done.stderr and f"frame 2 (2 of 2): {tmp_path}/x_2.png" in done.stderr


@pytest.fixture
def full_on_frame_two(monkeypatch):
    """The disk is full while frame 2 is rendered."""
    whole = frame_sequences.render_frame

    def render_frame(scene, *arguments, **keywords):
        with full_disk(20) if scene.frame_current == 2 else nullcontext():
            return whole(scene, *arguments, **keywords)

    monkeypatch.setattr(frame_sequences, "render_frame", render_frame)


def test_a_full_disk_ends_the_run_names_the_frame_and_keeps_what_there_is(small, tmp_path, capfd, full_on_frame_two):
    (tmp_path / "x_2.png").write_bytes(OLD)
    (tmp_path / "x_3.png").write_bytes(OLD)
    assert render(small, tmp_path / "x_#.png", "--frames", "1-3", "--json") == 1
    out, error = capfd.readouterr()
    assert_one_line(error.splitlines()[-1], "frame 2: ", "x_2.png: was not written")
    report = report_of(out)
    assert [(frame["frame"], frame["state"]) for frame in report["frames"]] == [(1, "written"), (2, "failed")]
    assert "was not written" in report["frames"][1]["reason"]
    assert report["error"] == f"frame 2: {report['frames'][1]['reason']}"
    assert names(tmp_path) == ["x_1.png", "x_2.png", "x_3.png"]
    check_picture(tmp_path / "x_1.png", "x_1.png", (16, 16))
    assert (tmp_path / "x_2.png").read_bytes() == (tmp_path / "x_3.png").read_bytes() == OLD


@pytest.mark.parametrize(
    "arguments, words",
    [
        (("-o", "x.png", "--frames", "1-2"), ("x.png", "x_####.png")),
        (("-o", "x_#.xyz", "--frames", "1-2"), ("x_#.xyz", ".png")),
        (("-o", "x_#.png", "--frames", "1-2"), ("x_2.png", "folder")),
        (("-o", "locked/x_#.png", "--frames", "3-4"), ("locked", "cannot be written")),
        (("-o", "x_#.jpg", "--frames", "3-4"), ("x_4.jpg", "write-protected")),
        (("-o", "a.png/x_#.png", "--frames", "3-4"), ("a.png is no folder",)),
        (("-o", "x.png", "--scene", "Scne"), ("no scene 'Scne'", "'Empty', 'Scene'")),
        (("-o", "x.png", "--scene", "Empty"), ("'Empty' has no camera",)),
        (("-o", "x.png", "--camera", "Cube"), ("no camera 'Cube'", "'Camera', 'Other'")),
        (("-o", "x.png", "--view-layer", "B"), ("no view layer 'B'", "'ViewLayer', 'Second'")),
        (("-o", "x.png", "--device", "GPU"), ("no GPU", "--device CPU")),
        (("-o", "x.png", "--frame", "10000000"), ("must be", "1048574")),
        (("-o", "x.exr", "--samples", "0:2"), ("samples 0:2", "0:1")),
        (("-o", "x.exr", "--samples", "0:1", "--time-limit", "3"), ("--time-limit",)),
        (("-o", "x.png", "--device", "gpu", "--backend", "osl"), ("--backend osl",)),
    ],
)
def test_what_cannot_be_done_is_one_line_before_the_work_and_leaves_nothing(
    arguments, words, small, tmp_path, monkeypatch, capfd
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(devices, "_built_types", lambda preferences: ())
    (tmp_path / "x_2.png").mkdir()
    (tmp_path / "a.png").touch()
    (tmp_path / "x_4.jpg").write_bytes(OLD)
    monkeypatch.setattr("os.access", lambda path, mode: not str(path).endswith("x_4.jpg"))
    before = names(tmp_path)
    if arguments[1].startswith("locked"):
        monkeypatch.setattr("tempfile.mkstemp", _refuse)
    assert render(small, *arguments[1:2], *arguments[2:]) == 1
    out, error = capfd.readouterr()
    assert_one_line("\n".join(line for line in error.splitlines() if "WARNING" not in line), *words)
    assert "Ready" not in out and "No media" not in out and names(tmp_path) == before


def _refuse(*_, **__):
    raise PermissionError(13, "Permission denied")


@pytest.mark.parametrize(
    "arguments",
    [
        ("--frames", "1-"),
        ("--frames", "1", "--frame", "1"),
        ("--samples", "4:4"),
        ("--time-limit", "0"),
        ("--time-limit", "nan"),
        ("--device", "TPU"),
    ],
)
def test_options_that_are_none_are_wrong_usage(arguments, small, tmp_path):
    assert render(small, tmp_path / "x_#.png", *arguments) == 2
    assert not names(tmp_path)


def test_a_camera_that_is_named_wins_over_markers_on_all_frames(small, tmp_path):
    assert render(small, tmp_path / "other_#.exr", "--frames", "2,4", "--camera", "Other") == 0
    assert render(small, tmp_path / "own_#.exr", "--frames", "4") == 0
    other = [read_picture(tmp_path / f"other_{frame}.exr") for frame in (2, 4)]
    np.testing.assert_array_equal(other[0], other[1])
    assert np.abs(other[1] - read_picture(tmp_path / "own_4.exr")).mean() > 0.05


def test_a_scene_has_its_cameras_and_layers_again(small):
    bpy.ops.wm.open_mainfile(filepath=str(small))
    scene = bpy.context.scene
    own = scene.camera
    with through_camera(scene, bpy.data.objects["Other"]), layer_alone(scene, scene.view_layers["Second"]):
        scene.frame_set(4)
        assert scene.camera.name == "Other" and [layer.use for layer in scene.view_layers] == [False, True]
    assert scene.timeline_markers[0].camera == own == scene.camera
    assert all(layer.use for layer in scene.view_layers)


def test_one_view_layer_is_rendered_alone(small, tmp_path):
    bpy.ops.wm.open_mainfile(filepath=str(small))
    bpy.context.scene.view_layers["Second"].use_pass_normal = True
    save_blend(tmp_path / "layers.blend")
    assert render(tmp_path / "layers.blend", tmp_path / "x.exr", "--view-layer", "Second", "--samples", "0:1") == 0
    channels = oiio.ImageBuf(str(tmp_path / "x.exr")).spec().channelnames
    assert {name.split(".")[0] for name in channels} == {"Second"}


def test_a_time_limit_ends_a_frame_early(small, tmp_path):
    arguments = ("--samples", 10_000_000, "--time-limit", 0.2)
    assert render(small, tmp_path / "x.png", *arguments) == 0
    check_picture(tmp_path / "x.png", "x.png", (16, 16))


NAMED = [
    (True, "shot", "A"),
    (False, "s_", "A"),
    (False, "a_##", "A"),
    (False, "s", ""),
    (False, "", "b_##"),
    (True, "", "A"),
]


@pytest.mark.parametrize("named", mostly_again(NAMED, 2))
def test_files_of_the_compositor_have_each_frames_number_as_blender_gives_it_to_animations(named, tmp_path):
    layered, name, item = named
    scene = stripes(8)
    writer = with_writer(scene, f"{tmp_path}/ours/", name, item, layered)
    for frame in render_frames(scene, [Frame(number, tmp_path / f"x_{number}.png") for number in (1, 2)]):
        assert frame.state == "written"
    assert (writer.file_name, writer.file_output_items[0].name) == (name, item)
    writer.directory = f"{tmp_path}/blender/"
    scene.frame_start, scene.frame_end, scene.render.filepath = 1, 2, f"{tmp_path}/x_"
    bpy.ops.render.render(animation=True)
    assert names(tmp_path / "ours") == names(tmp_path / "blender") and len(names(tmp_path / "ours")) == 2


def test_files_in_a_folder_of_their_nodes_name_are_whole_or_not_written_too(tmp_path, full_on_frame_two):
    scene = stripes(32)
    with_writer(scene, f"{tmp_path}/{{node_name}}/", "s_").name = "Beauty.1"
    (tmp_path / "Beauty.1").mkdir()
    (tmp_path / "Beauty.1" / "s_0002.png").write_bytes(OLD)
    states = [each.state for each in render_frames(scene, [Frame(k, tmp_path / f"x_{k}.png") for k in (1, 2)])]
    assert states == ["written", "failed"]
    files = ["Beauty.1/s_0001.png", "Beauty.1/s_0002.png"]
    assert names(tmp_path) == ["Beauty.1", *files, "x_1.png"]
    assert (tmp_path / files[1]).read_bytes() == OLD


def test_a_view_layer_that_the_compositor_needs_is_not_left_out(small):
    bpy.ops.wm.open_mainfile(filepath=str(small))
    scene = bpy.context.scene
    with_writer(scene, "//", "x")
    with pytest.raises(RenderError, match="'ViewLayer', too"), layer_alone(scene, scene.view_layers["Second"]):
        pass
    with layer_alone(scene, scene.view_layers["ViewLayer"]):
        assert [layer.use for layer in scene.view_layers] == [True, False]


def test_a_folder_of_passes_that_cannot_be_written_is_named_before_the_work(tmp_path, capfd):
    scene = stripes(16)
    writer = with_passes(tmp_path, scene)
    writer.directory = f"{tmp_path}/shot/passes/"
    save_blend(tmp_path / "passes.blend")
    (tmp_path / "shot").write_bytes(OLD)
    assert render(tmp_path / "passes.blend", tmp_path / "x_##.exr", "--frames", "11-13") == 1
    out, error = capfd.readouterr()
    assert_one_line(error.splitlines()[-1], "shot/passes: cannot be written")
    assert "Ready" not in out and names(tmp_path) == ["passes.blend", "shot"]


@pytest.mark.parametrize("device, words", [("CPU", "rendered: by OSL"), ("GPU", "rendered: by Cycles' own nodes")])
def test_the_device_is_set_before_what_renders_media_is_chosen(device, words, ball, tmp_path, monkeypatch, capfd):
    monkeypatch.setattr(devices, "_enable_gpus", lambda: ("A made-up GPU",))
    assert render(ball, tmp_path / "x.png", "--device", device, "--samples", 1) == 0
    out = capfd.readouterr().out
    assert words in out and ("renders on: A made-up GPU" in out) == (device == "GPU")


@pytest.mark.parametrize(
    "there, chosen, used",
    [
        ({"CUDA": ["A"], "OPTIX": ["A"]}, "NONE", ("OPTIX", ("A",))),
        ({"CUDA": ["A", "B"]}, "NONE", ("CUDA", ("A", "B"))),
        ({"CUDA": ["A"], "OPTIX": ["A"]}, "CUDA", ("CUDA", ("A",))),
        ({"HIP": ["C"]}, "CUDA", ("HIP", ("C",))),
    ],
)
def test_gpus_are_those_of_the_preferences_or_else_all_of_the_best_kind(there, chosen, used, monkeypatch):
    """What Cycles finds is made up, as machines differ."""

    class Device:
        def __init__(self, name, kind):
            self.name, self.type, self.use = name, kind, kind == chosen

    class Preferences:
        compute_device_type = chosen
        devices = [Device(name, kind) for kind, names in there.items() for name in names] + [Device("CPU", "CPU")]

        def get_device_types(self, context):
            return [("NONE", "", ""), *((kind, "", "") for kind in there)]

        def get_devices_for_type(self, kind):
            return [device for device in self.devices if device.type in (kind, "CPU")]

    class Addon:
        preferences = Preferences()

    monkeypatch.setattr(devices, "_preferences", lambda: Addon.preferences)
    scene = stripes()
    assert devices.use_device(scene, "GPU") == used[1] and scene.cycles.device == "GPU"
    assert Addon.preferences.compute_device_type == used[0]
    assert {(each.type, each.name) for each in Addon.preferences.devices if each.use} == {
        (used[0], name) for name in used[1]
    }
    devices.use_device(scene, "CPU")
    assert scene.cycles.device == "CPU"


def test_frames_are_within_blenders_limits():
    limits = bpy.types.Scene.bl_rna.properties["frame_current"]
    assert (limits.hard_min, limits.hard_max) == (FIRST_FRAME, LAST_FRAME)
