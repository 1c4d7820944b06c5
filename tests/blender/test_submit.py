"""Jobs of the Open Job Description as ``submit`` writes them: what they say, and what is refused."""

import json
import os
import shutil
from pathlib import Path

import bpy
import pytest
from disk import OLD, full_disk, names
from jobs import openjd
from scenes import add_camera, add_sphere, new_scene

import nested_dielectric as nd
from nested_dielectric import cli
from nested_dielectric.farm.job_template import Job, JobError, template
from nested_dielectric.scene.output import save_blend


@pytest.fixture(scope="module")
def file(tmp_path_factory) -> Path:
    scene = new_scene(8, with_group=True)
    add_camera((0, -5, 0.3), (0, 0, 0), angle=28)
    add_sphere("Glass", 0.8, nd.new_material("Glass", preset="bk7"))
    scene.frame_start, scene.frame_end, scene.frame_step = 3, 21, 2
    scene.frame_set(7)
    scene.cycles.samples = 10
    scene.cycles.use_denoising = True
    scene.render.image_settings.file_format = "PNG"
    bpy.data.scenes.new("Empty")
    other = bpy.data.scenes.new("Other")
    other.collection.objects.link(scene.camera)
    other.camera = scene.camera
    return save_blend(tmp_path_factory.mktemp("file") / "ball.blend")


def submit(file: Path, folder: Path, *options: object) -> dict:
    """Return what a job says."""
    assert cli.main(["submit", str(file), "--to", str(folder), *map(str, options)]) == 0
    return json.loads((folder / "template.json").read_text(encoding="utf-8"))


def defaults(said: dict) -> dict[str, object]:
    return {each["name"]: each["default"] for each in said["parameterDefinitions"]}


def command(said: dict, step: str) -> list[str]:
    """Return what a step runs in Blender."""
    (found,) = (each for each in said["steps"] if each["name"] == step)
    arguments = found["script"]["actions"]["onRun"]["args"]
    return arguments[arguments.index("--") + 1 :]


def space(said: dict, step: str) -> dict[str, dict]:
    (found,) = (each for each in said["steps"] if each["name"] == step)
    return {each["name"]: each for each in found["parameterSpace"]["taskParameterDefinitions"]}


def test_a_job_renders_what_the_scene_does(file, tmp_path):
    said = submit(file, tmp_path / "job")
    assert said["name"] == "ball" and said["extensions"] == ["TASK_CHUNKING"]
    values = defaults(said)
    assert (values["Frames"], values["OutputName"], values["ChunkSize"]) == ("3-21:2", "ball_####.png", 1)
    assert [each["name"] for each in said["steps"]] == ["Check", "Render"]
    assert said["steps"][1]["dependencies"] == [{"dependsOn": "Check"}]
    assert command(said, "Check") == ["check", "--scene=Scene"]
    stored = json.loads((tmp_path / "job" / "parameter_values.json").read_text(encoding="utf-8"))
    assert {each["name"]: each["value"] for each in stored["parameterValues"]}.items() <= values.items()


def test_a_job_holds_all_that_blender_needs_and_nothing_else(file, tmp_path):
    submit(file, tmp_path / "job")
    assert names(tmp_path) == ["job", *(f"job/{name}" for name in names(tmp_path / "job"))]
    found = names(tmp_path / "job")
    assert {"scene.blend", "program/task.py", "program/osl/nested_dielectric.osl", "program/presets/bk7.toml"} <= set(
        found
    )
    assert not [name for name in found if name.endswith((".pyc", ".md", "build", "assets"))]
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "job" / "scene.blend"))
    assert bpy.context.scene.name == "Scene" and bpy.context.scene.frame_current == 7


def test_a_job_says_what_was_asked_for(file, tmp_path):
    options = [
        "--name",
        "{{Shot}} 1\n",
        "--frames",
        "1-5, 9",
        "--output",
        "shot.##.exr",
        "--chunk",
        4,
        "--check",
        "strict",
    ]
    said = submit(
        file, tmp_path / "job", *options, "--camera", "Camera", "--view-layer", "ViewLayer", "--device", "cpu"
    )
    values = defaults(said)
    assert (values["Frames"], values["OutputName"], values["ChunkSize"]) == ("1-5,9", "shot.##.exr", 4)
    assert said["name"] == "{ {Shot} } 1 "
    assert command(said, "Check") == ["check", "--scene=Scene", "--strict"]
    assert {"--camera=Camera", "--view-layer=ViewLayer", "--device=CPU"} <= set(command(said, "Render"))
    assert openjd("check", tmp_path / "job" / "template.json").returncode == 0


def test_the_file_of_a_job_opens_with_the_scene_that_was_named(file, tmp_path):
    said = submit(file, tmp_path / "job", "--scene", "Other")
    assert command(said, "Check") == ["check", "--scene=Other"]
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "job" / "scene.blend"))
    assert bpy.context.scene.name == "Other"


def test_frames_that_are_named_twice_are_rendered_once(file, tmp_path):
    said = submit(file, tmp_path / "job", "--frames", "1-3,2-5", "--check", "none")
    assert defaults(said)["Frames"] == "1-5" and len(said["steps"]) == 1


def test_ranges_hold_all_samples_once_and_are_merged_and_denoised(file, tmp_path):
    said = submit(file, tmp_path / "job", "--ranges", 3)
    assert defaults(said)["Frames"] == "7" and defaults(said)["OutputName"] == "ball_####.exr"
    assert [each["name"] for each in said["steps"]] == ["Check", "Render", "Merge"] and "extensions" not in said
    assert space(said, "Render")["Samples"]["range"] == ["0:3", "3:6", "6:10"]
    merging = command(said, "Merge")
    assert [each for each in merging if "/parts/" in each] == [
        f"{{{{Param.OutputDir}}}}/parts/{name}/{{{{Param.OutputName}}}}" for name in ("0-3", "3-6", "6-10")
    ]
    assert merging[-2:] == ["--denoise", "{{Param.SceneFile}}"]
    assert openjd("check", tmp_path / "job" / "template.json").returncode == 0


@pytest.mark.parametrize(
    "options, words",
    [
        (["--output", "a/b_##.exr"], "is no plain name"),
        (["--output", "b.exr"], "put #### in its name"),
        (["--output", "b_##.mov"], "the ending must be one of"),
        (["--output", "b_##.png", "--ranges", "2"], "let the ending be .exr"),
        (["--ranges", "11"], "has 10 samples, so name 2 to 10"),
        (["--scene", "None"], "has no scene 'None'"),
        (["--scene", "Empty"], "has no camera"),
        (["--camera", "None"], "has no camera 'None'"),
        (["--device", "gpu", "--backend", "osl"], "renders on the CPU alone"),
        (["--frames", ",".join(map(str, range(1, 999, 2)))], "is longer than 1024 characters"),
    ],
)
def test_what_no_job_can_do_is_named_and_nothing_is_written(file, options, words, tmp_path, capsys):
    assert cli.main(["submit", str(file), "--to", str(tmp_path / "job"), *options]) == 1
    assert words in capsys.readouterr().err and names(tmp_path) == []


def test_a_folder_that_holds_something_is_left(file, tmp_path, capsys):
    (tmp_path / "job").mkdir()
    (tmp_path / "job" / "mine").write_bytes(OLD)
    assert cli.main(["submit", str(file), "--to", str(tmp_path / "job")]) == 1
    assert "name a new folder" in capsys.readouterr().err and names(tmp_path / "job") == ["mine"]


def test_a_disk_that_is_full_leaves_nothing_of_a_job(file, tmp_path):
    with full_disk(20_000):
        assert cli.main(["submit", str(file), "--to", str(tmp_path / "job")]) == 1
    assert names(tmp_path) == []


def test_a_file_that_lacks_a_picture_is_no_job(file, tmp_path, capsys):
    bpy.ops.wm.open_mainfile(filepath=str(file))
    image = bpy.data.images.new("Label", 1, 1)
    image.source, image.filepath = "FILE", "//lost.png"
    label = bpy.data.materials.new("Label")
    label.node_tree.nodes.new("ShaderNodeTexImage").image = image
    bpy.data.objects["Glass"].data.materials.append(label)
    lacking = save_blend(tmp_path / "x.blend")
    assert cli.main(["submit", str(lacking), "--to", str(tmp_path / "job")]) == 3
    assert "lost.png" in capsys.readouterr().out and names(tmp_path) == ["x.blend"]
    submit(lacking, tmp_path / "job", "--keep-outside")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "job" / "scene.blend"))  # which services put somewhere else
    assert bpy.data.images["Label"].filepath == str(file.parent / "lost.png")


@pytest.mark.parametrize("name", ["{{Camera}}", "Camera}}"])
def test_names_that_jobs_would_read_are_refused(name):
    with pytest.raises(JobError, match="rename it"):
        template(Job("x", "1", "x_#.exr", 1, options=(f"--camera={name}",)))


def test_a_file_whose_name_is_no_text_needs_another_for_its_pictures(file, tmp_path, capsys):
    odd = tmp_path / os.fsdecode(b"ball\xff.blend")
    shutil.copyfile(file, odd)
    assert cli.main(["submit", str(odd), "--to", str(tmp_path / "job")]) == 1
    assert "--output" in capsys.readouterr().err and not (tmp_path / "job").exists()
    submit(odd, tmp_path / "job", "--output", "ball_##.png")


def test_a_folder_may_end_in_a_slash_and_is_not_the_one_that_one_is_in(file, tmp_path, monkeypatch, capsys):
    (tmp_path / "job").mkdir()
    assert cli.main(["submit", str(file), "--to", f"{tmp_path}/job/"]) == 0
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    assert cli.main(["submit", str(file), "--to", "."]) == 1
    assert "name a new one in it" in capsys.readouterr().err and Path.cwd().exists()


def test_a_gpu_is_refused_for_what_it_would_show_magenta(tmp_path, capsys):
    new_scene(8)
    add_camera((0, -5, 0.3), (0, 0, 0), angle=28)
    add_sphere("Gem", 0.8, nd.new_material("Gem", preset="bk7", disperse=True, spectral_distribution="FL11"))
    gem = save_blend(tmp_path / "gem.blend")
    command = ["submit", str(gem), "--to", str(tmp_path / "job"), "--device", "gpu"]
    assert cli.main(command) == 1 and names(tmp_path) == ["gem.blend"]
    assert "scene 'Scene': needs Open Shading Language on the CPU ('Gem'" in capsys.readouterr().err
    assert cli.main([*command, "--backend", "native"]) == 0
