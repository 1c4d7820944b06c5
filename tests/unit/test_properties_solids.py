"""Closed bodies: what they enclose, their islands, walls and places, in any order and wherever they are."""

import itertools
from collections import Counter

import bpy  # noqa: F401  mathutils comes with it
import numpy as np
import property_tests
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from random_solids import apart, box, points, seeds, sizes, solids
from solids import at, grid_box, joined, random_matrix, solid_angles, winding

from nested_dielectric.geometry import meshes
from nested_dielectric.geometry.resting import resting_surfaces
from nested_dielectric.geometry.self_overlap import aligning_frame, near_islands
from nested_dielectric.geometry.solids import Body, PlacedSolid, Solid, touch_tolerance
from nested_dielectric.geometry.surfaces import (
    FLOAT_ROUNDING,
    TOUCH_TOLERANCE,
    JoinedSurfaces,
    faces_in_box,
    normals_of,
)
from nested_dielectric.geometry.walls import Walls
from nested_dielectric.geometry.winding import count_islands_inside, winding_numbers

HALF = 1.0 / 16.0
"""Half the lattice of the bodies' corners."""


# Winding numbers


def beside(solid: Solid, rng: np.random.Generator, count: int = 60) -> np.ndarray:
    """Points on the lattice of a body's corners and between, off its surface: rays meet edges and corners."""
    low, high = solid.vertices.min(axis=0) - 0.5, solid.vertices.max(axis=0) + 0.5
    places = np.round(rng.uniform(low, high, (count, 3)) / HALF) * HALF
    under = rng.random((count, 2)) < 0.5
    places[:, :2] = np.where(under, rng.choice(solid.vertices, count)[:, :2], places[:, :2])
    corners = solid.vertices[solid.triangles].transpose(1, 0, 2)
    angles = [solid_angles(*(corner - place for corner in corners)) for place in places]
    # Within a triangle the angle is half of all; on an edge it is none that a formula could tell.
    inside = np.array([np.abs(np.abs(each).max() - 2.0 * np.pi) < 1e-6 for each in angles])
    return places[~inside & (from_edges(places, corners) > 1e-6)]


def from_edges(places: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Distances of points from the nearest edge of some triangles, (3 corners, m, 3)."""
    start, way = corners.reshape(-1, 3), (np.roll(corners, -1, axis=0) - corners).reshape(-1, 3)
    offset = places[:, None] - start
    along = np.clip(np.einsum("kex,ex->ke", offset, way) / np.einsum("ex,ex->e", way, way), 0.0, 1.0)
    return np.linalg.norm(offset - along[..., None] * way, axis=2).min(axis=1)


grids = st.builds(lambda corner, size, cells: grid_box(corner, corner + size, cells), points, sizes, st.integers(1, 4))
several = st.lists(st.one_of(solids, grids), min_size=1, max_size=4).map(lambda some: joined(*some))


@given(several, seeds)
def test_winding_numbers_along_rays_through_edges_and_corners_are_those_by_solid_angles(solid, seed):
    """Van Oosterom and Strackee 1983; islands cross each other at will."""
    places = beside(solid, np.random.default_rng(seed))
    corners = solid.vertices[solid.triangles]
    total = np.array([solid_angles(*(corners - place).transpose(1, 0, 2)).sum() for place in places]) / (4.0 * np.pi)
    whole = np.abs(total - np.rint(total)) < 1e-6
    assert np.array_equal(
        winding_numbers(places[whole], PlacedSolid(solid, np.eye(4))), np.rint(total[whole]).astype(int)
    )


@given(several, seeds, st.floats(1e-3, 1e3))
def test_winding_numbers_are_the_same_turned_mirrored_and_scaled(solid, seed, scale):
    rng = np.random.default_rng(seed)
    places = rng.uniform(-9.0, 9.0, (40, 3))
    matrix = random_matrix(rng, 2.0)
    matrix[:3] *= scale
    there = places @ matrix[:3, :3].T + matrix[:3, 3]
    near = np.abs(places[:, None] - solid.vertices[None]).min() > 1e-6
    assume(near)
    assert np.array_equal(
        winding_numbers(places, PlacedSolid(solid, np.eye(4))), winding_numbers(there, PlacedSolid(solid, matrix))
    )


large_boxes = st.builds(lambda corner, size: box(corner / 4.0 - 6.03, size + 8.0), points, sizes)


@settings(max_examples=property_tests.FEW)
@given(st.lists(st.builds(box, points, sizes), min_size=1, max_size=3), large_boxes)
def test_islands_inside_a_body_are_those_whose_boxes_are(some, other):
    low, high = (np.array([end(each.vertices, axis=0) for each in some]) for end in (np.min, np.max))
    floor, ceiling = other.vertices.min(axis=0), other.vertices.max(axis=0)
    gaps = np.stack([low - floor, ceiling - high, floor - high, low - ceiling])
    outside = ((gaps[2] > 0.0) | (gaps[3] > 0.0)).any(axis=1)
    inside = ((gaps[0] > 0.0) & (gaps[1] > 0.0)).all(axis=1)
    assume((outside | inside).all())
    a, b = PlacedSolid(joined(*some), np.eye(4)), PlacedSolid(other, np.eye(4))
    nil = np.zeros(1, dtype=np.intp)
    assert count_islands_inside(a, nil, b, nil, np.zeros(1)).tolist() == [inside.sum()]


# Bodies in the world


@given(solids, seeds)
def test_a_placed_body_keeps_its_inside_and_scales_with_its_matrix(solid, seed):
    matrix = random_matrix(np.random.default_rng(seed), 3.0)
    place = PlacedSolid(solid, matrix)
    scale = abs(np.linalg.det(matrix[:3, :3]))
    triangles = place.corners.T
    volume = meshes.signed_volume(solid.vertices, solid.triangles)
    assert meshes.signed_volume(place.vertices.T, triangles) == pytest.approx(scale * volume, rel=1e-9)
    assert place.areas.sum() == pytest.approx(meshes.surface_area(place.vertices.T, triangles), rel=1e-12)
    assert np.abs(normals_of(place).sum(axis=1)).max() < 1e-9 * place.areas.sum()  # a closed surface's cancel
    assert np.allclose(np.stack(place.box), [place.vertices.min(axis=1), place.vertices.max(axis=1)])
    assert np.allclose(place.centroids(np.arange(len(triangles))), place.vertices.T[triangles].mean(axis=1))
    assert not place.flat and place.solid.closed
    flat = matrix.copy()
    flat[:3, 1] = 2.0 * flat[:3, 0]
    assert PlacedSolid(solid, flat).flat


@given(st.lists(solids, min_size=2, max_size=5))
def test_joined_surfaces_are_each_bodys_own(some):
    places = [PlacedSolid(each, np.eye(4)) for each in some]
    both = JoinedSurfaces(places)
    for number, place in enumerate(places):
        own = np.arange(both.starts[number], both.starts[number + 1])
        assert np.array_equal(both.points(own), place.points(np.arange(len(own))))
    assert np.array_equal(np.stack(both.boxes)[:, :, 0], np.stack(places[0].boxes)[:, :, 0])
    assert both.islands.tolist() == list(itertools.chain(*([n] * len(each.triangles) for n, each in enumerate(some))))
    assert both.island_starts.tolist() == list(range(len(some) + 1))


@given(solids, solids, st.floats(1e-3, 1e3), st.integers(0, 3))
def test_bodies_touch_within_a_part_of_the_smaller_ones_size_and_of_single_precision(one, other, scale, axis):
    matrix = at(*(1e4 * np.eye(4)[axis, :3]), scale=scale)
    a, b = PlacedSolid(one, np.eye(4)), PlacedSolid(other, matrix)
    size = min(np.linalg.norm(np.ptp(place.vertices, axis=1)) for place in (a, b))
    far = max(np.abs(place.vertices).max() for place in (a, b))
    assert touch_tolerance(a, b) == pytest.approx(TOUCH_TOLERANCE * size + FLOAT_ROUNDING * far, rel=1e-9)


@given(solids, seeds)
def test_a_body_is_the_same_while_nothing_of_it_changes(solid, seed):
    matrix = random_matrix(np.random.default_rng(seed), 3.0)
    body = Body(solid, matrix, 1, "water")
    assert body.is_same(Body(solid, matrix.copy(), 1, "water"))
    moved = matrix.copy()
    moved[0, 3] += 1e-9
    for other in (Body(solid, moved, 1, "water"), Body(solid, matrix, 2, "water"), Body(solid, matrix, 1, "ice")):
        assert not body.is_same(other)


@given(solids, points, sizes)
def test_faces_in_a_box_are_those_whose_boxes_meet_it(solid, corner, size):
    place = PlacedSolid(solid, np.eye(4))
    ends = place.points(np.arange(len(solid.triangles)))
    expected = ((ends.min(axis=1) <= corner + size) & (ends.max(axis=1) >= corner)).all(axis=1)
    assert sorted(faces_in_box(place, corner, corner + size)) == np.flatnonzero(expected).tolist()


@given(several, seeds)
def test_islands_are_what_edges_join(solid, seed):
    order = np.random.default_rng(seed).permutation(len(solid.triangles))
    mixed = Solid(solid.vertices, solid.triangles[order])
    islands = mixed.islands
    root = meshes.connected(len(mixed.vertices), *np.concatenate([mixed.triangles[:, :2], mixed.triangles[:, 1:]]).T)
    own = root[mixed.corners[0]]
    assert len(set(zip(islands.tolist(), own.tolist()))) == len(set(own.tolist())) == islands.max() + 1
    faces, starts = mixed.by_island
    assert all(set(islands[faces[a:b]]) == {n} for n, (a, b) in enumerate(itertools.pairwise(starts)))


@given(several, st.floats(1e-6, 1.0))
def test_pairs_of_islands_that_may_touch_leave_out_none_that_does(solid, tolerance):
    place = PlacedSolid(solid, np.eye(4))
    low, high = place.island_boxes
    size = np.full(low.shape[1], tolerance)
    found = set(zip(*(each.tolist() for each in near_islands(place, size))))
    meeting = np.argwhere(apart(low, high, low, high) <= 0.0).tolist()
    corners = [place.vertices[:, place.corners[:, place.islands == n].ravel()] for n in range(low.shape[1])]
    close = {
        (i, j)
        for i, j in meeting
        if i < j and (np.abs(corners[i][:, :, None] - corners[j][:, None]).max(axis=0) < tolerance).any()
    }
    assert close <= found and all(i < j for i, j in found)


@given(several)
def test_the_frame_that_islands_lie_along_is_a_rotation(solid):
    frame = aligning_frame(PlacedSolid(solid, np.eye(4)))[:3, :3]
    assert np.allclose(frame @ frame.T, np.eye(3), atol=1e-12) and np.linalg.det(frame) == pytest.approx(1.0)


@given(st.builds(box, points, sizes), st.builds(box, points, sizes))
def test_two_boxes_in_one_mesh_overlap_unless_they_are_apart(one, other):
    gap = apart(
        *(end[:, None] for each in (one, other) for end in (each.vertices.min(axis=0), each.vertices.max(axis=0)))
    )
    assert joined(one, other).overlaps_itself == bool(gap[0, 0] <= 0.0)
    assert not one.overlaps_itself


# Ways, walls and what rests


@settings(max_examples=10)
@given(st.builds(box, points, sizes), seeds)
def test_the_mean_way_through_a_box_is_four_volumes_by_its_surface(solid, seed):
    """Cauchy 1850, by lines in all directions, even over a disk that holds the body's shadow; 4.5 standard errors."""
    rng, count = np.random.default_rng(seed), 20000
    low, high = solid.vertices.min(axis=0), solid.vertices.max(axis=0)
    direction = rng.normal(size=(count, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    across = np.cross(direction, rng.normal(size=(count, 3)))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    reach = np.linalg.norm(high - low) / 2.0
    origin = (low + high) / 2.0 + across * (reach * np.sqrt(rng.random(count)))[:, None]
    ends = np.stack([(low - origin) / direction, (high - origin) / direction])
    chord = np.maximum(ends.max(axis=0).min(axis=1) - ends.min(axis=0).max(axis=1), 0.0)
    met = chord > 0.0
    error = chord[met].std() / np.sqrt(met.sum())
    assert abs(chord[met].mean() - meshes.mean_chord(solid.vertices, solid.triangles)) < 4.5 * error
    assert solid.mean_chord == pytest.approx(meshes.mean_chord(solid.vertices, solid.triangles), rel=1e-12)


@settings(max_examples=property_tests.FEW)
@given(st.floats(0.01, 1.0), st.floats(0.02, 1.0), st.integers(1, 3), st.sampled_from((-0.5, 2.0)), seeds)
def test_a_face_may_move_as_far_as_the_next_wall_before_it(gap, reach, cells, width, seed):
    """A box faces a block or a post over a gap; a third is beside them, before nothing."""
    turn = random_matrix(np.random.default_rng(seed), 1.0)
    turn[:3, :3] = np.linalg.qr(turn[:3, :3])[0]
    one = grid_box((-1, -1, -1), (1, 1, 0), cells)
    other, aside = grid_box((-0.9, -0.8, gap), (width, -0.3, 2), cells), grid_box((1.2, -1, -1), (3, 1, gap / 2), cells)
    bodies = [Body(each, turn, number, number) for number, each in enumerate((one, other, aside))]
    faces = np.flatnonzero((one.vertices[one.triangles][:, :, 2] == 0.0).all(axis=1))
    assert Walls(bodies).clearance(0, faces, np.ones(len(faces)), reach) == pytest.approx(min(gap, reach), rel=1e-6)
    inwards = Walls(bodies).clearance(0, faces, -np.ones(len(faces)), 2.0)
    assert inwards == pytest.approx(1.0, rel=1e-6)


def whole(low: int, high: int) -> st.SearchStrategy:
    return st.tuples(*[st.integers(low, high)] * 3).map(np.array)


coarse_boxes = st.builds(box, whole(-2, 2), whole(1, 3))


@given(st.lists(coarse_boxes, min_size=1, max_size=4), coarse_boxes)
def test_what_rests_on_a_box_is_what_shares_part_of_its_top_or_another_side(standing, foreign):
    """Boxes on a lattice share part of a plane or are apart by more than any tolerance."""
    ends = [(each.vertices.min(axis=0), each.vertices.max(axis=0)) for each in standing]
    expected = [number for number, (low, high) in enumerate(ends) if share_a_side(low, high, foreign)]
    assert list(resting_surfaces([PlacedSolid(each, np.eye(4)) for each in standing], foreign)) == expected


def share_a_side(low: np.ndarray, high: np.ndarray, other: Solid) -> bool:
    """Whether two boxes along the axes have sides in one plane that overlap by more than an edge."""
    floor, ceiling = other.vertices.min(axis=0), other.vertices.max(axis=0)
    overlap = np.minimum(high, ceiling) - np.maximum(low, floor)
    for axis in range(3):
        same = {low[axis], high[axis]} & {floor[axis], ceiling[axis]}
        if same and all(overlap[other] > 0.0 for other in range(3) if other != axis):
            return True
    return False


# Meshes


@given(st.lists(st.tuples(*[st.integers(0, 6)] * 3), max_size=12))
def test_open_edges_are_those_that_no_edge_cancels(triangles):
    balance: Counter = Counter()
    for triangle in triangles:
        for a, b in zip(triangle, (*triangle[1:], triangle[0])):
            if a != b:
                balance[min(a, b), max(a, b)] += 1 if a < b else -1
    expected = sum(1 for each in balance.values() if each)
    assert meshes.open_edge_count(np.array(triangles, dtype=np.int32).reshape(-1, 3)) == expected


@given(st.lists(st.tuples(*[st.sampled_from((0.0, -0.0, 1.0, 1.0000001, np.nan))] * 3), min_size=1, max_size=20))
def test_vertices_in_one_place_are_the_first_one_there(places):
    places = np.array(places, dtype=np.float32)
    first = meshes.same_places(places)
    for number, place in enumerate(places):
        same = [i for i, each in enumerate(places) if np.array_equal(each, place, equal_nan=True)]
        assert first[number] == same[0]


@given(several)
def test_volumes_add_up_and_are_those_of_tetrahedra(solid):
    corners = solid.vertices[solid.triangles].astype(np.longdouble)
    exact = sum(np.dot(a, np.cross(b, c)) for a, b, c in corners) / 6
    assert meshes.signed_volume(solid.vertices, solid.triangles) == pytest.approx(float(exact), rel=1e-12)
    assert np.array_equal(winding(solid.vertices.mean(axis=0, keepdims=True) + 1e3, corners.astype(np.float64)), [0])
