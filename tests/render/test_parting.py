"""Faces of two media in exactly the same place are parted, so that each surface is one medium's."""

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from scenes import (
    BOUNCES,
    add,
    add_box,
    add_camera,
    add_mesh,
    add_plane,
    add_sphere,
    cycles_glass,
    diffuse,
    mostly_again,
    new_scene,
    render,
    set_striped_world,
    set_world,
)

import nested_dielectric as nd
from nested_dielectric.preparation.checks import NEAR, find_problems
from nested_dielectric.preparation.parting import OFFSET_ATTRIBUTE, OFFSET_GROUP, offsets

# Half of the noise between two renders of 64 samples of the same interfaces is 0.001; unparted surfaces differ by 0.9.
SAME = 0.006


def stage() -> None:
    new_scene(48)
    set_striped_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=26)


def glass_shell(bm: bmesh.types.BMesh) -> None:
    bmesh.ops.create_uvsphere(bm, u_segments=48, v_segments=24, radius=1.0)
    inner = bmesh.ops.create_uvsphere(bm, u_segments=48, v_segments=24, radius=0.7)
    bmesh.ops.reverse_faces(bm, faces=list({face for vertex in inner["verts"] for face in vertex.link_faces}))


def flush(prepare: bool) -> tuple[np.ndarray, nd.Preparation | None]:
    """Water that fills a glass shell to the very wall."""
    stage()
    add_mesh("Shell", glass_shell, nd.new_material("Glass", ior=1.5), 1, smooth=True)
    add_sphere("Water", 0.7, nd.new_material("Water", ior=1.33), 2, segments=48)
    scene = bpy.context.scene
    preparation = nd.prepare(scene) if prepare else None
    scene.cycles.transparent_max_bounces = BOUNCES
    return render(64), preparation


def relative_error(picture: np.ndarray, reference: np.ndarray) -> float:
    return float(((picture - reference) ** 2 / (reference**2 + 0.01)).mean())


def test_water_flush_with_its_glass_looks_as_split_by_hand():
    stage()
    add_sphere("Outside", 1.0, cycles_glass(1.5), segments=48)
    add_sphere("Inside", 0.7, cycles_glass(1.33 / 1.5), segments=48)
    reference = render(64)
    assert relative_error(flush(prepare=False)[0], reference) > 0.1
    picture, preparation = flush(prepare=True)
    assert relative_error(picture, reference) < SAME
    assert any(change.startswith("Water:") and "'Shell'" in change for change in preparation.changes)


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


def test_two_blocks_of_one_medium_side_by_side_look_as_one():
    """Equal priorities fuse where they overlap; flush, there would be two faces between them."""

    def blocks(*spans, prepare: bool = False) -> np.ndarray:
        stage()
        material = nd.new_material("Glass", ior=1.5)
        for index, (low, high) in enumerate(spans):
            add_box(f"Block {index}", (-0.7, -0.6, low), (0.7, 0.6, high), material, 1)
        if prepare:
            nd.prepare(bpy.context.scene)
            bpy.context.scene.cycles.transparent_max_bounces = BOUNCES
        return render(16)

    reference = blocks((-0.8, 0.8))
    halves = ((-0.8, 0.1), (0.1, 0.8))
    assert relative_error(blocks(*halves), reference) > 1e-3
    assert relative_error(blocks(*halves, prepare=True), reference) < 1e-4


def test_far_from_the_origin_the_distance_is_above_single_precision():
    water = box_scene((-0.5, -0.5, 1), (0.5, 0.5, 2), 2)
    for obj in (water, bpy.data.objects["Ice"]):
        obj.location.x = 1e3
    scene = bpy.context.scene
    assert nd.prepare(scene).changes
    assert 1.0 - bounds(water)[0, 2] > 1e-3
    assert nd.prepare(scene).changes == ()


def block(name: str, low, high, priority: int) -> bpy.types.Object:
    return add_box(name, low, high, nd.new_material(name, ior=1.2 + 0.1 * priority), priority)


def shifted(x: float, y: float) -> None:
    block("Lower", (-1, -1, -1), (1, 1, 0), 1)
    block("Upper", (-1 + x, -1 + y, 0), (1 + x, 1 + y, 1), 2)


def side_by_side() -> None:
    """Four around one edge, their tops and bottoms in one plane."""
    for index, (x, y) in enumerate([(-1, -1), (-1, 0), (0, -1), (0, 0)]):
        block(f"Block {index}", (x, y, -1), (x + 1, y + 1, 1), index + 1)


def three_in_one_plane() -> None:
    block("A", (-1, -1, -1), (1, 1, 0), 3)
    block("B", (-0.7, -1.2, 0), (0.5, 0.8, 1), 1)
    block("C", (-0.2, -0.6, 0), (1.5, 1.1, 0.7), 2)


def askew_prisms() -> None:
    def prism(bm: bmesh.types.BMesh) -> None:
        corners = [(-1, -1, 0), (1, -1, 0), (0, 1, 0), (-1, -1, 1), (1, -1, 1), (0, 1, 1)]
        points = [bm.verts.new(corner) for corner in corners]
        for face in ((2, 1, 0), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)):
            bm.faces.new([points[i] for i in face])

    frame = add("Frame", None, (0, 0, -0.7))
    frame.rotation_euler = (0.4, 0.3, 0.2)
    add_mesh("A", prism, nd.new_material("A", ior=1.5), 1).parent = frame
    upper = add_mesh("B", prism, nd.new_material("B", ior=1.3), 2)
    upper.parent, upper.location, upper.rotation_euler.z = frame, (0.3, 0.2, 1.0), 0.7


COPLANAR = {
    "by half": lambda: shifted(0.5, 0.5),
    "by a thousandth": lambda: shifted(0.001, 0.0),
    "along one axis": lambda: shifted(0.5, 0.0),
    "side by side": side_by_side,
    "three in one plane": three_in_one_plane,
    "askew": askew_prisms,
}


@pytest.mark.parametrize("build", mostly_again(COPLANAR, 2))
def test_media_that_share_part_of_a_plane_neither_lose_nor_gain_light(build):
    """In a furnace. A few paths end between faces that are parted by a ten-thousandth: 2 of 10,000 were seen to be lost."""
    scene = new_scene(24)
    set_world()
    COPLANAR[build]()
    add_camera((2.2, -3.3, 1.7), (0, 0, 0), angle=34)
    preparation = nd.prepare(scene)
    assert preparation.problems == () and preparation.found.coincident == ()
    assert nd.prepare(scene).changes == ()
    scene.cycles.transparent_max_bounces = BOUNCES
    assert render(16).mean() == pytest.approx(1.0, abs=1e-3)


def test_faces_that_share_part_of_a_plane_lose_light_before_they_are_parted():
    new_scene(24)
    set_world()
    shifted(0.5, 0.5)
    add_camera((2.2, -3.3, 1.7), (0, 0, 0), angle=34)
    assert render(16).mean() < 0.9


def duplicate(obj: bpy.types.Object, location=(0.0, 0.0, 0.0), priority: int | None = None) -> bpy.types.Object:
    """As Alt+D: with the same mesh."""
    copy = add(f"{obj.name} again", obj.data, location)
    if priority is not None:
        nd.set_priority(copy, priority)
    return copy


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


def test_a_duplicate_in_the_same_place_looks_as_if_it_were_alone():
    def picture(copies: int, prepare: bool = True) -> np.ndarray:
        stage()
        ball = add_sphere("Ball", 1.0, nd.new_material("Glass", ior=1.5), 1, segments=24)
        for _ in range(copies):
            duplicate(ball)
        if prepare:
            nd.prepare(bpy.context.scene)
        bpy.context.scene.cycles.transparent_max_bounces = BOUNCES
        return render(64)

    alone = picture(0)
    assert relative_error(picture(1), alone) < SAME
    assert relative_error(picture(1, prepare=False), alone) > 0.1


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


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_by_as_much_as_the_check_says_a_block_on_a_table_looks_as_by_four_times_that(way):
    """Raised, with air below, or sunk in, without; exactly on the table it is darker by half."""

    def picture(height: float) -> np.ndarray:
        new_scene(32)
        set_world(strength=0.6)
        block("Block", (-0.8, -0.8, 0), (0.8, 0.8, 1), 1).location.z = height
        add_plane("Table", 8, (0, 0, 0), (0, 0, 1), diffuse(0.7))
        add_camera((2.5, -5, 3), (0, 0, 0.4), angle=26)
        return render(64)[17:22, 13:19].mean()

    diagonal = np.sqrt(1.6**2 + 1.6**2 + 1.0)
    near, far, on = (picture(way * NEAR * diagonal * times) for times in (1.0, 4.0, 0.0))
    # 1,920 paths, of which the spread was 0.4 % of the mean.
    assert near == pytest.approx(far, rel=0.02)
    assert on < 0.7 * near


def test_points_rise_with_all_their_faces():
    """At a cube's corner three planes move by a distance each; on a smooth surface near-equal normals move it once."""
    corner = offsets(5, np.array([[0, 1, 2]] * 3), np.eye(3), np.array([1.0, 2.0, -3.0]))
    assert corner[0] == pytest.approx([1.0, 2.0, -3.0])
    assert np.all(corner[3:] == 0.0)
    normals = np.array([[0.0, 0.02, 1.0], [0.0, -0.02, 1.0]])
    smooth = offsets(3, np.array([[0, 1, 2]] * 2), normals / np.linalg.norm(normals, axis=1)[:, None], np.ones(2))
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
