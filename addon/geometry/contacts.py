"""Which media touch which: what lies around closed meshes that overlap. Arrays in, answers out.

A surface that no other crosses has the same surroundings everywhere, so one winding number answers for each connected
component of it. What crosses stays unknown: rays must ask the scene there.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property

import numpy as np
from mathutils.bvhtree import BVHTree

from . import meshes

# What is known of the outside of a body: nothing (ask the scene); it is air; it is the known surrounding medium; a stronger
# or equal medium wins there, so the surface never exists.
PROBE, AIR, MEDIUM, NEVER = 0, 1, 2, 3
BY_OBJECT = 5  # of a material: each of its objects has its own

# Surfaces closer than this touch, in sizes of the smaller body.
TOLERANCE = 1e-5
# A few units in the last place of the float32 coordinates that Cycles traces.
ROUNDING = 2.5e-7
# Children of a box in a hierarchy, and pairs of faces that are compared at a time.
CHILDREN = 8
CHUNK = 4096
# Bodies of no more triangles are compared many pairs at a time, with so many triangles together.
SMALL = 4096
CROWD = 1 << 18
# Above everything.
HIGH = 1e300
# Numbers below which there is room for a table.
TABLE = 1 << 21
# Boxes into which a long or flat island is cut at most, along its longest axis and the next.
PIECES = (64, 8)
# Height above the centre, in sizes of the island, from which a face certainly looks away from it.
LEAST_HEIGHT = 1e-6
# Cosine of the largest angle between faces that coincide.
PARALLEL = 0.999
# Part of a face from which on what lies beyond is a wall, not the rim of what the face lies on.
WALL = 0.01
# Sine of the largest angle between faces of one flat side.
FLAT = 1e-3
# Cosine of the largest angle between faces that a plane through an edge of one may part where no other does.
NEARLY_PARALLEL = 0.9

_NO_FACES = np.empty(0, dtype=np.intp)


@dataclass(frozen=True, eq=False)
class Solid:
    """A triangle mesh in its own space: made once and kept, since its properties are computed once.

    :param vertices: (n, 3) float64.
    :param triangles: (m, 3) int32, vertex indices, counterclockwise from outside.
    """

    vertices: np.ndarray
    triangles: np.ndarray

    @cached_property
    def closed(self) -> bool:
        """Whether it bounds a volume: finite, no open or inconsistent edges, not inverted."""
        return (
            len(self.triangles) >= 4
            and bool(np.isfinite(self.vertices).all())
            and meshes.is_closed(self.triangles)
            and meshes.signed_volume(self.vertices, self.triangles) > 0.0
        )

    @cached_property
    def mean_chord(self) -> float:
        """Mean length of straight ways through it, as of a convex body: four volumes over the surface (Cauchy 1841)."""
        a, b, c = (self.vertices[self.triangles[:, corner]] for corner in range(3))
        surface = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
        return 4.0 * meshes.signed_volume(self.vertices, self.triangles) / max(float(surface), 1e-30)

    @cached_property
    def order(self) -> np.ndarray:
        """(m,) the triangles by their first corners, neighbours in space one after the other; all that is private counts
        them so.
        """
        return _morton_order(self.vertices.T[:, self.triangles[:, 0]])

    @cached_property
    def corners(self) -> np.ndarray:
        """(3, m) vertex indices of the ordered triangles: first, second and third corners."""
        return np.ascontiguousarray(self.triangles[self.order].T, dtype=np.intp)

    @cached_property
    def islands(self) -> np.ndarray:
        """(m,) number of the connected component of every ordered triangle, from 0."""
        a, b, c = self.corners
        root = meshes.connected(len(self.vertices), np.concatenate([a, b]), np.concatenate([b, c]))
        used = np.zeros(len(self.vertices), dtype=bool)
        used[root[a]] = True
        return (np.cumsum(used) - 1)[root[a]]

    @cached_property
    def by_island(self) -> tuple[np.ndarray, np.ndarray]:
        """The ordered triangles, an island's after the other's; (k + 1,) the place of each one's first."""
        return _by_number(self.islands)

    @cached_property
    def overlaps_itself(self) -> bool:
        """Whether its surface crosses itself, or some island does not separate the inside from the outside.

        Islands that are star-shaped about their centre cannot cross themselves; the others are intersected.
        """
        place = _Placed(self, np.eye(4))
        if len(self.by_island[1]) > 2:
            place = _Placed(self, _frame(place))
        for island in np.flatnonzero(~_star_shaped(place)):
            faces, starts = self.by_island
            if _crosses_itself(place, faces[starts[island] : starts[island + 1]]):
                return True
        if len(self.by_island[1]) == 2:
            return False
        return _islands_touch(place) or bool(np.any(_outer_windings(place) != 0))


@dataclass(frozen=True)
class Body:
    """A medium in the scene.

    :param matrix: (4, 4) from the mesh's space to the world's.
    :param priority: the lowest wins.
    :param medium: equal for bodies that are filled with the same.
    """

    solid: Solid
    matrix: np.ndarray
    priority: int
    medium: Hashable

    def is_same(self, other: Body) -> bool:
        """Whether it is the same solid in the same place with the same values."""
        return np.array_equal(self.matrix, other.matrix) and all(
            getattr(self, item.name) == getattr(other, item.name) for item in fields(self) if item.name != "matrix"
        )


@dataclass(frozen=True, eq=False)
class Contact:
    """What is known of a body's outside.

    :param code: PROBE, AIR, MEDIUM or NEVER.
    :param around: index of a body that is the known surrounding medium of code MEDIUM.
    :param level: of code PROBE, a priority that decides by itself: the first surface of that priority which a ray from the
        body meets tells whether a body of that priority, and nothing else, holds the point.
    :param robust: it overlaps itself.
    :param partners: bodies whose surfaces cross it or that hold part of it.
    :param coincident: other bodies, this body's triangles that share part of a plane with their surface, +1 for each
        whose normal points the same way, -1 for the others, and whether each lies on that surface as a whole.
    """

    code: int
    around: int | None = None
    level: int | None = None
    robust: bool = False
    partners: tuple[int, ...] = ()
    coincident: tuple[tuple[int, np.ndarray, np.ndarray, np.ndarray], ...] = ()


class _Surfaces:
    """Triangles of one or many bodies in the world, one body's after the other's. Coordinates are stored by axis.

    :ivar vertices: (3, n) world coordinates.
    :ivar corners: (3, m) vertex indices, counterclockwise from outside.
    :ivar starts: (bodies + 1,) first triangle of each body, and the number of all.
    :ivar islands: (m,) number of every triangle's connected component, those of a body in a row.
    :ivar by_island: the triangles, an island's after the other's; (k + 1,) the place of each one's first.
    :ivar island_starts: (bodies + 1,) first island of each body, and the number of all.
    """

    vertices: np.ndarray
    corners: np.ndarray
    starts: np.ndarray
    islands: np.ndarray
    by_island: tuple[np.ndarray, np.ndarray]
    island_starts: np.ndarray

    @cached_property
    def bounds(self) -> np.ndarray:
        """(6, m) lowest coordinates of the triangles, and highest ones negated."""
        bounds = _padded(self.corners.shape[1])
        for axis in range(3):
            a, b, c = (self.vertices[axis].take(corner) for corner in self.corners)
            np.minimum(np.minimum(a, b), c, out=bounds[axis])
            np.negative(np.maximum(np.maximum(a, b), c), out=bounds[axis + 3])
        return bounds

    @cached_property
    def hierarchy(self) -> _Hierarchy:
        """Of all triangles, a tree for each body."""
        return _Hierarchy(self.bounds, self.starts)

    @cached_property
    def island_trees(self) -> _Hierarchy:
        """Of the triangles by island, a tree for each island."""
        return _Hierarchy(self.bounds[:, self.by_island[0]], self.by_island[1])

    @cached_property
    def pieces(self) -> tuple[np.ndarray, _Hierarchy]:
        """The islands in some boxes that together hold all of them, and a tree of those boxes for each body."""
        bounds, island = _cut(self)
        body = np.searchsorted(self.island_starts, island, side="right") - 1
        order = _morton_order((bounds[:3] - bounds[3:]) / 2.0)
        order = order[np.argsort(body[order], kind="stable")]
        starts = np.searchsorted(body[order], np.arange(len(self.starts)))
        return island[order], _Hierarchy(bounds[:, order], starts)

    @cached_property
    def island_axes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of every island: (k, 3, 3) its own axes, as columns, the longest first; (3, k) how far it extends along them, and
        its middle.
        """
        low, high = self.island_boxes
        faces, starts = self.by_island
        count = len(starts) - 1
        centre = (low + high) / 2.0
        numbers = np.repeat(np.arange(count), 3 * np.diff(starts))
        offset = self.vertices[:, self.corners[:, faces].T.ravel()] - centre[:, numbers]
        products = np.stack([u * v for u in offset for v in offset])
        squares = np.add.reduceat(products, 3 * starts[:-1], axis=1).T.reshape(-1, 3, 3)
        axes = np.linalg.eigh(squares)[1][:, :, ::-1]
        along = np.einsum("kn,nka->an", offset, axes[numbers])
        least, most = (each.reduceat(along, 3 * starts[:-1], axis=1) for each in (np.minimum, np.maximum))
        return axes, most - least, centre + np.einsum("nka,an->kn", axes, (least + most) / 2.0)

    @cached_property
    def island_boxes(self) -> tuple[np.ndarray, np.ndarray]:
        """(3, k) lowest and highest coordinates of the islands."""
        faces, starts = self.by_island
        bounds = np.minimum.reduceat(self.bounds[:, faces], starts[:-1], axis=1)
        return bounds[:3], -bounds[3:]

    @cached_property
    def boxes(self) -> tuple[np.ndarray, np.ndarray]:
        """(3, bodies) lowest and highest coordinates of the bodies."""
        bounds = np.minimum.reduceat(self.bounds, self.starts[:-1], axis=1)
        return bounds[:3], -bounds[3:]

    def points(self, faces: np.ndarray) -> np.ndarray:
        """(k, 3 corners, 3 axes) corners of some triangles."""
        return self.vertices.T[self.corners[:, faces].T]

    def centroids(self, faces: np.ndarray) -> np.ndarray:
        """(k, 3) centres of some triangles."""
        return self.points(faces).mean(axis=1)


class _Crowd(_Surfaces):
    """Many bodies together."""

    def __init__(self, places: Sequence[_Placed]) -> None:
        def starts(counts: list[int]) -> np.ndarray:
            return np.concatenate([[0], np.cumsum(counts)])

        def joined(parts: list[np.ndarray], first: np.ndarray) -> np.ndarray:
            return np.concatenate([part + start for part, start in zip(parts, first.tolist())], axis=-1)

        self.vertices = np.concatenate([place.vertices for place in places], axis=1)
        first_vertices = starts([place.vertices.shape[1] for place in places])
        self.corners = joined([place.corners for place in places], first_vertices)
        self.starts = starts([place.corners.shape[1] for place in places])
        self.island_starts = starts([len(place.by_island[1]) - 1 for place in places])
        self.islands = joined([place.islands for place in places], self.island_starts)
        faces = joined([place.by_island[0] for place in places], self.starts)
        first_faces = joined([place.by_island[1][:-1] for place in places], self.starts)
        self.by_island = faces, np.append(first_faces, self.starts[-1])


@dataclass(frozen=True, eq=False)
class _Placed(_Surfaces):
    """A solid in the world."""

    solid: Solid
    matrix: np.ndarray

    @cached_property
    def flat(self) -> bool:
        """Whether the matrix leaves no volume."""
        linear = self.matrix[:3, :3]
        return bool(abs(np.linalg.det(linear)) <= 1e-12 * np.prod(np.linalg.norm(linear, axis=0)))

    @cached_property
    def vertices(self) -> np.ndarray:
        """(3, n) world coordinates."""
        return self.matrix[:3, :3] @ self.solid.vertices.T + self.matrix[:3, 3:]

    @cached_property
    def corners(self) -> np.ndarray:
        """(3, m) vertex indices, counterclockwise from outside even where the matrix mirrors."""
        mirrored = np.linalg.det(self.matrix[:3, :3]) < 0.0
        return self.solid.corners[::-1] if mirrored else self.solid.corners

    @cached_property
    def box(self) -> tuple[np.ndarray, np.ndarray]:
        """(3,) lowest and highest coordinates."""
        return self.vertices.min(axis=1), self.vertices.max(axis=1)

    @property
    def starts(self) -> np.ndarray:
        return np.array([0, self.corners.shape[1]])

    @property
    def islands(self) -> np.ndarray:
        return self.solid.islands

    @property
    def by_island(self) -> tuple[np.ndarray, np.ndarray]:
        return self.solid.by_island

    @property
    def island_starts(self) -> np.ndarray:
        return np.array([0, len(self.solid.by_island[1]) - 1])

    @property
    def boxes(self) -> tuple[np.ndarray, np.ndarray]:
        return self.box[0][:, None], self.box[1][:, None]

    @cached_property
    def island_boxes(self) -> tuple[np.ndarray, np.ndarray]:
        return self.boxes if len(self.by_island[1]) == 2 else super().island_boxes

    @cached_property
    def areas(self) -> np.ndarray:
        """(m,) areas of the triangles."""
        return 0.5 * _length(_normals(self))


@dataclass(frozen=True, eq=False)
class _Side:
    """What one body of a pair is to the other.

    :param held: it lies wholly inside the other body.
    :param crosses: its surface crosses or touches the other's, or some of its islands lie inside the other body.
    :param coincident: triangles that share part of a plane with the other's surface; signs: +1 if the normals point the
        same way, else -1; whole: those that lie on it as a whole.
    """

    held: bool = False
    crosses: bool = False
    coincident: np.ndarray = field(default_factory=lambda: _NO_FACES)
    signs: np.ndarray = field(default_factory=lambda: _NO_FACES)
    whole: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=bool))


@dataclass(eq=False)
class Memory:
    """What is known from the last analysis: bodies in the world, and pairs of them."""

    places: dict[tuple, _Placed] = field(default_factory=dict)
    pairs: dict[tuple, tuple[_Side, _Side]] = field(default_factory=dict)


def analyse(bodies: Sequence[Body], memory: Memory | None = None) -> list[Contact]:
    """Tell what lies around every body.

    :param memory: what an earlier analysis found; brought up to date.
    """
    memory = Memory() if memory is None else memory
    if not all(np.isfinite(body.matrix).all() and body.solid.closed for body in bodies):
        memory.places, memory.pairs = {}, {}
        return [Contact(PROBE, robust=body.solid.closed and body.solid.overlaps_itself) for body in bodies]
    keys = [(body.solid, np.ascontiguousarray(body.matrix, dtype=np.float64).tobytes()) for body in bodies]
    places = {
        key: memory.places.get(key) or _Placed(body.solid, np.array(body.matrix, dtype=np.float64))
        for key, body in zip(keys, bodies)
    }
    candidates = _candidates([places[key] for key in keys])
    pairs: dict[tuple, tuple[_Side, _Side] | None] = {}
    for i, j in candidates:
        key = (keys[i], keys[j])
        pairs[key] = memory.pairs.get(key)
    new = [key for key, pair in pairs.items() if pair is None]
    pairs.update(zip(new, _compare([(places[first], places[second]) for first, second in new])))
    sides: list[list[tuple[int, _Side]]] = [[] for _ in bodies]
    for i, j in candidates:
        for one, other, side in zip((i, j), (j, i), pairs[keys[i], keys[j]]):
            if side.held or side.crosses:
                sides[one].append((other, side))
    robust = [body.solid.overlaps_itself or places[key].flat for body, key in zip(bodies, keys)]
    memory.places, memory.pairs = places, pairs
    return _with_levels(bodies, [_contact(i, bodies, sides[i], robust[i]) for i in range(len(bodies))])


def flat_sides(solid: Solid) -> np.ndarray:
    """(m,) a number for each triangle, the same for those of one flat side: joined by edges that do not bend."""
    corners = solid.triangles.T.astype(np.int64)
    a, b = np.concatenate(corners), np.concatenate(np.roll(corners, -1, axis=0))
    edges = np.minimum(a, b) * len(solid.vertices) + np.maximum(a, b)
    order = np.argsort(edges, kind="stable")
    same = edges[order[1:]] == edges[order[:-1]]
    faces = order % len(solid.triangles)
    first, second = faces[:-1][same], faces[1:][same]
    p, q, r = (solid.vertices.T[:, corner] for corner in corners)
    normals = _cross(q - p, r - p)
    u, v = normals[:, first], normals[:, second]
    bend = _length(_cross(u, v))
    flat = (bend <= FLAT * _length(u) * _length(v)) & (_dot(u, v) > 0.0)
    return meshes.connected(len(solid.triangles), first[flat], second[flat])


class Walls:
    """Where the surfaces of bodies are, to tell how far faces may move."""

    def __init__(self, bodies: Sequence[Body]) -> None:
        self._places = [_Placed(body.solid, body.matrix) for body in bodies]
        self.boxes = np.array([place.box for place in self._places]).reshape(-1, 2, 3)
        """(n, 2, 3) lowest and highest coordinates of every body."""

    def clearance(self, index: int, faces: np.ndarray, sides: np.ndarray, reach: float) -> float:
        """Tell how far triangles of a body may move before they meet a wall, a body's own or another's.

        Surfaces that reach a triangle's plane where it lies, and what is straight before less than a hundredth of it,
        are no walls.

        :param faces: (k,) the triangles; sides: (k,) 1 where they move outwards, -1 where inwards.
        :param reach: how far to look, scene units; the answer where there is no wall.
        """
        place = self._places[index]
        own = np.empty_like(place.solid.order)
        own[place.solid.order] = np.arange(len(own))
        faces = own[faces]
        side = np.zeros(len(own))
        side[faces] = sides
        faces = np.sort(faces)
        moved = _Hierarchy(place.bounds[:, faces], np.array([0, len(faces)]))
        low, high = moved.bounds[:3].min(axis=1), -moved.bounds[3:].min(axis=1)
        near = (self.boxes[:, 0] <= high + reach).all(axis=1) & (self.boxes[:, 1] >= low - reach).all(axis=1)
        for beyond in (self._places[other] for other in np.flatnonzero(near)):
            first, second = _meeting(moved, beyond.hierarchy, reach)
            reach = _before(place, faces[first], side, beyond, second, reach)
        return reach


def _before(
    place: _Placed, first: np.ndarray, side: np.ndarray, beyond: _Placed, second: np.ndarray, reach: float
) -> float:
    """The least distance within reach from triangles to those of a surface that lie before them on one side."""
    found = [(_NO_FACES, np.empty(0), np.empty(0))]
    for start in range(0, len(first), CHUNK):
        i, j = first[start : start + CHUNK], second[start : start + CHUNK]
        heights, area = _above(_triangles(beyond, j).swapaxes(0, 1), _triangles(place, i).swapaxes(0, 1))
        lowest = (heights * side[i]).min(axis=0)
        before = np.flatnonzero((lowest > _tolerance(place, beyond)) & (lowest < reach))
        found.append((i[before], lowest[before], area[before]))
    i, lowest, area = (np.concatenate(parts) for parts in zip(*found))
    order = np.lexsort([lowest, i])
    i, lowest, area = i[order], lowest[order], area[order]
    # Of all that lies before one triangle, from the nearest on.
    covered = np.cumsum(area)
    start = np.searchsorted(i, i)
    covered -= covered[start] - area[start]
    return float(lowest[covered >= WALL * place.areas[i]].min(initial=reach))


def resting(surfaces: Sequence[Solid], foreign: Solid) -> list[int]:
    """Tell which surfaces share part of a plane with a foreign one, within the distance at which two bodies touch.

    :param surfaces: in the same space as the foreign one; none need be closed.
    """
    if len(foreign.triangles) == 0 or not surfaces:
        return []
    places = [_Placed(surface, np.eye(4)) for surface in surfaces]
    low, high = (np.array([place.box[end] for place in places]) for end in (0, 1))
    margin = TOLERANCE * np.linalg.norm(high - low, axis=1) + 2.0 * ROUNDING * np.abs([low, high]).max()
    low, high = low - margin[:, None], high + margin[:, None]
    foreign = _cropped(foreign, low.min(axis=0), high.max(axis=0))
    if len(foreign.triangles) == 0:
        return []
    other = _Placed(foreign, np.eye(4))
    return [index for index, place in enumerate(places) if _rests(place, other, low[index], high[index])]


def _cropped(solid: Solid, low: np.ndarray, high: np.ndarray) -> Solid:
    """The triangles whose boxes meet a box."""
    points = solid.vertices[solid.triangles]
    return Solid(
        solid.vertices,
        solid.triangles[((points.min(axis=1) <= high) & (points.max(axis=1) >= low)).all(axis=1)],
    )


def _rests(a: _Placed, b: _Placed, low: np.ndarray, high: np.ndarray) -> bool:
    """Whether surfaces share part of a plane; low, high: the box of a with a margin."""
    faces_b = _faces_in_box(b, low, high)
    if len(faces_b) == 0:
        return False
    margin = (high - low - a.box[1] + a.box[0]) / 2.0
    points = b.points(faces_b)
    faces_a = _faces_in_box(a, points.min(axis=(0, 1)) - margin, points.max(axis=(0, 1)) + margin)
    if len(faces_a) == 0:
        return False
    tolerance = _tolerance(a, b)
    trees = (
        _Hierarchy(place.bounds[:, faces], np.array([0, len(faces)])) for place, faces in ((a, faces_a), (b, faces_b))
    )
    first, second = _meeting(*trees, tolerance)
    index_a, index_b = (_numbered(first, len(faces_a)), _numbered(second, len(faces_b)))
    of_a, of_b = _triangles(a, faces_a[index_a[0]]), _triangles(b, faces_b[index_b[0]])
    i, j, _, tolerances = _parallel(of_a, index_a[1], of_b, index_b[1], np.full(len(first), tolerance))
    return bool(_share_a_plane(of_a, i, of_b, j, tolerances).any())


# Bodies


def _contact(index: int, bodies: Sequence[Body], sides: list[tuple[int, _Side]], robust: bool) -> Contact:
    """What is known of one body, its level apart, from what it is to its partners."""
    partners = tuple(sorted(j for j, _ in sides))
    order = bodies[index].solid.order
    coincident = tuple((j, order[side.coincident], side.signs, side.whole) for j, side in sides if len(side.coincident))
    code, around = (PROBE, None) if robust else _outside(index, bodies, sides)
    return Contact(code, around, robust=robust, partners=partners, coincident=coincident)


def _outside(index: int, bodies: Sequence[Body], sides: list[tuple[int, _Side]]) -> tuple[int, int | None]:
    """The code of a body, and one that is the known surrounding medium: of all that hold it the strongest decides, unless
    another that might win there crosses the body.
    """
    own = bodies[index].priority
    doubted = False
    for priority in sorted({bodies[j].priority for j, _ in sides}):
        members = [(j, side) for j, side in sides if bodies[j].priority == priority]
        holders = [j for j, side in members if side.held]
        if holders and priority <= own:
            return NEVER, None
        if holders and not doubted and len({bodies[j].medium for j, _ in members}) == 1:
            return MEDIUM, holders[0]
        doubted = True
    return PROBE if doubted else AIR, None


def _with_levels(bodies: Sequence[Body], contacts: list[Contact]) -> list[Contact]:
    """The contacts with their levels: of one priority, whose bodies are apart and whole."""
    faults: dict[int, list[tuple[int, ...]]] = {body.priority: [] for body in bodies}
    for i, contact in enumerate(contacts):
        own = bodies[i].priority
        faults[own] += [(i,)] * contact.robust + [(i, j) for j in contact.partners if bodies[j].priority == own]
    result = []
    for i, contact in enumerate(contacts):
        priorities = {bodies[j].priority for j in contact.partners}
        if contact.code == PROBE and not contact.robust and len(priorities) == 1:
            (level,) = priorities
            # The body's own surface is left out.
            if all(i in fault for fault in faults[level]):
                contact = replace(contact, level=level)
        result.append(contact)
    return result


# Pairs


def _candidates(places: Sequence[_Placed]) -> list[tuple[int, int]]:
    """Pairs of bodies whose boxes meet."""
    if len(places) < 2:
        return []
    low, high = np.array([place.box for place in places]).transpose(1, 2, 0)
    first, second = _overlapping_boxes(low, high, 2.0 * TOLERANCE)
    return list(zip(first.tolist(), second.tolist()))


def _overlapping_boxes(low: np.ndarray, high: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of boxes that meet when grown by a part of their size, the first with the lower number.

    :param low: (3, n) lowest coordinates; high: highest.
    """
    size = _length(high - low)
    margin = tolerance * size + 2.0 * ROUNDING * np.abs(np.concatenate([low, high])).max(axis=0) * (tolerance > 0.0)
    order = _morton_order((low + high) / 2.0)
    boxes = _Hierarchy(np.concatenate([low - margin, -high - margin])[:, order], np.array([0, len(order)]))
    first, second = _meeting(boxes, boxes, 0.0)
    first, second = order[first], order[second]
    once = first < second
    return first[once], second[once]


def _ranges(start: np.ndarray, stop: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All pairs of a place i and a number in [start[i], stop[i])."""
    lengths = stop - start
    owner = np.repeat(np.arange(len(start)), lengths)
    return owner, np.arange(len(owner)) + (start - (np.cumsum(lengths) - lengths))[owner]


def _compare(pairs: Sequence[tuple[_Placed, _Placed]]) -> list[tuple[_Side, _Side]]:
    """What two bodies are to each other, for every pair. Small ones are looked at together."""
    result: dict[int, tuple[_Side, _Side]] = {}
    crowds: list[list[int]] = [[]]
    room = CROWD
    known: set[int] = set()
    for number, pair in enumerate(pairs):
        counts = {id(place): place.corners.shape[1] for place in pair}
        if min(counts.values()) > SMALL:
            result[number] = _compare_some([pair])[0]
            continue
        room -= sum(count for place, count in counts.items() if place not in known)
        if room < 0:
            crowds.append([])
            room = CROWD - sum(counts.values())
            known = set()
        crowds[-1].append(number)
        known.update(counts)
    for numbers in crowds:
        result.update(zip(numbers, _compare_some([pairs[number] for number in numbers])))
    return [result[number] for number in range(len(pairs))]


def _compare_some(pairs: Sequence[tuple[_Placed, _Placed]]) -> list[tuple[_Side, _Side]]:
    """What two bodies are to each other, for some pairs at once."""
    if not pairs:
        return []
    tolerances, alike = _tolerances(pairs)
    result = {}
    for number in alike:
        side = _same_faces(*pairs[number], tolerances[number])
        if side is not None:
            result[number] = (side, side)
    left = [number for number in range(len(pairs)) if number not in result]
    if len(left) == 1:
        a, b = pairs[left[0]]
        first = second = np.zeros(1, dtype=np.intp)
    elif left:
        places = {id(place): place for number in left for place in pairs[number]}
        a = b = _Crowd(list(places.values()))
        index = {place: number for number, place in enumerate(places)}
        first, second = (np.array([index[id(pairs[number][end])] for number in left]) for end in (0, 1))
    if left:
        result.update(zip(left, _sides(a, first, b, second, tolerances[left])))
    return [result[number] for number in range(len(pairs))]


def _sides(
    a: _Surfaces, first: np.ndarray, b: _Surfaces, second: np.ndarray, tolerance: np.ndarray
) -> list[tuple[_Side, _Side]]:
    """What bodies are to each other in pairs.

    :param first: (n,) which body of a each pair has; second: which of b; tolerance: within which they touch.
    """
    i, j = _meeting(a.hierarchy, b.hierarchy, float(tolerance.max()), first, second)
    pair = _pairs_of(a, i, first, b, j, second)
    touch, coincident = _touching(a, i, b, j, pair, tolerance)
    sides = []
    for surfaces, bodies, others, partners, found in zip((a, b), (first, second), (b, a), (second, first), coincident):
        inside = np.zeros(len(first), dtype=np.intp)
        inside[~touch] = _islands_inside(surfaces, bodies[~touch], others, partners[~touch], tolerance[~touch])
        held = inside == np.diff(surfaces.island_starts)[bodies]
        sides.append(_split(surfaces, bodies, held, touch | (~held & (inside > 0)), *found))
    return list(zip(*sides))


def _pairs_of(
    a: _Surfaces, i: np.ndarray, first: np.ndarray, b: _Surfaces, j: np.ndarray, second: np.ndarray
) -> np.ndarray:
    """The pair of bodies to which each pair of triangles belongs."""
    if len(first) == 1:
        return np.zeros(len(i), dtype=np.intp)
    count = len(b.starts)
    keys = first * count + second
    order = np.argsort(keys)
    bodies = (np.searchsorted(each.starts, faces, side="right") - 1 for each, faces in ((a, i), (b, j)))
    return order[np.searchsorted(keys[order], next(bodies) * count + next(bodies))]


_NOTHING = _Side()


def _split(
    surfaces: _Surfaces,
    bodies: np.ndarray,
    held: np.ndarray,
    crosses: np.ndarray,
    coincident: np.ndarray,
    signs: np.ndarray,
    whole: np.ndarray,
) -> list[_Side]:
    """The sides of some pairs; coincident: sorted triangles, each by its place in a table with a row for every pair."""
    width = surfaces.corners.shape[1]
    ends = np.searchsorted(coincident, width * np.arange(len(bodies) + 1)).tolist()
    result = []
    for number, first in enumerate((width * np.arange(len(bodies)) + surfaces.starts[bodies]).tolist()):
        if held[number] or crosses[number]:
            some = slice(*ends[number : number + 2])
            result.append(
                _Side(bool(held[number]), bool(crosses[number]), coincident[some] - first, signs[some], whole[some])
            )
        else:
            result.append(_NOTHING)
    return result


def _tolerance(a: _Placed, b: _Placed) -> float:
    """The distance within which surfaces of two bodies touch."""
    return float(_tolerances([(a, b)])[0][0])


def _tolerances(pairs: Sequence[tuple[_Placed, _Placed]]) -> tuple[np.ndarray, list[int]]:
    """The distance within which surfaces of two bodies touch, for every pair; the pairs with equal boxes."""
    boxes = np.array([(a.box, b.box) for a, b in pairs])
    size = np.linalg.norm(boxes[:, :, 1] - boxes[:, :, 0], axis=2).min(axis=1)
    tolerances = TOLERANCE * size + ROUNDING * np.abs(boxes).max(axis=(1, 2, 3))
    apart = np.abs(boxes[:, 0] - boxes[:, 1]).max(axis=(1, 2))
    return tolerances, np.flatnonzero(apart <= tolerances).tolist()


def _same_faces(a: _Placed, b: _Placed, tolerance: float) -> _Side | None:
    """The side of either of two bodies with the same triangles in the same places."""
    if a.corners.shape != b.corners.shape or a.vertices.shape != b.vertices.shape:
        return None
    if not np.array_equal(a.corners, b.corners) or np.abs(a.vertices - b.vertices).max() > tolerance:
        return None
    faces = np.arange(a.corners.shape[1])
    every = np.ones(len(faces), dtype=np.int8)
    return _Side(crosses=True, coincident=faces, signs=every, whole=every.astype(bool))


def _faces_in_box(place: _Placed, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Triangles whose boxes meet a box."""
    return _in_boxes(place.hierarchy, _ONE, low[:, None], high[:, None])[1]


def _in_boxes(tree: _Hierarchy, trees: np.ndarray, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of a box and one of the smallest boxes of a tree that meets it.

    :param trees: (n,) the tree for each box; low, high: (3, n) the boxes.
    """
    boxes = np.concatenate([low, -high])
    node, box = _meet(tree.levels[-1], tree.tops.take(trees), boxes, np.arange(len(trees)), 0.0)
    for level in reversed(range(len(tree.levels) - 1)):
        node, box = _children_meet(tree, level, node, boxes, box, 0.0)
    return box, tree.items.take(node)


def _normals(place: _Placed, faces: np.ndarray | slice = slice(None)) -> np.ndarray:
    """(3, ...) outward normals of triangles, as long as twice their areas."""
    a, b, c = (corner[faces] for corner in place.corners)
    u, v = ([], [])
    for axis in place.vertices:
        first = axis[a]
        u.append(axis[b] - first)
        v.append(axis[c] - first)
    return _cross(u, v)


# Where two surfaces touch


def _morton_order(points: np.ndarray) -> np.ndarray:
    """(3, k) points sorted along a curve that fills space (Morton 1966)."""
    code = np.zeros(points.shape[1], dtype=np.int64)
    for axis, place in enumerate(points):
        low = place.min()
        bits = ((place - low) * (1023.0 / max(float(place.max() - low), 1e-300))).astype(np.int64)
        for shift, mask in ((16, 0x30000FF), (8, 0x300F00F), (4, 0x30C30C3), (2, 0x9249249)):
            bits = (bits | (bits << shift)) & mask
        code |= bits << axis
    return np.argsort(code)


@dataclass(frozen=True, eq=False)
class _Hierarchy:
    """Trees of ever larger boxes, all of one depth.

    :param bounds: (6, n) lowest coordinates of the smallest boxes and highest ones negated, neighbours in space one after
        the other, one tree's after the other's.
    :param starts: (trees + 1,) first box of each tree, and the number of all.
    """

    bounds: np.ndarray
    starts: np.ndarray

    @cached_property
    def _built(self) -> tuple[list[np.ndarray], list[np.ndarray | None], np.ndarray, np.ndarray]:
        counts, bounds = np.diff(self.starts), self.bounds
        single = len(counts) == 1
        levels: list[np.ndarray] = []
        groups: list[np.ndarray | None] = [None]
        while True:
            room = counts + -counts % CHILDREN
            starts = np.concatenate([[0], np.cumsum(room)])
            places = np.arange(len(bounds[0])) + np.repeat(starts[:-1] - np.cumsum(counts) + counts, counts)
            if single and bounds.base is not None and bounds.base.shape == (6, starts[-1]):
                level = bounds.base
            else:
                level = np.full((6, starts[-1]), np.inf)
                level[:, slice(len(places)) if single else places] = bounds
            if not levels:
                items = np.full(starts[-1], -1)
                items[places] = np.arange(len(places))
            elif single:
                groups.append(None)
            else:
                group = np.zeros(starts[-1], dtype=np.intp)
                group[places] = np.arange(len(places))
                groups.append(group)
            levels.append(level)
            if counts.max() <= 1:
                return levels, groups, items, starts[:-1]
            counts, bounds = room // CHILDREN, _joined(level)

    @property
    def levels(self) -> list[np.ndarray]:
        """(6, count) boxes, then those of every CHILDREN of them, and so on; every tree's filled up to whole groups with
        such as nothing meets.
        """
        return self._built[0]

    @property
    def groups(self) -> list[np.ndarray | None]:
        """For each level from the second on, the group of the level below that each box holds; None where it has the
        same number.
        """
        return self._built[1]

    @property
    def items(self) -> np.ndarray:
        """The place in the bounds of every box of the first level."""
        return self._built[2]

    @property
    def tops(self) -> np.ndarray:
        """(trees,) box of the last level that holds all of a tree."""
        return self._built[3]


def _padded(count: int) -> np.ndarray:
    """(6, count) room for boxes, the first columns of such that nothing meets and that fill the last group."""
    return np.full((6, count + -count % CHILDREN), np.inf)[:, :count]


def _joined(level: np.ndarray) -> np.ndarray:
    """The boxes of the groups of a level."""
    children = np.moveaxis(level.reshape(6, -1, CHILDREN), 2, 0)
    joined = _padded(children.shape[2])
    np.minimum(children[0], children[1], out=joined)
    for child in children[2:]:
        np.minimum(joined, child, out=joined)
    return joined


_ONE = np.zeros(1, dtype=np.intp)


def _meeting(
    a: _Hierarchy, b: _Hierarchy, tolerance: float, first: np.ndarray = _ONE, second: np.ndarray = _ONE
) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of the smallest boxes in pairs of trees that are no farther apart than the tolerance along each axis."""
    depth = [len(a.levels) - 1, len(b.levels) - 1]
    i, j = _meet(a.levels[-1], a.tops.take(first), b.levels[-1], b.tops.take(second), tolerance)
    while any(depth) and len(i):
        if depth[0] >= depth[1]:
            depth[0] -= 1
            i, j = _children_meet(a, depth[0], i, b.levels[depth[1]], j, tolerance)
        else:
            depth[1] -= 1
            j, i = _children_meet(b, depth[1], j, a.levels[depth[0]], i, tolerance)
    if any(depth):
        return _NO_FACES, _NO_FACES
    return a.items.take(i), b.items.take(j)


def _meet(
    a: np.ndarray, i: np.ndarray, b: np.ndarray, j: np.ndarray, tolerance: float, axes: Sequence[int] = (0, 1, 2)
) -> tuple[np.ndarray, np.ndarray]:
    """The pairs of places in two arrays of bounds that meet."""
    for axis in axes:
        meet = a[axis].take(i) + b[axis + 3].take(j) <= tolerance
        meet &= b[axis].take(j) + a[axis + 3].take(i) <= tolerance
        meet = np.flatnonzero(meet)
        i, j = i.take(meet), j.take(meet)
    return i, j


def _children_meet(
    tree: _Hierarchy, level: int, i: np.ndarray, b: np.ndarray, j: np.ndarray, tolerance: float
) -> tuple[np.ndarray, np.ndarray]:
    """The pairs of places in a tree's level and in an array of bounds that meet, the first among the children of boxes i
    of the level above.
    """
    if tree.groups[level + 1] is not None:
        i = tree.groups[level + 1].take(i)
    a = tree.levels[level]
    # Children stand side by side, so along one axis they are read by the group.
    groups = a.reshape(6, -1, CHILDREN)
    meet = groups[0].take(i, axis=0) + b[3].take(j)[:, None] <= tolerance
    meet &= b[0].take(j)[:, None] + groups[3].take(i, axis=0) <= tolerance
    found = np.flatnonzero(meet)
    pair = found // CHILDREN
    return _meet(a, (i.take(pair) - pair) * CHILDREN + found, b, j.take(pair), tolerance, (1, 2))


def _touching(
    a: _Surfaces, i: np.ndarray, b: _Surfaces, j: np.ndarray, pair: np.ndarray, tolerance: np.ndarray
) -> tuple[np.ndarray, list[tuple[np.ndarray, np.ndarray, np.ndarray]]]:
    """Which bodies cross, touch or coincide in pairs, and with which faces they coincide.

    :param i: (n,) triangles of a; j: those of b which may; pair: the pair of bodies to which both belong.
    :param tolerance: of every pair of bodies.
    :return: whether each pair touches; for a and b: triangles that coincide, their signs, and whether they do as a whole.
        Triangles are sorted, each by its place in a table with a row for every pair.
    """
    touch = np.zeros(len(tolerance), dtype=bool)
    if len(i) == 0:
        return touch, 2 * [(_NO_FACES, _NOTHING.signs, _NOTHING.whole)]
    (keys_a, i), (keys_b, j) = (
        _numbered(pair * width + faces, len(tolerance) * width)
        for faces, width in ((i, a.corners.shape[1]), (j, b.corners.shape[1]))
    )
    of_a, of_b = (_triangles(each, keys % each.corners.shape[1]) for each, keys in ((a, keys_a), (b, keys_b)))
    chunks = [slice(start, start + CHUNK) for start in range(0, len(i), CHUNK)]
    pairs = [_not_apart(of_a, i[chunk], of_b, j[chunk], tolerance[pair[chunk]]) for chunk in chunks]
    i, j, tolerance = (np.concatenate(parts) for parts in zip(*pairs))
    touch[keys_a[i] // a.corners.shape[1]] = True
    i, j, cosine, tolerance = _parallel(of_a, i, of_b, j, tolerance)
    shared = _share_a_plane(of_a, i, of_b, j, tolerance)
    result = []
    for keys, *other in ((keys_a, of_a, i, of_b, j), (keys_b, of_b, j, of_a, i)):
        faces, signs, whole = _coincident(*other, cosine, shared, tolerance)
        result.append((keys[faces], signs, whole))
    return touch, result


def _triangles(place: _Placed, faces: np.ndarray) -> np.ndarray:
    """(4, 3 axes, k) the corners of triangles and their unit normals."""
    normals = _normals(place, faces)
    points = place.vertices[:, place.corners[:, faces]].transpose(1, 0, 2)
    return np.concatenate([points, (normals / np.maximum(_length(normals), 1e-300))[None]])


def _numbered(values: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """The sorted different numbers below a count among some values, and each value's place among them."""
    if count > TABLE + 8 * values.size:
        different, place = np.unique(values, return_inverse=True)
        return different, place.reshape(values.shape)
    different = _sorted_set(values, count)
    place = np.empty(count, dtype=np.intp)
    place[different] = np.arange(len(different))
    return different, place[values]


def _sorted_set(values: np.ndarray, count: int) -> np.ndarray:
    """The sorted different numbers below a count among some values."""
    used = np.zeros(count, dtype=bool)
    used[values] = True
    return np.flatnonzero(used)


def _by_number(numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The places of every number among some, one number's after the other's; (k + 1,) the first of each."""
    starts = np.concatenate([[0], np.cumsum(np.bincount(numbers))])
    return np.arange(len(numbers)) if len(starts) == 2 else np.argsort(numbers, kind="stable"), starts


def _dot(u: Sequence[np.ndarray], v: Sequence[np.ndarray]) -> np.ndarray:
    """Scalar products; the first axis is that of coordinates."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def _length(vectors: Sequence[np.ndarray]) -> np.ndarray:
    """Lengths; the first axis is that of coordinates."""
    return np.sqrt(_dot(vectors, vectors))


def _cross(u: Sequence[np.ndarray], v: Sequence[np.ndarray]) -> np.ndarray:
    """Vector products; the first axis is that of coordinates."""
    return np.stack([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])


def _not_apart(
    a: np.ndarray, i: np.ndarray, b: np.ndarray, j: np.ndarray, tolerance: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The pairs of triangles between which no plane leaves a gap of more than the tolerance, and their tolerances.

    Of two convex polyhedra that are apart, some plane along a face of one, or along an edge of each, lies between
    (Gottschalk, Lin and Manocha 1996, OBBTree); of two flat ones in nearly a plane, one that stands on an edge.

    :param a: (4, 3 axes, k) triangles; i: (n,) which of them each pair has; b and j: the others; tolerance: (n,).
    """
    keep = _off_plane(a[:, :, i], b[0][:, j], b[3][:, j]) <= tolerance
    i, j, tolerance = i[keep], j[keep], tolerance[keep]
    keep = _off_plane(b[:, :, j], a[0][:, i], a[3][:, i]) <= tolerance
    i, j, tolerance = i[keep], j[keep], tolerance[keep]
    if len(i) == 0:
        return i, j, tolerance
    p, q = a[:, :, i].swapaxes(0, 1), b[:, :, j].swapaxes(0, 1)
    edges_p, edges_q = _edges(p), _edges(q)
    keep = _overlap(p, q, _cross(edges_p[:, :, None], edges_q[:, None]).reshape(3, 9, -1), tolerance)
    flat = np.flatnonzero(keep & (np.abs(_dot(p[:, 3], q[:, 3])) >= NEARLY_PARALLEL))
    if len(flat):
        p, q = p[:, :, flat], q[:, :, flat]
        within = _cross(edges_p[:, :, flat], p[:, 3:]), _cross(edges_q[:, :, flat], q[:, 3:])
        keep[flat] = _overlap(p, q, np.concatenate(within, axis=1), tolerance[flat])
    return i[keep], j[keep], tolerance[keep]


def _overlap(p: np.ndarray, q: np.ndarray, axes: np.ndarray, tolerance: np.ndarray) -> np.ndarray:
    """(k,) whether triangles overlap along all axes, but for a gap of the tolerance. p, q: (3 axes, 3 or more, k); axes:
    (3, n, k).
    """
    length = _length(axes)
    along_p, along_q = (_dot((t[:, :3] - q[:, :1])[:, :, None], axes[:, None]) for t in (p, q))
    gap = np.maximum(along_p.min(axis=0) - along_q.max(axis=0), along_q.min(axis=0) - along_p.max(axis=0))
    # Nearly parallel edges span no plane.
    return ((gap <= tolerance * length) | (length < 1e-6)).all(axis=0)


def _off_plane(triangles: np.ndarray, point: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """(k,) distances of (4, 3 axes, k) triangles from planes through (3, k) points; negative where the planes cross."""
    heights = [_dot(corner - point, normal) for corner in triangles[:3]]
    lowest = np.minimum(np.minimum(heights[0], heights[1]), heights[2])
    highest = np.maximum(np.maximum(heights[0], heights[1]), heights[2])
    return np.maximum(lowest, -highest)


def _edges(triangles: np.ndarray) -> np.ndarray:
    """(3 axes, 3, k) unit vectors from each corner of (3 axes, 3 or more, k) triangles to the next."""
    edges = np.roll(triangles[:, :3], -1, axis=1) - triangles[:, :3]
    return edges / np.maximum(_length(edges), 1e-300)


def _parallel(
    a: np.ndarray, i: np.ndarray, b: np.ndarray, j: np.ndarray, tolerance: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The pairs of triangles that are parallel, the products of their normals, and their tolerances."""
    cosine = _dot(a[3][:, i], b[3][:, j])
    parallel = np.abs(cosine) >= PARALLEL
    return i[parallel], j[parallel], cosine[parallel], tolerance[parallel]


def _coincident(
    a: np.ndarray,
    i: np.ndarray,
    b: np.ndarray,
    j: np.ndarray,
    cosine: np.ndarray,
    shared: np.ndarray,
    tolerance: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which triangles of a coincide with parallel ones of b, in part or as a whole.

    :param a: (4, 3 axes, k) triangles; i: (n,) which of them each pair has; b and j: the others.
    :param cosine: (n,) products of the normals; shared: whether the pair shares part of a plane; tolerance: within which
        that is.
    :return: the triangles; int8 signs of the products; whether all corners and the centre lie on some of b.
    """
    q = b[:, :, j]
    edges = _edges(q.swapaxes(0, 1))
    samples = np.concatenate([a[:3], a[:3].mean(axis=0, keepdims=True)])[:, :, i].swapaxes(0, 1)
    on = np.abs(_dot(samples - q[0][:, None], q[3][:, None])) <= tolerance
    for corner in range(3):
        on &= _dot(samples - q[corner][:, None], _cross(q[3], edges[:, corner])[:, None]) >= -tolerance
    covered = np.zeros((4, a.shape[2]), dtype=bool)
    for sample in range(4):
        covered[sample, i[on[sample]]] = True
    whole = covered.all(axis=0)
    signs = np.zeros(a.shape[2], dtype=np.int8)
    for pairs in (shared, on[3]):
        signs[i[pairs]] = np.where(cosine[pairs] >= 0.0, 1, -1)
    in_part = np.zeros(a.shape[2], dtype=bool)
    in_part[i[shared]] = True
    faces = np.flatnonzero(whole | in_part)
    return faces, signs[faces], whole[faces]


def _share_a_plane(a: np.ndarray, i: np.ndarray, b: np.ndarray, j: np.ndarray, tolerance: np.ndarray) -> np.ndarray:
    """(n,) whether nearly parallel triangles overlap by more than the tolerance where they lie in one place."""
    result = np.zeros(len(i), dtype=bool)
    for start in range(0, len(i), CHUNK):
        chunk = slice(start, start + CHUNK)
        p, q = a[:, :, i[chunk]].swapaxes(0, 1), b[:, :, j[chunk]].swapaxes(0, 1)
        within = _cross(_edges(p), p[:, 3:]), _cross(_edges(q), q[:, 3:])
        found = np.flatnonzero(_overlap(p, q, np.concatenate(within, axis=1), -tolerance[chunk]))
        heights, _ = _above(p[:, :, found], q[:, :, found])
        result[start + found] = np.nan_to_num(np.abs(heights), nan=np.inf).max(axis=0) <= tolerance[chunk][found]
    return result


def _above(p: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What of triangles p lies straight above or below triangles q, both (3 axes, 4, k) with their normals.

    :return: (6, k) heights above q's plane of the corners of that part, not numbers where there is none; (k,) its area as
        seen along q's normal.
    """
    polygon = p[:, :3] - q[:, :1]
    edges = _edges(q)
    for corner in range(3):
        start = (q[:, corner] - q[:, 0])[:, None]
        polygon = _clipped(polygon, _dot(polygon - start, _cross(q[:, 3], edges[:, corner])[:, None]))
    normal = q[:, 3:]
    area = 0.5 * np.abs(_dot(_cross(polygon, np.roll(polygon, -1, axis=1)), normal).sum(axis=0))
    return _dot(polygon, normal), np.nan_to_num(area)


def _clipped(polygons: np.ndarray, heights: np.ndarray) -> np.ndarray:
    """The parts of convex polygons above a plane, by its heights (Sutherland and Hodgman 1974, Reentrant polygon clipping).

    :param polygons: (3 axes, n, k) corners in order, some repeated where there are fewer; heights: (n, k).
    :return: (3 axes, n + 1, k); not numbers where nothing is left.
    """
    count, number = heights.shape
    following = np.roll(heights, -1, axis=0)
    above = heights >= 0.0
    crossed = above != (following >= 0.0)
    part = np.divide(heights, heights - following, out=np.zeros_like(heights), where=crossed)
    cuts = polygons + part * (np.roll(polygons, -1, axis=1) - polygons)
    corners = np.stack([polygons, cuts], axis=2).reshape(3, 2 * count, number)
    kept = np.stack([above, crossed], axis=1).reshape(2 * count, number)
    order = np.argsort(~kept, axis=0, kind="stable")[: count + 1]
    order = np.where(np.arange(count + 1)[:, None] < kept.sum(axis=0), order, order[0])
    return np.where(kept.any(axis=0), np.take_along_axis(corners, order[None], axis=1), np.nan)


# What holds what


def _islands_inside(
    a: _Surfaces, first: np.ndarray, b: _Surfaces, second: np.ndarray, tolerance: np.ndarray
) -> np.ndarray:
    """How many islands of bodies lie inside the other body of a pair, whose surfaces are apart; (n,).

    :param first: (n,) which body of a each pair has; second: which of b; tolerance: of the pair.
    """
    low, high = (side[:, second] + margin for side, margin in zip(b.boxes, (-tolerance, tolerance)))
    pair, island = _ranges(a.island_starts[first], a.island_starts[first + 1])
    lowest, highest = a.island_boxes
    within = (lowest[:, island] >= low[:, pair]) & (highest[:, island] <= high[:, pair])
    pair, island = (each[within.all(axis=0)] for each in (pair, island))
    faces, starts = a.by_island
    inside = _windings(a.centroids(faces[starts[island]]), b, second[pair]) >= 1  # one triangle speaks for all
    return np.bincount(pair[inside], minlength=len(first))


def _windings(
    points: np.ndarray, surfaces: _Surfaces, bodies: np.ndarray | None = None, left_out: np.ndarray | None = None
) -> np.ndarray:
    """The winding numbers of closed meshes about points, as signed crossings along rays upwards.

    An island counts only where a point lies in its box.

    :param points: (k, 3).
    :param bodies: (k,) the body for each point; None for the first.
    :param left_out: (k,) the triangle that is not counted for each point.
    :return: (k,) integers.
    """
    bodies = np.zeros(len(points), dtype=np.intp) if bodies is None else bodies
    by_island = surfaces.by_island[0]
    result = np.zeros(len(points), dtype=np.intp)
    for start in range(0, len(points), CHUNK):
        some = slice(start, start + CHUNK)
        owner, island = _islands_around(points[some], surfaces, bodies[some])
        owner += start
        low = points[owner].T
        high = np.array([low[0], low[1], np.full(len(owner), HIGH)])
        ray, face = _in_boxes(surfaces.island_trees, island, low, high)
        owner, face = owner[ray], by_island[face]
        if left_out is not None:
            other = face != left_out[owner]
            owner, face = owner[other], face[other]
        result += _crossings(points, surfaces, owner, face)
    return result


def _islands_around(points: np.ndarray, surfaces: _Surfaces, bodies: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of a point and an island of one body in whose box it may lie. points: (n, 3); bodies: (n,)."""
    count = len(surfaces.by_island[1]) - 1
    if count == len(surfaces.starts) - 1:
        return np.arange(len(points)), bodies
    island, tree = surfaces.pieces
    owner, piece = _in_boxes(tree, bodies, points.T, points.T)
    return np.divmod(np.unique(owner * count + island[piece]), count)


def _crossings(points: np.ndarray, place: _Surfaces, owner: np.ndarray, face: np.ndarray) -> np.ndarray:
    """Signed crossings of the rays upwards from points with some triangles, outwards positive.

    An edge that a ray meets is decided as if the point were moved by an infinitesimal along x and a smaller one along y
    (Edelsbrunner and Muecke 1990, Simulation of simplicity), so neighbouring triangles agree.

    :param points: (k, 3).
    :param owner: (n,) points; face: the triangles that may lie above each.
    :return: (k,) integers.
    """
    a, b, c = (place.vertices[:, corner[face]] - points[owner].T for corner in place.corners)
    areas = [_area(u, v) for u, v in ((b, c), (c, a), (a, b))]
    sides = [_side(area, u, v) for area, (u, v) in zip(areas, ((b, c), (c, a), (a, b)))]
    covered = (sides[0] == sides[1]) & (sides[1] == sides[2])
    above = (areas[0] * a[2] + areas[1] * b[2] + areas[2] * c[2]) * sides[0] > 0.0
    crossing = np.where(covered & above, sides[0], 0)
    return np.rint(np.bincount(owner, weights=crossing, minlength=len(points))).astype(np.intp)


def _area(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Twice the signed area of the triangle of the origin, u and v as seen from above; of opposite sign for v, u."""
    return u[0] * v[1] - u[1] * v[0]


def _side(area: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """+1 if a point just beside the origin lies left of the edge from u to v, -1 if right of it, 0 for a vertical one."""
    side = np.sign(area)
    side = np.where(side == 0.0, -np.sign(v[1] - u[1]), side)
    return np.where(side == 0.0, np.sign(v[0] - u[0]), side)


# Within one mesh


def _star_shaped(place: _Placed) -> np.ndarray:
    """(k,) whether each island is certainly star-shaped about its centre, so that it cannot cross itself.

    Where all triangles look away from the centre and a ray from it meets but one, none lies behind another.
    """
    islands = place.solid.islands
    low, high = place.island_boxes
    centre = (low + high) / 2.0
    size = np.linalg.norm(high - low, axis=0)
    normals = _normals(place)
    offset = [axis[place.corners[0]] - c[islands] for axis, c in zip(place.vertices, centre)]
    behind = _dot(offset, normals) < LEAST_HEIGHT * size[islands] * _length(normals)
    star = np.bincount(islands[behind], minlength=len(size)) == 0
    over = star[islands]
    for axis, c in zip(place.vertices[:2], centre[:2]):
        beyond = [axis[corner] > c[islands] for corner in place.corners]
        over &= (beyond[0] != beyond[1]) | (beyond[1] != beyond[2])
    faces = np.flatnonzero(over)
    return star & (_crossings(centre.T, place, islands[faces], faces) == 1)


def _islands_touch(place: _Placed) -> bool:
    """Whether the surfaces of two islands cross or touch."""
    size = _length(np.subtract(*place.island_boxes))
    tolerance = TOLERANCE * size + ROUNDING * float(np.abs(place.box).max())
    faces, trees = place.by_island[0], place.island_trees
    first, second = _near_islands(place, tolerance)
    for start in range(0, len(first), CHUNK):
        chunk = slice(start, start + CHUNK)
        i, j = _meeting(trees, trees, float(tolerance.max()), first[chunk], second[chunk])
        for begin in range(0, len(i), CHUNK):
            some = faces[i[begin : begin + CHUNK]], faces[j[begin : begin + CHUNK]]
            least = np.minimum(*(tolerance[place.islands[each]] for each in some))
            number = np.arange(len(least))
            if len(_not_apart(_triangles(place, some[0]), number, _triangles(place, some[1]), number, least)[0]):
                return True
    return False


def _near_islands(place: _Placed, tolerance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of islands that may touch, which are no farther apart than the tolerance of one of them."""
    island, tree = place.pieces
    grown = _Hierarchy(tree.bounds - tolerance[island], tree.starts)
    first, second = (island[piece] for piece in _meeting(grown, grown, 0.0))
    once = first < second
    return np.divmod(np.unique(first[once] * len(tolerance) + second[once]), len(tolerance))


def _frame(place: _Placed) -> np.ndarray:
    """(4, 4) what turns the axes along which islands extend the least and the most to x and z, so that boxes of many that
    lie askew, but alike, are apart.
    """
    axes, extent, _ = place.island_axes
    long = (axes * extent.T[:, None]).transpose(1, 0, 2).reshape(3, -1)
    result = np.eye(4)
    result[:3, :3] = np.linalg.eigh(long @ long.T)[1].T
    result[0] *= np.linalg.det(result)
    return result


def _cut(surfaces: _Surfaces) -> tuple[np.ndarray, np.ndarray]:
    """Boxes that together hold all islands: those that would leave most of a box empty, as long or flat ones do that lie
    askew, are cut along their own axes.

    :return: (6, n) lowest coordinates and highest ones negated; (n,) the island in each.
    """
    axes, extent, middle = surfaces.island_axes
    skew = np.sort(np.abs(axes), axis=1)[:, 1].T * extent
    thin = np.maximum(extent, 1e-9 * extent[0])
    parts = np.array([np.clip(skew[i] / thin[i + 1], 1, PIECES[i]).astype(int) for i in range(2)])
    island, number = _ranges(np.zeros(parts.shape[1], dtype=int), parts[0] * parts[1])
    part = np.divmod(number, parts[1][island])
    step = extent / np.array([*parts, np.ones(parts.shape[1])])
    offset = (np.array([*part, 0 * number]) + 0.5) * step[:, island] - 0.5 * extent[:, island]
    centre = middle[:, island] + np.einsum("nka,an->kn", axes[island], offset)
    # Cut boxes must not leave a gap to rounding.
    half = np.einsum("nka,an->kn", np.abs(axes), step / 2.0)[:, island] + ROUNDING * np.abs(centre).max()
    return np.concatenate([centre - half, -centre - half]), island


def _outer_windings(place: _Placed) -> np.ndarray:
    """(k,) the winding number of the mesh just outside one triangle of every island."""
    islands = place.solid.islands
    up = _normals(place)[2]
    steep = np.lexsort([np.abs(up), islands])
    faces = steep[np.cumsum(np.bincount(islands)) - 1]
    # The ray upwards from just outside a triangle that looks down enters through it.
    return _windings(place.centroids(faces), place, left_out=faces) - (up[faces] < 0.0)


def _crosses_itself(place: _Placed, faces: np.ndarray) -> bool:
    """Whether some triangles of a mesh cross, beyond the vertices and edges that they share."""
    centre = (place.box[0] + place.box[1]) / 2.0
    size = float((place.box[1] - place.box[0]).max())
    used, corners = _numbered(place.corners[:, faces], place.vertices.shape[1])
    vertices = ((place.vertices[:, used].T - centre) / max(size, 1e-300)).tolist()
    # Shared corners are known to the tree by their indices.
    tree = BVHTree.FromPolygons(vertices, corners.reshape(3, -1).T.tolist(), all_triangles=True, epsilon=1e-12)
    pairs = np.array(tree.overlap(tree), dtype=np.intp).reshape(-1, 2)
    if len(pairs) == 0:
        return False
    first, second = place.points(faces[pairs[:, 0]]), place.points(faces[pairs[:, 1]])
    return bool(np.any(_pierces(first, second) | _pierces(second, first)))


def _pierces(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """(k,) whether an edge of one triangle runs through the inside of another, by more than rounding.

    :param first: (k, 3 corners, 3 axes) triangles with the edges; second: those with the insides.
    """
    size = np.abs(second - second[:, :1]).max(axis=(1, 2)) + np.abs(first - second[:, :1]).max(axis=(1, 2))
    least = 1e-9 * size**3
    a, b, c = second.transpose(1, 0, 2)
    result = np.zeros(len(first), dtype=bool)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        start, end = first[:, i], first[:, j]
        through = _orientation(a, b, c, start), _orientation(a, b, c, end)
        sides = [_orientation(start, end, u, v) for u, v in ((a, b), (b, c), (c, a))]
        apart = (np.abs(through[0]) > least) & (np.abs(through[1]) > least) & (through[0] * through[1] < 0.0)
        inside = np.all([side > least for side in sides], axis=0) | np.all([side < -least for side in sides], axis=0)
        result |= apart & inside
    return result


def _orientation(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """(k,) six signed volumes of tetrahedra."""
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a)
