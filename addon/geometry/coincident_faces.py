"""How to move faces of media that lie in the same place, which rays cannot tell apart: a plan, without Blender's data.

Of two faces in one place a ray meets either, and a probe finds only one. The weaker medium's are moved into the stronger one,
where they are not seen: outwards where the faces look against each other, inwards where they look the same way. So what is
seen keeps its shape. Only where the stronger one's lie on part of a larger face are they moved themselves, outwards. A flat
side moves as a whole, by less than the thickness of any wall before it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from .contacts import Contact
from .coplanar import flat_sides
from .meshes import same_places
from .solids import Body, Solid
from .surfaces import FLOAT_ROUNDING, TOUCH_TOLERANCE
from .walls import Walls

SEPARATION = 1e-4
"""Distance between separated faces, in diagonals of the smaller object: ten times what counts as the same place."""

ROUNDED_SEPARATION = 4e-6
"""What is added to it, in the largest coordinate: far from the origin single precision is coarser."""

LEAST = 2.0
"""The least distance between separated faces, in distances within which surfaces count as touching."""

WALL = 3.0
"""How many times as thick as what faces move into it a wall has to be: others may move into it from its other side."""

FLATTEST = 0.02
"""Fraction of the largest eigenvalue below which a spread of normals is rounding, not another direction."""


@dataclass(eq=False)
class Move:
    """Triangles of a body that are to be moved.

    :ivar others: indices of the bodies that they are separated from.
    :ivar heights: (m,) by how much each triangle is to rise along its normal, in unit distances.
    :ivar unit: that distance, scene units.
    :ivar wall: the thickness of a wall that is too thin for it, else 0; least: how thick it has to be.
    """

    heights: np.ndarray
    others: list[int] = field(default_factory=list)
    unit: float = 0.0
    wall: float = 0.0
    least: float = 0.0


def plan_moves(bodies: Sequence[Body], found: Sequence[Contact], rims: bool = False) -> dict[int, Move]:
    """Return how the triangles of bodies are to be moved so that no two lie in one place, by the body's index.

    Whatever lies on a stronger one's face is moved farther than that. With rims, where faces share no more than what a
    move beside them has made, it only moves otherwise; so a row of many blocks does not move farther and farther.

    :param found: the contacts of each body, in the order of the bodies.
    """
    coincident = {(i, other): facts for i, contact in enumerate(found) for other, *facts in contact.coincident}
    strongest_first = sorted(range(len(bodies)), key=lambda i: (bodies[i].priority, i))
    order = {index: number for number, index in enumerate(strongest_first)}
    pairs = {tuple(sorted(pair, key=order.__getitem__)) for pair in coincident}
    moves: dict[int, Move] = {}
    ranks: dict[int, np.ndarray] = {}
    numbers = _distinct_ranks(pairs, strongest_first) if rims else {}
    for strong, weak in sorted(pairs, key=lambda pair: (order[pair[1]], order[pair[0]])):
        of_strong, of_weak = coincident.get((strong, weak)), coincident.get((weak, strong))
        # The stronger one's lie on part of a larger face, which would move farther than they need to.
        outwards = of_weak is None or (
            not rims and of_strong is not None and of_strong[2].all() and not of_weak[2].any()
        )
        index, other = (strong, weak) if outwards else (weak, strong)
        faces, signs, _ = of_strong if outwards else of_weak
        sides = np.ones(len(faces)) if outwards else -signs.astype(float)
        across = coincident.get((other, index))
        rank = 1.0
        if rims:
            rank = float(numbers[index])
        elif across is not None and other in ranks:
            rank += ranks[other][across[0]].max(initial=0.0)
        if rank == 0.0:
            continue
        room = len(bodies[index].solid.triangles)
        move = moves.setdefault(index, Move(np.zeros(room)))
        move.others.append(other)
        own = ranks.setdefault(index, np.zeros(room))
        own[faces] = np.maximum(own[faces], rank)
        # Where one side is to move both ways, an overlap is better than a gap.
        move.heights[faces] = np.where((sides > 0.0) | (move.heights[faces] > 0.0), own[faces], -own[faces])
    if moves:
        walls = Walls(bodies)
        sides_of: dict[int, np.ndarray] = {}
        for index, move in moves.items():
            _move_flat_sides(bodies[index].solid, move, sides_of)
        for group in _groups(moves):
            _find_distance(walls, {index: moves[index] for index in group if index in moves}, group)
    return moves


def _distinct_ranks(pairs: Iterable[tuple[int, int]], order: Sequence[int]) -> dict[int, int]:
    """Return a small number for each body, another one than those of the bodies with which it is paired."""
    beside: dict[int, set[int]] = {index: set() for index in order}
    for one, other in pairs:
        beside[one].add(other)
        beside[other].add(one)
    numbers: dict[int, int] = {}
    for index in order:
        taken = {numbers.get(other, -1) for other in beside[index]}
        numbers[index] = next(number for number in range(len(taken) + 1) if number not in taken)
    return numbers


def _move_flat_sides(solid: Solid, move: Move, known: dict[int, np.ndarray]) -> None:
    """Let all triangles of a flat side move as one of them does.

    :param known: flat sides of solids that have been looked at, by id; brought up to date.
    """
    if move.heights.all():
        return
    if id(solid) not in known:
        known[id(solid)] = flat_sides(solid)
    sides = known[id(solid)]
    moved = np.flatnonzero(move.heights)
    highest, lowest = np.zeros(len(sides)), np.zeros(len(sides))
    np.maximum.at(highest, sides[moved], move.heights[moved])
    np.minimum.at(lowest, sides[moved], move.heights[moved])
    move.heights = np.where(highest > 0.0, highest, lowest)[sides]


def _groups(moves: dict[int, Move]) -> list[list[int]]:
    """Return groups of bodies that are separated from each other, one through another."""
    group: dict[int, list[int]] = {}
    for index, move in moves.items():
        for other in move.others:
            one, two = (group.setdefault(body, [body]) for body in (index, other))
            if one is not two:
                one, two = sorted((one, two), key=len, reverse=True)
                one += two
                group.update(dict.fromkeys(two, one))
    return list({id(members): members for members in group.values()}.values())


def _find_distance(walls: Walls, moves: dict[int, Move], group: list[int]) -> None:
    """Find one distance for a group of bodies that are separated from each other, so that no two move alike."""
    low, high = walls.boxes[group].swapaxes(0, 1)
    size = float(np.linalg.norm(high - low, axis=1).min())
    reach = float(np.abs(walls.boxes[group]).max())
    wanted = SEPARATION * size + ROUNDED_SEPARATION * reach
    least = LEAST * (TOUCH_TOLERANCE * size + FLOAT_ROUNDING * reach)
    units = {}
    for index, move in moves.items():
        faces = np.flatnonzero(move.heights)
        highest = WALL * float(np.abs(move.heights).max())
        wall = walls.clearance(index, faces, np.sign(move.heights[faces]), highest * wanted)
        units[index] = wall / highest
        if units[index] < least:
            move.wall, move.least = wall, least * highest
    unit = min((unit for unit in units.values() if unit >= least), default=wanted)
    for move in moves.values():
        move.unit = unit


def least_squares_offsets(count: int, corners: np.ndarray, normals: np.ndarray, heights: np.ndarray) -> np.ndarray:
    """Return how far to move points so that triangles rise by their heights along their normals.

    The shortest vector that does so best: the least squares of each point's triangles.

    :param count: number of points.
    :param corners: (m, 3) indices of points.
    :param normals: (m, 3) unit vectors.
    :param heights: (m,).
    :returns: (count, 3); 0 for points of no triangle.
    """
    squares = np.zeros((count, 3, 3))
    sums = np.zeros((count, 3))
    for corner in corners.T:
        np.add.at(squares, corner, normals[:, :, None] * normals[:, None, :])
        np.add.at(sums, corner, heights[:, None] * normals)
    used = np.unique(corners)
    result = np.zeros((count, 3))
    inverse = np.linalg.pinv(squares[used], rcond=FLATTEST, hermitian=True)
    result[used] = np.einsum("nij,nj->ni", inverse, sums[used])
    return result


def local_offsets(body: Body, move: Move) -> np.ndarray:
    """Return how far a body's points move, (n, 3), in its own space."""
    linear = body.matrix[:3, :3]
    faces = np.flatnonzero(move.heights)
    corners = body.solid.triangles[faces]
    a, b, c = (body.solid.vertices[corners[:, i]] @ linear.T for i in range(3))
    normals = np.cross(b - a, c - a) * np.sign(np.linalg.det(linear))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    world = least_squares_offsets(len(body.solid.vertices), corners, normals, move.unit * move.heights[faces])
    other_side = np.setdiff1d(np.arange(len(world)), body.solid.triangles)  # of a seam, which no triangle names
    world[other_side] = world[same_places(body.solid.vertices.astype(np.float32))[other_side]]
    return world @ np.linalg.inv(linear).T
