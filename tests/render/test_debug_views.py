"""Debug views: flat colours as the legend has them, and exact numbers, whichever body renders and whatever is told."""

import bpy
import numpy as np
import pytest
from crossing_blocks import add_crossing
from scenes import (
    add_camera,
    add_plane,
    add_point_light,
    add_sphere,
    diffuse,
    mostly_again,
    native,
    new_scene,
    oiio,
    render,
    set_striped_world,
    set_world,
)

import nested_dielectric as nd
from nested_dielectric.model.contract import DebugView
from nested_dielectric.model.debug_views import GREEN, OPACITY, RED, STEPS, medium_colour, step_of
from nested_dielectric.nodes.shader_nodes import attribute
from nested_dielectric.scene.debug_views import add_debug_passes, remove_debug_passes, set_debug_view

# Single precision: sums of powers of two are exact, hues go through a few divisions.
COLOUR_TOLERANCE = 1e-6

SURFACES = 6
"""That a ray through the middle of the balls meets."""

EXPECTED = {
    "MEDIUM": {"": [5, 2, 5, 5, 5, -1]},
    "DEPTH": {"": [1, 2, 3, 3, 2, 1], "native": [1, 0, 0, 0, 0, 1]},
    "RAYS": {"": [0] * SURFACES, "asked": [1, 2, 1, 1, 2, 1]},
    "BODY": {"": [0] * SURFACES, "native": [1] * SURFACES},
    "TOLD": {"": [1, 2, 3, 3, 2, 1], "asked": [0] * SURFACES},
}
"""Numbers of each view from surface to surface of :func:`nested_balls`; what is under '' holds for all others.

From the ball of glass (5) light comes to water (2), which wins over ice (3): the surfaces of that do not exist, so the medium
behind the second and third surface that is let through is that behind the fifth. A probe from glass meets nothing, one from
water glass, one from ice water, which decides.
"""


def nested_balls(told: str) -> bpy.types.Scene:
    scene = new_scene(16, with_group=True)
    set_world((0.0, 0.0, 0.0))
    add_camera((0.0, -5.01, 0.1), (0, 0, 0), width=3)
    for name, radius, priority in (("Glass", 1.2, 5), ("Water", 0.9, 2), ("Ice", 0.6, 3)):
        add_sphere(name, radius, nd.new_material(name, ior=1.3), priority, segments=32)
    nd.prepare(scene, cut=False, backend="NATIVE" if told == "native" else "OSL")
    if told == "asked":
        nd.clear_analysis(scene)
    return scene


def seen(scene: bpy.types.Scene, view: str, through: int = 0) -> np.ndarray:
    set_debug_view(scene, view, through)
    return render(1)


def middle(picture: np.ndarray) -> np.ndarray:
    return picture[8, 8]


def colour_of(view: str, number: float) -> tuple[float, float, float]:
    """The legend's colour."""
    if view == "MEDIUM" and number >= 0:
        return medium_colour(number)
    return STEPS[DebugView[view]][step_of(DebugView[view], number)].colour


@pytest.mark.parametrize("told", mostly_again(("asked", "told", "native")))
def test_the_colour_of_each_surface_on_the_way_is_the_legends(told):
    scene = nested_balls(told)
    for view, numbers in EXPECTED.items():
        for through, number in enumerate(numbers.get(told, numbers[""])):
            found = middle(seen(scene, view, through))
            np.testing.assert_allclose(
                found, colour_of(view, number), atol=COLOUR_TOLERANCE, err_msg=f"{view} {through}"
            )
    picture = seen(scene, "MEDIUM", SURFACES)
    assert not middle(picture).any()


def test_surfaces_that_do_not_exist_are_red_behind_veils_of_green():
    scene = nested_balls("told")
    scene.cycles.min_transparent_bounces = 32  # or Cycles plays Russian roulette with what veils leave
    expected, left = np.zeros(3), 1.0
    for exists in (1, 1, 0, 0, 1, 1):
        expected += left * OPACITY[exists] * np.array(GREEN if exists else RED)
        left *= 1.0 - OPACITY[exists]
    np.testing.assert_allclose(middle(seen(scene, "VALIDITY")), expected, atol=COLOUR_TOLERANCE)


def test_a_picture_holds_the_legends_colours_and_nothing_else():
    """Whatever the light; the silhouette is that of the ball."""
    scene = nested_balls("asked")
    set_striped_world()
    scene.world.cycles_visibility.camera = False
    scene.render.resolution_percentage = 400
    picture = seen(scene, "MEDIUM").reshape(-1, 3)
    covered = picture.any(axis=1)
    np.testing.assert_allclose(picture[covered], np.tile(medium_colour(5), (covered.sum(), 1)), atol=COLOUR_TOLERANCE)
    # Of 64 x 64 samples along the rim of a polygon of 32 corners, which lacks 1 % of the disk.
    assert covered.mean() == pytest.approx(np.pi * 1.2**2 / 9.0, rel=0.03)


def test_media_that_are_cut_and_own_nodes_show_the_same_media_as_those_that_ask():
    def build():
        scene = new_scene(48, with_group=True)
        set_world((0.0, 0.0, 0.0))
        add_crossing()
        add_camera((4.03, -5.01, 3.5), (0.01, 0.02, 0), angle=40)
        return scene

    pictures = {}
    scene = build()
    nd.prepare(scene, cut=False, backend="OSL")
    nd.clear_analysis(scene)
    pictures["asked"] = [seen(scene, "MEDIUM", through) for through in range(2)]
    nd.prepare(scene, cut=True, backend="OSL")
    pictures["cut"] = [seen(scene, "MEDIUM", through) for through in range(2)]
    told = seen(scene, "TOLD")
    assert np.unique(told.reshape(-1, 3), axis=0).shape[0] == 2, "faces that are cut, and nothing else"
    assert {tuple(each) for each in told.reshape(-1, 3)} == {(0.0, 0.0, 0.0), STEPS[DebugView.TOLD][4].colour}
    scene = build()
    nd.prepare(scene, backend="NATIVE")
    pictures["native"] = [seen(scene, "MEDIUM", through) for through in range(2)]
    assert len(np.unique(pictures["asked"][0].reshape(-1, 3).round(4), axis=0)) == 3
    for way in ("cut", "native"):
        same = np.isclose(pictures[way][0], pictures["asked"][0], atol=COLOUR_TOLERANCE).all(axis=-1)
        # A cut moves edges by the last bits of its corners.
        assert same.mean() > 0.995, way
    same = np.isclose(pictures["native"][1], pictures["cut"][1], atol=COLOUR_TOLERANCE).all(axis=-1)
    assert same.mean() > 0.995


def test_a_surface_of_own_nodes_that_is_told_nothing_shows_the_alarm():
    scene = new_scene(16, with_group=True)
    add_crossing(open_one=True)
    add_camera((4.03, -5.01, 3.5), (0.01, 0.02, 0), angle=20)
    nd.prepare(scene, backend="NATIVE")
    for view in ("MEDIUM", "TOLD", "DEPTH"):
        np.testing.assert_array_equal(middle(seen(scene, view)), (1.0, 0.0, 1.0))


@pytest.mark.parametrize("told", mostly_again(("asked", "native")))
def test_all_else_is_lit_as_without_a_debug_view_and_a_picture_after_it_is_as_before(told):
    """Media are no lights: not a sample of the floor is drawn otherwise, and none of it sees their colours."""
    scene = nested_balls(told)
    set_world((0.2, 0.2, 0.2))
    add_point_light((1.0, -2.0, 3.0), 100.0)
    add_plane("Floor", 10.0, (0, 0, -1.3), (0, 0, 1), diffuse(0.8))
    scene.camera.location.z = 2.0
    scene.camera.rotation_euler.x -= 0.35
    before = render(4)
    shown = set_debug_view(scene, "BODY") or render(4)
    media = np.isclose(shown, colour_of("BODY", told == "native"), atol=0.02).all(axis=-1)
    assert 0.2 < media.mean() < 0.9
    floor = np.isclose(shown, before, rtol=1e-5).all(axis=-1)
    mixed = ~media & ~floor  # along the rim of the ball
    assert mixed.mean() < 0.2 and floor.mean() > 0.1
    set_debug_view(scene, "NONE")
    np.testing.assert_array_equal(render(4), before)


def read_layers(path) -> dict[str, np.ndarray]:
    """All channels of an OpenEXR file by name; (height, width) floats."""
    file = oiio.ImageInput.open(str(path))
    channels, place = {}, 0
    while file.seek_subimage(place, 0):
        pixels = np.array(oiio.ImageBuf(str(path), place, 0).get_pixels(oiio.FLOAT))
        channels |= {name: pixels[..., index] for index, name in enumerate(file.spec().channelnames)}
        place += 1
    file.close()
    return channels


def save_layers(scene: bpy.types.Scene) -> None:
    settings = scene.render.image_settings
    settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth = "32"


@pytest.mark.parametrize("osl", [True, False])
def test_cycles_reads_a_view_layers_property_before_the_scenes_and_writes_no_aov_where_osl_runs(osl, tmp_path):
    """What passes of debug views lean on: a newer Cycles that writes AOVs would spare their view layers."""
    scene = new_scene(4)
    scene.cycles.shading_system = osl
    add_camera((0, 0, 5), (0, 0, 0), width=1)
    material = native("Plain", "ShaderNodeEmission")
    tree = material.node_tree
    glow = next(node for node in tree.nodes if node.type == "EMISSION")
    number = attribute(tree, "VIEW_LAYER", '["number"]')
    tree.links.new(number.outputs["Fac"], glow.inputs["Strength"])
    aov = tree.nodes.new("ShaderNodeOutputAOV")
    aov.aov_name = "Value"
    aov.inputs["Value"].default_value = 7.0
    add_plane("Plane", 4.0, (0, 0, 0), (0, 0, 1), material)
    first, second = scene.view_layers[0], scene.view_layers.new("Second")
    first.name = "First"
    for layer in (first, second):
        layer.aovs.add().name = "Value"
        layer.aovs[0].type = "VALUE"
    scene["number"], second["number"] = 3.0, 5.0
    save_layers(scene)
    scene.cycles.samples = 1
    scene.render.filepath = str(tmp_path / "layers.exr")
    bpy.ops.render.render(write_still=True)
    found = read_layers(tmp_path / "layers.exr")
    assert found["First.Combined.R"][2, 2] == 3.0 and found["Second.Combined.R"][2, 2] == 5.0
    assert found["First.Value.X"][2, 2] == (0.0 if osl else 7.0)


@pytest.mark.parametrize("told", mostly_again(("asked", "native")))
def test_view_layers_hold_exact_numbers_and_leave_the_picture_as_it_is(told, tmp_path):
    scene = nested_balls(told)
    set_world((0.5, 0.5, 0.5))
    scene.view_layers[0].name = "Main"
    save_layers(scene)
    scene.cycles.samples = 4

    def layers(name):
        scene.render.filepath = str(tmp_path / name)
        bpy.ops.render.render(write_still=True)
        return read_layers(tmp_path / name)

    before = layers("before.exr")
    assert len(add_debug_passes(scene)) == 6 and add_debug_passes(scene) == ()
    found = layers("passes.exr")
    for channel in "RGB":
        np.testing.assert_array_equal(found[f"Main.Combined.{channel}"], before[f"Main.Combined.{channel}"])
    numbers = {name: numbers.get(told, numbers[""])[0] for name, numbers in EXPECTED.items()} | {"VALIDITY": 2}
    for view, number in numbers.items():
        layer = found[f"ND {view.title()}.Emission.R"]
        assert layer[8, 8] == number and layer[0, 0] == 0.0, view
    assert len(remove_debug_passes(scene)) == 6
    assert [layer.name for layer in scene.view_layers] == ["Main"]
