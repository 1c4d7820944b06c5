"""Commands that render, as processes of their own."""

import bpy
import pytest
from command_line import run, save_scene
from scenes import read_picture

import nested_dielectric as nd


def test_render_prepares_in_memory_shows_progress_and_leaves_the_file(tmp_path):
    file = save_scene(tmp_path)
    before = file.read_bytes()
    done = run("render", file, "-o", tmp_path / "new" / "picture.png", "--samples", 20, "--frame", 3)
    assert done.returncode == 0, done.stderr
    assert "Render Engine: EEVEE -> Cycles" in done.stdout
    assert done.stdout.strip().endswith(str(tmp_path / "new" / "picture.png"))
    assert "of 20 samples" in done.stderr
    picture = read_picture(tmp_path / "new" / "picture.png")
    assert picture.shape[:2] == (24, 24) and picture.std() > 0.05
    assert file.read_bytes() == before


@pytest.mark.again
def test_the_demo_command_renders_the_picture(tmp_path):
    done = run("demo", "-o", tmp_path / "picture.png", "--samples", 1, "--save", tmp_path / "scene.blend")
    assert done.returncode == 0, done.stderr
    *_, path, saving = done.stdout.strip().splitlines()
    assert path == str(tmp_path / "picture.png")
    assert float(saving.split()[3]) > 0.0, saving
    picture = read_picture(tmp_path / "picture.png")
    assert picture.shape[:2] == (720, 720)
    # The stripes of the straw are the only saturated red, and they are seen above the glass and through the water.
    red = picture[..., 0] > 2.5 * picture[..., 1]
    assert red[40:200].any() and red[340:460].any()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    assert bpy.context.scene.name == "Iced Water" and nd.get_priority(bpy.context.scene.objects["Water"]) == 30
