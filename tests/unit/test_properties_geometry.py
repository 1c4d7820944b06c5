"""Geometry by many at once is geometry by one after the other: sets of numbers, boxes, triangles, planes."""

import itertools
from collections import Counter

import bpy  # noqa: F401  mathutils comes with it
import numpy as np
import property_tests
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from random_solids import apart, points, seeds, sizes
from solids import grid_box, joined

from nested_dielectric.geometry.coplanar import (
    LEAST_COSINE,
    coincident_triangles,
    flat_sides,
    parallel_pairs,
    share_a_plane,
)
from nested_dielectric.geometry.hierarchy import BoxHierarchy, leaves_in_boxes, morton_order, overlapping_leaves
from nested_dielectric.geometry.numbering import LARGEST_TABLE, compact_numbers, group_by_number, index_ranges
from nested_dielectric.geometry.pairs import overlapping_boxes
from nested_dielectric.geometry.solids import PlacedSolid, Solid
from nested_dielectric.geometry.triangles import clip_to_prism, edge_directions, with_normals, without_separating_axis
from nested_dielectric.geometry.vectors import cross, dot, length

# Numbers


@given(st.lists(st.tuples(st.integers(0, 50), st.integers(0, 9)), max_size=20))
def test_ranges_are_written_out_one_after_the_other(ranges):
    start, count = np.array(ranges, dtype=np.int64).reshape(-1, 2).T
    owner, number = index_ranges(start, start + count)
    expected = [(place, each) for place, (first, some) in enumerate(ranges) for each in range(first, first + some)]
    assert list(zip(owner.tolist(), number.tolist())) == expected


@given(st.lists(st.integers(0, 99), min_size=1, max_size=40), st.booleans())
def test_numbers_are_made_compact_by_tables_as_by_sorting(values, sparse):
    values = np.array(values)
    different, place = compact_numbers(values, (LARGEST_TABLE * 2) if sparse else 100)
    assert different.tolist() == sorted(set(values.tolist())) and np.array_equal(different[place], values)


@given(st.lists(st.integers(0, 6), min_size=1, max_size=30))
def test_places_are_grouped_by_number(numbers):
    places, starts = group_by_number(np.array(numbers))
    groups = [places[first:last].tolist() for first, last in itertools.pairwise(starts)]
    assert groups == [[i for i, each in enumerate(numbers) if each == number] for number in range(max(numbers) + 1)]


@given(seeds)
def test_products_of_vectors_are_those_of_numpy(seed):
    u, v = np.random.default_rng(seed).normal(size=(2, 3, 50))
    assert np.allclose(dot(u, v), np.einsum("xn,xn->n", u, v), rtol=1e-13, atol=1e-13)
    assert np.allclose(cross(u, v), np.cross(u.T, v.T).T, rtol=0, atol=1e-14)
    assert np.allclose(length(u), np.linalg.norm(u, axis=0), rtol=1e-15)


# Boxes


def boxes(rng: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Boxes on a lattice, many of which share sides, some flat; (3, n) each."""
    low = rng.integers(-8, 8, (3, count)).astype(np.float64)
    return low, low + rng.integers(0, 4, (3, count))


def trees(rng: np.random.Generator, counts: list[int]) -> tuple[BoxHierarchy, np.ndarray, np.ndarray]:
    """Trees of so many boxes each, in an order that fills space."""
    low, high = boxes(rng, sum(counts))
    starts = np.concatenate([[0], np.cumsum(counts)])
    for first, last in itertools.pairwise(starts):
        order = first + morton_order((low + high)[:, first:last])
        low[:, first:last], high[:, first:last] = low[:, order], high[:, order]
    return BoxHierarchy(np.concatenate([low, -high]), starts), low, high


counts = st.lists(st.integers(1, 70), min_size=1, max_size=4)


@settings(max_examples=property_tests.FEW)
@given(seeds, counts, counts, st.sampled_from((0.0, 1.0, 0.5)))
def test_boxes_of_trees_meet_as_by_comparing_all(seed, some, others, tolerance):
    rng = np.random.default_rng(seed)
    (a, low, high), (b, other_low, other_high) = trees(rng, some), trees(rng, others)
    near = apart(low, high, other_low, other_high) <= tolerance
    pairs = np.array(list(itertools.product(range(len(some)), range(len(others)))))
    chosen = pairs[rng.permutation(len(pairs))[: 1 + len(pairs) // 2]]
    found = overlapping_leaves(a, b, tolerance, chosen[:, 0], chosen[:, 1])
    owner = [np.searchsorted(tree.starts, np.arange(tree.starts[-1]), side="right") - 1 for tree in (a, b)]
    expected = {
        (i, j)
        for i, j in zip(*(each.tolist() for each in np.nonzero(near)))
        if (owner[0][i], owner[1][j]) in set(map(tuple, chosen.tolist()))
    }
    assert Counter(zip(*(each.tolist() for each in found))) == Counter(expected)


@settings(max_examples=property_tests.FEW)
@given(seeds, counts)
def test_boxes_find_what_they_meet_in_their_trees(seed, some):
    rng = np.random.default_rng(seed)
    tree, low, high = trees(rng, some)
    wanted_low, wanted_high = boxes(rng, 20)
    of_tree = rng.integers(0, len(some), 20)
    meets = apart(wanted_low, wanted_high, low, high) <= 0.0
    owner = np.searchsorted(tree.starts, np.arange(tree.starts[-1]), side="right") - 1
    found = leaves_in_boxes(tree, of_tree, wanted_low, wanted_high)
    expected = np.argwhere(meets & (owner == of_tree[:, None]))
    assert sorted(zip(*(each.tolist() for each in found))) == sorted(map(tuple, expected.tolist()))


@settings(max_examples=property_tests.FEW)
@given(seeds, st.integers(1, 60))
def test_pairs_of_boxes_are_found_once_and_by_tolerance_no_fewer(seed, count):
    low, high = boxes(np.random.default_rng(seed), count)
    near = apart(low, high, low, high)
    exact = {(i, j) for i, j in np.argwhere(near <= 0.0).tolist() if i < j}
    pairs = list(zip(*(each.tolist() for each in overlapping_boxes(low, high, 0.0))))
    assert set(pairs) == exact and len(pairs) == len(exact)
    wider = set(zip(*(each.tolist() for each in overlapping_boxes(low, high, 0.3))))
    assert wider >= {(i, j) for i, j in np.argwhere(near <= 0.0).tolist() if i < j}


@given(seeds, st.integers(1, 100))
def test_a_curve_fills_space_by_digits_of_both_sides(seed, count):
    """The order of numbers made of the bits of x, y and z in turn (Morton 1966)."""
    places = np.random.default_rng(seed).integers(0, 1024, (3, count)).astype(np.float64)
    places[:, 0], places[:, -1] = 0.0, 1023.0
    bits = list(itertools.product(range(10), range(3)))
    codes = [sum((int(place[axis]) >> bit & 1) << (3 * bit + axis) for bit, axis in bits) for place in places.T]
    if count == 1:
        codes = [0]
    assert [codes[i] for i in morton_order(places)] == sorted(codes)


# Triangles


def triangle_pairs(seed: int, count: int = 200) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of triangles of which half meet, (count, 3 corners, 3 axes) each."""
    rng = np.random.default_rng(seed)
    return rng.uniform(-1, 1, (count, 3, 3)), rng.uniform(-1, 1, (count, 3, 3)) + rng.uniform(-0.5, 0.5, (count, 1, 3))


def stacked(triangles: np.ndarray) -> np.ndarray:
    """Triangles as pairs of them are compared: (4, 3 axes, k)."""
    solid = Solid(triangles.reshape(-1, 3), np.arange(3 * len(triangles), dtype=np.int32).reshape(-1, 3))
    place = PlacedSolid(solid, np.eye(4))
    order = np.empty(len(triangles), dtype=np.intp)
    order[solid.order] = np.arange(len(triangles))
    return with_normals(place, order)


def pierce(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether an edge of a triangle runs through another (Möller and Trumbore 1997)."""
    a, b, c = other
    for i in range(3):
        start, way = one[i], one[(i + 1) % 3] - one[i]
        matrix = np.stack([b - a, c - a, -way], axis=1)
        s, t, along = np.linalg.solve(matrix, start - a)
        if s >= 0.0 and t >= 0.0 and s + t <= 1.0 and 0.0 <= along <= 1.0:
            return True
    return False


@settings(max_examples=property_tests.FEW)
@given(seeds)
def test_triangles_that_no_plane_parts_are_those_that_pierce_each_other(seed):
    one, other = triangle_pairs(seed)
    number = np.arange(len(one))
    kept = without_separating_axis(stacked(one), number, stacked(other), number, np.zeros(len(one)))[0]
    expected = [i for i in number if pierce(one[i], other[i]) or pierce(other[i], one[i])]
    assert kept.tolist() == expected


@given(seeds)
def test_triangles_have_unit_normals_and_edges(seed):
    one, _ = triangle_pairs(seed, 20)
    found = stacked(one)
    assert np.allclose(found[:3].transpose(2, 0, 1), one)
    normals = np.cross(one[:, 1] - one[:, 0], one[:, 2] - one[:, 0])
    assert np.allclose(found[3].T, normals / np.linalg.norm(normals, axis=1, keepdims=True), atol=1e-9)
    edges = edge_directions(found.swapaxes(0, 1)).transpose(2, 1, 0)
    ways = np.roll(one, -1, axis=1) - one
    assert np.allclose(edges, ways / np.linalg.norm(ways, axis=2, keepdims=True))


def common_area(one: np.ndarray, other: np.ndarray) -> float:
    """Area of what two triangles in a plane share, (3, 2) each: the hull of corners within and of edges' crossings."""
    corners = []
    for p, q in ((one, other), (other, one)):
        turns = [np.sign(np.linalg.det([q[(k + 1) % 3] - q[k], p[i] - q[k]])) for i in range(3) for k in range(3)]
        corners += [p[i] for i in range(3) if len(set(turns[3 * i : 3 * i + 3])) == 1]
    for i, j in itertools.product(range(3), repeat=2):
        way, across = one[(i + 1) % 3] - one[i], other[(j + 1) % 3] - other[j]
        s, t = np.linalg.solve(np.stack([way, -across], axis=1), other[j] - one[i])
        if 0.0 <= s <= 1.0 and 0.0 <= t <= 1.0:
            corners.append(one[i] + s * way)
    if len(corners) < 3:
        return 0.0
    around = np.array(corners) - np.mean(corners, axis=0)
    x, y = around[np.argsort(np.arctan2(around[:, 1], around[:, 0]))].T
    return 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


@settings(max_examples=property_tests.FEW)
@given(seeds)
def test_what_of_a_triangle_lies_above_another_has_the_area_of_what_both_share_in_a_plane(seed):
    """Seen along z: any triangle above or below one in the plane z = 0; heights are those of the corners of the part."""
    one, other = triangle_pairs(seed, 40)
    other[:, :, 2] = 0.0
    heights, area = clip_to_prism(stacked(one).swapaxes(0, 1), stacked(other).swapaxes(0, 1))
    expected = [common_area(p[:, :2], q[:, :2]) for p, q in zip(one, other)]
    assert np.allclose(area, expected, atol=1e-9)
    up = np.sign(np.linalg.det(other[:, 1:, :2] - other[:, :1, :2]))
    for i in np.flatnonzero(np.array(expected) > 1e-6):
        assert one[i, :, 2].min() - 1e-9 <= (up[i] * heights[:, i]).min()
        assert (up[i] * heights[:, i]).max() <= one[i, :, 2].max() + 1e-9


# Planes


def in_a_plane(seed: int, count: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of triangles in the plane z = 0, of which half share some of it and none by less than a thousandth."""
    one, other = triangle_pairs(seed, count)
    one[:, :, 2] = other[:, :, 2] = 0.0
    areas = [common_area(p[:, :2], q[:, :2]) for p, q in zip(one, other)]
    clear = [area == 0.0 or area > 1e-3 for area in areas]
    return one[clear], other[clear]


@settings(max_examples=property_tests.FEW)
@given(seeds, st.sampled_from((1e-6, 1e-4)), st.sampled_from((0.0, 0.5, 2.0)))
def test_triangles_share_a_plane_where_they_overlap_in_it_within_the_tolerance(seed, tolerance, height):
    one, other = in_a_plane(seed)
    expected = [common_area(p[:, :2], q[:, :2]) > 0.0 and height <= 1.0 for p, q in zip(one, other)]
    other[:, :, 2] += height * tolerance
    number = np.arange(len(one))
    found = share_a_plane(stacked(one), number, stacked(other), number, np.full(len(one), tolerance))
    assert found.tolist() == expected


@given(seeds)
def test_pairs_are_parallel_where_the_angle_between_them_is_small(seed):
    rng = np.random.default_rng(seed)
    one, _ = triangle_pairs(seed, 60)
    angles = rng.uniform(0.0, 0.1, len(one))
    axes = (one[:, 1] - one[:, 0]) / np.linalg.norm(one[:, 1] - one[:, 0], axis=1, keepdims=True)
    offset = one - one[:, :1]
    along = np.einsum("kcx,kx->kc", offset, axes)[..., None] * axes[:, None]
    turned = along + np.cos(angles)[:, None, None] * (offset - along)
    turned += np.sin(angles)[:, None, None] * np.cross(axes[:, None], offset)
    turned = turned[:, [0, 2, 1]] if rng.random() < 0.5 else turned
    number = np.arange(len(one))
    found, _, cosine, left = parallel_pairs(stacked(one), number, stacked(turned), number, angles)
    assume(np.all(np.abs(np.cos(angles) - LEAST_COSINE) > 1e-9))
    assert found.tolist() == np.flatnonzero(np.cos(angles) >= LEAST_COSINE).tolist()
    assert np.allclose(np.abs(cosine), np.cos(angles[found]), atol=1e-9) and np.array_equal(left, angles[found])


@settings(max_examples=property_tests.FEW)
@given(seeds)
def test_a_triangle_lies_on_others_as_a_whole_where_they_hold_its_corners_and_centre(seed):
    one, other = in_a_plane(seed, 9)
    i, j = (each.ravel() for each in np.indices((len(one), len(other))))
    shared = np.array([common_area(one[a][:, :2], other[b][:, :2]) > 0.0 for a, b in zip(i, j)])
    a, b = stacked(one), stacked(other)
    cosine = np.einsum("xk,xk->k", a[3][:, i], b[3][:, j])
    found, signs, whole = coincident_triangles(a, i, b, j, cosine, shared, np.full(len(i), 1e-9))
    corners = np.concatenate([one, one.mean(axis=1, keepdims=True)], axis=1)[:, :, :2]
    held = [all(any(holds(triangle[:, :2], place) for triangle in other) for place in places) for places in corners]
    touched = shared.reshape(len(one), -1).any(axis=1)
    assert found.tolist() == np.flatnonzero(touched | np.array(held)).tolist()
    assert whole.tolist() == np.array(held)[found].tolist() and set(signs.tolist()) <= {-1, 1}


def holds(triangle: np.ndarray, place: np.ndarray) -> bool:
    """Whether a triangle holds a point of its plane, (3, 2) and (2,), by barycentric coordinates (Möbius 1827)."""
    u, v = np.linalg.solve(
        np.stack([triangle[1] - triangle[0], triangle[2] - triangle[0]], axis=1), place - triangle[0]
    )
    return bool(u >= 0.0 and v >= 0.0 and u + v <= 1.0)


@given(st.lists(st.tuples(points, sizes, st.integers(1, 4)), min_size=1, max_size=3), seeds)
def test_flat_sides_of_boxes_are_six_however_they_are_divided(some, seed):
    whole = joined(*(grid_box(corner, corner + size, cells) for corner, size, cells in some))
    order = np.random.default_rng(seed).permutation(len(whole.triangles))
    sides = flat_sides(Solid(whole.vertices, whole.triangles[order]))
    expected = Counter(2 * cells * cells for _, _, cells in some for _ in range(6))
    assert Counter(np.unique(sides, return_counts=True)[1].tolist()) == expected
