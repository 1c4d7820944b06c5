"""What stands in a tinted medium, or shines in it: every stretch of light's way is charged once."""

from __future__ import annotations

import random

import bpy  # before mathutils, which lives inside it
import numpy as np
import pytest
from references import reference_tiles
from scenes import (
    add,
    add_box,
    add_camera,
    add_plane,
    add_sphere,
    assert_mean,
    cycles_glass,
    diffuse,
    emission,
    fresnel,
    mostly_again,
    native,
    new_scene,
    render,
    set_half_world,
    set_world,
)
from test_closed_forms import AIM, aim_camera, beer_lambert, tinted

import nested_dielectric as nd
from nested_dielectric.analysis.charging import Filling, left_to_volumes
from nested_dielectric.preparation.checks import find_problems

THROUGH = 1 - fresnel(0, 1, 1.33)
SMOOTH = {"internal_reflections": False}
EVERY_WAY = [False, True]
NAMES = ["asking", "prepared"]


def prepare_if(prepared: bool) -> None:
    if prepared:
        nd.prepare(bpy.context.scene)


def see_through(opacity: float, behind: bpy.types.Material | None = None) -> bpy.types.Material:
    """A card that lets light on, and is black for the rest."""
    material = behind or diffuse(0.0)
    tree = material.node_tree
    output = tree.get_output_node("CYCLES")
    opaque = output.inputs["Surface"].links[0].from_socket
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = opacity
    tree.links.new(tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[1])
    tree.links.new(opaque, mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    return material


def with_volume(kind: str, density: float, color=(1.0, 1.0, 1.0)) -> bpy.types.Material:
    """Nothing but a volume."""
    material = native("Smoke", kind, Density=density, Color=(*color, 1.0))
    tree = material.node_tree
    output = tree.get_output_node("CYCLES")
    link = output.inputs["Surface"].links[0]
    tree.links.new(link.from_socket, output.inputs["Volume"])
    tree.links.remove(output.inputs["Surface"].links[0])
    return material


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


# Light that starts inside ---------------------------------------------------------------------------------------------


LAMP = (AIM[0], AIM[1], 1.0)


def add_lamp(kind: str) -> None:
    """Small, at a height of 1 above the floor."""
    if kind == "MESH":
        add_sphere("Bulb", 0.0005, emission(1.5e6), None, LAMP, 16)
        return
    light = bpy.data.lights.new("Lamp", kind)
    light.energy = 100.0
    if kind == "AREA":
        light.size = 0.001
    else:
        light.shadow_soft_size = 0.0005
    add("Lamp", light, LAMP)


def lit_floor(kind: str, *boxes: tuple[float, float]) -> None:
    """A floor straight under a lamp, seen from close by; a tinted box, and one that wins over it, each from a height to
    another.
    """
    new_scene(8)
    set_world((0, 0, 0))
    add_plane("Floor", 20, (0, 0, 0), (0, 0, 1), diffuse())
    add_lamp(kind)
    materials = [
        tinted("Tint", 1.0, shadow_mode="TRANSMISSION"),
        nd.new_material("Ice", ior=1.0, shadow_mode="TRANSMISSION"),
    ]
    for priority, (material, (low, high)) in enumerate(zip(materials, boxes)):
        size = 3 + priority
        add_box(material.name, (-size, -size, low), (size, size, high), material, 2 - priority)
    bpy.context.scene.cycles.max_bounces = 0
    add_camera((AIM[0], AIM[1], 0.2), AIM, width=0.001)


LAMPS = mostly_again(["POINT", "MESH", "AREA", "SPOT"], 2)


@pytest.mark.parametrize("kind", LAMPS)
@pytest.mark.parametrize("iced", [False, True], ids=["alone", "through ice"])
def test_a_lamp_inside_a_tint_lights_what_is_outside_through_it(kind, iced):
    lit_floor(kind)
    bare = render(16).reshape(-1, 3).mean(axis=0)
    lit_floor(kind, (0.3, 1.4), *([(0.5, 0.7)] if iced else []))
    problems = nd.prepare(bpy.context.scene).problems
    assert not problems
    expected = bare * beer_lambert(0.7 - (0.2 if iced else 0.0))
    # The same seed draws the same points of the lamp, which is so small that the way to its rim is the same.
    assert render(16).reshape(-1, 3).mean(axis=0) == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("kind", ["MESH"])
def test_a_glowing_mesh_inside_a_tint_lights_what_is_outside_through_it_without_an_analysis(kind):
    lit_floor(kind)
    bare = render(16).reshape(-1, 3).mean(axis=0)
    lit_floor(kind, (0.3, 1.4), (0.5, 0.7))
    assert render(16).reshape(-1, 3).mean(axis=0) == pytest.approx(bare * beer_lambert(0.5), rel=0.01)


def test_a_lamp_lights_what_stands_in_the_same_tint_through_it():
    """No surface of the medium lies between them."""
    pictures = []
    for boxes in ((), ((-1.0, 1.4),)):
        lit_floor("POINT", *boxes)
        nd.prepare(bpy.context.scene)
        pictures.append(render(16).reshape(-1, 3).mean(axis=0))
    bare, inside = pictures
    assert inside == pytest.approx(bare * beer_lambert(1.0) * beer_lambert(0.2), rel=0.02)


# Against Cycles' own volume ---------------------------------------------------------------------------------------------

COLOR = (0.9, 0.5, 0.2)
SHADOWS = {"shadow_mode": "TRANSMISSION"}


def cycles_volume() -> bpy.types.Material:
    """What Cycles itself makes of that tint without a surface."""
    material = native("Tea", "ShaderNodeBsdfTransparent")
    tree = material.node_tree
    volume = tree.nodes.new("ShaderNodeVolumeCoefficients")
    volume.inputs["Scatter Coefficients"].default_value = (0.0, 0.0, 0.0)
    volume.inputs["Absorption Coefficients"].default_value = [-np.log(channel) for channel in COLOR]
    tree.links.new(volume.outputs[0], tree.get_output_node("CYCLES").inputs["Volume"])
    return material


def scattering_domain() -> None:
    add_box("Smoke", (-1.2, -1.2, -0.6), (1.2, 1.2, 0.1), with_volume("ShaderNodeVolumeScatter", 0.5))


def glass_marble() -> None:
    add_sphere("Marble", 0.4, cycles_glass(1.5), None, (0.0, 0.1, -0.3), 32)


def leaf_over_a_spoon() -> None:
    add_plane("Leaf", 3.0, (0.1, 0, 0), (0.1, 0.1, 1), see_through(0.4, diffuse(0.5)))


def hair() -> None:
    dice = random.Random(1)
    curves = bpy.data.hair_curves.new("Hair")
    curves.add_curves([2] * 100)
    points = []
    for _ in range(100):
        x, y = dice.uniform(-1, 1), dice.uniform(-1, 1)
        points += [x, y, -0.9, x + dice.uniform(-0.3, 0.3), y + dice.uniform(-0.3, 0.3), 0.0]
    curves.attributes["position"].data.foreach_set("vector", points)
    curves.attributes.new("radius", "FLOAT", "POINT").data.foreach_set("value", [0.02] * 200)
    curves.materials.append(diffuse(0.6))
    add("Hair", curves)


def tea_with_a_bubble(ours: bool, build, volume=None) -> None:
    """A box of tea with a box of air cut out of its top; of index 1, so that Cycles needs no surface."""
    new_scene(16)
    set_world()
    bpy.context.scene.cycles.volume_bounces = 8
    bpy.context.scene.cycles.volume_biased = volume is not None  # without it Cycles looks at two million points first
    low, high = (-2, -2, -1), (2, 2, 1)
    if ours:
        tea = nd.new_material("Tea", ior=1.0, transmittance=COLOR, transmittance_depth=1.0, **SHADOWS)
        add_box("Tea", low, high, tea, 2)
        add_box("Bubble", (-0.7, -0.6, 0.2), (0.3, 0.9, 1.4), nd.new_material("Air", ior=1.0, **SHADOWS), 1)
    else:
        tea = cycles_volume()
        cut = add_box("Tea", low, high, tea).modifiers.new("Cut", "BOOLEAN")
        cut.object = add_box("Bubble", (-0.7, -0.6, 0.2), (0.3, 0.9, 1.4))
        cut.object.hide_render = cut.object.hide_viewport = True
    add_plane("Spoon", 1.5, (0.2, 0.2, -0.7), (0, 0.2, 1), diffuse(0.8))
    if build is not None:
        build()
    if volume is not None:
        volume(tea)
    add_camera((1.013, -3.007, 5), (0.013, 0.007, 0), angle=25)


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


def add_scattering(material: bpy.types.Material) -> None:
    """What an artist adds to a liquid's volume, with the mask where there is one."""
    tree = material.node_tree
    output = tree.get_output_node("CYCLES")
    volume = tree.nodes.new("ShaderNodeVolumeScatter")
    volume.inputs["Density"].default_value = 0.5
    volume.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    node = tree.nodes.get("Nested Dielectric")
    if node is not None:
        density = tree.nodes.new("ShaderNodeMath")
        density.operation = "MULTIPLY"
        density.inputs[1].default_value = 0.5
        tree.links.new(node.outputs["Volume Mask"], density.inputs[0])
        tree.links.new(density.outputs[0], volume.inputs["Density"])
    both = tree.nodes.new("ShaderNodeAddShader")
    tree.links.new(output.inputs["Volume"].links[0].from_socket, both.inputs[0])
    tree.links.new(volume.outputs[0], both.inputs[1])
    tree.links.new(both.outputs[0], output.inputs["Volume"])


def test_a_volume_that_the_artist_adds_to_tea_ends_where_another_medium_wins():
    assert_as_cycles(None, add_scattering, 256)


# Labels -----------------------------------------------------------------------------------------------------------------


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


# What is named ----------------------------------------------------------------------------------------------------------


def problems() -> str:
    return "\n".join(map(str, find_problems(bpy.context.scene)))


@pytest.mark.quick
def test_a_lamp_in_a_tint_that_must_ask_is_named_with_the_remedy():
    lit_floor("POINT", (0.3, 1.4), (0.5, 0.7))
    assert nd.prepare(bpy.context.scene).problems == ()
    bpy.data.objects["Ice"].keyframe_insert("location", frame=1)
    (problem,) = nd.prepare(bpy.context.scene).problems
    assert problem.name == "Lamp" and "'Tint'" in problem.text and "move" in problem.remedy
    bpy.data.objects["Lamp"].location.z = 3.0
    assert problems() == ""


@pytest.mark.quick
@pytest.mark.parametrize(
    "build", [scattering_domain, leaf_over_a_spoon, glass_marble, hair], ids=lambda build: build.__name__
)
def test_what_sends_light_on_in_a_tint_that_must_ask_is_named(build):
    tea_with_a_bubble(True, build)
    bpy.data.objects["Bubble"].keyframe_insert("location", frame=1)
    (problem,) = nd.prepare(bpy.context.scene).problems
    assert problem.name in ("Smoke", "Leaf", "Marble", "Hair")


@pytest.mark.quick
def test_a_volume_of_the_artists_without_the_mask_is_named_where_another_medium_wins():
    tea_with_a_bubble(True, None, add_scattering)
    assert nd.prepare(bpy.context.scene).problems == ()
    bubble = bpy.data.objects["Bubble"]
    bubble.scale.x = -1.0
    assert [problem.name for problem in nd.prepare(bpy.context.scene).problems] == ["Bubble"]
    bubble.scale.x = 1.0
    tree = bpy.data.materials["Tea"].node_tree
    tree.links.remove(tree.nodes["Nested Dielectric"].outputs["Volume Mask"].links[0])
    (problem,) = nd.prepare(bpy.context.scene).problems
    assert problem.name == "Tea" and "'Bubble'" in problem.text and "'Volume Mask'" in problem.remedy


@pytest.mark.quick
def test_a_label_with_holes_on_a_tinted_bottle_is_named():
    new_scene()
    bottle = add_box("Bottle", (-1, -1, -1), (1, 1, 1), tinted("Beer", 1.33), 1)
    bottle.data.materials.append(emission())
    assert problems() == ""
    bottle.data.materials[1] = see_through(0.5)
    assert "'Bottle' is tinted and has the label" in problems()


# Which media are left to volumes ------------------------------------------------------------------------------------------


def filling(material: str, priority: int, *, chord=1.0, absorbs=(0.1, 0.5, 1.0), **keywords) -> Filling:
    return Filling(material, priority, chord, absorbs, **keywords)


CLEAR = (0.0, 0.0, 0.0)


@pytest.mark.pure
@pytest.mark.parametrize(
    "fillings, pairs, volumes, giving_back",
    [
        pytest.param([filling("Tea", 2)], [], {"Tea"}, set(), id="alone"),
        pytest.param([filling("Water", 2, absorbs=CLEAR)], [], set(), set(), id="clear"),
        pytest.param(
            [filling("Tea", 2), filling("Ice", 1, absorbs=CLEAR)], [(0, 1)], set(), set(), id="nothing wants it"
        ),
        pytest.param(
            [filling("Tea", 2, wanted=True), filling("Ice", 1, absorbs=CLEAR)],
            [(0, 1)],
            {"Tea"},
            {"Ice"},
            id="a lamp in iced tea",
        ),
        pytest.param(
            [filling("Tea", 3, wanted=True), filling("Ice", 2, absorbs=CLEAR), filling("Gem", 1, absorbs=CLEAR)],
            [(0, 1), (1, 2)],
            {"Tea"},
            {"Ice", "Gem"},
            id="ways through ice end at the gem in it",
        ),
        pytest.param(
            [filling("Tea", 2, wanted=True), filling("Ice", 1, absorbs=CLEAR, certain=False)],
            [(0, 1)],
            set(),
            set(),
            id="ice that moves",
        ),
        pytest.param(
            [filling("Tea", 2, wanted=True), filling("Tea", 2)], [(0, 1)], set(), set(), id="two of one priority"
        ),
        pytest.param(
            [filling("Ink", 2, wanted=True, absorbs=(9.0, 9.0, 9.0)), filling("Ice", 1, absorbs=CLEAR)],
            [(0, 1)],
            set(),
            set(),
            id="too dark to be given back",
        ),
        pytest.param(
            [filling("Ink", 2, wanted=True, absorbs=(9.0, 9.0, 9.0)), filling("Glass", 1, chord=0.1, absorbs=CLEAR)],
            [(0, 1)],
            {"Ink"},
            {"Glass"},
            id="a thin wall",
        ),
        pytest.param([filling("Tea", 2), filling("Tea", 2, simple=False)], [], set(), set(), id="one of several unfit"),
    ],
)
def test_media_are_left_to_volumes_where_all_can_be_given_back(fillings, pairs, volumes, giving_back):
    assert left_to_volumes(fillings, pairs) == (volumes, giving_back)
