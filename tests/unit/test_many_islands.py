"""Many small bodies at once are what each is alone."""

import bpy  # noqa: F401  mathutils comes with it
import numpy as np
import pytest
from solids import at, grid_box, icosphere, inverted, joined, random_matrix, same, winding

from nested_dielectric.geometry import contacts
from nested_dielectric.geometry.contacts import PairCache, analyse
from nested_dielectric.geometry.pairs import relate_pairs
from nested_dielectric.geometry.self_overlap import aligning_frame, near_islands
from nested_dielectric.geometry.solids import Body, PlacedSolid, Solid
from nested_dielectric.geometry.surfaces import JoinedSurfaces
from nested_dielectric.geometry.winding import winding_numbers


def random_scene(rng: np.random.Generator) -> list[Body]:
    shapes = [icosphere(2), icosphere(1), grid_box((-1, -1, -1), (1, 1, 1), 3)]
    priorities = rng.integers(1, 4, 12)
    return [Body(shapes[rng.integers(3)], random_matrix(rng, 2.0), int(p), int(p)) for p in priorities]


@pytest.mark.parametrize("seed", range(5))
def test_a_memory_changes_no_answer(seed):
    rng = np.random.default_rng(seed)
    bodies, memory = random_scene(rng), PairCache()
    for _ in range(8):
        kept, fresh = analyse(bodies, memory), analyse(bodies)
        assert all(same(a, b) for a, b in zip(kept, fresh, strict=True))
        move = int(rng.integers(len(bodies)))
        body = bodies[move]
        if rng.random() < 0.3:
            bodies[move] = Body(body.solid, body.matrix, int(rng.integers(1, 4)), 0)
        elif rng.random() < 0.2:
            del bodies[move]
        else:
            bodies[move] = Body(body.solid, random_matrix(rng, 2.0), body.priority, body.medium)


def test_only_the_pairs_of_what_moved_are_looked_at_again(monkeypatch):
    sphere = icosphere()
    bodies = [Body(sphere, at(1.5 * i), 1 + i % 3, i) for i in range(10)]
    memory = PairCache()
    compared = []

    def compare(pairs, original=relate_pairs):
        compared.append(len(pairs))
        return original(pairs)

    monkeypatch.setattr(contacts, "relate_pairs", compare)
    analyse(bodies, memory)
    analyse(bodies, memory)
    for place in ((6.0, 0.1), (0.0, 100.0)):
        bodies[4] = Body(sphere, at(*place), 2, 4)
        analyse(bodies, memory)
    assert compared == [9, 0, 2, 0]


@pytest.mark.parametrize("seed", range(6))
def test_many_pairs_at_once_are_what_each_is_alone(seed):
    rng = np.random.default_rng(seed)
    shapes = [icosphere(1), icosphere(2), grid_box((-1, -1, -1), (1, 1, 1), 2)]
    shapes += [joined(icosphere(1, 0.5, (-0.7, 0, 0)), icosphere(1, 0.5, (0.7, 0, 0)))]
    shapes += [joined(icosphere(1), inverted(icosphere(1, 0.6)))]
    places = [PlacedSolid(shapes[rng.integers(5)], random_matrix(rng, 1.5)) for _ in range(9)]
    places += [PlacedSolid(places[0].solid, places[0].matrix)]
    pairs = [(places[i], places[j]) for i in range(10) for j in range(i)]
    for (one, two), pair in zip(relate_pairs(pairs), pairs, strict=True):
        for side, alone in zip((one, two), relate_pairs([pair])[0]):
            for name in ("is_inside", "crosses", "coincident", "signs", "whole"):
                assert np.array_equal(getattr(side, name), getattr(alone, name))


def fibres(count: int, axis=(0.3, -0.5, 0.8), radius: float = 0.3, seed: int | None = None) -> list[Solid]:
    """Long prisms side by side in a square, all along one axis; with a seed, each anywhere and along its own."""
    rng = np.random.default_rng(seed)
    across = int(np.ceil(count**0.5))
    angle = np.arange(6) * np.pi / 3.0
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1) * radius / across
    points = np.concatenate([np.c_[ring, -np.ones(6)], np.c_[ring, np.ones(6)], [[0, 0, -1], [0, 0, 1]]])
    i, j = np.arange(6), np.roll(np.arange(6), -1)
    sides = [(i, j, 6 + j), (i, 6 + j, 6 + i), (j, i, i * 0 + 12), (6 + i, 6 + j, i * 0 + 13)]
    triangles = np.concatenate([np.stack(side, axis=1) for side in sides]).astype(np.int32)
    result = []
    for number in range(count):
        along = np.array(axis) if seed is None else rng.normal(size=3)
        turn = frame_along(along)
        place = np.array([number % across, number // across, 0]) / across if seed is None else rng.uniform(-1, 1, 3)
        vertices = (points + place) @ turn if seed is None else points @ turn + place
        result.append(Solid(vertices, triangles))
    return result


def frame_along(axis) -> np.ndarray:
    """(3, 3) rows of which the last points along an axis."""
    first = np.cross(axis, (0.1, 0.7, 0.3))
    rows = np.array([first, np.cross(axis, first), axis])
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def test_fibres_side_by_side_do_not_overlap_and_one_across_them_does():
    apart = fibres(200)
    assert joined(*apart).overlaps_itself is False
    middle = apart[77].vertices.mean(axis=0)
    across = fibres(1, axis=(1.0, 0.4, 0.2), radius=0.01)[0]
    assert joined(*apart, Solid(across.vertices + middle, across.triangles)).overlaps_itself is True
    bead = icosphere(1, 0.001, tuple(middle))
    assert joined(*apart, bead).overlaps_itself is True
    assert joined(*apart, inverted(bead)).overlaps_itself is False  # a bubble


@pytest.mark.parametrize("seed", [None, 1])
def test_few_pairs_of_many_long_islands_are_looked_at(seed):
    """Boxes along the axes would leave about all pairs."""
    place = PlacedSolid(joined(*fibres(400, radius=0.3 if seed is None else 0.02, seed=seed)), np.eye(4))
    if seed is None:
        place = PlacedSolid(place.solid, aligning_frame(place))
    tolerance = np.full(400, 1e-6)
    first, second = near_islands(place, tolerance)
    assert len(first) < (4 if seed is None else 20) * 400
    assert (first < second).all() and len(set(zip(first.tolist(), second.tolist()))) == len(first)


@pytest.mark.parametrize("seed", range(3))
def test_boxes_of_islands_leave_out_no_pair_that_touches(seed):
    solids = fibres(40, radius=0.4, seed=seed)
    place = PlacedSolid(joined(*solids), np.eye(4))
    pairs = set(zip(*(index.tolist() for index in near_islands(place, np.full(40, 1e-5)))))
    island = place.islands[np.argsort(place.solid.order)].reshape(40, -1)[:, 0].tolist()
    touching = 0
    for i in range(40):
        for j in range(i):
            sides = relate_pairs([(PlacedSolid(solids[i], np.eye(4)), PlacedSolid(solids[j], np.eye(4)))])
            if sides[0][0].crosses:
                touching += 1
                assert tuple(sorted((island[i], island[j]))) in pairs
    assert touching > 10


def test_winding_numbers_of_many_islands_are_those_by_solid_angles():
    solid = joined(*fibres(80, radius=0.45, seed=4), icosphere(1, 0.7), inverted(icosphere(1, 0.2)))
    points = np.random.default_rng(5).uniform(-0.8, 0.8, (300, 3))
    place = PlacedSolid(solid, np.eye(4))
    expected = winding(points, solid.vertices[solid.triangles])
    assert set(expected) >= {0, 1, 2}
    assert np.array_equal(winding_numbers(points, place), expected)
    crowd = JoinedSurfaces([PlacedSolid(icosphere(2), at(5.0)), place])
    assert np.array_equal(winding_numbers(points, crowd, np.ones(300, dtype=int)), expected)
