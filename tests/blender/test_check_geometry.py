"""What a check finds of the shapes and places of media: each with where it is and what would mend it."""

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from checked import ball, findings, middle_of, only
from faults import edit
from object_types import curve, text
from same_place import block, duplicate
from scenes import (
    add,
    add_box,
    add_mesh,
    add_sphere,
    new_scene,
)

import nested_dielectric as nd
from nested_dielectric.checking import kinds
from nested_dielectric.checking.finding import Action


def vessel(gap: float, priority: int = 1) -> tuple[bpy.types.Object, bpy.types.Object]:
    """A hollow ball of glass with a wall of 0.2, and a ball of water in it."""
    new_scene(8, with_group=True)
    glass = add_sphere("Vessel", 1.0, nd.new_material("Glass", ior=1.5), 2, segments=32)
    inner = add_sphere("Inner", 0.8, None, None, segments=32)
    inner.data.flip_normals()
    edit(glass, lambda bm: bm.from_mesh(inner.data))
    bpy.data.objects.remove(inner)
    return glass, add_sphere("Water", 0.8 - gap, nd.new_material("Water", ior=1.33), priority, segments=32)


# Meshes.


def test_a_hole_is_found_with_the_faces_around_it_and_can_be_closed():
    new_scene(8, with_group=True)
    obj = ball(location=(3, 0, 0))
    edges = len(obj.data.polygons[40].vertices)  # Blenders number faces differently
    ring = [face.index for face in obj.data.polygons if set(face.vertices) & set(obj.data.polygons[40].vertices)]
    edit(obj, lambda bm: bmesh.ops.delete(bm, geom=[bm.faces[40]], context="FACES_ONLY"))
    found = only(kinds.OPEN_MESH)
    assert len(found.place.faces) == edges and {face + (face >= 40) for face in found.place.faces} <= set(ring)
    assert min(np.linalg.norm(middle_of(obj, f) - found.place.point) for f in found.place.faces) < 0.1
    assert found.fix.action == Action.CLOSE_HOLES and found.fix.names == ("Ball",) and found.fix.safe


def test_a_fin_is_found_and_is_for_the_artist_to_remove():
    new_scene(8, with_group=True)
    obj = ball()

    def fin(bm):
        edge = bm.edges[:][30]
        bm.faces.new([*edge.verts, bm.verts.new((0, 0, 3))])

    edit(obj, fin)
    found = only(kinds.OPEN_MESH)
    assert "share an edge" in found.text and found.fix is None and len(found.place.faces) == 3


def test_faces_turned_against_the_others_are_found_one_by_one():
    new_scene(8, with_group=True)
    obj = ball()
    edit(obj, lambda bm: bmesh.ops.reverse_faces(bm, faces=[bm.faces[k] for k in (20, 50, 51)]))
    found = only(kinds.MIXED_NORMALS)
    assert found.place.faces == (20, 50, 51) and "3 of them" in found.text
    assert np.linalg.norm(middle_of(obj, 20) - found.place.point) < 0.2
    assert found.fix.action == Action.RECALCULATE_NORMALS


def test_what_cannot_be_changed_as_it_is_has_a_remedy_and_no_fix():
    new_scene(8, with_group=True)
    obj = ball()
    edit(obj, lambda bm: bmesh.ops.reverse_faces(bm, faces=[bm.faces[20]]))
    obj.modifiers.new("Bevel", "BEVEL").width = 0.0
    assert all(found.fix is None for found in findings(kinds.MIXED_NORMALS))
    obj.modifiers.clear()
    obj.shape_key_add(name="Basis")
    assert only(kinds.MIXED_NORMALS).fix is None


def test_normals_that_look_inwards_are_found_of_one_part_too():
    new_scene(8, with_group=True)
    obj = ball()
    obj.data.flip_normals()
    found = only(kinds.INWARD_NORMALS)
    assert found.fix.action == Action.RECALCULATE_NORMALS and len(found.place.faces) == len(obj.data.polygons)
    obj.data.flip_normals()
    other = ball("Other", (4, 0, 0))
    other.data.transform(other.matrix_basis)
    other.data.flip_normals()
    edit(obj, lambda bm: bm.from_mesh(other.data))
    count = len(other.data.polygons)
    bpy.data.objects.remove(other)
    found = only(kinds.INWARD_NORMALS)
    assert min(found.place.faces) == count and "parts" in found.text and found.place.point[0] > 2.9


def test_a_cavity_is_no_part_that_looks_inwards():
    vessel(-0.01)
    assert findings() == []


def test_a_mesh_that_overlaps_itself_is_slow_and_where_it_does_is_told():
    new_scene(8, with_group=True)
    obj = add_box("Both", (-1, -1, -1), (1, 1, 0), nd.new_material("Glass", preset="glass"))
    other = add_box("Other", (-0.9, -0.8, -0.1), (0.9, 0.8, 1))
    edit(obj, lambda bm: bm.from_mesh(other.data))
    bpy.data.objects.remove(other)
    found = only(kinds.SELF_OVERLAP)
    assert found.severity == kinds.Severity.SLOW and len(found.place.faces) == 1 and found.fix is None
    assert nd.prepare(bpy.context.scene).found.overlapping == ("Both",)


def test_a_tube_without_caps_gets_them():
    new_scene(8, with_group=True)
    obj = curve(nd.new_material("Glass", ior=1.5), capped=False)
    found = only(kinds.OPEN_MESH)
    assert found.fix.action == Action.FILL_CAPS and found.fix.names == (obj.name,)
    obj.data.use_fill_caps = True
    assert findings() == []


def test_an_open_text_has_no_fix_but_a_remedy():
    new_scene(8, with_group=True)
    text(nd.new_material("Glass", ior=1.5), extrude=0.0)
    found = only(kinds.OPEN_MESH)
    assert found.fix is None and "Extrude" in found.remedy and found.place.point is not None


# Pairs of media.


@pytest.mark.parametrize("location", [(0.5, 0, 0), (0, 0, 0.2)])
def test_media_of_equal_priority_are_found_with_a_point_that_lies_in_both(location):
    new_scene(8, with_group=True)
    add_sphere("Large", 1.0, nd.new_material("Ice", ior=1.31), 3, segments=32)
    add_sphere("Small", 0.6, nd.new_material("Water", ior=1.33), 3, location, 32)
    found = only(kinds.EQUAL_PRIORITIES)
    point = np.array(found.place.point)
    assert np.linalg.norm(point) < 1.0 and np.linalg.norm(point - location) < 0.6
    assert set(found.objects) == {"Large", "Small"}
    assert (found.fix.action, found.fix.names, found.fix.value) == (Action.SET_PRIORITY, ("Small",), 2)
    assert not found.fix.safe  # who should win is the artist's to say
    nd.set_priority(bpy.data.objects["Small"], found.fix.value)
    assert findings() == []


def test_a_suggested_priority_is_none_that_a_neighbour_has():
    new_scene(8, with_group=True)
    add_sphere("Large", 1.0, nd.new_material("Ice", ior=1.31), 3, segments=32)
    add_sphere("Small", 0.6, nd.new_material("Water", ior=1.33), 3, (0.5, 0, 0), 32)
    add_sphere("Beside", 0.3, nd.new_material("Air", ior=1.0), 2, (1.0, 0, 0), 32)
    fix = findings(kinds.EQUAL_PRIORITIES)[0].fix
    assert (fix.names, fix.value) == (("Large",), 4)


def test_instances_of_equal_priority_that_overlap_another_medium_are_found():
    new_scene(8, with_group=True)
    add_box("Block", (4, -1, -1), (6, 1, 1), nd.new_material("Ice", ior=1.31), 1)
    drop = add_sphere("Drop", 0.6, nd.new_material("Water", ior=1.33), 1, segments=16)
    collection = bpy.data.collections.new("Drops")
    bpy.context.scene.collection.objects.unlink(drop)
    collection.objects.link(drop)
    for x in (0, 4):
        instance = add("Instance", None, (x, 0, 0))
        instance.instance_type, instance.instance_collection = "COLLECTION", collection
    found = only(kinds.EQUAL_PRIORITIES)
    assert 4.0 < found.place.point[0] < 4.6


def test_media_that_move_are_looked_at_where_they_are_on_this_frame():
    new_scene(8, with_group=True)
    add_sphere("Ice", 1.0, nd.new_material("Ice", ior=1.31), 1, segments=16)
    other = add_sphere("Water", 1.0, nd.new_material("Water", ior=1.33), 1, (5, 0, 0), 16)
    other.keyframe_insert("location", frame=1)
    other.location.x = -4.0
    other.keyframe_insert("location", frame=9)
    scene = bpy.context.scene
    scene.frame_set(1)
    assert findings() == []
    scene.frame_set(9)
    assert only(kinds.EQUAL_PRIORITIES).place.point is not None


def test_a_copy_in_the_same_place_is_found_and_hiding_it_is_for_the_artist_to_choose():
    new_scene(8, with_group=True)
    first = ball()
    copy = add("Ball.001", first.data.copy())
    found = only(kinds.DUPLICATE)
    assert found.objects == ("Ball.001", "Ball") and not found.fix.safe
    assert (found.fix.action, found.fix.names) == (Action.MERGE_COPIES, ("Ball.001",))
    assert np.linalg.norm(found.place.point) == pytest.approx(1.0, abs=0.05)
    copy.hide_render = copy.hide_viewport = True
    assert findings() == []


def test_many_copies_are_named_once_each():
    new_scene(8, with_group=True)
    first = ball()
    for _ in range(3):
        duplicate(first)
    assert len(findings(kinds.DUPLICATE)) == 3
    assert all(found.others == ("Ball",) for found in findings())


def test_faces_in_the_same_place_are_found_before_a_scene_is_prepared_and_gone_after():
    new_scene(8, with_group=True)
    block("Table", (-2, -2, -1), (2, 2, 0), 1)
    cup = block("Cup", (-1, -1, 0), (1, 1, 1), 2)
    found = only(kinds.COINCIDENT)
    assert found.objects == ("Cup", "Table") and found.fix.action == Action.PART_FACES
    (face,) = found.place.faces
    assert middle_of(cup, face)[2] == 0.0 and found.place.point[2] == 0.0
    assert nd.prepare(bpy.context.scene).problems == () and findings() == []


def test_faces_that_cannot_be_parted_are_found_once_whether_prepared_or_not():
    new_scene(8, with_group=True)
    block("Table", (-2, -2, -1), (2, 2, 0), 1)
    block("Cup", (-1, -1, 0), (1, 1, 1), 2).modifiers.new("Bevel", "BEVEL").width = 0.0
    found = only(kinds.COINCIDENT)
    assert found.fix is None and "apply its modifiers" in found.remedy
    assert [str(each) for each in nd.prepare(bpy.context.scene).problems] == [str(found)]


@pytest.mark.parametrize("gap", [0.001, 0.02])
def test_water_off_its_wall_is_found_with_the_film_and_pushed_by_its_thickness(gap):
    _, water = vessel(gap)
    found = only(kinds.GAP)
    assert found.objects == ("Water", "Vessel")
    # The film lies between facets, which lie up to half a per cent inside their spheres.
    assert 0.99 * (0.8 - gap) < np.linalg.norm(found.place.point) < 0.8
    fix = found.fix
    assert fix.action == Action.PUSH_INTO_WALL and fix.names == ("Water", "Vessel") and fix.safe
    assert gap < fix.value < gap + 0.1
    water.scale = [(0.8 - gap + fix.value) / (0.8 - gap)] * 3
    assert findings() == []


def test_water_that_stands_on_its_floor_but_off_the_walls_is_found():
    new_scene(8, with_group=True)
    glass = add_box("Glass", (-1, -1, -1), (1, 1, 1), nd.new_material("Glass", ior=1.5), 2)
    hollow = add_box("Hollow", (-0.9, -0.9, -0.9), (0.9, 0.9, 1.2))
    cut = glass.modifiers.new("Cut", "BOOLEAN")
    cut.object, cut.operation, cut.solver = hollow, "DIFFERENCE", "EXACT"
    hollow.hide_render = hollow.hide_viewport = True
    add_box("Water", (-0.89, -0.89, -0.91), (0.89, 0.89, 0.5), nd.new_material("Water", ior=1.33), 1)
    found = only(kinds.GAP)
    assert found.name == "Water" and -0.9 < found.place.point[2] < 0.5
    assert max(np.abs(found.place.point[:2])) == pytest.approx(0.895, abs=1e-3)
    assert all(abs(bpy.data.objects["Water"].data.polygons[face].normal.z) < 0.1 for face in found.place.faces)


def test_glasses_that_stand_beside_each_other_and_films_that_water_fills_are_no_gaps():
    new_scene(8, with_group=True)
    glass = nd.new_material("Glass", ior=1.5)
    for index in range(3):
        add_sphere(f"Glass {index}", 1.0, glass, 3, (2.005 * index, 0, 0), 32)
        add_box(f"Pane {index}", (4.02 * index, 3, 0), (4.02 * index + 4, 7, 1), glass, 3)
    assert findings() == []
    vessel(0.01)
    add_sphere("Filling", 0.9, nd.new_material("Oil", ior=1.47), 9, segments=32)
    assert findings() == []


def test_an_overlap_that_floats_hardly_tell_is_found_far_away():
    new_scene(8, with_group=True)
    x, overlap = 2000.0, 0.0009
    block("Table", (x - 2, -2, -1), (x + 2, 2, 0), 1)
    block("Cup", (x - 1, -1, -overlap), (x + 1, 1, 1), 2)
    found = findings(kinds.THIN_OVERLAP)
    assert [each.objects for each in found] == [("Cup", "Table")]
    assert found[0].place.point[2] == pytest.approx(-overlap / 2, abs=overlap)
    assert found[0].fix.action == Action.PUSH_INTO_WALL and found[0].fix.value > overlap


def test_a_pane_thinner_than_rays_tell_is_found():
    new_scene(8, with_group=True)
    block("Pane", (-1, -1, 0), (1, 1, 2e-5), 1)
    found = only(kinds.THIN_WALL)
    assert found.place.point[2] == pytest.approx(1e-5, abs=1e-6) and len(found.place.faces) == 2
    bpy.data.objects["Pane"].scale.z = 2.0
    assert findings() == []


def test_a_check_changes_nothing_and_says_the_same_again():
    vessel(0.01)
    mesh = add_mesh("Sheet", lambda bm: bmesh.ops.create_grid(bm, size=3.0), nd.new_material("Sheet", ior=1.4))
    before = [(obj.name, len(obj.modifiers), obj.matrix_world.copy()) for obj in bpy.data.objects]
    first = findings()
    assert {found.kind for found in first} >= {kinds.GAP, kinds.OPEN_MESH} and mesh is not None
    assert findings() == first
    assert [(obj.name, len(obj.modifiers), obj.matrix_world) for obj in bpy.data.objects] == before
