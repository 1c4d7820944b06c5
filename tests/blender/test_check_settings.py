"""What a check says of settings, bounces, values and scenes: made, placed, and nothing where all is right."""

import json

import bpy
import pytest
import structures
from nested_balls import build_scene
from scenes import add_camera, add_sphere, new_scene

import nested_dielectric as nd
from nested_dielectric.checking.finding import Action, Fix, from_json, to_json
from nested_dielectric.checking.kinds import KINDS, Severity
from nested_dielectric.preparation import live
from nested_dielectric.scene.settings import AT_LEAST


def found(kind: str) -> list[nd.Finding]:
    return [finding for finding in nd.check(bpy.context.scene) if finding.kind.key == kind]


def shells(count: int) -> bpy.types.Scene:
    """Build balls within balls, seen by a camera, with enough bounces."""
    scene = new_scene(with_group=True)
    for index in range(count):
        nd.assign(
            add_sphere(f"Ball {index}", 1.0 - 0.8 * index / count), nd.new_material("Glass", priority=count - index)
        )
    add_camera((0, -5, 0.31), (0, 0, 0), angle=28)
    for path, least in AT_LEAST.items():
        setattr(scene.cycles, path.removeprefix("cycles."), least)
    return scene


def test_bounces_are_counted_along_rays_from_the_camera():
    scene = shells(6)
    assert nd.check(scene) == []
    scene.cycles.transmission_bounces = 19
    (finding,) = found("few-bounces")
    assert "Transmission" in finding.text and "meet 12 interfaces" in finding.text
    assert finding.fix == Fix(Action.SET_SETTING, (scene.name,), 64, "cycles.transmission_bounces")
    x, y, z = finding.place.point
    assert x * x + y * y + z * z == pytest.approx(1.0, abs=0.05)  # the outermost ball, as its mesh has it
    scene.cycles.transmission_bounces = 20
    assert found("few-bounces") == []


def test_more_nesting_than_prepare_expects_asks_for_more_bounces():
    scene = shells(40)
    first, second = found("few-bounces")
    assert {first.fix.path, second.fix.path} == {"cycles.max_bounces", "cycles.transmission_bounces"}
    assert first.fix.value == second.fix.value == 96  # 80 interfaces, and 8 reflections
    scene.cycles.max_bounces = scene.cycles.transmission_bounces = 96
    assert found("few-bounces") == []


def test_hidden_surfaces_are_counted_for_transparent_bounces_unless_they_are_cut():
    scene = new_scene(with_group=True)
    nd.assign(add_sphere("Winner", 1.0), nd.new_material("Glass", priority=1))
    for index in range(5):
        nd.assign(add_sphere(f"Loser {index}", 0.9 - 0.1 * index), nd.new_material("Water", priority=2 + index))
    add_camera((0, -5, 0.31), (0, 0, 0), angle=28)
    scene.cycles.transparent_max_bounces = 9
    (finding,) = found("few-bounces")
    assert "10 hidden surfaces" in finding.text and finding.fix.path == "cycles.transparent_max_bounces"
    nd.prepare(scene, cut=True)
    scene.cycles.transparent_max_bounces = 9
    assert found("few-bounces") == []


@pytest.mark.parametrize(
    "spoil, path, value",
    [
        (lambda scene: setattr(scene.render, "engine", "BLENDER_EEVEE"), "render.engine", "CYCLES"),
        (lambda scene: setattr(scene.cycles, "shading_system", False), "cycles.shading_system", True),
        (lambda scene: setattr(scene.cycles, "device", "GPU"), "cycles.device", "CPU"),
    ],
)
def test_settings_that_show_no_media_are_named_with_the_switch(spoil, path, value):
    build_scene()
    scene = bpy.context.scene
    nd.prepare(scene, cut=False, backend="OSL")
    assert found("settings") == []
    spoil(scene)
    (finding,) = found("settings")
    assert finding.fix == Fix(Action.SET_SETTING, (scene.name,), value, path)
    assert finding.severity == Severity.WRONG and finding.name == scene.name


def test_dispersing_media_without_what_carries_wavelengths_are_named():
    scene = new_scene(with_group=True)
    nd.assign(add_sphere("Prism", 1.0), nd.new_material("Prism", disperse=True))
    (finding,) = found("no-colours")
    assert finding.fix.action == Action.PREPARE
    nd.prepare(scene)
    assert found("no-colours") == []


@pytest.mark.parametrize("depth, words", [(0.02, "less than 1 %"), (2000.0, "99.8")])
def test_a_depth_in_another_unit_is_a_note(depth, words):
    scene = new_scene(with_group=True)
    tint = {"transmittance": (0.8, 0.3, 0.1)}
    nd.assign(add_sphere("Drink", 1.0), nd.new_material("Drink", transmittance_depth=1.3, **tint))
    assert found("tint-strength") == []
    bpy.data.materials["Drink"].node_tree.nodes["Nested Dielectric"].inputs["Transmittance Depth"].default_value = depth
    (finding,) = found("tint-strength")
    assert words in finding.text and finding.severity == Severity.NOTE
    assert finding.fix.action == Action.SET_DEPTH and finding.fix.value == pytest.approx(
        4 / 3, rel=0.02
    )  # Cauchy's 4 V / S
    assert not nd.prepare(scene).problems


def test_a_material_that_another_scene_was_told_of_last_is_named():
    first = new_scene(with_group=True)
    glass = nd.new_material("Glass")
    nd.assign(add_sphere("Ball", 1.0), glass)
    nd.prepare(first)
    second = bpy.data.scenes.new("Second")
    second.collection.objects.link(bpy.data.objects["Ball"])
    second.render.engine, second.cycles.shading_system = "CYCLES", True
    nd.prepare(second)
    live.remove()  # which tells whichever scene is looked at
    (finding,) = found("scenes-ask")
    assert finding.severity == Severity.SLOW and set(finding.others) == {"Second", "Glass"}
    nd.prepare(first)
    assert found("scenes-ask") == []
    nd.prepare(second, backend="NATIVE")
    assert len(found("scenes-disagree")) == 1


def test_a_finding_is_the_same_after_json():
    scene = shells(6)
    scene.cycles.transmission_bounces = 5
    for finding in nd.check(scene):
        assert from_json(json.loads(json.dumps(to_json(finding)))) == finding


def test_every_kind_has_a_key_of_its_own_and_says_what_shows():
    assert all(kind.key == key and kind.shows and not kind.shows.endswith(".") for key, kind in KINDS.items())


def state() -> list:
    """Return what an artist might find changed."""
    values = []
    for scene in bpy.data.scenes:
        values.append((scene.name, dict(scene.items()), [getattr(scene.cycles, path[7:]) for path in AT_LEAST]))
    for obj in bpy.data.objects:
        values.append((obj.name, dict(obj.items()), [modifier.name for modifier in obj.modifiers], obj.hide_render))
    for material in bpy.data.materials:
        node = material.node_tree.nodes["Nested Dielectric"]
        values.append([getattr(socket, "default_value", None) for socket in node.inputs if socket.type != "RGBA"])
    return [str(value) for value in values] + [str(len(bpy.data.objects)), str(len(bpy.data.node_groups))]


def test_a_check_changes_nothing():
    scene = shells(6)
    scene.cycles.transmission_bounces = 5
    before = state()
    assert nd.check(scene)
    assert state() == before


def test_media_that_nodes_alone_instance_are_no_foreign_objects():
    scene = structures.droplets(8, True, "nodes")
    kinds = {finding.kind.key for finding in nd.check(scene)}
    assert not kinds & {"foreign-coincident", "foreign-inside", "foreign-across"}
