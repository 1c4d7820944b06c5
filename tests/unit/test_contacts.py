"""Which media touch which: the analysis against brute force and against scenes with a known answer."""

import bpy  # noqa: F401  mathutils comes with it
import numpy as np
import pytest
from mathutils import Matrix
from solids import at, grid_box, icosphere, inverted, joined, placed, random_matrix, same, torus, winding

from nested_dielectric.geometry.contacts import analyse
from nested_dielectric.geometry.solids import Body, Solid
from nested_dielectric.model.contract import Exterior

# Face centres nearer than this to another surface may be told either way by the brute force.
OUTSIDE = 1e-6


def just_outside(body: Body) -> np.ndarray:
    """Points all over each face; (m, points, 3)."""
    own = placed(body)
    normals = np.cross(own[:, 1] - own[:, 0], own[:, 2] - own[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    weights = np.array([[0.9, 0.05, 0.05], [0.05, 0.9, 0.05], [0.05, 0.05, 0.9]])
    return np.einsum("pc,mcx->mpx", weights, own) + OUTSIDE * normals[:, None]


def brute_force(bodies: list[Body], index: int) -> tuple[np.ndarray, np.ndarray]:
    """For points all over each face, just outside: codes and media; (m, points)."""
    points = just_outside(bodies[index]).reshape(-1, 3)
    best = np.full(len(points), np.inf)
    medium = np.full(len(points), -1)
    for j, body in enumerate(bodies):
        if j == index:
            continue
        wins = (winding(points, placed(body)) >= 1) & (body.priority < best)
        best[wins], medium[wins] = body.priority, body.medium
    codes = np.where(
        best <= bodies[index].priority, Exterior.WINNER, np.where(np.isinf(best), Exterior.AIR, Exterior.MEDIUM)
    )
    count = len(bodies[index].solid.triangles)
    return codes.reshape(count, -1), medium.reshape(count, -1)


def assert_true(bodies: list[Body], found: list) -> None:
    """What is said of a body is what brute force finds on all of it."""
    for index, (body, contact) in enumerate(zip(bodies, found)):
        codes, media = brute_force(bodies, index)
        if contact.code != Exterior.UNKNOWN:
            assert (codes == contact.code).all()
        if contact.surrounding_body is not None:
            assert (media == bodies[contact.surrounding_body].medium).all()
        if contact.sole_priority is not None:
            points = just_outside(body).reshape(-1, 3)
            for j, other in enumerate(bodies):
                if j != index and other.priority != contact.sole_priority:
                    assert (winding(points, placed(other)) == 0).all()


def test_a_body_alone_is_in_air():
    (contact,) = analyse([Body(icosphere(), at(), 3, "water")])
    assert (contact.code, contact.partners, contact.sole_priority, contact.overlaps_itself) == (
        Exterior.AIR,
        (),
        None,
        False,
    )


def test_nested_spheres_know_the_medium_around_them():
    sphere = icosphere()
    bodies = [Body(sphere, at(scale=s), p, f"m{p}") for s, p in ((4.0, 5), (2.0, 3), (1.0, 1), (3.0, 4))]
    found = analyse(bodies)
    assert [c.code for c in found] == [Exterior.AIR, Exterior.MEDIUM, Exterior.MEDIUM, Exterior.MEDIUM]
    assert [c.surrounding_body for c in found] == [None, 3, 1, 0]
    assert found[2].partners == (0, 1, 3)


def test_a_sphere_inside_a_stronger_or_equal_one_never_exists():
    sphere = icosphere()
    for inner in (2, 3):
        outer, inside = analyse([Body(sphere, at(scale=2.0), 2, 0), Body(sphere, at(), inner, 0)])
        assert (outer.code, inside.code) == (Exterior.AIR, Exterior.WINNER)


def test_a_mirrored_body_holds_what_it_surrounds():
    sphere = icosphere()
    found = analyse([Body(sphere, at(scale=(-2.0, 2.0, 2.0)), 2, 0), Body(sphere, at(scale=(1, -1, 1)), 1, 1)])
    assert [c.code for c in found] == [Exterior.AIR, Exterior.MEDIUM]


@pytest.mark.parametrize("seed", range(30))
def test_codes_of_random_crossing_bodies_are_those_of_brute_force(seed):
    rng = np.random.default_rng(seed)
    shapes = [icosphere(2), icosphere(1), grid_box((-1, -1, -1), (1, 1, 1), 3)]
    shapes += [joined(icosphere(1, 0.4, (-0.8, 0, 0)), icosphere(1, 0.5, (0.7, 0, 0)))]
    shapes += [joined(icosphere(1, 1.0), inverted(icosphere(1, 0.6)))]
    count = int(rng.integers(2, 6))
    bodies = [
        Body(shapes[rng.integers(len(shapes))], random_matrix(rng, rng.choice([0.3, 1.0])), int(rng.integers(1, 4)), 0)
        for _ in range(count)
    ]
    bodies = [Body(b.solid, b.matrix, b.priority, b.priority) for b in bodies]
    found = analyse(bodies)
    assert_true(bodies, found)


def test_bodies_that_cross_are_left_to_rays():
    sphere = icosphere(3)
    bodies = [Body(sphere, at(), 1, 1), Body(sphere, at(1.0, 0.1, 0.2), 2, 2), Body(sphere, at(9.0), 3, 3)]
    found = analyse(bodies)
    assert [c.code for c in found] == [Exterior.UNKNOWN, Exterior.UNKNOWN, Exterior.AIR]
    assert [c.partners for c in found] == [(1,), (0,), ()]


@pytest.mark.parametrize("cells", [1, 5])
@pytest.mark.parametrize("turn", [0.0, 0.4])
def test_a_box_standing_on_a_bigger_one_coincides_with_it(cells, turn):
    floor = grid_box((-2, -2, -1), (2, 2, 0), cells)
    box = grid_box((-0.7, -0.6, 0), (0.5, 0.7, 1), 2)
    matrix = np.array(Matrix.Rotation(turn, 4, "Z"))
    bodies = [Body(floor, at(), 1, 1), Body(box, matrix, 2, 2)]
    found = analyse(bodies)
    other, faces, signs, whole = found[1].coincident[0]
    bottom = np.flatnonzero((placed(bodies[1])[:, :, 2] == 0.0).all(axis=1))
    assert other == 0
    assert sorted(faces) == sorted(bottom)
    assert (signs == -1).all() and whole.all()
    assert [c.code for c in found] == [Exterior.UNKNOWN, Exterior.UNKNOWN]
    assert_true(bodies, found)


def test_identical_spheres_coincide_everywhere():
    sphere = icosphere()
    copy = Solid(sphere.vertices.copy(), sphere.triangles.copy())
    turned = Solid(sphere.vertices, np.roll(sphere.triangles[::-1], 1, axis=1))
    for other in (sphere, copy, turned):
        found = analyse([Body(sphere, at(1, 2, 3), 1, 1), Body(other, at(1, 2, 3), 2, 2)])
        for index, contact in enumerate(found):
            ((partner, faces, signs, whole),) = contact.coincident
            assert (contact.code, partner) == (Exterior.UNKNOWN, 1 - index)
            assert sorted(faces) == list(range(len(sphere.triangles)))
            assert (signs == 1).all() and whole.all()


def test_surfaces_that_share_a_part_of_a_side_are_left_to_rays():
    bodies = [
        Body(grid_box((0, 0, 0), (1, 1, 1), 3), at(), 1, 1),
        Body(grid_box((0, 0.2, 0.3), (2, 0.9, 0.8), 3), at(), 2, 2),
        Body(grid_box((1, 0, 0), (2, 1, 1), 4), at(0, 0.31, 0.17), 3, 3),
    ]
    found = analyse(bodies)
    assert all(contact.coincident for contact in found)
    assert_true(bodies, found)


@pytest.mark.parametrize("broken", ["open", "inverted", "not a number"])
def test_one_body_in_doubt_leaves_all_to_rays(broken):
    sphere = icosphere()
    odd = sphere
    if broken == "open":
        odd = Solid(sphere.vertices, sphere.triangles[1:])
    if broken == "inverted":
        odd = inverted(sphere)
    if broken == "not a number":
        odd = Solid(np.where(np.arange(len(sphere.vertices))[:, None] == 3, np.nan, sphere.vertices), sphere.triangles)
    bodies = [Body(sphere, at(), 1, 1), Body(odd, at(9.0), 2, 2)]
    assert not odd.closed
    assert [(c.code, c.sole_priority, c.partners) for c in analyse(bodies)] == [(Exterior.UNKNOWN, None, ())] * 2


def test_bodies_of_equal_priority_fuse():
    sphere = icosphere(2)
    bodies = [Body(sphere, at(), 2, 0), Body(sphere, at(1.1), 2, 0)]
    found = analyse(bodies)
    assert [(c.code, c.sole_priority) for c in found] == [(Exterior.UNKNOWN, 2)] * 2
    assert_true(bodies, found)


def test_equally_strong_surroundings_of_different_media_are_left_to_rays():
    sphere = icosphere()
    around = [Body(sphere, at(0.1 * i, scale=3.0), 5, medium) for i, medium in enumerate("ab")]
    inner = Body(sphere, at(), 1, "c")
    assert analyse([*around, inner])[2].code == Exterior.UNKNOWN
    same = [Body(sphere, at(0.1 * i, scale=3.0), 5, "a") for i in range(2)]
    contact = analyse([*same, inner])[2]
    assert contact.code == Exterior.MEDIUM and contact.surrounding_body in (0, 1)


def test_a_surrounding_medium_may_cross_the_body_elsewhere():
    """With another body of the same medium; one of another medium, or that wins over it, is asked for."""
    sphere = icosphere()
    inner, around = Body(sphere, at(), 1, "c"), Body(sphere, at(scale=3.0), 5, "a")
    for priority, medium, code in (
        (5, "a", Exterior.MEDIUM),
        (5, "b", Exterior.UNKNOWN),
        (4, "a", Exterior.UNKNOWN),
        (0, "a", Exterior.UNKNOWN),
        (6, "b", Exterior.MEDIUM),
    ):
        assert analyse([around, Body(sphere, at(1.0), priority, medium), inner])[2].code == code


def test_a_stronger_holder_decides_where_weaker_surfaces_cross():
    sphere = icosphere()
    bodies = [Body(sphere, at(scale=3.0), 1, 1), Body(sphere, at(), 2, 2), Body(sphere, at(1.0), 3, 3)]
    assert [c.code for c in analyse(bodies)] == [Exterior.AIR, Exterior.WINNER, Exterior.WINNER]


def test_a_mesh_whose_islands_lie_in_different_media_is_left_to_rays():
    droplets = joined(*(icosphere(1, 0.3, (x, 0, 0)) for x in range(5)))
    bodies = [Body(droplets, at(), 2, 2), Body(icosphere(2), at(2.0, scale=0.6), 1, 1)]
    assert not droplets.overlaps_itself
    found = analyse(bodies)
    assert (found[0].code, found[1].code) == (Exterior.UNKNOWN, Exterior.AIR)
    assert_true(bodies, found)
    bodies[1] = Body(icosphere(2), at(2.0, scale=4.0), 1, 1)
    assert analyse(bodies)[0].code == Exterior.WINNER


def test_a_cavity_is_outside_of_its_body():
    hollow = joined(icosphere(2), inverted(icosphere(2, 0.6)))
    assert hollow.closed and not hollow.overlaps_itself
    bodies = [Body(hollow, at(), 1, 1), Body(icosphere(), at(scale=0.3), 2, 2)]
    assert [c.code for c in analyse(bodies)] == [Exterior.AIR, Exterior.AIR]
    filled = [Body(hollow, at(), 1, 1), Body(icosphere(), at(scale=0.8), 2, 2)]
    found = analyse(filled)
    assert (found[0].code, found[0].sole_priority, found[1].code) == (Exterior.UNKNOWN, 2, Exterior.WINNER)
    assert_true(filled, found)


@pytest.mark.parametrize(
    ("solid", "answer"),
    [
        (icosphere(3), False),
        (torus(), False),
        (torus(minor=1.4, wobble=0.02), True),
        (joined(icosphere(2), icosphere(2, 1.0, (1.0, 0.1, 0.2))), True),
        (joined(icosphere(2), icosphere(2, 0.5)), True),
        (joined(icosphere(2), inverted(icosphere(2, 0.5)), icosphere(1, 0.2)), False),
        (joined(icosphere(2), inverted(icosphere(2, 0.5)), inverted(icosphere(1, 0.2))), True),
        (joined(icosphere(2), inverted(icosphere(2, 0.5, (3.0, 0, 0)))), True),
        (joined(icosphere(2), icosphere(2)), True),
        (grid_box((-1, -1, -1), (1, 1, 1), 6), False),
    ],
)
def test_a_mesh_overlaps_itself_where_it_is_wound_twice(solid, answer):
    assert solid.closed
    assert solid.overlaps_itself is answer


def test_a_body_that_overlaps_itself_is_left_to_rays():
    double = joined(icosphere(2), icosphere(2, 1.0, (1.0, 0.1, 0.2)))
    found = analyse([Body(double, at(), 1, 1), Body(icosphere(), at(-0.5, scale=0.2), 2, 2)])
    assert (found[0].code, found[0].overlaps_itself) == (Exterior.UNKNOWN, True)
    assert (found[1].code, found[1].overlaps_itself) == (Exterior.WINNER, False)


def test_a_body_scaled_to_nothing_concerns_nobody():
    sphere = icosphere()
    found = analyse([Body(sphere, at(scale=0.0), 1, 1), Body(sphere, at(scale=2.0), 2, 2)])
    assert found[0].overlaps_itself
    assert found[1].code == Exterior.AIR


def test_one_priority_decides_only_if_its_bodies_are_apart():
    sphere = icosphere()
    cube, one, two = (
        Body(sphere, at(), 2, 2),
        Body(sphere, at(1.2, scale=0.5), 1, 1),
        Body(sphere, at(-1.2, scale=0.5), 1, 1),
    )
    assert [c.sole_priority for c in analyse([cube, one, two])] == [1, 2, 2]
    touching = Body(sphere, at(1.8, scale=0.5), 1, 1)
    assert analyse([cube, one, two, touching])[0].sole_priority is None
    apart = [Body(sphere, at(9.0 + x), 1, 1) for x in (0.0, 0.5)]
    assert [c.sole_priority for c in analyse([cube, one, two, *apart])[:2]] == [None, 2]
    other = Body(sphere, at(0, 1.2, scale=0.5), 3, 3)
    assert analyse([cube, one, other])[0].sole_priority is None
    assert analyse([cube, Body(sphere, at(1.2), 2, 2)])[0].sole_priority == 2
    double = Body(joined(icosphere(1), icosphere(1, 1.0, (0.5, 0, 0))), at(9.0), 1, 1)
    assert analyse([cube, one, double])[0].sole_priority is None
    assert analyse([double, Body(sphere, at(9.0, 1.0), 2, 2)])[0].sole_priority is None


def test_far_from_the_origin_the_answer_is_the_same():
    sphere = icosphere(3)
    bodies = [Body(sphere, at(), 1, 1), Body(sphere, at(1.0, 0.1, 0.2), 2, 2)]
    moved = [Body(b.solid, at(300.0, -200.0, 100.0) @ b.matrix, b.priority, b.medium) for b in bodies]
    assert all(same(a, b) for a, b in zip(analyse(bodies), analyse(moved)))
