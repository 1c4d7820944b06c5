"""The command check, as pipelines use it."""

import json

import bpy
from command_line import assert_one_line, run, save_scene

KEYS = {"kind", "severity", "objects", "text", "shows", "remedy", "faces", "point", "fix"}


def test_a_wrong_file_ends_with_3_and_is_named_in_lines_and_in_json(tmp_path):
    file = save_scene(tmp_path)
    before = file.read_bytes()
    done = run("check", file)
    assert done.returncode == 3 and "wrong picture: 'Scene' renders with" in done.stdout and "shows: " in done.stdout
    done = run("check", file, "--json")
    report = json.loads(done.stdout)
    assert done.returncode == 3 and report["schema"] == 1 and report["file"] == str(file) and report["saved"] is None
    scene = report["scenes"]
    assert [each["scene"] for each in scene] == ["Scene"] and scene[0]["changes"] == []
    assert all(finding.keys() == KEYS for finding in scene[0]["findings"])
    assert scene[0]["findings"][0]["fix"]["action"] == "SET_SETTING"
    assert file.read_bytes() == before


def test_fix_saves_another_file_that_is_right(tmp_path):
    file = save_scene(tmp_path)
    before = file.read_bytes()
    done = run("check", file, "--fix", "-o", tmp_path / "fixed.blend")
    assert done.returncode == 0 and "changed: Render Engine" in done.stdout and "nothing is wrong" in done.stdout
    assert file.read_bytes() == before
    assert run("check", tmp_path / "fixed.blend", "--strict").returncode == 0
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "fixed.blend"))
    assert bpy.context.scene.render.engine == "CYCLES"


def test_fix_without_a_file_to_write_is_refused(tmp_path):
    done = run("check", save_scene(tmp_path), "--fix")
    assert done.returncode == 1
    assert_one_line(done.stderr, "--fix", "--output")


def test_a_scene_that_is_named_is_checked_alone(tmp_path):
    file = save_scene(tmp_path)
    bpy.data.scenes.new("Other")
    bpy.ops.wm.save_mainfile()
    assert run("check", file).returncode == 3
    done = run("check", file, "--scene", "Other")
    assert done.returncode == 0 and "Other: nothing is wrong" in done.stdout and "Scene:" not in done.stdout
    done = run("check", file, "--scene", "None")
    assert done.returncode == 1 and "has no scene 'None'" in done.stderr
