"""Faces of two media in exactly the same place are parted, so that each surface is one medium's."""

import bpy  # before bmesh, which lives inside it
import bmesh  # isort: skip
import numpy as np
import pytest

import nested_dielectric as nd
from nested_dielectric.parting import OFFSET_ATTRIBUTE, offsets
from scenes import (
    BOUNCES,
    add_box,
    add_camera,
    add_mesh,
    add_sphere,
    cycles_glass,
    new_scene,
    render,
    set_striped_world,
)

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


def test_points_rise_with_all_their_faces():
    """At a cube's corner three planes move by a distance each; on a smooth surface near-equal normals move it once."""
    corner = offsets(5, np.array([[0, 1, 2]] * 3), np.eye(3), np.array([1.0, 2.0, -3.0]))
    assert corner[0] == pytest.approx([1.0, 2.0, -3.0])
    assert np.all(corner[3:] == 0.0)
    normals = np.array([[0.0, 0.02, 1.0], [0.0, -0.02, 1.0]])
    smooth = offsets(3, np.array([[0, 1, 2]] * 2), normals / np.linalg.norm(normals, axis=1)[:, None], np.ones(2))
    assert smooth[0] == pytest.approx([0.0, 0.0, 1.0], abs=1e-3)
