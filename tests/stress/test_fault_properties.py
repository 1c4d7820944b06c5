"""Custom properties may hold anything, such as words, huge numbers, lists and pointers: nothing raises, and it is mended."""

import os
import random

import bpy
import pytest
from scenes import add_box, add_camera, add_point_light, add_sphere, new_scene
from storms import raised_by_handlers

import nested_dielectric as nd
from nested_dielectric.analysis.surroundings import clear_analysis
from nested_dielectric.checking.check import check as find_problems
from nested_dielectric.model.spectral_tables import spectral_table
from nested_dielectric.nodes.material_version import find_group
from nested_dielectric.nodes.spectral_tables import uses_table
from nested_dielectric.preparation import live, prepare_scene, render_handlers
from nested_dielectric.scene import ray_visibility
from nested_dielectric.scene.lights import light_carriers
from nested_dielectric.ui import media_list

NAN = float("nan")

VALUES = {
    "a word": lambda: "junk",
    "an empty word": lambda: "",
    "a path": lambda: '"]["nd_priority',
    "bytes": lambda: b"\xff\xfe",
    "a whole number": lambda: 7,
    "a negative one": lambda: -3,
    "the largest one": lambda: 2**31 - 1,
    "a huge number": lambda: 1e300,
    "no number": lambda: NAN,
    "infinity": lambda: float("inf"),
    "a switch": lambda: True,
    "whole numbers": lambda: [1, 2],
    "numbers": lambda: [1.0] * 4,
    "many numbers": lambda: [1.0] * 100,
    "no numbers": lambda: [NAN] * 3,
    "nothing": list,
    "switches": lambda: [True, False],
    "words": lambda: ["a", "b"],
    "a group": lambda: {"a": 1, "b": {"c": [1.0]}},
    "groups": lambda: [{"a": 1}, {"b": 2}],
    "an object": lambda: bpy.data.objects["Far"],
    "a material": lambda: bpy.data.materials["Sea"],
    "a scene": lambda: bpy.context.scene,
    "a camera": lambda: bpy.data.cameras["Camera"],
}

SCENE = ("nd_scene", "nd_analysed", "nd_told", "nd_centre", "nd_cut", "nd_cut_surfaces", "nd_backend", "nd_prepared")
OBJECT = ("nd_outside", "nd_outside_transmittance", "nd_cut", "nd_cut_of", "nd_priority", "nd_plan", "nd_kept")
MATERIAL = (
    "spectral_distribution",
    "spectral_gamut",
    "spectral_saturation",
    "clamp_negative",
    "nd_preset",
    "nd_preset_key",
)
GROUP = ("nd_version", "nd_lights_version", "nd_source", "nd_passes", "nd_whole", "nd_attributes")


def owners() -> list[tuple[str, str, str]]:
    """Every place where something is stored: a collection of data, a name in it, a property."""
    found = [("scenes", scene.name, name) for scene in bpy.data.scenes for name in SCENE]
    found += [("objects", obj.name, name) for obj in bpy.data.objects for name in OBJECT if obj.type == "MESH"]
    found += [("collections", each.name, "nd_cut_of") for each in bpy.data.collections]
    found += [("materials", each.name, name) for each in bpy.data.materials for name in MATERIAL]
    found += [("node_groups", tree.name, name) for tree in bpy.data.node_groups for name in GROUP]
    return found + [("images", image.name, "nd_tables") for image in bpy.data.images]


def move(_: bpy.types.Scene) -> None:
    bpy.data.objects["Ball"].location.x += 0.01
    bpy.context.view_layer.update()


def undo(scene: bpy.types.Scene) -> None:
    bpy.ops.ed.undo_push(message="before")
    move(scene)
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    bpy.ops.ed.redo()


def look(scene: bpy.types.Scene) -> None:
    media_list.forget_media()
    media_list.listed_lines(scene)
    light_carriers(scene)
    prepare_scene.last_report(scene)
    find_problems(scene)


USES = (
    move,
    undo,
    look,
    lambda scene: scene.frame_set(scene.frame_current + 1),
    lambda scene: render_handlers.analyse_before_render(scene),
    lambda scene: bpy.ops.wm.save_as_mainfile(filepath=bpy.data.filepath, copy=True),
    lambda scene: nd.add_passes(scene),
    lambda scene: nd.update_materials(),
    lambda scene: live.bake_cut(scene),
    clear_analysis,
    prepare_scene.put_back,
)


@pytest.fixture(scope="module", params=["cut", "native", "asking"])
def file(request, tmp_path_factory):
    """A file in which everything is stored that can be: cut surfaces that are kept, lights, tables, passes, a report."""
    scene = new_scene(8, with_group=True)
    native = request.param == "native"
    ball = add_sphere("Ball", 0.6, nd.new_material("Prism", preset="bk7", disperse=not native), segments=12)
    nd.set_priority(ball, 1)
    water = nd.new_material("Sea", preset="water", transmittance=(0.5, 0.7, 0.9), transmittance_depth=2.0)
    add_box("Water", (-1, -1, -1), (1, 1, 0.1), water)
    add_box("Floor", (-1, -1, -1.5), (1, 1, -1), nd.new_material("Floor", preset="glass"))
    add_box("Far", (5, 5, 5), (6, 6, 6), water)
    add_point_light((2.0, 2.0, 4.0), 100.0)
    bpy.data.objects["Lamp"].visible_transmission = False
    add_camera((0.13, -6.0, 0.41), (0.02, 0.0, 0.01), angle=35)
    nd.prepare(scene, cut=request.param != "asking", backend="NATIVE" if native else None)
    nd.add_passes(scene)
    live.bake_cut(scene)
    path = str(tmp_path_factory.mktemp("stored") / "stored.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    return path


def damage(path: str, owner: tuple[str, str, str], value: str, chance: random.Random) -> None:
    """Store a value where another stood, use the scene, and prepare it."""
    bpy.ops.wm.open_mainfile(filepath=path)
    live.install()
    kind, name, prop = owner
    data = getattr(bpy.data, kind)[name]
    try:
        data[prop] = VALUES[value]()
    except (TypeError, OverflowError):  # what Blender keeps in no property
        return
    data.update_tag()
    artists = {obj.name for obj in bpy.data.objects if "nd_cut_of" not in obj}
    with raised_by_handlers() as raised:
        for use in chance.sample(USES, 4):
            use(bpy.context.scene)  # which is another after a step was undone
        scene = bpy.context.scene
        nd.prepare(scene)
    assert not raised, raised[0]
    assert artists <= {obj.name for obj in bpy.data.objects}
    assert nd.prepare(scene).changes == ()
    if kind != "node_groups":
        return
    node = bpy.data.materials["Prism"].node_tree.nodes["Nested Dielectric"]
    assert node.node_tree == find_group()
    assert not node.inputs["Disperse"].default_value or uses_table(node, spectral_table(gamut="REC709"))


CASES = 300 if "ND_STRESS" in os.environ else 5


@pytest.mark.always
def test_whatever_stands_in_a_stored_property_raises_nothing_and_is_mended(file):
    bpy.ops.wm.open_mainfile(filepath=file)
    chance = random.Random(0)
    pairs = [(owner, value) for owner in owners() for value in VALUES]
    for owner, value in chance.sample(pairs, min(CASES, len(pairs))):
        try:
            damage(file, owner, value, chance)
        except Exception as error:
            raise AssertionError(f"{owner} holds {value}") from error


@pytest.mark.always
@pytest.mark.parametrize("value", ["junk", 7, 1.5, [1, 2], {"a": 1}, False])
def test_rays_meet_a_medium_again_although_what_its_artist_has_set_was_damaged(value):
    new_scene()
    ball = add_sphere("Ball", 1.0, segments=8)
    ball.visible_shadow = False
    ball["nd_cut"] = value
    ray_visibility.show(ball)
    assert ball.visible_camera and not ball.visible_shadow
    del ball["nd_cut"]
    ray_visibility.hide(ball)
    assert not ball.visible_camera
    ball["nd_cut"] = value
    ray_visibility.show(ball)
    assert ball.visible_camera and not ray_visibility.is_hidden(ball)


@pytest.mark.always
def test_a_scene_that_stands_where_its_middle_is_stored_is_no_point(file):
    damage(file, ("scenes", "Scene", "nd_centre"), "a scene", random.Random(1))
    assert not isinstance(bpy.context.scene.get("nd_centre"), bpy.types.ID)
