"""Faces of two media in exactly the same place are parted, so that each surface is one medium's."""

import bpy  # before bmesh, which lives inside it
import numpy as np
import pytest
from same_place import block, duplicate
from scenes import add, add_box, add_plane, diffuse, mostly_again, new_scene

import nested_dielectric as nd
from nested_dielectric.checking.check import check as find_problems
from nested_dielectric.checking.foreign_checks import NEAR
from nested_dielectric.geometry.coincident_faces import least_squares_offsets
from nested_dielectric.nodes.names import OFFSET_ATTRIBUTE, OFFSET_GROUP


def box_scene(low, high, priority: int) -> bpy.types.Object:
    """A block of ice of priority 1, and water between two corners."""
    new_scene(8)
    add_box("Ice", (-1, -1, -1), (1, 1, 1), nd.new_material("Ice", ior=1.31), 1)
    return add_box("Water", low, high, nd.new_material("Water", ior=1.33), priority)


def bounds(obj: bpy.types.Object) -> np.ndarray:
    bpy.context.view_layer.update()
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = np.array([tuple(obj.matrix_world @ vertex.co) for vertex in evaluated.data.vertices])
    return np.array([points.min(axis=0), points.max(axis=0)])


def test_a_weaker_medium_that_stands_on_a_stronger_grows_into_it():
    water = box_scene((-0.5, -0.5, 1), (0.5, 0.5, 2), 2)
    nd.prepare(bpy.context.scene)
    moved = bounds(water) - np.array([(-0.5, -0.5, 1), (0.5, 0.5, 2)])
    assert moved[0, 2] < -1e-5
    moved[0, 2] = 0.0
    assert np.abs(moved).max() < 1e-6


def test_a_weaker_medium_with_the_same_outline_shrinks_into_the_stronger():
    water = box_scene((-1, -1, -1), (1, 1, 1), 2)
    nd.prepare(bpy.context.scene)
    moved = bounds(water) - np.array([(-1, -1, -1), (1, 1, 1)])
    assert moved[0].min() > 1e-5 and moved[1].max() < -1e-5


def test_a_stronger_medium_on_part_of_a_larger_face_grows_out_of_it():
    """Ice that is frozen into water, their tops in one plane."""
    water = box_scene((-2, -2, -2), (2, 2, 1), 2)
    nd.prepare(bpy.context.scene)
    moved = bounds(bpy.data.objects["Ice"]) - np.array([(-1, -1, -1), (1, 1, 1)])
    assert moved[1, 2] > 1e-5
    moved[1, 2] = 0.0
    assert np.abs(moved).max() < 1e-6
    assert not water.modifiers


def test_the_stronger_medium_keeps_its_shape_and_a_second_time_nothing_changes():
    box_scene((-0.5, -0.5, 1), (0.5, 0.5, 2), 2)
    scene = bpy.context.scene
    assert nd.prepare(scene).changes
    assert OFFSET_ATTRIBUTE not in bpy.data.objects["Ice"].data.attributes
    assert not bpy.data.objects["Ice"].modifiers
    assert nd.prepare(scene).changes == ()


def test_a_turned_and_scaled_object_is_parted_by_the_same_distance():
    water = box_scene((-0.5, -0.5, 1), (0.5, 0.5, 2), 2)
    water.data.transform(water.matrix_world)
    water.scale = (2.0, 0.5, 0.1)
    for vertex in water.data.vertices:
        vertex.co = (vertex.co.x / 2.0, vertex.co.y / 0.5, vertex.co.z / 0.1)
    nd.prepare(bpy.context.scene)
    expected = 1e-4 * np.sqrt(3.0) + 4e-6 * 2.0
    assert 1.0 - bounds(water)[0, 2] == pytest.approx(expected, rel=0.02)


def test_what_cannot_be_parted_is_named_with_the_remedy():
    water = box_scene((-0.5, -0.5, 1), (0.5, 0.5, 2), 2)
    water.modifiers.new("Bevel", "BEVEL").width = 0.0
    problems = nd.prepare(bpy.context.scene).problems
    assert any(
        problem.name == "Water" and "'Ice'" in problem.text and "overlap" in problem.remedy for problem in problems
    )
    assert OFFSET_ATTRIBUTE not in water.data.attributes


def test_far_from_the_origin_the_distance_is_above_single_precision():
    water = box_scene((-0.5, -0.5, 1), (0.5, 0.5, 2), 2)
    for obj in (water, bpy.data.objects["Ice"]):
        obj.location.x = 1e3
    scene = bpy.context.scene
    assert nd.prepare(scene).changes
    assert 1.0 - bounds(water)[0, 2] > 1e-3
    assert nd.prepare(scene).changes == ()


def test_duplicates_that_share_a_mesh_are_parted_from_each_other():
    scene = new_scene(8)
    first = block("Block", (-1, -1, -1), (1, 1, 1), 1)
    second, third = duplicate(first, priority=2), duplicate(first, priority=3)
    preparation = nd.prepare(scene)
    assert preparation.problems == () and preparation.found.coincident == ()
    outer, middle, inner = (bounds(obj)[1] for obj in (first, second, third))
    assert (outer - middle).min() > 1e-4 and (middle - inner).min() > 1e-4 and np.abs(outer - 1.0).max() < 1e-6
    assert first.data.users == 3 and nd.prepare(scene).changes == ()


def test_duplicates_that_share_a_mesh_stand_on_others_in_their_own_ways():
    """Alike where they are turned alike."""
    scene = new_scene(8)
    block("Table", (-9, -9, -1), (9, 9, 0), 1)
    cup = block("Cup", (-1, -1, 0), (1, 1, 1), 2)
    beside, hanging = duplicate(cup, (3, 0, 0)), duplicate(cup, (-4, 0, -1))
    hanging.rotation_euler.x = np.pi
    assert nd.prepare(scene).problems == ()
    low = [bounds(obj)[:, 2] for obj in (cup, beside, hanging)]
    assert low[0][0] < -1e-5 and low[1][0] == pytest.approx(low[0][0]) and low[2][0] < -1.0 - 1e-5
    names = [obj.data.attributes.keys() for obj in (cup, beside, hanging)]
    assert sum(name.startswith(OFFSET_ATTRIBUTE) for name in names[0]) == 2
    later = duplicate(cup, (0, 3, 0))
    later.modifiers.new(OFFSET_GROUP, "NODES").node_group = bpy.data.node_groups[OFFSET_GROUP]
    assert nd.prepare(scene).changes == () and bounds(later)[0, 2] == pytest.approx(low[0][0])
    before = bounds(cup)
    on_top = block("Lid", (-2, -2, 1), (2, 2, 2), 1)
    nd.prepare(scene)
    assert bounds(cup)[1, 2] > 1.0 + 1e-5 and on_top.modifiers.keys() == []
    assert bounds(cup)[0, 2] == pytest.approx(before[0, 2]) and bounds(beside)[1, 2] == pytest.approx(1.0)


def test_a_group_of_an_older_file_learns_to_read_a_name():
    scene = new_scene(8)
    block("Table", (-9, -9, -1), (9, 9, 0), 1)
    cup = block("Cup", (-1, -1, 0), (1, 1, 1), 2)
    tree = bpy.data.node_groups.new(OFFSET_GROUP, "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    source, sink = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    offset, moved = tree.nodes.new("GeometryNodeInputNamedAttribute"), tree.nodes.new("GeometryNodeSetPosition")
    offset.data_type = "FLOAT_VECTOR"
    offset.inputs["Name"].default_value = OFFSET_ATTRIBUTE
    tree.links.new(source.outputs[0], moved.inputs["Geometry"])
    tree.links.new(offset.outputs["Attribute"], moved.inputs["Offset"])
    tree.links.new(moved.outputs[0], sink.inputs[0])
    old = block("Old", (3, 3, 5), (4, 4, 6), 3)
    old.modifiers.new(OFFSET_GROUP, "NODES").node_group = tree
    values = np.zeros((8, 3), dtype=np.float32)
    values[:, 0] = 0.25
    old.data.attributes.new(OFFSET_ATTRIBUTE, "FLOAT_VECTOR", "POINT").data.foreach_set("vector", values.ravel())
    duplicate(cup, (0, 4, 0)).rotation_euler.x = 0.0
    assert nd.prepare(scene).problems == () and bounds(cup)[0, 2] < -1e-5
    assert bounds(old)[0, 0] == pytest.approx(3.25)


@pytest.mark.parametrize("thickness", mostly_again([3e-4, 1e-3, 0.1]))
def test_no_face_moves_through_a_wall_thinner_than_its_way(thickness):
    """Water on both sides of a pane; a face moves by 2.8e-4 where there is room."""
    new_scene(8)
    pane = block("Pane", (-1, -1, 0), (1, 1, thickness), 1)
    upper = block("Upper", (-0.8, -0.8, thickness), (1.2, 0.8, 1), 2)
    lower = block("Lower", (-0.8, -0.9, -1), (0.9, 0.8, 0), 3)
    preparation = nd.prepare(bpy.context.scene)
    assert preparation.problems == () and preparation.found.coincident == ()
    bottom, top = bounds(upper)[0, 2], bounds(lower)[1, 2]
    assert 0.0 < top < bottom < thickness and bottom - top > 0.3 * thickness
    assert (thickness - bottom > 2e-4) == (thickness > 9e-4)
    assert np.abs(bounds(pane)[:, 2] - (0.0, thickness)).max() < 1e-6


def test_a_thin_pane_itself_does_not_move_through_its_other_side():
    new_scene(8)
    pane = block("Pane", (-1, -1, -1e-4), (1, 1, 1e-4), 2)
    block("Block", (-0.8, -0.8, -1), (1.2, 0.8, -1e-4), 1)
    block("Lid", (-1, -1, -1e-4), (0.3, 0.2, 1e-4), 1)
    nd.prepare(bpy.context.scene)
    low, high = bounds(pane)[:, 2]
    assert low < high


def test_a_wall_too_thin_to_part_anything_in_is_named():
    new_scene(8)
    block("Pane", (-1, -1, -2e-5), (1, 1, 2e-5), 1)
    upper = block("Upper", (-0.8, -0.8, 2e-5), (1.2, 0.8, 1), 2)
    problems = nd.prepare(bpy.context.scene).problems
    assert [problem.name for problem in problems] == ["Upper"] and "'Pane'" in problems[0].text
    assert "thicker than" in problems[0].remedy and "4e-05" in problems[0].remedy
    assert not upper.modifiers


def test_in_a_long_row_no_block_moves_farther_than_the_first():
    scene = new_scene(8)
    row = [block(f"Block {k}", (k, 0, 0), (k + 1, 1, 1), k + 1) for k in range(8)]
    assert nd.prepare(scene).found.coincident == ()
    for k, obj in enumerate(row):
        assert np.abs(bounds(obj) - ((k, 0, 0), (k + 1, 1, 1))).max() < 3e-4


def test_the_remedy_for_what_cannot_be_parted_can_be_done():
    """Modifiers of a mesh with several users cannot be applied."""
    new_scene(8)
    block("Table", (-9, -9, -1), (9, 9, 0), 1)
    cup = block("Cup", (-1, -1, 0), (1, 1, 1), 2)
    duplicate(cup, (0, 0, 5))
    cup.modifiers.new("Bevel", "BEVEL").width = 0.0
    (problem,) = nd.prepare(bpy.context.scene).problems
    assert "single-user" in problem.remedy and "apply its modifiers" in problem.remedy


def resting() -> list[str]:
    return [str(problem) for problem in find_problems(bpy.context.scene) if "no medium" in problem.text]


def test_what_stands_on_something_foreign_is_named_with_both_names():
    new_scene(8)
    cup = block("Cup", (-1, -1, 0), (1, 1, 1), 1)
    table = add_plane("Table", 1.5, (0.9, 0.4, 0), (0, 0, 1), diffuse())
    (said,) = resting()
    assert "'Cup'" in said and "'Table'" in said and "apart" in said and "overlap" in said
    table.location.z = -NEAR * 3.0
    bpy.context.view_layer.update()
    assert resting() == []
    table.location.z = NEAR * 3.0
    bpy.context.view_layer.update()
    assert resting() == []
    add_box("Label", (-0.5, -1.01, 0.2), (0.7, -1, 0.6), diffuse())
    bpy.data.objects.remove(table)
    assert ["'Label'" in each for each in resting()] == [True]
    bpy.data.objects["Label"].hide_render = True
    assert resting() == []
    assert cup.location.z == 0.0


def test_what_stands_on_an_instanced_or_curved_foreign_thing_is_named():
    new_scene(8)
    block("Cup", (-1, -1, 0), (1, 1, 1), 1)
    collection = bpy.data.collections.new("Tables")
    collection.objects.link(bpy.data.objects.new("Board", add_plane("Part", 4, (0, 0, 0), (0, 0, 1), diffuse()).data))
    bpy.data.objects.remove(bpy.data.objects["Part"])
    instancer = add("Instancer", None)
    instancer.instance_type, instancer.instance_collection = "COLLECTION", collection
    assert ["'Board'" in each for each in resting()] == [True]
    instancer.location.z = -0.5
    text = bpy.data.curves.new("Sign", "FONT")
    text.body, text.size = "X", 3.0
    add("Sign", text, (-0.8, -0.8, 0))
    bpy.context.view_layer.update()
    assert ["'Sign'" in each for each in resting()] == [True]


def test_points_rise_with_all_their_faces():
    """At a cube's corner three planes move by a distance each; on a smooth surface near-equal normals move it once."""
    corner = least_squares_offsets(5, np.array([[0, 1, 2]] * 3), np.eye(3), np.array([1.0, 2.0, -3.0]))
    assert corner[0] == pytest.approx([1.0, 2.0, -3.0])
    assert np.all(corner[3:] == 0.0)
    normals = np.array([[0.0, 0.02, 1.0], [0.0, -0.02, 1.0]])
    smooth = least_squares_offsets(
        3, np.array([[0, 1, 2]] * 2), normals / np.linalg.norm(normals, axis=1)[:, None], np.ones(2)
    )
    assert smooth[0] == pytest.approx([0.0, 0.0, 1.0], abs=1e-3)


def test_instances_of_one_object_that_lie_in_one_plane_are_named_once_and_left():
    """Whatever moves one of them moves all."""
    scene = new_scene(8)
    block("Table", (-9, -9, -1), (9, 9, -0.5), 1)
    cup = block("Cup", (-1, -1, 0), (1, 1, 1), 2)
    collection = bpy.data.collections.new("Cups")
    scene.collection.objects.unlink(cup)
    collection.objects.link(cup)
    for index in range(5):
        empty = bpy.data.objects.new("Instance", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        empty.location.x = 1.3 * index
        scene.collection.objects.link(empty)
    done = nd.prepare(scene)
    assert done.changes == () and not cup.modifiers
    named = [str(problem) for problem in done.problems if "same place" in str(problem)]
    assert len(named) == 1 and "'Cup'" in named[0] and "let them overlap" in named[0]
