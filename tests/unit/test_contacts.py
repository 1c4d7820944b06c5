"""Which media touch which: the analysis against brute force and against scenes with a known answer."""

import bpy  # noqa: F401  mathutils comes with it
import numpy as np
import pytest
from mathutils import Matrix

from nested_dielectric.geometry import contacts, meshes
from nested_dielectric.geometry.contacts import AIR, MEDIUM, NEVER, PROBE, Body, Memory, Solid, analyse

pytestmark = pytest.mark.quick

# Face centres nearer than this to another surface may be told either way by the brute force.
OUTSIDE = 1e-6


def solid_angles(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Return the signed solid angles of triangles about the origin, positive where it lies on their inner side.

    Van Oosterom and Strackee 1983, The solid angle of a plane triangle. The sum over a closed mesh is 4 pi times its
    winding number (Jacobson, Kavan and Sorkine-Hornung 2013, Robust inside-outside segmentation).

    :param a: (n, 3) first corners; b, c: the others.
    :return: (n,) steradians.
    """
    la, lb, lc = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c))
    cosines = (np.einsum("ij,ij->i", u, v) for u, v in ((a, b), (b, c), (c, a)))
    ab, bc, ca = cosines
    return 2.0 * np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb)


def icosphere(subdivisions: int = 2, radius: float = 1.0, centre=(0.0, 0.0, 0.0)) -> Solid:
    phi = (1.0 + 5.0**0.5) / 2.0
    vertices = [(-1, phi, 0), (1, phi, 0), (-1, -phi, 0), (1, -phi, 0), (0, -1, phi), (0, 1, phi)]
    vertices += [(0, -1, -phi), (0, 1, -phi), (phi, 0, -1), (phi, 0, 1), (-phi, 0, -1), (-phi, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6)]
    faces += [(7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10)]
    faces += [(8, 6, 7), (9, 8, 1)]
    points, triangles = np.array(vertices, dtype=np.float64), np.array(faces)
    for _ in range(subdivisions):
        edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
        unique, index = np.unique(edges, axis=0, return_inverse=True)
        ab, bc, ca = len(points) + index.reshape(3, -1)
        points = np.concatenate([points, points[unique].mean(axis=1)])
        a, b, c = triangles.T
        triangles = np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    points *= radius / np.linalg.norm(points, axis=1, keepdims=True)
    return Solid(points + np.array(centre), triangles.astype(np.int32))


def grid_box(low, high, cells: int = 1) -> Solid:
    """A box whose sides are divided into cells * cells squares."""
    steps = np.arange(cells + 1)
    u, v = (t.ravel() for t in np.meshgrid(steps[:-1], steps[:-1], indexing="ij"))
    points, triangles = [], []
    for axis in range(3):
        for end in (0, cells):
            square = np.empty((len(u), 4, 3), dtype=np.int64)
            square[:, :, axis] = end
            square[:, :, (axis + 1) % 3] = np.stack([u, u + 1, u + 1, u], axis=1)
            square[:, :, (axis + 2) % 3] = np.stack([v, v, v + 1, v + 1], axis=1)
            if end == 0:
                square = square[:, ::-1]
            start = sum(len(p) for p in points)
            points.append(square.reshape(-1, 3))
            index = start + np.arange(4 * len(u)).reshape(-1, 4)
            triangles += [index[:, [0, 1, 2]], index[:, [0, 2, 3]]]
    unique, index = np.unique(np.concatenate(points), axis=0, return_inverse=True)
    low, high = np.array(low, dtype=np.float64), np.array(high, dtype=np.float64)
    return Solid(low + (high - low) * unique / cells, index[np.concatenate(triangles)].astype(np.int32))


def joined(*solids: Solid) -> Solid:
    offsets = np.cumsum([0] + [len(solid.vertices) for solid in solids])
    triangles = [solid.triangles + offset for solid, offset in zip(solids, offsets)]
    return Solid(np.concatenate([solid.vertices for solid in solids]), np.concatenate(triangles).astype(np.int32))


def inverted(solid: Solid) -> Solid:
    return Solid(solid.vertices, np.ascontiguousarray(solid.triangles[:, ::-1]))


def at(*place: float, scale=1.0) -> np.ndarray:
    matrix = np.diag(np.append(np.broadcast_to(scale, 3), 1.0).astype(np.float64))
    matrix[: len(place), 3] = place
    return matrix


def placed(body: Body) -> np.ndarray:
    """(m, 3, 3) triangles in the world, counterclockwise from outside."""
    points = body.solid.vertices @ body.matrix[:3, :3].T + body.matrix[:3, 3]
    triangles = body.solid.triangles
    return points[triangles[:, ::-1] if np.linalg.det(body.matrix[:3, :3]) < 0.0 else triangles]


def winding(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Winding numbers by solid angles of all triangles about all points."""
    result = []
    for some in np.array_split(points, max(1, len(points) * len(triangles) // 200_000)):
        corners = (triangles[None] - some[:, None, None]).reshape(-1, 3, 3).transpose(1, 0, 2)
        result.append(solid_angles(*corners).reshape(len(some), -1).sum(axis=1))
    return np.rint(np.concatenate(result) / (4.0 * np.pi)).astype(int)


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
    codes = np.where(best <= bodies[index].priority, NEVER, np.where(np.isinf(best), AIR, MEDIUM))
    count = len(bodies[index].solid.triangles)
    return codes.reshape(count, -1), medium.reshape(count, -1)


def assert_true(bodies: list[Body], found: list) -> None:
    """What is said of a body is what brute force finds on all of it."""
    for index, (body, contact) in enumerate(zip(bodies, found)):
        codes, media = brute_force(bodies, index)
        if contact.code != PROBE:
            assert (codes == contact.code).all()
        if contact.around is not None:
            assert (media == bodies[contact.around].medium).all()
        if contact.level is not None:
            points = just_outside(body).reshape(-1, 3)
            for j, other in enumerate(bodies):
                if j != index and other.priority != contact.level:
                    assert (winding(points, placed(other)) == 0).all()


def random_matrix(rng: np.random.Generator, spread: float) -> np.ndarray:
    linear = np.linalg.qr(rng.normal(size=(3, 3)))[0] @ np.diag(rng.uniform(0.3, 1.2, 3) * rng.choice([-1, 1], 3))
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, rng.uniform(-spread, spread, 3)
    return matrix


def test_a_body_alone_is_in_air():
    (contact,) = analyse([Body(icosphere(), at(), 3, "water")])
    assert (contact.code, contact.partners, contact.level, contact.robust) == (AIR, (), None, False)


def test_nested_spheres_know_the_medium_around_them():
    sphere = icosphere()
    bodies = [Body(sphere, at(scale=s), p, f"m{p}") for s, p in ((4.0, 5), (2.0, 3), (1.0, 1), (3.0, 4))]
    found = analyse(bodies)
    assert [c.code for c in found] == [AIR, MEDIUM, MEDIUM, MEDIUM]
    assert [c.around for c in found] == [None, 3, 1, 0]
    assert found[2].partners == (0, 1, 3)


def test_a_sphere_inside_a_stronger_or_equal_one_never_exists():
    sphere = icosphere()
    for inner in (2, 3):
        outer, inside = analyse([Body(sphere, at(scale=2.0), 2, 0), Body(sphere, at(), inner, 0)])
        assert (outer.code, inside.code) == (AIR, NEVER)


def test_a_mirrored_body_holds_what_it_surrounds():
    sphere = icosphere()
    found = analyse([Body(sphere, at(scale=(-2.0, 2.0, 2.0)), 2, 0), Body(sphere, at(scale=(1, -1, 1)), 1, 1)])
    assert [c.code for c in found] == [AIR, MEDIUM]


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
    assert [c.code for c in found] == [PROBE, PROBE, AIR]
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
    assert [c.code for c in found] == [PROBE, PROBE]
    assert_true(bodies, found)


def test_identical_spheres_coincide_everywhere():
    sphere = icosphere()
    copy = Solid(sphere.vertices.copy(), sphere.triangles.copy())
    turned = Solid(sphere.vertices, np.roll(sphere.triangles[::-1], 1, axis=1))
    for other in (sphere, copy, turned):
        found = analyse([Body(sphere, at(1, 2, 3), 1, 1), Body(other, at(1, 2, 3), 2, 2)])
        for index, contact in enumerate(found):
            ((partner, faces, signs, whole),) = contact.coincident
            assert (contact.code, partner) == (PROBE, 1 - index)
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
    assert [(c.code, c.level, c.partners) for c in analyse(bodies)] == [(PROBE, None, ())] * 2


def test_bodies_of_equal_priority_fuse():
    sphere = icosphere(2)
    bodies = [Body(sphere, at(), 2, 0), Body(sphere, at(1.1), 2, 0)]
    found = analyse(bodies)
    assert [(c.code, c.level) for c in found] == [(PROBE, 2)] * 2
    assert_true(bodies, found)


def test_equally_strong_surroundings_of_different_media_are_left_to_rays():
    sphere = icosphere()
    around = [Body(sphere, at(0.1 * i, scale=3.0), 5, medium) for i, medium in enumerate("ab")]
    inner = Body(sphere, at(), 1, "c")
    assert analyse([*around, inner])[2].code == PROBE
    same = [Body(sphere, at(0.1 * i, scale=3.0), 5, "a") for i in range(2)]
    contact = analyse([*same, inner])[2]
    assert contact.code == MEDIUM and contact.around in (0, 1)


def test_a_surrounding_medium_may_cross_the_body_elsewhere():
    """With another body of the same medium; one of another medium, or that wins over it, is asked for."""
    sphere = icosphere()
    inner, around = Body(sphere, at(), 1, "c"), Body(sphere, at(scale=3.0), 5, "a")
    for priority, medium, code in (
        (5, "a", MEDIUM),
        (5, "b", PROBE),
        (4, "a", PROBE),
        (0, "a", PROBE),
        (6, "b", MEDIUM),
    ):
        assert analyse([around, Body(sphere, at(1.0), priority, medium), inner])[2].code == code


def test_a_stronger_holder_decides_where_weaker_surfaces_cross():
    sphere = icosphere()
    bodies = [Body(sphere, at(scale=3.0), 1, 1), Body(sphere, at(), 2, 2), Body(sphere, at(1.0), 3, 3)]
    assert [c.code for c in analyse(bodies)] == [AIR, NEVER, NEVER]


def test_a_mesh_whose_islands_lie_in_different_media_is_left_to_rays():
    droplets = joined(*(icosphere(1, 0.3, (x, 0, 0)) for x in range(5)))
    bodies = [Body(droplets, at(), 2, 2), Body(icosphere(2), at(2.0, scale=0.6), 1, 1)]
    assert not droplets.overlaps_itself
    found = analyse(bodies)
    assert (found[0].code, found[1].code) == (PROBE, AIR)
    assert_true(bodies, found)
    bodies[1] = Body(icosphere(2), at(2.0, scale=4.0), 1, 1)
    assert analyse(bodies)[0].code == NEVER


def test_a_cavity_is_outside_of_its_body():
    hollow = joined(icosphere(2), inverted(icosphere(2, 0.6)))
    assert hollow.closed and not hollow.overlaps_itself
    bodies = [Body(hollow, at(), 1, 1), Body(icosphere(), at(scale=0.3), 2, 2)]
    assert [c.code for c in analyse(bodies)] == [AIR, AIR]
    filled = [Body(hollow, at(), 1, 1), Body(icosphere(), at(scale=0.8), 2, 2)]
    found = analyse(filled)
    assert (found[0].code, found[0].level, found[1].code) == (PROBE, 2, NEVER)
    assert_true(filled, found)


def torus(steps: int = 24, minor: float = 0.3, wobble: float = 0.0) -> Solid:
    u, v = (t.ravel() for t in np.meshgrid(np.arange(steps), np.arange(steps), indexing="ij"))
    s, t = 2 * np.pi * u / steps, 2 * np.pi * v / steps
    points = np.stack(
        [(1 + minor * np.cos(t)) * np.cos(s), (1 + minor * np.cos(t)) * np.sin(s), minor * np.sin(t)], axis=1
    )
    points += wobble * np.random.default_rng(0).normal(size=points.shape)
    a, b = u * steps + v, (u + 1) % steps * steps + v
    c, d = (u + 1) % steps * steps + (v + 1) % steps, u * steps + (v + 1) % steps
    return Solid(points, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32))


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
    assert (found[0].code, found[0].robust) == (PROBE, True)
    assert (found[1].code, found[1].robust) == (NEVER, False)


def test_a_body_scaled_to_nothing_concerns_nobody():
    sphere = icosphere()
    found = analyse([Body(sphere, at(scale=0.0), 1, 1), Body(sphere, at(scale=2.0), 2, 2)])
    assert found[0].robust
    assert found[1].code == AIR


def test_one_priority_decides_only_if_its_bodies_are_apart():
    sphere = icosphere()
    cube, one, two = (
        Body(sphere, at(), 2, 2),
        Body(sphere, at(1.2, scale=0.5), 1, 1),
        Body(sphere, at(-1.2, scale=0.5), 1, 1),
    )
    assert [c.level for c in analyse([cube, one, two])] == [1, 2, 2]
    touching = Body(sphere, at(1.8, scale=0.5), 1, 1)
    assert analyse([cube, one, two, touching])[0].level is None
    apart = [Body(sphere, at(9.0 + x), 1, 1) for x in (0.0, 0.5)]
    assert [c.level for c in analyse([cube, one, two, *apart])[:2]] == [None, 2]
    other = Body(sphere, at(0, 1.2, scale=0.5), 3, 3)
    assert analyse([cube, one, other])[0].level is None
    assert analyse([cube, Body(sphere, at(1.2), 2, 2)])[0].level == 2
    double = Body(joined(icosphere(1), icosphere(1, 1.0, (0.5, 0, 0))), at(9.0), 1, 1)
    assert analyse([cube, one, double])[0].level is None
    assert analyse([double, Body(sphere, at(9.0, 1.0), 2, 2)])[0].level is None


def random_scene(rng: np.random.Generator) -> list[Body]:
    shapes = [icosphere(2), icosphere(1), grid_box((-1, -1, -1), (1, 1, 1), 3)]
    priorities = rng.integers(1, 4, 12)
    return [Body(shapes[rng.integers(3)], random_matrix(rng, 2.0), int(p), int(p)) for p in priorities]


def same(one, other) -> bool:
    facts = (
        (each.code, each.around, each.level, each.partners, each.robust, repr(each.coincident)) for each in (one, other)
    )
    return next(facts) == next(facts)


@pytest.mark.parametrize("seed", range(5))
def test_a_memory_changes_no_answer(seed):
    rng = np.random.default_rng(seed)
    bodies, memory = random_scene(rng), Memory()
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
    memory = Memory()
    compared = []

    def compare(pairs, original=contacts._compare):
        compared.append(len(pairs))
        return original(pairs)

    monkeypatch.setattr(contacts, "_compare", compare)
    analyse(bodies, memory)
    analyse(bodies, memory)
    for place in ((6.0, 0.1), (0.0, 100.0)):
        bodies[4] = Body(sphere, at(*place), 2, 4)
        analyse(bodies, memory)
    assert compared == [9, 0, 2, 0]


def test_far_from_the_origin_the_answer_is_the_same():
    sphere = icosphere(3)
    bodies = [Body(sphere, at(), 1, 1), Body(sphere, at(1.0, 0.1, 0.2), 2, 2)]
    moved = [Body(b.solid, at(300.0, -200.0, 100.0) @ b.matrix, b.priority, b.medium) for b in bodies]
    assert all(same(a, b) for a, b in zip(analyse(bodies), analyse(moved)))


def test_boxes_are_paired_as_by_comparing_all():
    rng = np.random.default_rng(1)
    low = rng.random((3, 300))
    high = low + 0.2 * rng.random((3, 300))
    first, second = contacts._overlapping_boxes(low, high, 0.0)
    meet = np.all((low[:, :, None] <= high[:, None]) & (low[:, None] <= high[:, :, None]), axis=0)
    expected = {(i, j) for i, j in zip(*np.nonzero(meet)) if i < j}
    assert {(min(i, j), max(i, j)) for i, j in zip(first.tolist(), second.tolist())} == expected
    assert len(first) == len(expected)


def test_winding_numbers_by_crossings_are_those_by_solid_angles():
    rng = np.random.default_rng(2)
    solid = joined(torus(), icosphere(2, 0.5, (1.0, 0.2, 0.1)), inverted(icosphere(1, 0.2, (1.0, 0.1, 0.1))))
    place = contacts._Placed(solid, np.eye(4))
    points = rng.uniform(-1.5, 1.5, (400, 3))
    assert np.array_equal(contacts._windings(points, place), winding(points, placed(Body(solid, at(), 1, 1))))
    assert np.array_equal(contacts._windings(points[:5], place), winding(points[:5], solid.vertices[solid.triangles]))


def test_winding_numbers_are_exact_above_vertices_and_edges():
    box = grid_box((-1, -1, -1), (1, 1, 1), 4)
    place = contacts._Placed(box, np.eye(4))
    steps = np.linspace(-1.0, 1.0, 9)
    points = np.array([(x, y, 0.1) for x in steps[1:-1] for y in steps[1:-1]])
    assert (contacts._windings(points, place) == 1).all()
    assert (contacts._windings(points + (2.0, 0.0, 0.0), place)[points[:, 0] > 0.0] == 0).all()


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


@pytest.mark.parametrize("seed", range(6))
def test_many_pairs_at_once_are_what_each_is_alone(seed):
    rng = np.random.default_rng(seed)
    shapes = [icosphere(1), icosphere(2), grid_box((-1, -1, -1), (1, 1, 1), 2)]
    shapes += [joined(icosphere(1, 0.5, (-0.7, 0, 0)), icosphere(1, 0.5, (0.7, 0, 0)))]
    shapes += [joined(icosphere(1), inverted(icosphere(1, 0.6)))]
    places = [contacts._Placed(shapes[rng.integers(5)], random_matrix(rng, 1.5)) for _ in range(9)]
    places += [contacts._Placed(places[0].solid, places[0].matrix)]
    pairs = [(places[i], places[j]) for i in range(10) for j in range(i)]
    for (one, two), pair in zip(contacts._compare(pairs), pairs, strict=True):
        for side, alone in zip((one, two), contacts._compare([pair])[0]):
            for name in ("held", "crosses", "coincident", "signs", "whole"):
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
    place = contacts._Placed(joined(*fibres(400, radius=0.3 if seed is None else 0.02, seed=seed)), np.eye(4))
    if seed is None:
        place = contacts._Placed(place.solid, contacts._frame(place))
    tolerance = np.full(400, 1e-6)
    first, second = contacts._near_islands(place, tolerance)
    assert len(first) < (4 if seed is None else 20) * 400
    assert (first < second).all() and len(set(zip(first.tolist(), second.tolist()))) == len(first)


@pytest.mark.parametrize("seed", range(3))
def test_boxes_of_islands_leave_out_no_pair_that_touches(seed):
    solids = fibres(40, radius=0.4, seed=seed)
    place = contacts._Placed(joined(*solids), np.eye(4))
    pairs = set(zip(*(index.tolist() for index in contacts._near_islands(place, np.full(40, 1e-5)))))
    island = place.islands[np.argsort(place.solid.order)].reshape(40, -1)[:, 0].tolist()
    touching = 0
    for i in range(40):
        for j in range(i):
            sides = contacts._compare(
                [(contacts._Placed(solids[i], np.eye(4)), contacts._Placed(solids[j], np.eye(4)))]
            )
            if sides[0][0].crosses:
                touching += 1
                assert tuple(sorted((island[i], island[j]))) in pairs
    assert touching > 10


def test_winding_numbers_of_many_islands_are_those_by_solid_angles():
    solid = joined(*fibres(80, radius=0.45, seed=4), icosphere(1, 0.7), inverted(icosphere(1, 0.2)))
    points = np.random.default_rng(5).uniform(-0.8, 0.8, (300, 3))
    place = contacts._Placed(solid, np.eye(4))
    expected = winding(points, solid.vertices[solid.triangles])
    assert set(expected) >= {0, 1, 2}
    assert np.array_equal(contacts._windings(points, place), expected)
    crowd = contacts._Crowd([contacts._Placed(icosphere(2), at(5.0)), place])
    assert np.array_equal(contacts._windings(points, crowd, np.ones(300, dtype=int)), expected)


def test_flat_sides_are_those_of_a_box():
    sides = contacts.flat_sides(grid_box((0, 0, 0), (3, 2, 1), 4))
    assert sorted(np.unique(sides, return_counts=True)[1].tolist()) == [32] * 6
    assert len(set(contacts.flat_sides(icosphere(2)).tolist())) == 320


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
        return contacts.Walls(bodies).clearance(index, faces, np.full(len(faces), side), 0.01)

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
    assert contacts.resting([far, standing], top) == ([1] if answer else [])
