"""The flagship scene: iced water."""

import bpy
import pytest
from scenes import new_scene

from nested_dielectric.checking.check import check as find_problems
from nested_dielectric.checking.kinds import FOREIGN_ACROSS, Severity
from nested_dielectric.demo.iced_water import build_scene
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
    problems = [found for found in find_problems(scene) if found.severity != Severity.NOTE]
    assert {found.kind.key for found in problems} == {"few-bounces"}  # which preparing it sets
    assert [(note.kind, note.name) for note in find_problems(scene) if note.severity == Severity.NOTE] == [
        (FOREIGN_ACROSS, "Straw")
    ]


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
