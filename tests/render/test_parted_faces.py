"""Faces of two media in exactly the same place look right once they are parted."""

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from same_place import block, duplicate
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
from nested_dielectric.checking.foreign_checks import NEAR

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
