"""The flagship scene: iced water."""

import bpy
import pytest
from scenes import new_scene, read_picture
from test_command_line import run

import nested_dielectric as nd
from nested_dielectric.demo.iced_water import build_scene
from nested_dielectric.preparation.checks import find_problems
from nested_dielectric.scene.media import media


@pytest.fixture
def scene():
    new_scene()
    scene = build_scene()
    bpy.context.window.scene = scene
    return scene


def test_the_scene_holds_every_medium_and_nothing_is_wrong_with_them(scene):
    names = [obj.name for obj in media(scene)]
    assert sum(name.startswith("Ice Cube") for name in names) == 3
    assert {"Tumbler", "Water", "Bubbles in Water", "Bubbles in Ice"} < set(names)
    assert "Straw" not in names and "Straw" in scene.objects
    assert find_problems(scene) == []


def test_ice_breaks_the_surface_and_water_reaches_into_the_glass(scene):
    def extent(name: str, axis: int) -> tuple[float, float]:
        obj = scene.objects[name]
        values = [(obj.matrix_world @ vertex.co)[axis] for vertex in obj.data.vertices]
        return min(values), max(values)

    level = extent("Water", 2)[1]
    for index in (1, 2, 3):
        low, high = extent(f"Ice Cube {index}", 2)
        assert low < 0.74 < level < high
    assert extent("Tumbler", 0)[1] > extent("Water", 0)[1]


def test_the_users_own_scene_is_left_alone(scene):
    own = bpy.data.scenes["Scene"]
    assert len(own.objects) == 0 and own.cycles.samples != scene.cycles.samples


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
    assert nd.get_priority(bpy.data.objects["Water"]) == 30
