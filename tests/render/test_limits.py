"""Where the shader meets a limit of its own the picture shows the alarm, and what can be counted is counted."""

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from mathutils import Matrix
from scenes import add_box, add_camera, add_mesh, add_sphere, diffuse, new_scene, render, set_striped_world, set_world

import nested_dielectric as nd
from nested_dielectric.model import contract
from nested_dielectric.nodes import group

SLABS = 1200


def hide_from_paths(obj: bpy.types.Object) -> None:
    """Leave an object to the shader's own rays; one that no ray meets would not be there."""
    for name in ("camera", "glossy", "transmission"):
        setattr(obj, f"visible_{name}", False)


def cube_below_slabs(count: int) -> np.ndarray:
    """The picture of a cube that a winner around it hides, with so many slabs between its top and the winner's surface."""
    new_scene(16)
    set_striped_world()
    glass = nd.new_material("Glass", ior=1.5)
    add_box("Winner", (-5, -5, -5), (5, 5, 5), glass, 1)
    add_box("Hidden", (-1, -1, -1), (1, 1, 1), nd.new_material("Hidden", ior=2.4), 3)

    def build(bm):
        for index in range(count):
            place = Matrix.Translation((0.0, 0.0, 2.0 + 2.0 * index / count)) @ Matrix.Diagonal((3, 3, 1.0 / count, 1))
            bmesh.ops.create_cube(bm, size=1.0, matrix=place)

    if count:
        hide_from_paths(add_mesh("Slabs", build, glass, 5))
    add_camera((1.0, -4.0, 4.0), (0.1, 0.0, 1.0), angle=10)
    return render(4)


def test_thousands_of_surfaces_on_a_ray_are_counted():
    np.testing.assert_allclose(cube_below_slabs(SLABS), cube_below_slabs(0), atol=1e-5)


def is_magenta(picture: np.ndarray) -> bool:
    red, green, blue = picture.mean(axis=(0, 1))
    return green < 0.5 * min(red, blue)


def test_a_surface_whose_rays_meet_more_than_they_may_count_shows_magenta(monkeypatch):
    """A limit that a scene of a few surfaces reaches stands for the real one."""
    inlined_source = group.inlined_source
    few = f"#define PROBE_HITS {contract.PROBE_HITS}"
    monkeypatch.setattr(group, "inlined_source", lambda name: inlined_source(name).replace(few, "#define PROBE_HITS 8"))
    assert is_magenta(cube_below_slabs(20))


def ball_with_slots(before: int) -> bpy.types.Object:
    """A ball of water in one of glass, whose dielectric has so many foreign materials in the slots before it."""
    new_scene(16)
    set_world()
    add_camera((0, -5, 0), (0, 0, 0), angle=10)
    ball = add_sphere("Glass", 1.0, None)
    for index in range(before):
        ball.data.materials.append(diffuse(0.1 + 0.01 * index))
    ball.data.materials.append(nd.new_material("Glass", ior=1.5))
    ball.data.polygons.foreach_set("material_index", [before] * len(ball.data.polygons))
    add_sphere("Water", 0.5, nd.new_material("Water", ior=1.33), 5)
    return ball


@pytest.mark.parametrize("own_priority", [None, 2])
def test_a_medium_in_a_slot_where_neighbours_do_not_look_shows_magenta(own_priority):
    ball = ball_with_slots(contract.MATERIAL_SLOTS)
    if own_priority is not None:
        nd.set_priority(ball, own_priority)
    assert is_magenta(render(16))


def test_a_medium_in_the_last_slot_where_neighbours_look_shows():
    ball_with_slots(contract.MATERIAL_SLOTS - 1)
    assert not is_magenta(render(16))


def test_a_medium_behind_another_in_a_slot_where_neighbours_do_not_look_shows_magenta():
    """Its neighbours take it for the other one."""
    ball = ball_with_slots(contract.MATERIAL_SLOTS)
    ball.data.materials[0] = nd.new_material("Other", ior=1.2)
    assert is_magenta(render(64))


def test_a_medium_that_is_told_what_lies_outside_may_stand_in_any_slot():
    ball_with_slots(contract.MATERIAL_SLOTS)
    nd.prepare(bpy.context.scene, cut=False, backend="OSL")
    assert not is_magenta(render(64))


def ball_in_white(size: float, distance: float, wall: float = 0.0, segments: int = 32) -> np.ndarray:
    """A ball so large and so far from the origin, hollow if it has a wall, in a white world."""
    new_scene(16)
    set_world()

    def build(bm):
        bmesh.ops.create_uvsphere(bm, u_segments=segments, v_segments=segments // 2, radius=size)
        if wall:
            outer = set(bm.faces)
            bmesh.ops.create_uvsphere(bm, u_segments=segments, v_segments=segments // 2, radius=size - wall)
            bmesh.ops.reverse_faces(bm, faces=[face for face in bm.faces if face not in outer])

    ball = add_mesh("Ball", build, nd.new_material("Glass", ior=1.5))
    ball.location.x = distance
    add_camera((distance, -5.0 * size, 0.3 * size), (distance, 0, 0), angle=26)
    return render(64)


@pytest.mark.parametrize(
    "size, distance, wall", [(1.0, 1e6, 0.0), (1.0, 1e5, 0.2), (1.0, 0.0, 1e-6), (1e-4, 100.0, 0.0)]
)
def test_what_single_precision_does_not_hold_shows_magenta(size, distance, wall):
    """Cycles' own Glass errs there, too: by 1 % of the mean 10^5 out with a wall of 0.3, by 6 % 3 * 10^6 out."""
    red, green, blue = ball_in_white(size, distance, wall).mean(axis=(0, 1))
    assert min(red, blue) > 1.05 * green


@pytest.mark.parametrize(
    "size, distance, wall, segments",
    [(1.0, 1e4, 0.0, 32), (1.0, 0.0, 1e-5, 32), (1e5, 0.0, 10.0, 32), (1e-3, 1.0, 0.0, 32), (1.0, 30.0, 0.01, 96)],
)
def test_what_single_precision_holds_shows_no_alarm(size, distance, wall, segments):
    picture = ball_in_white(size, distance, wall, segments)
    np.testing.assert_allclose(picture[..., 0], picture[..., 1], atol=1e-6)
