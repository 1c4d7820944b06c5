"""Light in media that absorb is charged once for the whole of its way."""

from __future__ import annotations

import bpy  # before mathutils, which lives inside it
import numpy as np
import pytest
from drinks import (
    add_scattering,
    glass_marble,
    hair,
    leaf_over_a_spoon,
    scattering_domain,
    see_through,
    tea_with_a_bubble,
    with_volume,
)
from references import reference_tiles
from scenes import (
    add_box,
    add_plane,
    diffuse,
    emission,
    fresnel,
    mostly_again,
    new_scene,
    render,
    set_half_world,
    set_world,
)
from significance import assert_mean
from slabs import aim_camera, beer_lambert, tinted

import nested_dielectric as nd

THROUGH = 1 - fresnel(0, 1, 1.33)
SMOOTH = {"internal_reflections": False}
EVERY_WAY = [False, True]
NAMES = ["asking", "prepared"]


def prepare_if(prepared: bool) -> None:
    if prepared:
        nd.prepare(bpy.context.scene)


def domain(material: bpy.types.Material) -> None:
    add_box("Smoke", (-30, -30, -0.9), (30, 30, -0.4), material)


def clear_card() -> float:
    add_plane("Card", 30, (0, 0, -0.7), (0, 0, 1), see_through(0.0))
    return 1.0


def card_with_alpha() -> float:
    add_plane("Card", 30, (0, 0, -0.7), (0, 0, 1), see_through(0.6))
    return 0.4


def two_labels_with_holes() -> float:
    """One behind the other; their holes are finer than a pixel."""
    for height in (-0.3, -0.8):
        material = see_through(0.5)
        tree = material.node_tree
        noise = tree.nodes.new("ShaderNodeTexWhiteNoise")
        step = tree.nodes.new("ShaderNodeMath")
        step.operation = "GREATER_THAN"
        position = tree.nodes.new("ShaderNodeNewGeometry")
        tree.links.new(position.outputs["Position"], noise.inputs["Vector"])
        tree.links.new(noise.outputs["Value"], step.inputs[0])
        tree.links.new(step.outputs[0], tree.nodes["Mix Shader"].inputs[0])
        add_plane("Label", 30, (0, 0, height), (0, 0, 1), material)
    return 0.25


def hidden_object() -> float:
    ball = add_plane("Hidden", 30, (0, 0, -0.5), (0, 0, 1), diffuse(0.8))
    ball.visible_camera = ball.visible_transmission = False
    return 1.0


def empty_domain() -> float:
    domain(with_volume("ShaderNodeVolumeScatter", 0.0))
    return 1.0


def absorbing_domain() -> float:
    domain(with_volume("ShaderNodeVolumeAbsorption", 1.4, (0.0, 0.0, 0.0)))
    return float(np.exp(-1.4 * 0.5))


@pytest.mark.parametrize("prepared", EVERY_WAY, ids=NAMES)
@pytest.mark.parametrize(
    "build",
    mostly_again(
        [card_with_alpha, clear_card, two_labels_with_holes, hidden_object, empty_domain, absorbing_domain], 2
    ),
    ids=lambda build: build.__name__,
)
def test_what_lets_light_on_in_a_drink_is_charged_once(build, prepared):
    new_scene(16)
    set_half_world(2, -1)
    add_box("Water", (-20, -20, -1.2), (20, 20, 0), tinted("Water", 1.33, **SMOOTH), 2)
    left = build()
    aim_camera()
    prepare_if(prepared)
    assert_mean(render(256), THROUGH**2 * beer_lambert(1.2) * left)


@pytest.mark.parametrize("iced", [False, True], ids=["alone", "through ice"])
def test_what_stands_behind_a_card_with_alpha_is_tinted_over_the_whole_way(iced):
    """The ice has the water's index, so it takes no light, and no colour either."""
    new_scene(16)
    set_world((0, 0, 0))
    add_box("Water", (-20, -20, -3), (20, 20, 0), tinted("Water", 1.33, **SMOOTH), 2)
    if iced:
        add_box("Ice", (-40, -40, -0.4), (40, 40, -0.1), nd.new_material("Ice", ior=1.33), 1)
    add_plane("Leaf", 30, (0, 0, -0.6), (0, 0, 1), see_through(0.5))
    add_plane("Spoon", 30, (0, 0, -1.1), (0, 0, 1), emission())
    aim_camera()
    nd.prepare(bpy.context.scene)
    assert_mean(render(256), THROUGH * 0.5 * beer_lambert(1.1 - (0.3 if iced else 0.0)))


@pytest.mark.parametrize("clear", [False, True], ids=["opaque", "with a clear card in the water"])
def test_what_is_frozen_into_ice_is_not_tinted_by_the_water_around_it(clear):
    new_scene(16)
    set_world((0, 0, 0))
    add_box("Water", (-20, -20, -3), (20, 20, 0), tinted("Water", 1.33, **SMOOTH), 2)
    add_box("Ice", (-40, -40, -2), (40, 40, -0.5), nd.new_material("Ice", ior=1.33), 1)
    if clear:
        add_plane("Leaf", 30, (0, 0, -0.2), (0, 0, 1), see_through(0.0))
    add_plane("Cherry", 30, (0, 0, -1.1), (0, 0, 1), emission())
    aim_camera()
    nd.prepare(bpy.context.scene)
    assert_mean(render(256), THROUGH * beer_lambert(0.5))


def assert_as_cycles(build, volume=None, samples: int = 128) -> None:
    """Means within 1 %."""
    tea_with_a_bubble(False, build, volume)
    reference = reference_tiles(lambda: render(samples)[None], samples, 1).reshape(-1, 3).mean(axis=0)
    tea_with_a_bubble(True, build, volume)
    assert nd.prepare(bpy.context.scene).problems == ()
    assert render(samples).reshape(-1, 3).mean(axis=0) == pytest.approx(reference, rel=0.01)


@pytest.mark.parametrize(
    "build",
    mostly_again([scattering_domain, leaf_over_a_spoon, glass_marble, hair]),
    ids=lambda build: build.__name__,
)
def test_what_stands_in_tea_is_tinted_as_by_cycles_own_volume(build):
    assert_as_cycles(build)


def test_a_volume_that_the_artist_adds_to_tea_ends_where_another_medium_wins():
    assert_as_cycles(None, add_scattering, 256)


@pytest.mark.parametrize("prepared", EVERY_WAY, ids=NAMES)
def test_a_label_on_a_bottle_is_seen_through_the_drink_in_it(prepared):
    """It is a face of the bottle with another material."""
    new_scene(16)
    set_world((0, 0, 0))
    bottle = add_box("Water", (-20, -20, -1.2), (20, 20, 0), tinted("Water", 1.33, **SMOOTH), 2)
    bottle.data.materials.append(emission())
    min(bottle.data.polygons, key=lambda face: face.center.z).material_index = 1
    aim_camera()
    prepare_if(prepared)
    assert_mean(render(256), THROUGH * beer_lambert(1.2))
