"""Meshes of closed bodies: winding numbers, parts, flat sides and walls."""

import bpy  # noqa: F401  mathutils comes with it
import numpy as np
import pytest
from solids import at, grid_box, icosphere, inverted, joined, placed, random_matrix, torus, winding

from nested_dielectric.geometry import meshes
from nested_dielectric.geometry.contacts import analyse
from nested_dielectric.geometry.coplanar import flat_sides
from nested_dielectric.geometry.pairs import overlapping_boxes
from nested_dielectric.geometry.resting import resting_surfaces
from nested_dielectric.geometry.solids import Body, PlacedSolid, Solid
from nested_dielectric.geometry.walls import Walls
from nested_dielectric.geometry.winding import winding_numbers


def test_boxes_are_paired_as_by_comparing_all():
    rng = np.random.default_rng(1)
    low = rng.random((3, 300))
    high = low + 0.2 * rng.random((3, 300))
    first, second = overlapping_boxes(low, high, 0.0)
    meet = np.all((low[:, :, None] <= high[:, None]) & (low[:, None] <= high[:, :, None]), axis=0)
    expected = {(i, j) for i, j in zip(*np.nonzero(meet)) if i < j}
    assert {(min(i, j), max(i, j)) for i, j in zip(first.tolist(), second.tolist())} == expected
    assert len(first) == len(expected)


def test_winding_numbers_by_crossings_are_those_by_solid_angles():
    rng = np.random.default_rng(2)
    solid = joined(torus(), icosphere(2, 0.5, (1.0, 0.2, 0.1)), inverted(icosphere(1, 0.2, (1.0, 0.1, 0.1))))
    place = PlacedSolid(solid, np.eye(4))
    points = rng.uniform(-1.5, 1.5, (400, 3))
    assert np.array_equal(winding_numbers(points, place), winding(points, placed(Body(solid, at(), 1, 1))))
    assert np.array_equal(winding_numbers(points[:5], place), winding(points[:5], solid.vertices[solid.triangles]))


def test_winding_numbers_are_exact_above_vertices_and_edges():
    box = grid_box((-1, -1, -1), (1, 1, 1), 4)
    place = PlacedSolid(box, np.eye(4))
    steps = np.linspace(-1.0, 1.0, 9)
    points = np.array([(x, y, 0.1) for x in steps[1:-1] for y in steps[1:-1]])
    assert (winding_numbers(points, place) == 1).all()
    assert (winding_numbers(points + np.array((2.0, 0.0, 0.0)), place)[points[:, 0] > 0.0] == 0).all()


def test_closed_meshes_are_told_from_open_ones():
    sphere = icosphere(2)
    assert meshes.is_closed(sphere.triangles)
    for face in range(0, len(sphere.triangles), 7):
        assert not meshes.is_closed(np.delete(sphere.triangles, face, axis=0))
        turned = sphere.triangles.copy()
        turned[face] = turned[face, ::-1]
        assert not meshes.is_closed(turned)


def test_connected_components_are_those_of_a_search():
    rng = np.random.default_rng(3)
    a, b = rng.integers(0, 200, (2, 150))
    root = meshes.connected(200, a, b)
    expected = np.arange(200)
    for _ in range(200):
        for i, j in zip(a, b):
            expected[i] = expected[j] = min(expected[i], expected[j])
    assert np.array_equal(root == root[:, None], expected == expected[:, None])


def on_surface(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(k, m) whether points lie on triangles, by comparing all with all."""
    a, b, c = triangles.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    on = np.abs(np.einsum("kmx,mx->km", points[:, None] - a, normal)) < 1e-6
    for u, v in ((a, b), (b, c), (c, a)):
        on &= np.einsum("kmx,mx->km", points[:, None] - u, np.cross(normal, v - u)) > -1e-9
    return on


@pytest.mark.parametrize("seed", range(12))
def test_faces_that_share_part_of_a_plane_are_those_that_samples_find(seed):
    """Boxes on a lattice, all turned and moved alike, so that many faces lie partly in one plane, few wholly."""
    rng = np.random.default_rng(seed)
    turn = random_matrix(rng, 2.0)
    bodies = []
    for number in range(4):
        low = rng.integers(0, 4, 3)
        high = low + rng.integers(1, 4, 3)
        bodies.append(Body(grid_box(low, high, int(rng.integers(1, 3))), turn, number, number))
    weights = rng.dirichlet((1.0, 1.0, 1.0), 400)
    for index, contact in enumerate(analyse(bodies)):
        own = placed(bodies[index])
        normals = np.cross(own[:, 1] - own[:, 0], own[:, 2] - own[:, 0])
        for other, body in enumerate(bodies):
            if other == index:
                continue
            theirs = placed(body)
            their_normals = np.cross(theirs[:, 1] - theirs[:, 0], theirs[:, 2] - theirs[:, 0])
            parallel = np.linalg.norm(np.cross(normals[:, None], their_normals[None]), axis=2) < 1e-9
            expected, signs, whole = [], [], []
            for face, triangle in enumerate(own):
                on = on_surface(weights @ triangle, theirs) & parallel[face]
                if on.any():
                    expected.append(face)
                    signs.append(np.sign(normals[face] @ their_normals[on.any(axis=0)][0]))
                    whole.append(on.any(axis=1).all())
            found = [facts[1:] for facts in contact.coincident if facts[0] == other]
            order = np.argsort(found[0][0]) if found else []
            assert (found[0][0][order].tolist() if found else []) == expected
            if found:
                assert found[0][1][order].tolist() == signs
                assert found[0][2][order].tolist() == whole


def test_boxes_that_only_share_an_edge_coincide_nowhere():
    """Their tops lie in one plane, but side by side."""
    bodies = [Body(grid_box((0, 0, 0), (1, 1, 1), 2), at(x, y), i, i) for i, (x, y) in enumerate([(0, 0), (1, 1)])]
    assert all(contact.coincident == () for contact in analyse(bodies))


def test_flat_sides_are_those_of_a_box():
    sides = flat_sides(grid_box((0, 0, 0), (3, 2, 1), 4))
    assert sorted(np.unique(sides, return_counts=True)[1].tolist()) == [32] * 6
    assert len(set(flat_sides(icosphere(2)).tolist())) == 320


@pytest.mark.parametrize("cells", [1, 3])
def test_a_wall_is_as_far_as_it_is_and_a_rim_is_none(cells):
    turn = random_matrix(np.random.default_rng(3), 1.0)
    turn[:3, :3] /= np.cbrt(np.abs(np.linalg.det(turn[:3, :3])))
    turn[:3, :3] = np.linalg.qr(turn[:3, :3])[0]
    pane = grid_box((-1, -1, -0.003), (1, 1, 0), cells)
    block = grid_box((-0.7, -0.6, 0), (1.2, 0.7, 1), cells)
    bodies = [Body(pane, turn, 1, 1), Body(block, turn, 2, 2)]

    def clearance(index: int, side: float, height: float) -> float:
        flat = np.isclose(bodies[index].solid.vertices[bodies[index].solid.triangles][:, :, 2], height).all(axis=1)
        faces = np.flatnonzero(flat)
        return Walls(bodies).clearance(index, faces, np.full(len(faces), side), 0.01)

    assert clearance(1, 1.0, 0.0) == pytest.approx(0.003, rel=1e-3)  # down through the pane
    assert clearance(0, -1.0, 0.0) == pytest.approx(0.003, rel=1e-3)  # the pane's own other side
    assert clearance(0, 1.0, 0.0) == 0.01  # up into the block
    assert clearance(1, -1.0, 0.0) == 0.01


@pytest.mark.parametrize(
    ("shift", "answer"), [((0.0, 0.0), True), ((1.9, 0.3), True), ((2.1, 0.0), False), ((0.0, 0.0, 1e-3), False)]
)
def test_what_rests_on_part_of_a_foreign_plane_is_found(shift, answer):
    turn = at(*shift)
    table = grid_box((-1, -1, -1), (1, 1, 0), 3)
    top = Solid(table.vertices, table.triangles[(table.vertices[table.triangles][:, :, 2] == 0.0).all(axis=1)])
    glass = placed(Body(grid_box((-1, -1, 0), (1, 1, 2), 2), turn, 1, 1)).reshape(-1, 3)
    standing = Solid(glass, np.arange(len(glass), dtype=np.int32).reshape(-1, 3))
    far = Solid(glass + 9.0, standing.triangles)
    places = [PlacedSolid(solid, np.eye(4)) for solid in (far, standing)]
    found = resting_surfaces(places, top)
    assert list(found) == ([1] if answer else [])
    for faces in found.values():
        assert (np.abs(glass.reshape(-1, 3, 3)[faces][:, :, 2]) < 1e-9).all()
