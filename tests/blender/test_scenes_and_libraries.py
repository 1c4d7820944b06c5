"""What is told in one scene or file says nothing in another."""

import bpy  # before bmesh, which lives inside it
import pytest
from told import (
    ORDINARY,
    ball,
    codes,
    fresh,
    inputs,
    instance,
    into_collection,
    media_of,
    medium,
    ordinary_scene,
    snapshot,
    told_by_material,
    told_code,
)

import nested_dielectric as nd
from nested_dielectric.analysis import surroundings
from nested_dielectric.model.contract import Exterior
from nested_dielectric.nodes.identity import SCENE_PROPERTY
from nested_dielectric.nodes.names import SCENE_SOCKET
from nested_dielectric.preparation import render_handlers


def holds_in(scene: bpy.types.Scene, obj: bpy.types.Object) -> bool:
    """Whether an object's medium believes in a scene what it carries."""
    number = inputs(media_of(obj)[0])[SCENE_SOCKET].default_value
    return number != 0 and number == scene.get(SCENE_PROPERTY)


@pytest.mark.parametrize("instanced", [False, True], ids=["linked", "instanced"])
def test_an_object_in_two_scenes_is_told_of_the_one_that_was_analysed_last(instanced):
    """In the other something else may surround it."""
    scene, bead = ordinary_scene()
    if instanced:
        instance(into_collection(bead))
    other = scene.copy()
    other.collection.objects.unlink(bpy.data.objects["Water"])
    nd.analyse(scene)
    assert told_code(bead) == Exterior.MEDIUM and holds_in(scene, bead) and not holds_in(other, bead)
    nd.analyse(other)
    assert told_code(bead) == Exterior.AIR and holds_in(other, bead) and not holds_in(scene, bead)


def test_what_one_scene_tells_stays_when_another_is_analysed_or_cleared():
    scene, _bead = ordinary_scene()
    other = bpy.data.scenes.new("Other")
    far = bpy.data.objects.new("Far", bpy.data.meshes["Bead"].copy())
    far.data.materials[0] = medium("Far", 1.5)
    other.collection.objects.link(far)
    nd.analyse(scene)
    before = {name: told for name, told in snapshot().items() if "Far" not in name}
    nd.analyse(other)
    assert told_code(far) == Exterior.AIR
    nd.clear_analysis(other)
    assert told_code(far) == Exterior.UNKNOWN
    assert {name: told for name, told in snapshot().items() if "Far" not in name} == before
    render_handlers.analyse_before_render(scene)
    assert surroundings.last_found(scene).known and surroundings.last_found(other) is None


def test_a_copied_scene_gets_a_number_of_its_own():
    scene, _ = ordinary_scene()
    nd.analyse(scene)
    copy = scene.copy()
    nd.analyse(copy)
    assert copy[SCENE_PROPERTY] != scene[SCENE_PROPERTY]


def test_a_scene_that_is_not_in_the_window_is_looked_at():
    scene, _ = ordinary_scene()
    other = scene.copy()
    other.name = "Other"
    for obj in scene.collection.objects:
        scene.collection.objects.unlink(obj)
    assert not nd.analyse(other).doubts
    assert codes() == ORDINARY


def test_a_linked_material_is_left_as_it_is(tmp_path):
    _, bead = ordinary_scene()
    file = str(tmp_path / "library.blend")
    bpy.data.libraries.write(file, {bead.active_material})
    scene = fresh()
    with bpy.data.libraries.load(file, link=True) as (_, wanted):
        wanted.materials = ["Bead"]
    (linked,) = wanted.materials
    own = medium("Own", 1.33)
    before = told_by_material(linked)
    inside, outside = ball("Inside", 0.5, linked, 1), ball("Outside", 1.0, own, 2)
    crossing = ball("Crossing", 0.5, linked, 1, (1.0, 0.1, 0.0))
    for _ in range(2):
        assert not nd.analyse(scene).doubts
        assert told_by_material(linked) == before
        assert told_code(inside) == told_code(crossing) == Exterior.UNKNOWN
        assert (told_code(outside), inputs(own)["Outside Priority"].default_value) == (Exterior.UNKNOWN, 1.0)
    nd.clear_analysis(scene)
    assert told_by_material(linked) == before and inputs(own)["Outside Priority"].default_value < 0.0


def test_linked_media_ask_whatever_their_file_tells_them(tmp_path):
    ordinary_scene()
    nd.analyse(bpy.context.scene)
    file = str(tmp_path / "library.blend")
    collection = into_collection(*bpy.data.objects)
    collection.name = "Linked"
    known = codes()
    bpy.data.libraries.write(file, {collection})
    scene = fresh()
    with bpy.data.libraries.load(file, link=True) as (_, wanted):
        wanted.collections = ["Linked"]
    instance(wanted.collections[0], (0.0, 3.0, 0.0))
    own = ball("Own", 0.3, medium("Own", 1.7), 0, (5.0, 3.0, 0.0))
    found = nd.analyse(scene)
    assert codes() == known | {"Own": Exterior.MEDIUM} and not found.doubts
    assert holds_in(scene, own) and not any(holds_in(scene, bpy.data.objects[name]) for name in known)
    assert set(found.asking) == set(known) and found.known == ("Own",)


def test_a_linked_object_and_a_local_one_of_its_name_are_two(tmp_path):
    ordinary_scene()
    file = str(tmp_path / "library.blend")
    bpy.data.libraries.write(file, {bpy.data.objects["Bead"]})
    scene, bead = ordinary_scene()
    with bpy.data.libraries.load(file, link=True) as (_, wanted):
        wanted.objects = ["Bead"]
    (linked,) = wanted.objects
    scene.collection.objects.link(linked)
    bead.location.x = 30.0
    nd.register()
    try:
        nd.analyse(scene)
        before = codes()
        bead.location.x = 31.0
        bpy.context.view_layer.update()
        followed = snapshot()
        nd.analyse(scene)
        assert followed == snapshot() and codes() == before
    finally:
        nd.unregister()
