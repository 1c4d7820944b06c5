"""Where meshes are open, and which of their faces are turned."""

import bpy  # noqa: F401  mathutils comes with it
import numpy as np
import pytest
from solids import grid_box, icosphere, inverted, joined

from nested_dielectric.geometry.mesh_faults import mesh_faults
from nested_dielectric.geometry.solids import Solid


def turned(solid: Solid, faces) -> np.ndarray:
    triangles = solid.triangles.copy()
    triangles[faces] = triangles[faces, ::-1]
    return triangles


def test_a_closed_mesh_has_no_faults():
    for solid in (icosphere(2), grid_box((0, 0, 0), (1, 1, 1), 2), inverted(icosphere(1))):
        faults = mesh_faults(solid.vertices, solid.triangles)
        assert len(faults.holes) == len(faults.crowded) == len(faults.turned) == 0


def test_faces_along_a_hole_are_found():
    ball = icosphere(1)
    missing = set(ball.triangles[7])
    faults = mesh_faults(ball.vertices, np.delete(ball.triangles, 7, axis=0))
    rest = np.delete(ball.triangles, 7, axis=0)
    beside = [index for index, face in enumerate(rest) if len(missing & set(face)) == 2]
    assert faults.holes.tolist() == beside and len(beside) == 3


def test_a_fin_is_no_hole_but_its_edge_is_shared_by_three():
    ball = icosphere(1)
    vertices = np.concatenate([ball.vertices, [[0.0, 0.0, 2.0]]])
    fin = np.array([[*ball.triangles[0][:2], len(ball.vertices)]])
    faults = mesh_faults(vertices, np.concatenate([ball.triangles, fin]))
    assert faults.holes.tolist() == [len(ball.triangles)] and len(faults.crowded) == 3


@pytest.mark.parametrize("few", [[5], [0, 1, 2, 40], list(range(60))])
def test_the_faces_that_look_inwards_are_found_whether_few_or_most(few):
    ball = icosphere(1)
    assert mesh_faults(ball.vertices, turned(ball, few)).turned.tolist() == few
    rest = [index for index in range(len(ball.triangles)) if index not in few]
    assert mesh_faults(ball.vertices, turned(ball, rest)).turned.tolist() == rest


def test_a_part_that_is_turned_as_a_whole_is_no_mixture_beside_one_that_is():
    both = joined(icosphere(1, 1.0), inverted(icosphere(1, 0.5)))
    assert mesh_faults(both.vertices, turned(both, [3])).turned.tolist() == [3]


def test_a_surface_with_one_side_is_named_along_its_seam():
    """A Klein bottle of squares: a torus of which one way round comes back mirrored."""
    n = 6
    number = lambda i, j: (i % n) * n + ((j if i // n % 2 == 0 else -j) % n)  # noqa: E731
    faces = []
    for i in range(n):
        for j in range(n):
            a, b, c, d = number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)
            faces += [(a, b, c), (a, c, d)]
    points = np.random.default_rng(0).normal(size=(n * n, 3))
    faults = mesh_faults(points, np.array(faces))
    assert len(faults.holes) == len(faults.crowded) == 0
    assert 0 < len(faults.turned) <= 2 * n * 2


def test_parts_that_look_inwards_are_told_from_cavities():
    ball = icosphere(1)
    away = joined(ball, inverted(icosphere(1, 1.0, (5.0, 0.0, 0.0))))
    assert away.inward_triangles().tolist() == list(range(80, 160)) and away.overlaps_itself
    hollow = joined(ball, inverted(icosphere(1, 0.5)))
    assert len(hollow.inward_triangles()) == 0 and not hollow.overlaps_itself
    crossing = joined(ball, icosphere(1, 1.0, (0.7, 0.0, 0.0)))
    assert len(crossing.inward_triangles()) == 0 and crossing.overlaps_itself
    middle = crossing.vertices[crossing.triangles[crossing.overlapping_triangle]].mean(axis=0)
    assert abs(middle[0] - 0.35) < 0.4  # near the plane where both cross
