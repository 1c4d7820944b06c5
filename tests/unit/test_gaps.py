"""Films of air between bodies, overlaps and walls that are too thin: against shells and boxes of known thickness."""

import bpy  # noqa: F401  mathutils comes with it
import numpy as np
import pytest
from solids import at, grid_box, icosphere, inverted, joined

from nested_dielectric.geometry.common_points import common_point
from nested_dielectric.geometry.gaps import FILM, FLAT_FILM, find_layers, room_ahead, thin_walls, thinnest_wall
from nested_dielectric.geometry.solids import PlacedSolid, Solid
from nested_dielectric.geometry.surfaces import FLOAT_ROUNDING, TOUCH_TOLERANCE

SHELL = joined(icosphere(3, 1.0), inverted(icosphere(3, 0.8)))


def place(solid: Solid, matrix=None) -> PlacedSolid:
    return PlacedSolid(solid, np.eye(4) if matrix is None else matrix)


@pytest.mark.parametrize(
    "turn", [at(0.0), at(5.0, -3.0, 2.0, scale=(1e-3, 1e-3, 1e-3)), at(0.0, scale=(-2.0, 2.0, 2.0))]
)
def test_a_film_between_a_shell_and_a_ball_in_it_is_as_thick_as_their_radii_differ(turn):
    scale = abs(turn[1, 1])
    shell, ball = place(SHELL, turn), place(icosphere(3, 0.79), turn)
    (film,), thin = find_layers([shell, ball], [(), ()])
    assert thin == [] and (film.first, film.second) == (1, 0)
    assert film.share == pytest.approx(1.0) and not film.one_sided
    # Facets of both lie inside their spheres by the same part.
    assert np.abs(film.thickness / scale - 0.01).max() < 2e-4
    radius = np.linalg.norm((film.points.T - turn[:3, 3]) / scale, axis=1)
    assert radius.min() > 0.77 and radius.max() < 0.7901
    # The shell is 0.2 thick.
    assert room_ahead(film, shell, film.thickness, scale) == pytest.approx(0.2 * scale, rel=0.03)


@pytest.mark.parametrize("radius", [0.8, 0.801, 0.7])
def test_bodies_that_touch_overlap_or_stand_off_have_no_film(radius):
    assert find_layers([place(SHELL), place(icosphere(3, radius))], [(), ()]) == ([], [])


def test_a_film_that_a_third_body_fills_is_none():
    water = icosphere(3, 0.9)
    places = [place(SHELL), place(icosphere(3, 0.79)), place(water)]
    assert len(find_layers(places[:2], [(), ()])[0]) == 1
    assert find_layers(places, [(), (), ()])[0] == []


@pytest.mark.parametrize("gap, answer", [(0.5, True), (2.0, False)])
def test_between_flat_sides_only_the_thinnest_film_counts_unless_the_bodies_touch_beside_it(gap, answer):
    below = grid_box((0, 0, 0), (1, 1, 1), 2)
    gap *= FLAT_FILM * 3.0**0.5
    above = grid_box((0, 0, 1.0 + gap), (1, 1, 2.0 + gap), 2)
    places = [place(below), place(above)]
    found = find_layers(places, [(), ()])[0]
    assert [film.one_sided for film in found] == [True] * answer
    assert len(find_layers(places, [(1,), (0,)])[0]) == 1
    if answer:
        assert found[0].share == pytest.approx(1 / 6, abs=0.03)


def test_thick_films_and_bodies_that_are_not_parallel_are_left_alone():
    box, size = grid_box((0, 0, 0), (1, 1, 1), 2), 3.0**0.5
    apart = place(grid_box((0, 0, 1.0), (1, 1, 2.0), 2), at(0, 0, 1.1 * FILM * size))
    assert find_layers([place(box), apart], [(1,), (0,)])[0] == []
    leaning = at(0, 0, 1e-3)
    cosine, sine = np.cos(0.35), np.sin(0.35)
    leaning[:3, :3] = [[cosine, 0, -sine], [0, 1, 0], [sine, 0, cosine]]
    assert find_layers([place(box), place(grid_box((0, 0, 1), (1, 1, 2)), leaning)], [(1,), (0,)])[0] == []


@pytest.mark.parametrize("shift", [0.0, 1e4])
def test_an_overlap_near_what_floats_tell_is_thin_and_ten_times_as_much_is_not(shift):
    below = place(grid_box((0, 0, 0), (1, 1, 1), 2), at(shift))
    tolerance = TOUCH_TOLERANCE * 3.0**0.5 + FLOAT_ROUNDING * (shift + 1.0)
    for overlap, count in ((1.5 * tolerance, 1), (15.0 * tolerance, 0)):
        above = place(grid_box((0.1, 0.1, 1.0 - overlap), (0.9, 0.9, 1.8), 2), at(shift))
        _, thin = find_layers([below, above], [(), ()])
        assert len(thin) == count
        assert all(layer.thickness == pytest.approx(overlap, rel=0.01) for layer in thin)


def test_many_bodies_are_looked_at_together_as_in_pairs():
    """Balls in shells, each pair far from the others and of its own size."""
    places = []
    for index in range(40):
        there = at(4.0 * index, scale=1.0 + 0.01 * index)
        inner = (0.79, 0.805)[index % 2]
        places += [place(SHELL, there), place(icosphere(3, inner), there)]
    films, _ = find_layers(places, [()] * len(places))
    assert [(film.first, film.second) for film in films] == [(4 * k + 1, 4 * k) for k in range(20)]


def test_a_wall_is_as_thin_as_the_pane_is():
    pane = grid_box((0, 0, 0), (1, 1, 1e-3), 3)
    assert thinnest_wall(pane) == pytest.approx(1e-3, rel=1e-6)
    assert thin_walls(place(pane), 1.01e-3).thickness == pytest.approx(1e-3, rel=1e-6)
    assert thin_walls(place(pane), 0.99e-3) is None
    assert thinnest_wall(grid_box((0, 0, 0), (1, 1, 1), 3)) == np.inf
    shell = joined(icosphere(3, 1.0), inverted(icosphere(3, 0.995)))
    assert thinnest_wall(shell) == pytest.approx(0.005, rel=0.1)
    assert thinnest_wall(icosphere(3, 1.0)) == np.inf


@pytest.mark.parametrize(
    "solid, there, meet",
    [
        (icosphere(2, 1.0), at(1.5), True),
        (icosphere(2, 0.1), at(0.3, 0.2), True),
        (icosphere(2, 9.0), at(0.0), True),
        (grid_box((-1, -1, -1), (1, 1, 1)), at(1.7, 0.5), True),
        (grid_box((-1, -1, 1), (1, 1, 2)), at(0.0), False),
        (icosphere(2, 1.0), at(2.1), False),
        (icosphere(2, 1.0), at(1.5, scale=(-1.0, 1.0, 1.0)), True),
    ],
)
def test_a_common_point_lies_in_both_bodies_and_there_is_none_where_they_touch_at_most(solid, there, meet):
    base = place(grid_box((-1, -1, -1), (1, 1, 1), 2))
    other = place(solid, there)
    point = common_point(base, other)
    assert (point is not None) == meet
    if meet:
        assert np.abs(point).max() < 1.0
        local = np.linalg.inv(there) @ [*point, 1.0]
        size = np.abs(solid.vertices).max() if len(solid.vertices) > 8 else np.inf
        assert np.linalg.norm(local[:3]) < size or (np.abs(local[:3]) < 1.0).all()
