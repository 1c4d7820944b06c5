"""Parting media whose faces lie in the same place, which rays cannot tell apart.

Of two faces in one place a ray meets either, and a probe finds only one. The weaker medium's are moved into the stronger one,
where they are not seen: outwards where the faces look against each other, inwards where they look the same way. So what is
seen keeps its shape. Only where the stronger one's lie on part of a larger face are they moved themselves, outwards. A flat
side moves as a whole, by less than the thickness of any wall before it. A Geometry Nodes modifier moves the points by an
attribute of the mesh, in a render without the extension too; it names the attribute, so objects may share a mesh.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import count

import bpy
import numpy as np

from ..analysis.analysis import is_analysed, is_offset, keeps_mesh, listed, looked_at
from ..geometry import contacts
from ..geometry.contacts import Body, Contact
from ..geometry.meshes import same_places
from ..nodes.node_group import ATTRIBUTE_SOCKET, OFFSET_ATTRIBUTE, OFFSET_GROUP, is_offset_group
from ..scene.media import all_objects
from .checks import Problem
from .live import analyse

PARTING = 1e-4
"""Distance between parted faces, in diagonals of the smaller object: ten times what counts as the same place."""

ROUNDING = 4e-6
"""The same in coordinates far from the origin, where single precision is coarser than that."""

LEAST = 2.0
"""The least distance between parted faces, in those within which surfaces count as touching."""

WALL = 3.0
"""Part of a wall's thickness by which faces may move into it: others may do so from its other side."""

PASSES = 8
"""Faces beside those that have moved may come to lie in one plane with others: so all is looked at again."""

FLATTEST = 0.02
"""Part of the largest below which a spread of normals is rounding, not another direction."""


@dataclass(eq=False)
class Move:
    """Triangles of a body that are to be moved.

    :ivar others: indices of the bodies that they are parted from.
    :ivar heights: (m,) by how much each triangle is to rise along its normal, in unit distances.
    :ivar unit: that distance, scene units.
    :ivar wall: the thickness of a wall that is too thin for it, else 0; least: how thick it has to be.
    """

    heights: np.ndarray
    others: list[int] = field(default_factory=list)
    unit: float = 0.0
    wall: float = 0.0
    least: float = 0.0


def part_coincident(scene: bpy.types.Scene) -> tuple[list[str], list[Problem]]:
    """Part what coincides in a scene, which has just been analysed, and analyse it again. Return what was changed, in
    sentences, and what could not be.
    """
    distances: dict[bpy.types.Object, float] = {}
    others: dict[bpy.types.Object, dict[str, None]] = {}
    for left in reversed(range(PASSES + 1)):
        rows, found = looked_at(scene)
        found, alike = _between_objects([obj for obj, _ in rows], found)
        problems = [
            Problem(
                obj.name, "has instances with faces in the same place, which would all move alike", "let them overlap"
            )
            for obj in alike
        ]
        moved: dict[bpy.types.Object, np.ndarray] = {}
        for index, move in plan([body for _, body in rows], found, rims=left < PASSES).items():
            obj, body = rows[index]
            names = dict.fromkeys(rows[other][0].name for other in move.others)
            remedy = _hindrance(obj, move) if left else "let them overlap"
            if remedy:
                problems.append(Problem(obj.name, f"has faces in the same place as {listed(tuple(names))}", remedy))
                continue
            # An object that is instanced moves the same everywhere.
            offset = _local_offsets(body, move)
            before = moved.get(obj, offset)
            moved[obj] = np.where(np.abs(before) >= np.abs(offset), before, offset)
            distances[obj] = max(distances.get(obj, 0.0), move.unit * float(np.abs(move.heights).max()))
            others.setdefault(obj, {}).update(names)
        if not moved:
            break
        users = Counter(
            (obj.data, _attribute_name(modifier))
            for obj in bpy.data.objects
            for modifier in filter(is_offset, obj.modifiers)
        )
        for obj, offset in moved.items():
            _move(obj, offset, users)
        analyse(scene)
    changes = [
        f"{obj.name}: {distance:.2g} parted from {listed(tuple(others[obj]))}, which has faces in the same place "
        f"(modifier {OFFSET_GROUP!r})"
        for obj, distance in distances.items()
    ]
    return changes, problems


def join_parted(scene: bpy.types.Scene) -> list[str]:
    """Take back what :func:`part_coincident` has moved in a scene, but where another analysed scene shows it; return what was
    changed, in sentences.
    """
    shown = {obj for other in bpy.data.scenes if other != scene and is_analysed(other) for obj in all_objects(other)}
    found = [
        (obj, modifier)
        for obj in sorted(all_objects(scene) - shown, key=lambda obj: obj.name)
        if obj.is_editable
        for modifier in filter(is_offset, obj.modifiers)
    ]
    groups = {modifier.node_group for _, modifier in found}
    moved = {(obj.data, _attribute_name(modifier)) for obj, modifier in found if obj.mode == "OBJECT"}
    for obj, modifier in found:
        obj.modifiers.remove(modifier)
    moved -= {
        (obj.data, _attribute_name(modifier))
        for obj in bpy.data.objects
        for modifier in filter(is_offset, obj.modifiers)
    }
    for mesh, name in moved:
        if mesh.is_editable and name in mesh.attributes:
            mesh.attributes.remove(mesh.attributes[name])
    for group in groups:
        if not group.users and group.library is None:
            bpy.data.node_groups.remove(group)
    return [f"{obj.name}: faces are where they were" for obj, _ in found]


def _between_objects(
    objects: Sequence[bpy.types.Object], found: Sequence[Contact]
) -> tuple[list[Contact], list[bpy.types.Object]]:
    """Contacts without what coincides with another instance of the same object, and the objects of which some does."""
    result = []
    alike: dict[bpy.types.Object, None] = {}
    for obj, contact in zip(objects, found):
        others = tuple(each for each in contact.coincident if objects[each[0]] != obj)
        if len(others) < len(contact.coincident):
            alike[obj] = None
            contact = replace(contact, coincident=others)
        result.append(contact)
    return result, list(alike)


def plan(bodies: Sequence[Body], found: Sequence[Contact], rims: bool = False) -> dict[int, Move]:
    """Tell which bodies' triangles are to be moved by how much, so that no two lie in one place, by the body's index.

    Whatever lies on a stronger one's face is moved farther than that. With rims, where faces share no more than what a
    move beside them has made, it only moves otherwise; so a row of many blocks does not move farther and farther.
    """
    sets = {(i, other): facts for i, contact in enumerate(found) for other, *facts in contact.coincident}
    place = sorted(range(len(bodies)), key=lambda i: (bodies[i].priority, i))
    order = {index: number for number, index in enumerate(place)}
    pairs = {tuple(sorted(pair, key=order.__getitem__)) for pair in sets}
    moves: dict[int, Move] = {}
    ranks: dict[int, np.ndarray] = {}
    ways = _ways(pairs, place) if rims else {}
    for strong, weak in sorted(pairs, key=lambda pair: (order[pair[1]], order[pair[0]])):
        of_strong, of_weak = sets.get((strong, weak)), sets.get((weak, strong))
        # The stronger one's lie on part of a larger face, which would move farther than they need to.
        outwards = of_weak is None or (
            not rims and of_strong is not None and of_strong[2].all() and not of_weak[2].any()
        )
        index, other = (strong, weak) if outwards else (weak, strong)
        faces, signs, _ = of_strong if outwards else of_weak
        sides = np.ones(len(faces)) if outwards else -signs.astype(float)
        across = sets.get((other, index))
        rank = 1.0
        if rims:
            rank = float(ways[index])
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
        walls = contacts.Walls(bodies)
        sides_of: dict[int, np.ndarray] = {}
        for index, move in moves.items():
            _move_flat_sides(bodies[index].solid, move, sides_of)
        for group in _groups(moves):
            _find_distance(walls, {index: moves[index] for index in group if index in moves}, group)
    return moves


def _ways(pairs: Iterable[tuple[int, int]], order: Sequence[int]) -> dict[int, int]:
    """A small number for each body, another one than those of the bodies with which it is paired."""
    beside: dict[int, set[int]] = {index: set() for index in order}
    for one, other in pairs:
        beside[one].add(other)
        beside[other].add(one)
    ways: dict[int, int] = {}
    for index in order:
        taken = {ways.get(other, -1) for other in beside[index]}
        ways[index] = next(way for way in range(len(taken) + 1) if way not in taken)
    return ways


def _move_flat_sides(solid: contacts.Solid, move: Move, known: dict[int, np.ndarray]) -> None:
    """Let all triangles of a flat side move as one of them does. known: flat sides of solids looked at before."""
    if move.heights.all():
        return
    if id(solid) not in known:
        known[id(solid)] = contacts.flat_sides(solid)
    sides = known[id(solid)]
    moved = np.flatnonzero(move.heights)
    highest, lowest = np.zeros(len(sides)), np.zeros(len(sides))
    np.maximum.at(highest, sides[moved], move.heights[moved])
    np.minimum.at(lowest, sides[moved], move.heights[moved])
    move.heights = np.where(highest > 0.0, highest, lowest)[sides]


def _groups(moves: dict[int, Move]) -> list[list[int]]:
    """Bodies that are parted from each other, one through another."""
    group: dict[int, list[int]] = {}
    for index, move in moves.items():
        for other in move.others:
            one, two = (group.setdefault(body, [body]) for body in (index, other))
            if one is not two:
                one, two = sorted((one, two), key=len, reverse=True)
                one += two
                group.update(dict.fromkeys(two, one))
    return list({id(members): members for members in group.values()}.values())


def _find_distance(walls: contacts.Walls, moves: dict[int, Move], group: list[int]) -> None:
    """Find one distance for bodies that are parted from each other, so that no two move alike."""
    low, high = walls.boxes[group].swapaxes(0, 1)
    size = float(np.linalg.norm(high - low, axis=1).min())
    reach = float(np.abs(walls.boxes[group]).max())
    wanted = PARTING * size + ROUNDING * reach
    least = LEAST * (contacts.TOLERANCE * size + contacts.ROUNDING * reach)
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


def _hindrance(obj: bpy.types.Object, move: Move) -> str:
    """What to do before faces can be moved; empty where the points of the mesh are those of the evaluated one."""
    if move.wall:
        thin = f"the wall there thicker than {move.least:.2g}, which is {move.wall:.2g}"
        return f"let them overlap, or make {thin}: then they are parted"
    first = []
    if obj.library is not None or obj.data.library is not None:
        first.append("make it local")
    if obj.type != "MESH":
        first.append("turn it into a mesh (Object > Convert > Mesh)")
    elif obj.data.shape_keys is not None:
        first.append("apply its shape keys")
    if obj.mode != "OBJECT":
        first.append("leave its mode for Object Mode")
    if not all(map(keeps_mesh, obj.modifiers)):
        first.append(
            "apply its modifiers" if obj.data.users == 1 else "make its mesh single-user and apply its modifiers"
        )
    return f"let them overlap, or {', '.join(first)}: then they are parted" if first else ""


def offsets(count: int, corners: np.ndarray, normals: np.ndarray, heights: np.ndarray) -> np.ndarray:
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


def _local_offsets(body: Body, move: Move) -> np.ndarray:
    """(n, 3) how far a body's points move, in its own space."""
    linear = body.matrix[:3, :3]
    faces = np.flatnonzero(move.heights)
    corners = body.solid.triangles[faces]
    a, b, c = (body.solid.vertices[corners[:, i]] @ linear.T for i in range(3))
    normals = np.cross(b - a, c - a) * np.sign(np.linalg.det(linear))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    world = offsets(len(body.solid.vertices), corners, normals, move.unit * move.heights[faces])
    other_side = np.setdiff1d(np.arange(len(world)), body.solid.triangles)  # of a seam, which no triangle names
    world[other_side] = world[same_places(body.solid.vertices.astype(np.float32))[other_side]]
    return world @ np.linalg.inv(linear).T


def _move(obj: bpy.types.Object, offset: np.ndarray, users: Counter[tuple[bpy.types.ID, str]]) -> None:
    """Move an object's points, from where they have been moved to before.

    :param users: number of modifiers that read an attribute of a mesh, by both; kept up to date.
    """
    mesh = obj.data
    modifier = next(filter(is_offset, obj.modifiers), None)
    if modifier is None:
        modifier = obj.modifiers.new(OFFSET_GROUP, "NODES")
    else:
        name = _attribute_name(modifier)
        offset = offset + _values(mesh, name)
        users[mesh, name] -= 1
    modifier.node_group = _ensure_group()
    offset = offset.astype(np.float32)
    for number in count():
        name = f"{OFFSET_ATTRIBUTE}.{number:03d}" if number else OFFSET_ATTRIBUTE
        attribute = mesh.attributes.get(name)
        if attribute is None:
            attribute = mesh.attributes.new(name, "FLOAT_VECTOR", "POINT")
            break
        if _is_readable(attribute) and (not users[mesh, name] or np.array_equal(_values(mesh, name), offset)):
            break
    attribute.data.foreach_set("vector", offset.reshape(-1))
    _name_input(modifier).value = name
    users[mesh, name] += 1
    mesh.update_tag()
    obj.update_tag()


def _is_readable(attribute: bpy.types.Attribute) -> bool:
    return (attribute.data_type, attribute.domain) == ("FLOAT_VECTOR", "POINT")


def _values(mesh: bpy.types.Mesh, name: str) -> np.ndarray:
    """(n, 3) float32 offsets of a mesh's points by an attribute; 0 where there is none."""
    values = np.zeros((len(mesh.vertices), 3), dtype=np.float32)
    attribute = mesh.attributes.get(name)
    if attribute is not None and _is_readable(attribute):
        attribute.data.foreach_get("vector", values.reshape(-1))
        values[~np.isfinite(values)] = 0.0
    return values


def _name_input(modifier: bpy.types.NodesModifier):
    socket = modifier.node_group.interface.items_tree[ATTRIBUTE_SOCKET]
    return getattr(modifier.properties.inputs, socket.identifier)


def _attribute_name(modifier: bpy.types.NodesModifier) -> str:
    if ATTRIBUTE_SOCKET not in modifier.node_group.interface.items_tree:
        return OFFSET_ATTRIBUTE
    return _name_input(modifier).value or OFFSET_ATTRIBUTE


def _ensure_group() -> bpy.types.NodeTree:
    tree = next((tree for tree in bpy.data.node_groups if tree.library is None and is_offset_group(tree)), None)
    if tree is None:
        tree = bpy.data.node_groups.new(OFFSET_GROUP, "GeometryNodeTree")
        tree.is_modifier = True
        tree.description = "Moves points off faces of another medium in the same place"
        tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
        tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    elif ATTRIBUTE_SOCKET in tree.interface.items_tree:
        return tree
    tree.nodes.clear()
    tree.interface.new_socket(ATTRIBUTE_SOCKET, in_out="INPUT", socket_type="NodeSocketString")
    source, sink = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    unnamed = tree.nodes.new("FunctionNodeCompare")
    unnamed.data_type = "STRING"
    unnamed.operation = "EQUAL"
    name = tree.nodes.new("GeometryNodeSwitch")
    name.input_type = "STRING"
    name.inputs["True"].default_value = OFFSET_ATTRIBUTE
    offset = tree.nodes.new("GeometryNodeInputNamedAttribute")
    offset.data_type = "FLOAT_VECTOR"
    moved = tree.nodes.new("GeometryNodeSetPosition")
    text = [socket for socket in unnamed.inputs if socket.type == "STRING"]
    tree.links.new(source.outputs[ATTRIBUTE_SOCKET], text[0])
    tree.links.new(unnamed.outputs["Result"], name.inputs["Switch"])
    tree.links.new(source.outputs[ATTRIBUTE_SOCKET], name.inputs["False"])
    tree.links.new(name.outputs["Output"], offset.inputs["Name"])
    tree.links.new(source.outputs["Geometry"], moved.inputs["Geometry"])
    tree.links.new(offset.outputs["Attribute"], moved.inputs["Offset"])
    tree.links.new(moved.outputs["Geometry"], sink.inputs[0])
    for index, node in enumerate((source, unnamed, name, offset, moved, sink)):
        node.location = (220.0 * index, -160.0 if node in (unnamed, name, offset) else 0.0)
    return tree
