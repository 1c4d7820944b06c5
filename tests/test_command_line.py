"""The command line, as a process of its own."""

import subprocess
import sys
from pathlib import Path

import bpy
import pytest

import nested_dielectric as nd
from scenes import add_camera, add_sphere, new_scene, read_picture, set_striped_world


def run(*arguments: object) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-m", "nested_dielectric", *map(str, arguments)], capture_output=True, text=True, check=False
    )


def assert_one_line(error: str, *words: str) -> None:
    lines = error.strip().splitlines()
    assert len(lines) == 1 and lines[0].startswith("nested-dielectric: error: ")
    assert all(word in lines[0] for word in words), lines[0]


@pytest.fixture(scope="module")
def file(tmp_path_factory) -> Path:
    """A saved scene that still renders with EEVEE."""
    new_scene(24)
    set_striped_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=28)
    add_sphere("Glass", 1.0, nd.new_material("Glass", preset="glass"))
    bpy.context.scene.render.engine = "BLENDER_EEVEE"
    path = tmp_path_factory.mktemp("file") / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def test_render_prepares_in_memory_shows_progress_and_leaves_the_file(file, tmp_path):
    before = file.read_bytes()
    done = run("render", file, "-o", tmp_path / "new" / "picture.png", "--samples", 20, "--frame", 3)
    assert done.returncode == 0, done.stderr
    assert "Render Engine: BLENDER_EEVEE -> CYCLES" in done.stdout
    assert done.stdout.strip().endswith(str(tmp_path / "new" / "picture.png"))
    assert "of 20 samples" in done.stderr
    picture = read_picture(tmp_path / "new" / "picture.png")
    assert picture.shape[:2] == (24, 24) and picture.std() > 0.05
    assert file.read_bytes() == before


def test_prepare_saves_the_file_and_a_second_time_has_nothing_to_do(file):
    assert "changed: Render Engine" in run("prepare", file).stdout
    done = run("prepare", file)
    assert done.returncode == 0 and "nothing to change" in done.stdout


def test_presets_are_listed():
    done = run("presets")
    assert done.returncode == 0
    assert set(nd.preset_names()) <= {line.split()[0] for line in done.stdout.splitlines()}


@pytest.mark.parametrize(
    "arguments, words",
    [
        (("render", "missing.blend", "-o", "x.png"), ("missing.blend", "no such file")),
        (("prepare",), ("no file is open",)),
    ],
)
def test_a_failure_is_one_clear_line_and_exit_code_1(arguments, words):
    done = run(*arguments)
    assert done.returncode == 1
    assert_one_line(done.stderr, *words)


def test_a_file_that_is_no_blend_is_named(tmp_path):
    (tmp_path / "text.blend").write_text("no blend")
    done = run("render", tmp_path / "text.blend", "-o", tmp_path / "x.png")
    assert done.returncode == 1
    assert "text.blend" in done.stderr.strip().splitlines()[-1]


def test_an_ending_without_a_format_is_named_before_anything_is_rendered(file, tmp_path):
    done = run("render", file, "-o", tmp_path / "picture.xyz")
    assert done.returncode == 1
    assert_one_line(done.stderr, "picture.xyz", ".png")


@pytest.mark.parametrize(
    "arguments", [(), ("rendr",), ("render",), ("render", "a.blend", "-o", "b.png", "--samples", "0")]
)
def test_wrong_usage_has_exit_code_2(arguments):
    assert run(*arguments).returncode == 2
