"""Closed meshes and which of them touch, for any bodies."""

import bpy  # noqa: F401  mathutils comes with it
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_solids import solids

from nested_dielectric.geometry import meshes
from nested_dielectric.geometry.contacts import analyse
from nested_dielectric.geometry.solids import Body, Solid
from nested_dielectric.model.contract import Exterior

shifts = st.tuples(*[st.floats(-1e3, 1e3)] * 3).map(np.array)


def shuffled(solid: Solid, seed: int) -> Solid:
    """The same surface: vertices and triangles in another order, triangles begun at another corner."""
    generator = np.random.default_rng(seed)
    order = generator.permutation(len(solid.vertices))
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    triangles = place[generator.permutation(solid.triangles)].astype(np.int32)
    turns = generator.integers(0, 3, len(triangles))
    triangles = np.take_along_axis(triangles, (np.arange(3) + turns[:, None]) % 3, axis=1)
    return Solid(solid.vertices[order], triangles)


@given(solids, st.integers(0, 2**31), shifts)
def test_a_bodys_volume_and_surface_are_its_own_in_any_order_and_place(solid, seed, shift):
    other = shuffled(solid, seed)
    volume, area = (
        meshes.signed_volume(solid.vertices, solid.triangles),
        meshes.surface_area(solid.vertices, solid.triangles),
    )
    assert volume > 0.0 and solid.closed
    moved = other.vertices + shift
    assert meshes.signed_volume(moved, other.triangles) == pytest.approx(volume, rel=1e-7)
    assert meshes.signed_volume(moved, other.triangles[:, ::-1]) == pytest.approx(-volume, rel=1e-7)
    assert meshes.surface_area(moved, other.triangles) == pytest.approx(area, rel=1e-7)
    assert meshes.mean_chord(moved, other.triangles) == pytest.approx(4.0 * volume / area, rel=1e-6)


@given(solids, st.integers(0, 2**31), st.integers(0, 11))
def test_a_body_is_closed_until_a_face_is_missing_turned_or_there_twice(solid, seed, which):
    triangles = shuffled(solid, seed).triangles
    which %= len(triangles)
    turned = triangles.copy()
    turned[which] = turned[which, ::-1]
    for broken in (np.delete(triangles, which, axis=0), turned, np.append(triangles, triangles[[which]], axis=0)):
        assert not meshes.is_closed(broken) and meshes.open_edge_count(broken) >= 3
    assert meshes.is_closed(triangles) and meshes.open_edge_count(triangles) == 0


@given(st.lists(st.tuples(*[st.integers(0, 6)] * 3), max_size=12))
def test_edges_that_cancel_are_counted_and_guessed_alike(triangles):
    triangles = np.array(triangles, dtype=np.int32).reshape(-1, 3)
    assert meshes.is_closed(triangles) == (meshes.open_edge_count(triangles) == 0)


@given(st.integers(1, 30), st.data())
def test_nodes_are_connected_as_by_walking(count, data):
    ends = st.integers(0, count - 1)
    links = data.draw(st.lists(st.tuples(ends, ends), max_size=40))
    a, b = (np.array([link[end] for link in links], dtype=np.int64) for end in (0, 1))
    root = meshes.connected(count, a, b)
    group = list(range(count))
    for _ in range(count):
        for one, other in links:
            group[one] = group[other] = min(group[one], group[other])
    assert [group.index(each) for each in group] == [root.tolist().index(each) for each in root.tolist()]


# Contacts


def holds(solid: Solid, places: np.ndarray) -> np.ndarray:
    """Whether a body holds each of some places: signed crossings along a ray (Möller and Trumbore 1997)."""
    direction = np.array([0.3141, 0.2718, 0.9093])
    a, b, c = (solid.vertices[solid.triangles[:, corner]] for corner in range(3))
    u, v = b - a, c - a
    cross = np.cross(direction, v)
    determinant = np.einsum("tx,tx->t", u, cross)
    offset = places[:, None] - a
    first = np.einsum("ptx,tx->pt", offset, cross) / determinant
    turned = np.cross(offset, u)
    second = turned @ direction / determinant
    distance = np.einsum("ptx,tx->pt", turned, v) / determinant
    met = (first >= 0.0) & (second >= 0.0) & (first + second <= 1.0) & (distance > 0.0)
    return (met * np.where(determinant > 0.0, -1, 1)).sum(axis=1) != 0


def just_outside(solid: Solid) -> np.ndarray:
    """Places all over the faces, a little above them."""
    a, b, c = (solid.vertices[solid.triangles[:, corner]] for corner in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    weights = np.array([(0.34, 0.33, 0.33), (0.9, 0.06, 0.04), (0.04, 0.9, 0.06), (0.06, 0.04, 0.9)])
    return (np.einsum("pc,ctx->ptx", weights, np.stack([a, b, c])) + 1e-7 * normals).reshape(-1, 3)


@st.composite
def scenes(draw) -> list[Body]:
    """Bodies of a few priorities, off each other's planes, of many sizes and some mirrored, each with a medium of its own."""
    made = []
    for index in range(draw(st.integers(2, 6))):
        solid = draw(solids)
        scale = draw(st.sampled_from((0.1, 0.3, 1.0, 3.0)))
        matrix = np.diag((scale, scale, scale * draw(st.sampled_from((1.0, -1.0))), 1.0))
        place = draw(st.tuples(*[st.integers(-997, 997)] * 3).map(lambda n: np.array(n) / 331.7))
        matrix[:3, 3] = place - matrix[:3, :3] @ solid.vertices.mean(axis=0)
        made.append(Body(solid, matrix, draw(st.integers(0, 3)), index))
    return made


def placed(body: Body) -> Solid:
    """A body in the world."""
    mirrored = np.linalg.det(body.matrix[:3, :3]) < 0.0
    triangles = body.solid.triangles[:, ::-1] if mirrored else body.solid.triangles
    return Solid(body.solid.vertices @ body.matrix[:3, :3].T + body.matrix[:3, 3], triangles)


def test_what_is_told_of_any_bodies_is_so_all_over_their_faces():
    told = set()

    @settings(max_examples=150)
    @given(scenes())
    def check(bodies):
        world = [placed(body) for body in bodies]
        for index, contact in enumerate(analyse(bodies)):
            others = [other for other in range(len(bodies)) if other != index]
            places = just_outside(world[index])
            inside = np.array([holds(world[other], places) for other in others])
            assert_told(bodies, index, others, inside, contact)
            told.add(contact.code)

    check()
    assert told == {Exterior.UNKNOWN, Exterior.AIR, Exterior.MEDIUM, Exterior.WINNER}


def assert_told(bodies, index: int, others: list[int], inside: np.ndarray, contact) -> None:
    """A contact is true where each of the others holds a place or not; (others, places)."""
    priorities = np.array([bodies[other].priority for other in others])
    best = np.where(inside, priorities[:, None], 1000).min(axis=0)
    own = bodies[index].priority
    if contact.code == Exterior.AIR:
        assert not inside.any()
    if contact.code == Exterior.WINNER:
        assert np.all(best <= own)
    if contact.code == Exterior.MEDIUM:
        assert np.all(best == bodies[contact.surrounding_body].priority) and np.all(best > own)
        assert np.all(inside[others.index(contact.surrounding_body)])
    if contact.code == Exterior.UNKNOWN and contact.sole_priority is not None:
        assert set(best) <= {contact.sole_priority, 1000}
