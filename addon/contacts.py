"""Which media touch which: what lies around the faces of closed meshes that overlap. Arrays in, answers out.

A face away from all crossings has the same surroundings as its neighbours, so one winding number answers for a whole
connected piece of a surface. Faces near a crossing stay unknown: rays must ask the scene there.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property

import numpy as np
from mathutils.bvhtree import BVHTree

from . import meshes

# What is known of the outside of a face: nothing (ask the scene); it is air; it is the body's known surrounding medium;
# a stronger or equal medium wins there, so the face never exists.
PROBE, AIR, MEDIUM, NEVER = 0, 1, 2, 3
# A body's code: look at each face.
FACES = 4
# From here on a face's code: ask, but bodies of the priority that is left alone decide, as by Contact.level.
LEVELS = 8
HIGHEST_LEVEL = 127 - LEVELS

# Surfaces closer than this touch, in sizes of the smaller body.
TOLERANCE = 1e-5
# A few units in the last place of the float32 coordinates that Cycles traces.
ROUNDING = 2.5e-7
# Children of a box in a hierarchy, boxes at its top, and pairs of faces that are compared at a time.
CHILDREN = 8
TOP = 32
CHUNK = 4096
# Part of a hierarchy's boxes from which on it is faster to look at all faces than at those in boxes.
MANY = 8
# Height above the centre, in sizes of the island, from which a face certainly looks away from it.
LEAST_HEIGHT = 1e-6
# Cosine of the largest angle between faces that coincide.
PARALLEL = 0.999
# Cosine of the largest angle between faces that a plane through an edge of one may part where no other does.
NEARLY_PARALLEL = 0.9

_COUNT = np.int32
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
    def island_faces(self) -> np.ndarray:
        """(k,) one triangle of every island."""
        labels = self.islands
        faces = np.empty(int(labels.max()) + 1, dtype=np.intp)
        faces[labels] = np.arange(len(labels))
        return faces

    @cached_property
    def overlaps_itself(self) -> bool:
        """Whether its surface crosses itself, or some island does not separate the inside from the outside.

        Islands that are star-shaped about their centre cannot cross themselves; the others are intersected.
        """
        place = _Placed(self, np.eye(4))
        for island in np.flatnonzero(~_star_shaped(place)):
            if _crosses_itself(place, np.flatnonzero(self.islands == island)):
                return True
        if len(self.island_faces) == 1:
            return False
        return _islands_touch(place) or bool(np.any(_outer_windings(place) != 0))


@dataclass(frozen=True)
class Body:
    """A medium in the scene.

    :param matrix: (4, 4) from the mesh's space to the world's.
    :param priority: the lowest wins.
    :param medium: equal for bodies that are filled with the same.
    :param certain: False where place or shape may differ in the render.
    :param wants_faces: whether an answer by face is of use.
    """

    solid: Solid
    matrix: np.ndarray
    priority: int
    medium: Hashable
    certain: bool = True
    wants_faces: bool = True

    def is_same(self, other: Body) -> bool:
        """Whether it is the same solid in the same place with the same values."""
        return np.array_equal(self.matrix, other.matrix) and all(
            getattr(self, item.name) == getattr(other, item.name) for item in fields(self) if item.name != "matrix"
        )


@dataclass(frozen=True, eq=False)
class Contact:
    """What is known of a body's outside.

    :param code: PROBE, AIR, MEDIUM, NEVER, or FACES.
    :param around: index of the body that is the known surrounding medium of code MEDIUM.
    :param faces: (m,) int8, codes of the triangles where the code is FACES; LEVELS and more are theirs alone.
    :param level: a priority that decides by itself: the first surface of that priority which a ray from the body meets
        tells whether a body of that priority, and nothing else, holds the point.
    :param robust: it overlaps itself.
    :param partners: bodies whose surfaces cross it or that hold part of it.
    :param coincident: other bodies, this body's triangles that lie exactly on their surface, and +1 for each whose
        normal points the same way, -1 for the others.
    :param holders: bodies of the surrounding medium's priority that hold a face of code MEDIUM; 0 where faces differ.
    """

    code: int
    around: int | None = None
    faces: np.ndarray | None = None
    level: int | None = None
    robust: bool = False
    partners: tuple[int, ...] = ()
    coincident: tuple[tuple[int, np.ndarray, np.ndarray], ...] = ()
    holders: int = 0

    @cached_property
    def face_levels(self) -> tuple[int, ...]:
        """Priorities that decide by themselves at some faces."""
        codes = _NO_FACES if self.faces is None else _sorted_set(self.faces, LEVELS + HIGHEST_LEVEL + 1)
        return tuple((codes[codes >= LEVELS] - LEVELS).tolist())


@dataclass(frozen=True, eq=False)
class _Placed:
    """A solid in the world. Coordinates are stored by axis."""

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

    @cached_property
    def hierarchy(self) -> _Hierarchy:
        """Of all triangles."""
        return _Hierarchy(self, np.arange(self.corners.shape[1]))

    @cached_property
    def island_boxes(self) -> tuple[np.ndarray, np.ndarray]:
        """(3, k) lowest and highest coordinates of the islands."""
        count = len(self.solid.island_faces)
        if count == 1:
            return self.box[0][:, None], self.box[1][:, None]
        bounds = np.full((6, count), np.inf)
        for side, faces in zip(bounds, self.hierarchy.bounds[0]):
            np.minimum.at(side, self.solid.islands, faces)
        return bounds[:3], -bounds[3:]

    @cached_property
    def areas(self) -> np.ndarray:
        """(m,) areas of the triangles."""
        return 0.5 * _length(_normals(self))

    def points(self, faces: np.ndarray) -> np.ndarray:
        """(k, 3 corners, 3 axes) corners of some triangles."""
        return self.vertices.T[self.corners[:, faces].T]

    def centroids(self, faces: np.ndarray) -> np.ndarray:
        """(k, 3) centres of some triangles."""
        return self.points(faces).mean(axis=1)


@dataclass(frozen=True, eq=False)
class _Side:
    """What one body of a pair is to the other.

    :param touching: sorted triangles that cross or touch the other's surface.
    :param inside: the other triangles that lie inside the other body.
    :param coincident: triangles on the other's surface; signs: +1 if the normals point the same way, else -1.
    """

    touching: np.ndarray = field(default_factory=lambda: _NO_FACES)
    inside: np.ndarray = field(default_factory=lambda: _NO_FACES)
    coincident: np.ndarray = field(default_factory=lambda: _NO_FACES)
    signs: np.ndarray = field(default_factory=lambda: _NO_FACES)

    @property
    def concerned(self) -> bool:
        return len(self.touching) > 0 or len(self.inside) > 0


@dataclass(eq=False)
class Memory:
    """What is known from the last analysis: bodies in the world, pairs of them, and what followed for every body.

    :ivar looked_at: pairs whose meshes were compared in the last analysis.
    """

    looked_at: int = 0
    places: dict[tuple, _Placed] = field(default_factory=dict)
    pairs: dict[tuple, tuple[_Side, _Side]] = field(default_factory=dict)
    contacts: dict[tuple, Contact] = field(default_factory=dict)


def analyse(bodies: Sequence[Body], memory: Memory | None = None) -> list[Contact]:
    """Tell what lies around every body's faces.

    :param memory: what an earlier analysis found; brought up to date.
    """
    memory = Memory() if memory is None else memory
    memory.looked_at = 0
    if not all(body.certain and np.isfinite(body.matrix).all() and body.solid.closed for body in bodies):
        memory.places, memory.pairs, memory.contacts = {}, {}, {}
        return [Contact(PROBE, robust=body.solid.closed and body.solid.overlaps_itself) for body in bodies]
    keys = [(body.solid, np.ascontiguousarray(body.matrix, dtype=np.float64).tobytes()) for body in bodies]
    places = {
        key: memory.places.get(key) or _Placed(body.solid, np.array(body.matrix, dtype=np.float64))
        for key, body in zip(keys, bodies)
    }
    pairs: dict[tuple, tuple[_Side, _Side]] = {}
    sides: list[list[tuple[int, _Side]]] = [[] for _ in bodies]
    related: list[tuple[int, int]] = []
    for i, j in _candidates([places[key] for key in keys]):
        key = (keys[i], keys[j])
        if key not in pairs:
            pair = memory.pairs.get(key)
            if pair is None:
                memory.looked_at += 1
                pair = _compare(places[keys[i]], places[keys[j]])
            pairs[key] = pair
        of_i, of_j = pairs[key]
        if of_i.concerned:
            sides[i].append((j, of_i))
        if of_j.concerned:
            sides[j].append((i, of_j))
        if of_i.concerned or of_j.concerned:
            related.append((i, j))
    robust = [body.solid.overlaps_itself or places[key].flat for body, key in zip(bodies, keys)]
    contacts: dict[tuple, Contact] = {}
    for i, body in enumerate(bodies):
        key = (keys[i], robust[i], body.priority, body.wants_faces, i) + tuple(
            (j, bodies[j].priority, bodies[j].medium, id(side)) for j, side in sides[i]
        )
        contacts[key] = memory.contacts.get(key) or _contact(i, bodies, places[keys[i]], sides[i], robust[i])
    memory.places, memory.pairs, memory.contacts = places, pairs, contacts
    return _with_levels(bodies, list(contacts.values()), robust, related)


# Bodies


def _contact(
    index: int, bodies: Sequence[Body], place: _Placed, sides: list[tuple[int, _Side]], robust: bool
) -> Contact:
    """What is known of one body, its level apart, from what it is to its partners."""
    partners = tuple(sorted(j for j, _ in sides))
    order = place.solid.order
    coincident = tuple((j, order[side.coincident], side.signs) for j, side in sides if len(side.coincident))
    result = Contact(PROBE, robust=robust, partners=partners, coincident=coincident)
    if robust:
        return result
    codes, names, holders, levels = _face_codes(bodies[index].priority, bodies, place, sides)
    around = None
    known = codes == MEDIUM
    count = 0
    if known.any():
        chosen = int(holders[0][known][0])
        if (holders[0][known] != chosen).any():
            area = np.bincount(holders[0][known], weights=place.areas[known], minlength=len(names))
            chosen = int(np.argmax(area))
            codes[known & (holders[0] != chosen)] = PROBE
        around = names[chosen]
        counts = holders[1][codes == MEDIUM]
        count = int(counts[0]) if (counts == counts[0]).all() else 0
    codes = np.where((codes == PROBE) & (levels >= 0), LEVELS + levels, codes).astype(np.int8)
    first = int(codes[0])
    if (codes == first).all():
        return replace(result, code=first if first < LEVELS else PROBE, around=around, holders=count)
    if not bodies[index].wants_faces:
        return result
    faces = np.empty_like(codes)
    faces[order] = codes
    return replace(result, code=FACES, around=around, faces=faces, holders=count)


def _face_codes(
    own: int, bodies: Sequence[Body], place: _Placed, sides: list[tuple[int, _Side]]
) -> tuple[np.ndarray, list[int], tuple[np.ndarray, np.ndarray], np.ndarray]:
    """The codes of a body's faces, or one code for all of them.

    A face that touches a body is unknown only if no stronger one holds it, since that decides.

    :return: codes; one body of every surrounding medium; for each face the place of its medium in that list, and the
        number of bodies of the medium's priority that hold it; the only priority that touches or holds it, below 0 where
        there are none, several, or one beyond HIGHEST_LEVEL.
    """
    all_faces = place.corners.shape[1]
    uniform = all(len(side.touching) == 0 and len(side.inside) in (0, all_faces) for _, side in sides)
    count = 1 if uniform else all_faces
    groups: dict[tuple[int, Hashable], list[tuple[int, _Side]]] = {}
    for j, side in sides:
        groups.setdefault((bodies[j].priority, bodies[j].medium), []).append((j, side))
    codes = np.full(count, AIR, dtype=np.int8)
    names: list[int] = []
    medium, holders = np.zeros(count, dtype=_COUNT), np.zeros(count, dtype=_COUNT)
    decided = np.zeros(count, dtype=bool)
    doubted = np.zeros(count, dtype=bool)
    levels, several = np.full(count, -1, dtype=_COUNT), np.zeros(count, dtype=bool)
    for priority in sorted({priority for priority, _ in groups}):
        claims = np.zeros(count, dtype=_COUNT)
        held = np.zeros(count, dtype=bool)
        number = np.zeros(count, dtype=_COUNT)
        which = np.zeros(count, dtype=_COUNT)
        unsure = np.zeros(count, dtype=bool)
        for members in (members for key, members in groups.items() if key[0] == priority):
            inside = np.zeros(count, dtype=_COUNT)
            for _, side in members:
                several[side.coincident] = True  # of two faces in one place a ray meets either
                if len(side.inside) == all_faces:
                    inside += 1
                else:
                    inside[side.inside] += 1
            near = np.zeros(count, dtype=bool)
            touching = [side.touching for _, side in members if len(side.touching)]
            if touching:
                near[np.concatenate(touching)] = True
            claims += near | (inside > 0)
            which[inside > 0] = len(names)
            names.append(members[0][0])
            held |= inside > 0
            number += inside
            unsure |= near
        concerned = held | unsure
        several |= concerned & (levels >= 0)
        levels[concerned] = priority
        if priority <= own:
            codes[held] = NEVER
            decided |= held
            doubted |= unsure
            continue
        codes[~decided & (doubted | unsure | (claims > 1))] = PROBE
        known = ~decided & ~doubted & held & (claims == 1)
        codes[known] = MEDIUM
        medium[known] = which[known]
        # A body of the same medium that only touches the face may or may not hold it.
        holders[known] = np.where(unsure[known], 0, number[known])
        decided |= held
        doubted |= unsure
    codes[~decided & doubted] = PROBE
    levels[several | (levels > HIGHEST_LEVEL)] = -1
    return codes, names, (medium, holders), levels


def _with_levels(
    bodies: Sequence[Body], contacts: list[Contact], robust: list[bool], related: list[tuple[int, int]]
) -> list[Contact]:
    """The contacts with their levels: of one priority, whose bodies are apart and whole."""
    faults: dict[int, int] = {}
    own_faults = [0] * len(bodies)
    for i, body in enumerate(bodies):
        if robust[i]:
            faults[body.priority] = faults.get(body.priority, 0) + 1
            own_faults[i] += 1
    for i, j in related:
        priority = bodies[i].priority
        if priority == bodies[j].priority:
            faults[priority] = faults.get(priority, 0) + 1
            own_faults[i] += 1
            own_faults[j] += 1

    def decides(i: int, priority: int) -> bool:
        return faults.get(priority, 0) == (own_faults[i] if bodies[i].priority == priority else 0)

    def with_level(i: int, contact: Contact) -> Contact:
        undecided = [LEVELS + level for level in contact.face_levels if not decides(i, level)]
        if undecided:
            contact = replace(contact, faces=np.where(np.isin(contact.faces, undecided), PROBE, contact.faces))
        priorities = {bodies[j].priority for j in contact.partners}
        if contact.code in (PROBE, FACES) and len(priorities) == 1 and decides(i, min(priorities)):
            return replace(contact, level=min(priorities))
        return contact

    return [with_level(i, contact) for i, contact in enumerate(contacts)]


# Pairs


def _candidates(places: Sequence[_Placed]) -> list[tuple[int, int]]:
    """Pairs of bodies whose boxes meet."""
    if len(places) < 2:
        return []
    low = np.array([place.box[0] for place in places]).T
    high = np.array([place.box[1] for place in places]).T
    first, second = _overlapping_boxes(low, high, 2.0 * TOLERANCE)
    return list(zip(np.minimum(first, second).tolist(), np.maximum(first, second).tolist()))


def _overlapping_boxes(low: np.ndarray, high: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of boxes that meet when grown by a part of their size, by a sweep along their sparsest axis.

    :param low: (3, n) lowest coordinates; high: highest.
    """
    size = np.linalg.norm(high - low, axis=0)
    margin = tolerance * size + 2.0 * ROUNDING * np.abs(np.concatenate([low, high])).max(axis=0) * (tolerance > 0.0)
    low, high = low - margin, high + margin
    sparse = int(np.argmin((high - low).sum(axis=1) / np.maximum(high.max(axis=1) - low.min(axis=1), 1e-300)))
    order = np.argsort(low[sparse], kind="stable")
    low, high = low[:, order], high[:, order]
    last = np.searchsorted(low[sparse], high[sparse], side="right")
    start = np.arange(len(order)) + 1
    first, second = _ranges(start, np.maximum(last, start))
    for axis in range(3):
        if axis != sparse:
            meet = (low[axis, first] <= high[axis, second]) & (low[axis, second] <= high[axis, first])
            first, second = first[meet], second[meet]
    return order[first], order[second]


def _ranges(start: np.ndarray, stop: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All pairs of a place i and a number in [start[i], stop[i])."""
    lengths = stop - start
    owner = np.repeat(np.arange(len(start)), lengths)
    return owner, np.arange(len(owner)) + (start - (np.cumsum(lengths) - lengths))[owner]


def _compare(a: _Placed, b: _Placed) -> tuple[_Side, _Side]:
    """What two bodies are to each other."""
    tolerance = _tolerance(a, b)
    if same := _same_faces(a, b, tolerance):
        return same, same
    of_a, of_b = _touching(a, b, *_meeting(a.hierarchy, b.hierarchy, tolerance), tolerance)
    return (
        replace(of_a, inside=_faces_inside(a, of_a.touching, b, tolerance)),
        replace(of_b, inside=_faces_inside(b, of_b.touching, a, tolerance)),
    )


def _tolerance(a: _Placed, b: _Placed) -> float:
    """The distance within which surfaces of two bodies touch."""
    sizes = [float(np.linalg.norm(place.box[1] - place.box[0])) for place in (a, b)]
    reach = max(float(np.abs(place.box).max()) for place in (a, b))
    return TOLERANCE * min(sizes) + ROUNDING * reach


def _same_faces(a: _Placed, b: _Placed, tolerance: float) -> _Side | None:
    """The side of either of two bodies with the same triangles in the same places."""
    if a.corners.shape != b.corners.shape or a.vertices.shape != b.vertices.shape:
        return None
    if np.abs(np.array(a.box) - np.array(b.box)).max() > tolerance or not np.array_equal(a.corners, b.corners):
        return None
    if np.abs(a.vertices - b.vertices).max() > tolerance:
        return None
    faces = np.arange(a.corners.shape[1])
    return _Side(touching=faces, coincident=faces, signs=np.ones(len(faces), dtype=np.int8))


def _faces_in_box(place: _Placed, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Triangles whose boxes meet a box; infinite sides are allowed."""
    bounds = place.hierarchy.bounds
    box = np.concatenate([-high, low])
    sides = np.flatnonzero(np.isfinite(box))
    faces = np.arange(bounds[-1].shape[1])
    for level in reversed(bounds):
        if level is not bounds[-1]:
            faces = (faces[:, None] * CHILDREN + np.arange(CHILDREN)).ravel()
            faces = faces[faces < level.shape[1]]
        for side in sides:
            faces = faces[level[side, faces] + box[side] <= 0.0]
        if len(faces) * MANY > level.shape[1]:
            break
    else:
        return faces
    meet = np.ones(bounds[0].shape[1], dtype=bool)
    for side in sides:
        meet &= bounds[0][side] <= -box[side]
    return np.flatnonzero(meet)


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
    """Bounds of triangles and of ever larger groups of them.

    :param order: (k,) the triangles, neighbours in space one after the other.
    """

    place: _Placed
    order: np.ndarray

    @cached_property
    def bounds(self) -> list[np.ndarray]:
        """(6, k) lowest coordinates and highest ones negated, then those of every CHILDREN of them, and so on."""
        bounds = _padded(len(self.order))
        for axis in range(3):
            a, b, c = (self.place.vertices[axis][corner[self.order]] for corner in self.place.corners)
            np.minimum(np.minimum(a, b), c, out=bounds[axis])
            np.negative(np.maximum(np.maximum(a, b), c), out=bounds[axis + 3])
        levels = [bounds]
        while levels[-1].shape[1] > TOP:
            levels.append(_joined(levels[-1]))
        return levels


def _padded(count: int) -> np.ndarray:
    """(6, count) room for bounds, the first columns of such that nothing meets and that fill the last group."""
    return np.full((6, count + -count % CHILDREN), np.inf)[:, :count]


def _groups(bounds: np.ndarray) -> np.ndarray:
    """(6, groups, CHILDREN) the bounds of a level, from :func:`_padded`, by group."""
    return bounds.base.reshape(6, -1, CHILDREN)


def _joined(bounds: np.ndarray) -> np.ndarray:
    """The bounds of the groups of a level."""
    children = np.moveaxis(_groups(bounds), 2, 0)
    joined = _padded(children.shape[2])
    np.minimum(children[0], children[1], out=joined)
    for child in children[2:]:
        np.minimum(joined, child, out=joined)
    return joined


def _meeting(a: _Hierarchy, b: _Hierarchy, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of triangles of two hierarchies whose boxes are no farther apart than the tolerance along each axis."""
    depth = [len(a.bounds) - 1, len(b.bounds) - 1]
    i, j = (index.ravel() for index in np.indices((a.bounds[-1].shape[1], b.bounds[-1].shape[1])))
    i, j = _meet(a.bounds[-1], i, b.bounds[-1], j, tolerance)
    while any(depth) and len(i):
        if depth[0] >= depth[1]:
            depth[0] -= 1
            i, j = _children_meet(a.bounds[depth[0]], i, b.bounds[depth[1]], j, tolerance)
        else:
            depth[1] -= 1
            j, i = _children_meet(b.bounds[depth[1]], j, a.bounds[depth[0]], i, tolerance)
    return a.order[i], b.order[j]


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
    a: np.ndarray, i: np.ndarray, b: np.ndarray, j: np.ndarray, tolerance: float
) -> tuple[np.ndarray, np.ndarray]:
    """The pairs of places in two arrays of bounds that meet, the first among the children of groups i."""
    # Children stand side by side, so along one axis they are read by the group.
    groups = _groups(a)
    meet = groups[0].take(i, axis=0) + b[3].take(j)[:, None] <= tolerance
    meet &= b[0].take(j)[:, None] + groups[3].take(i, axis=0) <= tolerance
    found = np.flatnonzero(meet)
    pair = found // CHILDREN
    return _meet(a, (i.take(pair) - pair) * CHILDREN + found, b, j.take(pair), tolerance, (1, 2))


def _touching(a: _Placed, b: _Placed, first: np.ndarray, second: np.ndarray, tolerance: float) -> tuple[_Side, _Side]:
    """The faces of two bodies that cross, touch or coincide, among pairs of a triangle of each."""
    if len(first) == 0:
        return _Side(), _Side()
    faces_a, index_a = _numbered(first, a.corners.shape[1])
    faces_b, index_b = _numbered(second, b.corners.shape[1])
    of_a, of_b = _triangles(a, faces_a), _triangles(b, faces_b)
    chunks = [slice(start, start + CHUNK) for start in range(0, len(first), CHUNK)]
    pairs = [_not_apart(of_a, index_a[chunk], of_b, index_b[chunk], tolerance) for chunk in chunks]
    i, j = (np.concatenate(parts) for parts in zip(*pairs))
    on_b, signs_a = _resting(of_a, i, of_b, j, tolerance)
    on_a, signs_b = _resting(of_b, j, of_a, i, tolerance)
    return (
        _Side(touching=faces_a[_sorted_set(i, len(faces_a))], coincident=faces_a[on_b], signs=signs_a),
        _Side(touching=faces_b[_sorted_set(j, len(faces_b))], coincident=faces_b[on_a], signs=signs_b),
    )


def _triangles(place: _Placed, faces: np.ndarray) -> np.ndarray:
    """(4, 3 axes, k) the corners of triangles and their unit normals."""
    normals = _normals(place, faces)
    points = place.vertices[:, place.corners[:, faces]].transpose(1, 0, 2)
    return np.concatenate([points, (normals / np.maximum(_length(normals), 1e-300))[None]])


def _numbered(values: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """The sorted different numbers below a count among some values, and each value's place among them."""
    different = _sorted_set(values, count)
    place = np.empty(count, dtype=np.intp)
    place[different] = np.arange(len(different))
    return different, place[values]


def _sorted_set(values: np.ndarray, count: int) -> np.ndarray:
    """The sorted different numbers below a count among some values."""
    used = np.zeros(count, dtype=bool)
    used[values] = True
    return np.flatnonzero(used)


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
    a: np.ndarray, i: np.ndarray, b: np.ndarray, j: np.ndarray, tolerance: float
) -> tuple[np.ndarray, np.ndarray]:
    """The pairs of triangles between which no plane leaves a gap of more than the tolerance.

    Of two convex polyhedra that are apart, some plane along a face of one, or along an edge of each, lies between
    (Gottschalk, Lin and Manocha 1996, OBBTree); of two flat ones in nearly a plane, one that stands on an edge.

    :param a: (4, 3 axes, k) triangles; i: (n,) which of them each pair has; b and j: the others.
    """
    keep = _off_plane(a[:, :, i], b[0][:, j], b[3][:, j]) <= tolerance
    i, j = i[keep], j[keep]
    keep = _off_plane(b[:, :, j], a[0][:, i], a[3][:, i]) <= tolerance
    i, j = i[keep], j[keep]
    if len(i) == 0:
        return i, j
    p, q = a[:, :, i].swapaxes(0, 1), b[:, :, j].swapaxes(0, 1)
    edges_p, edges_q = _edges(p), _edges(q)
    keep = _overlap(p, q, _cross(edges_p[:, :, None], edges_q[:, None]).reshape(3, 9, -1), tolerance)
    flat = np.flatnonzero(keep & (np.abs(_dot(p[:, 3], q[:, 3])) >= NEARLY_PARALLEL))
    if len(flat):
        p, q = p[:, :, flat], q[:, :, flat]
        within = _cross(edges_p[:, :, flat], p[:, 3:]), _cross(edges_q[:, :, flat], q[:, 3:])
        keep[flat] = _overlap(p, q, np.concatenate(within, axis=1), tolerance)
    return i[keep], j[keep]


def _overlap(p: np.ndarray, q: np.ndarray, axes: np.ndarray, tolerance: float) -> np.ndarray:
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


def _resting(
    a: np.ndarray, i: np.ndarray, b: np.ndarray, j: np.ndarray, tolerance: float
) -> tuple[np.ndarray, np.ndarray]:
    """Which triangles of a lie on parallel ones of b with all their corners and their centres.

    :param a: (4, 3 axes, k) triangles; i: (n,) which of them each pair has; b and j: the others.
    :return: the triangles; int8 signs of the product of both normals.
    """
    cosine = _dot(a[3][:, i], b[3][:, j])
    parallel = np.abs(cosine) >= PARALLEL
    if not parallel.any():
        return _NO_FACES, np.empty(0, dtype=np.int8)
    i, j, cosine = i[parallel], j[parallel], cosine[parallel]
    q = b[:, :, j]
    edges = _edges(q.swapaxes(0, 1))
    samples = np.concatenate([a[:3], a[:3].mean(axis=0, keepdims=True)])[:, :, i].swapaxes(0, 1)
    on = np.abs(_dot(samples - q[0][:, None], q[3][:, None])) <= tolerance
    for corner in range(3):
        on &= _dot(samples - q[corner][:, None], _cross(q[3], edges[:, corner])[:, None]) >= -tolerance
    covered = np.zeros((4, a.shape[2]), dtype=bool)
    for sample in range(4):
        covered[sample, i[on[sample]]] = True
    signs = np.zeros(a.shape[2], dtype=np.int8)
    signs[i[on[3]]] = np.where(cosine[on[3]] >= 0.0, 1, -1)
    faces = np.flatnonzero(covered.all(axis=0))
    return faces, signs[faces]


# What holds what


def _faces_inside(a: _Placed, touching: np.ndarray, b: _Placed, tolerance: float) -> np.ndarray:
    """The triangles of a, those that touch b's surface left out, that lie inside b.

    Pieces of a surface between crossings lie wholly inside or outside, and what reaches out of b's box is outside.
    """
    labels = a.solid.islands
    count = len(a.solid.island_faces)
    crossed = np.zeros(count, dtype=bool)
    crossed[labels[touching]] = True
    low, high = b.box[0] - tolerance, b.box[1] + tolerance
    lowest, highest = a.island_boxes
    whole = np.flatnonzero(~crossed & (lowest >= low[:, None]).all(axis=0) & (highest <= high[:, None]).all(axis=0))
    inside = np.zeros(count, dtype=bool)
    if len(whole):
        inside[whole] = _windings(a.centroids(a.solid.island_faces[whole]), b) >= 1
    faces = np.flatnonzero(inside[labels]) if inside.any() else _NO_FACES
    if len(touching) == 0:
        return faces
    near = _faces_in_box(a, low, high)
    free = np.ones(a.corners.shape[1], dtype=bool)
    free[touching] = False
    parts = near[free[near] & crossed[labels[near]]] if count > 1 else near[free[near]]
    if len(parts) == 0:
        return faces
    used, corners = _numbered(a.corners[:, parts], a.vertices.shape[1])
    root = meshes.connected(
        len(used), np.concatenate([corners[0], corners[1]]), np.concatenate([corners[1], corners[2]])
    )
    reaches_out = np.zeros(len(used), dtype=bool)
    for axis in range(3):
        position = a.vertices[axis][used]
        reaches_out[root[(position < low[axis]) | (position > high[axis])]] = True
    piece = root[corners[0]]
    chosen = np.flatnonzero(~reaches_out[piece])
    if len(chosen) == 0:
        return faces
    pieces, index = _numbered(piece[chosen], len(used))
    samples = np.empty(len(pieces), dtype=np.intp)
    samples[index] = chosen
    holds = _windings(a.centroids(parts[samples]), b) >= 1
    found = parts[chosen[holds[index]]]
    return found if len(faces) == 0 else np.sort(np.concatenate([faces, found]))


def _windings(points: np.ndarray, place: _Placed, left_out: np.ndarray | None = None) -> np.ndarray:
    """The winding numbers of a closed mesh about points, as signed crossings along rays upwards.

    :param points: (k, 3).
    :param left_out: (k,) the triangle that is not counted for each point.
    :return: (k,) integers.
    """
    owners, faces = [_NO_FACES], [_NO_FACES]
    for chunk in range(0, len(points), 4096):
        owner, face = _columns(points[chunk : chunk + 4096], place)
        owners.append(owner + chunk)
        faces.append(face)
    owner, face = np.concatenate(owners), np.concatenate(faces)
    if left_out is not None:
        other = face != left_out[owner]
        owner, face = owner[other], face[other]
    return _crossings(points, place, owner, face)


def _crossings(points: np.ndarray, place: _Placed, owner: np.ndarray, face: np.ndarray) -> np.ndarray:
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


def _columns(points: np.ndarray, place: _Placed) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of a point and a triangle whose box the ray from it upwards meets."""
    if len(points) <= 64:
        hits = [_faces_in_box(place, np.array(point), np.array([*point[:2], np.inf])) for point in points]
        return np.repeat(np.arange(len(points)), [len(hit) for hit in hits]), np.concatenate([_NO_FACES, *hits])
    bounds = place.hierarchy.bounds[0]
    order = np.argsort(points[:, 0])
    x = points[order, 0]
    face, rank = _ranges(np.searchsorted(x, bounds[0], "left"), np.searchsorted(x, -bounds[3], "right"))
    owner = order[rank]
    y, z = points[owner, 1], points[owner, 2]
    meets = (bounds[1, face] <= y) & (-bounds[4, face] >= y) & (-bounds[5, face] >= z)
    return owner[meets], face[meets]


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
    low, high = place.island_boxes
    size = np.linalg.norm(high - low, axis=0)
    reach = float(np.abs(place.box).max())
    order = np.argsort(place.solid.islands, kind="stable")
    ends = np.cumsum(np.bincount(place.solid.islands))

    def hierarchy(island: int) -> _Hierarchy:
        faces = order[ends[island - 1] if island else 0 : ends[island]]
        return _Hierarchy(place, faces[_morton_order(place.vertices[:, place.corners[0, faces]])])

    for pair in zip(*_overlapping_boxes(low, high, 2.0 * TOLERANCE)):
        tolerance = TOLERANCE * float(size[list(pair)].min()) + ROUNDING * reach
        faces = _meeting(*(hierarchy(int(island)) for island in pair), tolerance)
        if len(_touching(place, place, *faces, tolerance)[0].touching):
            return True
    return False


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
