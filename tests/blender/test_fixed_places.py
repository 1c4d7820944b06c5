"""Surfaces are pushed into walls, moved off what is no medium, parted, and brought to the origin."""

import bpy  # before bmesh, which lives inside it
import numpy as np
import pytest
from faults import SIDES, UNIT, glass, hollow, kinds, mend, vessel, volume, world_points
from mathutils import Vector
from scenes import add, add_box, add_camera, add_mesh, diffuse, mostly_again, new_scene

import nested_dielectric as nd
from nested_dielectric.analysis.mesh_modifiers import is_offset
from nested_dielectric.analysis.validity import is_analysed
from nested_dielectric.checking.finding import Action
from nested_dielectric.preparation.prepare_scene import put_back


@pytest.fixture(autouse=True)
def scene():
    new_scene(with_group=True)
    return bpy.context.scene


@pytest.mark.parametrize("scale", mostly_again(((1, 1, 1), (-2, 1, 0.5))))
def test_a_liquid_is_pushed_into_its_wall_and_its_surface_stays(scale):
    gap, overlap = 0.02, 0.03
    _, water = vessel(gap, scale)
    before = world_points(water)
    (change,) = mend(Action.PUSH_INTO_WALL, "Water", "Cup", value=gap + overlap, kind="gap")
    assert change == f"Water: pushed 0.05 into 'Cup' (modifier {water.modifiers[0].name!r})"
    after = world_points(water)
    radius, below = np.linalg.norm(after[:, :2], axis=1), before[:, 2] < -0.5
    # The faces rise by the distance, so their corners by a little more.
    assert radius == pytest.approx(1.0 - gap + (gap + overlap) / np.cos(np.pi / SIDES), abs=1e-4)
    assert after[below, 2] == pytest.approx(before[below, 2] - gap - overlap, abs=1e-5)
    assert after[~below, 2] == pytest.approx(before[~below, 2], abs=1e-6)
    assert is_offset(water.modifiers[0])
    assert "Water: faces are where they were" in put_back(bpy.context.scene)
    assert world_points(water) == pytest.approx(before)


def test_a_liquid_that_reaches_a_little_into_its_wall_is_pushed_on_and_a_thin_layer_keeps_its_surface():
    _, water = vessel(-0.001)
    water.data.vertices.foreach_set("co", (world_points(water) * (1, 1, 0.01) + (0, 0, -0.991)).astype("f").ravel())
    before = world_points(water)
    mend(Action.PUSH_INTO_WALL, "Water", "Cup", value=0.05, kind="thin-overlap")
    after = world_points(water)
    below = before[:, 2] < -0.996
    assert after[~below, 2] == pytest.approx(before[~below, 2], abs=1e-6)
    assert after[below, 2] == pytest.approx(before[below, 2] - 0.05, abs=1e-5)
    assert np.linalg.norm(after[:, :2], axis=1).min() > 1.05


def test_a_liquid_is_not_pushed_through_its_wall_nor_where_there_is_none():
    _, water = vessel(0.02)
    with pytest.raises(nd.ParameterError, match="would come out of 'Cup', whose wall is thinner than"):
        mend(Action.PUSH_INTO_WALL, "Water", "Cup", value=0.5)
    with pytest.raises(nd.ParameterError, match="has no faces within"):
        mend(Action.PUSH_INTO_WALL, "Water", "Cup", value=0.01)
    for value in (None, -1.0, float("nan"), "x", True):
        with pytest.raises(nd.ParameterError, match="needs a distance"):
            mend(Action.PUSH_INTO_WALL, "Water", "Cup", value=value)
    water.modifiers.new("Smooth", "SUBSURF")
    with pytest.raises(nd.ParameterError, match="gets its points from the modifier 'Smooth'; apply it first"):
        mend(Action.PUSH_INTO_WALL, "Water", "Cup", value=0.05)
    assert len(water.modifiers) == 1


@pytest.mark.parametrize("prepared", (False, True))
def test_coincident_faces_are_parted_and_an_unprepared_scene_stays_unprepared(prepared, scene):
    add_box("Ice", *UNIT, nd.new_material("Ice", ior=1.31), 1)
    water = add_box("Water", (-0.5, -0.5, 1), (0.5, 0.5, 2), nd.new_material("Water", ior=1.33), 2)
    if prepared:
        nd.prepare(scene)
        put_back(scene)
        nd.analyse(scene)
    (change,) = mend(Action.PART_FACES, "Water", "Ice", kind="coincident")
    assert "parted from 'Ice'" in change and world_points(water)[:, 2].min() < 1.0 - 1e-5
    assert is_analysed(scene) == prepared
    assert mend(Action.PART_FACES, "Water", "Ice", kind="coincident") == []


def test_what_stands_on_no_medium_is_moved_off_it():
    table = add_box("Table", (-5, -5, -1), (5, 5, 0), diffuse())
    cup = add_box("Cup", (-1, -1, 0), (1, 1, 2), glass())
    (finding,) = nd.check(bpy.context.scene)
    assert finding.kind.key == "foreign-coincident"
    (change,) = mend(Action.MOVE_APART, "Cup", "Table", value=0.001)
    assert change.startswith("Cup: faces moved 0.001 off 'Table'")
    points = world_points(cup)
    assert points.min(axis=0) == pytest.approx((-1, -1, 0.001), abs=1e-6)
    assert points.max(axis=0) == pytest.approx((1, 1, 2)) and kinds() == []
    assert world_points(table)[:, 2].max() == 0.0
    with pytest.raises(nd.ParameterError, match="has no faces on 'Table' any more"):
        mend(Action.MOVE_APART, "Cup", "Table", value=0.0001)


def test_what_modifiers_make_is_moved_as_a_whole_unless_it_lies_between():
    add_box("Table", (-5, -5, -1), (5, 5, 0), diffuse())
    cup = add_box("Cup", (-1, -1, 0), (1, 1, 2), glass())
    bevel = cup.modifiers.new("Bevel", "BEVEL")
    bevel.width = 0.1
    root = add("Root", None)
    root.scale = (2, 2, 2)
    bpy.context.view_layer.update()
    cup.parent = root
    cup.matrix_parent_inverse = root.matrix_world.inverted()
    assert mend(Action.MOVE_APART, "Cup", "Table", value=0.001) == ["Cup: moved 0.001 off 'Table'"]
    assert world_points(cup)[:, 2].min() == pytest.approx(0.001, abs=1e-6)
    cup.location.z -= 0.001
    add_box("Shelf", (-5, -5, 2), (5, 5, 3), diffuse())
    with pytest.raises(nd.ParameterError, match="'Cup' lies between what it touches"):
        mend(Action.MOVE_APART, "Cup", "Table", "Shelf", value=0.001)
    cup.keyframe_insert("location", frame=1)
    with pytest.raises(nd.ParameterError, match="is placed by keyframes"):
        mend(Action.MOVE_APART, "Cup", "Table", value=0.001)


def test_copies_are_hidden_not_deleted():
    add_box("Box", *UNIT, glass())
    copy = add("Copy", bpy.data.objects["Box"].data)
    assert mend(Action.MERGE_COPIES, "Copy", kind="duplicate") == ["Copy: hidden in viewports and renders"]
    assert copy.hide_render and copy.hide_viewport and mend(Action.MERGE_COPIES, "Copy", kind="duplicate") == []
    copy.hide_render = False
    copy.keyframe_insert("hide_render", frame=1)
    with pytest.raises(nd.ParameterError, match="keyframes or a driver that show and hide it"):
        mend(Action.MERGE_COPIES, "Copy", kind="duplicate")


@pytest.mark.parametrize("scale", ((1e-3, 2e-3, 5e-3), (-1.0, 1.0, 3.0)))
def test_scale_and_rotation_are_applied_and_nothing_moves(scale):
    box = add_mesh("Box", hollow, glass())
    root = add("Root", None, (1, 2, 3))
    root.rotation_euler = (0.3, 0.2, 0.1)
    box.parent = root
    box.location, box.rotation_euler, box.scale = (1, 0, 2), (0.5, 1.0, 0.2), scale
    child = add("Child", None, (1, 1, 1))
    child.parent = box
    bpy.context.view_layer.update()
    normals = [Vector(each.vector) for each in box.data.corner_normals]
    box.data.normals_split_custom_set(normals)
    before, place = world_points(box), np.array(child.matrix_world)
    assert mend(Action.APPLY_TRANSFORM, "Box", kind="precision") == ["Box: scale and rotation applied"]
    assert world_points(box) == pytest.approx(before, abs=1e-5)
    assert np.array(child.matrix_world) == pytest.approx(place, abs=1e-4)
    assert tuple(box.scale) == (1, 1, 1) and tuple(box.rotation_euler) == (0, 0, 0) and volume(box) > 0.0
    for polygon in box.data.polygons:
        for index in polygon.loop_indices:
            assert box.data.corner_normals[index].vector.dot(polygon.normal) > 0.99
    assert mend(Action.APPLY_TRANSFORM, "Box", kind="precision") == []


def test_transforms_that_would_leave_a_trace_are_refused():
    box = add_box("Box", *UNIT, glass())
    box.scale = (2, 2, 2)
    copy = add("Copy", box.data)
    with pytest.raises(nd.ParameterError, match="shares its mesh; make it single-user"):
        mend(Action.APPLY_TRANSFORM, "Box")
    bpy.data.objects.remove(copy)
    bevel = box.modifiers.new("Bevel", "BEVEL")
    with pytest.raises(nd.ParameterError, match="has the modifier 'Bevel', which would do otherwise"):
        mend(Action.APPLY_TRANSFORM, "Box")
    box.modifiers.remove(bevel)
    box.delta_scale = (2, 1, 1)
    with pytest.raises(nd.ParameterError, match="has delta transforms"):
        mend(Action.APPLY_TRANSFORM, "Box")
    box.delta_scale = (1, 1, 1)
    box.keyframe_insert("scale", frame=1)
    with pytest.raises(nd.ParameterError, match="keyframes, a driver or a constraint"):
        mend(Action.APPLY_TRANSFORM, "Box")
    assert tuple(box.scale) == (2, 2, 2)


def test_a_scene_far_away_is_brought_to_the_origin_with_camera_lights_keyframes_and_instances(scene):
    far = Vector((1e5, -2e5, 3e4))
    box = add_box("Box", *UNIT, glass())
    box.location = far
    for frame, z in ((1, 0.0), (10, 4.0)):
        box.location = far + Vector((0, 0, z))
        box.keyframe_insert("location", frame=frame)
    camera = add_camera(far + Vector((0, -5, 0)), far)
    child = add("Child", None, (1, 0, 0))
    child.parent = box
    collection = bpy.data.collections.new("Kept")
    scene.collection.children.link(collection)
    collection.objects.link(camera)
    instancer = add("Instancer", None, far + Vector((3, 0, 0)))
    instancer.instance_type, instancer.instance_collection = "COLLECTION", collection
    scene.frame_set(10)

    def places():
        bpy.context.view_layer.update()
        graph = bpy.context.evaluated_depsgraph_get()
        return np.array([tuple(each.matrix_world.translation) for each in graph.object_instances])

    before, count = places(), len(places())
    mend(Action.MOVE_TO_ORIGIN, scene.name, kind="precision")
    after = places()
    assert len(after) == count >= 4
    # The coordinates of single precision at 2e5 are 0.016 apart.
    assert after - before == pytest.approx(np.tile(after[0] - before[0], (count, 1)), abs=0.05)
    assert np.abs(world_points(box).mean(axis=0)).max() < 0.05
    scene.frame_set(1)
    assert box.matrix_world.translation.z == pytest.approx(-4.0, abs=0.05)


def test_scenes_that_cannot_be_moved_as_a_whole_are_refused(scene):
    box = add_box("Box", *UNIT, glass())
    box.location = (1e5, 0, 0)
    target = add("Target", None)
    for kind, refused in (("TRACK_TO", False), ("CHILD_OF", True)):
        constraint = box.constraints.new(kind)
        constraint.target = target
        if refused:
            with pytest.raises(nd.ParameterError, match="'Box' has the constraint 'Child Of', which may hold it"):
                mend(Action.MOVE_TO_ORIGIN, scene.name)
        box.constraints.remove(constraint)
    other = bpy.data.scenes.new("Other")
    other.collection.objects.link(box)
    with pytest.raises(nd.ParameterError, match="'Box' stands in scene 'Other', too"):
        mend(Action.MOVE_TO_ORIGIN, scene.name)
    other.collection.objects.unlink(box)
    box.driver_add("location", 0)
    with pytest.raises(nd.ParameterError, match="'Box' is placed by a driver"):
        mend(Action.MOVE_TO_ORIGIN, scene.name)
    assert box.location.x == 1e5
