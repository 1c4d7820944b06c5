"""What a check finds of where media are, and of what is no medium beside and in them."""

import bpy
import numpy as np
import pytest
from checked import ball, findings, middle_of, only
from same_place import block
from scenes import add_box, add_camera, add_plane, add_point_light, add_sphere, add_sun, diffuse, new_scene

import nested_dielectric as nd
from nested_dielectric.checking import kinds
from nested_dielectric.checking.finding import Action

# Precision.


def test_a_scene_far_from_the_origin_is_found_once_and_can_be_moved_there():
    new_scene(8, with_group=True)
    objects = [ball(f"Ball {index}") for index in range(4)]
    for index, obj in enumerate(objects):
        obj.location.x = 3e5 + 3 * index
    found = only(kinds.PRECISION)
    assert set(found.objects) == {obj.name for obj in objects} and "steps of 0.031" in found.text
    assert found.fix.action == Action.MOVE_TO_ORIGIN and not found.fix.safe
    assert found.place.point[0] == pytest.approx(3e5, abs=20)
    for obj in objects:
        obj.location.x -= 3e5
    assert findings() == []


def test_walls_that_are_too_thin_only_where_they_stand_are_to_be_moved():
    """The shader shows its alarm with less than 3.8e-6 of the largest coordinate behind a surface."""
    new_scene(8, with_group=True)
    pane = block("Pane", (-1, -1, 0), (1, 1, 0.01), 1)
    pane.location.x = 2000.0
    assert findings() == []
    pane.location.x = 3000.0
    found = only(kinds.PRECISION)
    assert found.fix.action == Action.MOVE_TO_ORIGIN and len(found.place.faces) == 2


def test_a_mesh_far_from_its_own_origin_is_found_and_no_move_mends_it():
    new_scene(8, with_group=True)
    obj = ball(location=(3e5, 0, 0))
    obj.location.x = -3e5
    found = only(kinds.PRECISION)
    assert "its own origin" in found.text and found.fix is None
    assert found.place.point == pytest.approx((0, 0, 0), abs=0.1)


def test_what_is_too_small_is_found_and_what_is_huge_is_not():
    new_scene(8, with_group=True)
    obj = ball()
    for scale, count in ((1e-5, 1), (1e-4, 0), (1e6, 0)):
        obj.scale = [scale] * 3
        found = findings()
        assert len(found) == count
        assert all(each.kind == kinds.PRECISION and "scale all" in each.remedy for each in found)


# What is no medium.


def test_a_medium_on_a_table_is_found_with_the_faces_that_lie_on_it():
    new_scene(8, with_group=True)
    cup = block("Cup", (-1, -1, 0), (1, 1, 1), 1)
    add_plane("Table", 4, (0, 0, 0), (0, 0, 1), diffuse())
    found = only(kinds.FOREIGN_COINCIDENT)
    (face,) = found.place.faces
    assert middle_of(cup, face)[2] == 0.0 and found.place.point[2] == 0.0
    assert (found.fix.action, found.fix.names) == (Action.MOVE_APART, ("Cup", "Table"))
    cup.location.z += found.fix.value
    assert findings() == []


def test_what_stands_inside_a_medium_or_crosses_it_is_a_note_for_each_object():
    new_scene(8, with_group=True)
    add_sphere("Water", 1.0, nd.new_material("Water", ior=1.33), 2, segments=32)
    add_sphere("Ice", 0.5, nd.new_material("Ice", ior=1.31), 1, segments=32)
    add_box("Spoon", (0.6, 0, 0), (0.65, 0.1, 2.0), diffuse())
    add_box("Pearl", (-0.1, -0.1, -0.1), (0.1, 0.1, 0.1), diffuse())
    add_box("Table", (-4, -4, -3), (4, 4, -2), diffuse())
    add_box("Corner", (6, 6, 6), (7, 7, 7), nd.new_material("Block", ior=1.4), 3)
    add_box("Beside", (5, 5, 5), (6, 6, 6), diffuse())
    found = {each.name: each for each in findings()}
    assert {name: each.kind for name, each in found.items()} == {
        "Spoon": kinds.FOREIGN_ACROSS,
        "Pearl": kinds.FOREIGN_INSIDE,
    }
    assert found["Pearl"].others == ("Ice",) and found["Spoon"].others == ("Water",)
    assert all(np.linalg.norm(each.place.point) < 1.0 and each.severity == "note" for each in found.values())
    done = nd.prepare(bpy.context.scene)
    assert done.problems == () and {note.name for note in done.notes} == set(found)


def test_a_camera_and_lights_inside_a_medium_are_noted_with_its_name():
    new_scene(8, with_group=True)
    add_sphere("Water", 1.0, nd.new_material("Water", ior=1.33), segments=32)
    add_camera((0, -0.5, 0), (0, 0, 0))
    add_point_light((0.2, 0.3, 0), 10.0)
    add_point_light((3, 0, 0), 10.0)
    add_sun((0, 0, -1))
    found = findings()
    assert [each.kind for each in found] == [kinds.CAMERA_INSIDE, kinds.LIGHT_INSIDE]
    assert all(each.others == ("Water",) for each in found)
    assert found[0].place.point == pytest.approx((0, -0.5, 0))
    bpy.context.scene.camera.location.y = -5.0
    assert [each.kind for each in findings()] == [kinds.LIGHT_INSIDE]
