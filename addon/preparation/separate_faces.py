"""Separating media whose faces lie in the same place, and taking that back.

What moves how far is planned in :mod:`nested_dielectric.preparation.coincident_faces`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import bpy
import numpy as np

from ..analysis.findings import listed
from ..analysis.mesh_modifiers import is_offset, keeps_mesh
from ..analysis.surroundings import last_contacts
from ..analysis.validity import is_analysed
from ..checking.finding import Finding
from ..checking.kinds import COINCIDENT
from ..geometry.contacts import Contact
from ..nodes.names import OFFSET_GROUP
from ..scene.media import all_objects
from .coincident_faces import Move, local_offsets, plan_moves
from .live import analyse
from .offset_modifier import add_offset, attribute_name

PASSES = 8
"""How often faces may move: those beside them may then lie in one plane with others, so all is looked at again."""


def separate_coincident_faces(scene: bpy.types.Scene) -> tuple[list[str], list[Finding]]:
    """Separate what coincides in a scene, which has just been analysed, and analyse it again.

    :returns: what was changed, in sentences, and what could not be.
    """
    separated: dict[bpy.types.Object, _Separated] = {}
    for left in reversed(range(PASSES + 1)):
        offsets, problems = _next_offsets(scene, left, separated)
        if not offsets:
            break
        users = users_of_attributes()
        for obj, offset in offsets.items():
            add_offset(obj, offset, users)
        analyse(scene)
    changes = [
        f"{obj.name}: {each.distance:.2g} parted from {listed(tuple(each.others))}, which has faces in the same place "
        f"(modifier {OFFSET_GROUP!r})"
        for obj, each in separated.items()
    ]
    return changes, problems


@dataclass
class _Separated:
    """How far an object's faces have moved, in scene units, and the names of those that they were separated from, in order."""

    distance: float = 0.0
    others: dict[str, None] = field(default_factory=dict)


def _next_offsets(
    scene: bpy.types.Scene, left: int, separated: dict[bpy.types.Object, _Separated]
) -> tuple[dict[bpy.types.Object, np.ndarray], list[Finding]]:
    """Return how far to move objects' points, (n, 3) in their own space, and what of a scene cannot be separated.

    :param left: passes that follow; in the last nothing moves.
    :param separated: objects that have been moved; brought up to date.
    """
    rows, found = last_contacts(scene)
    found, alike = _between_objects([obj for obj, _ in rows], found)
    text = "has instances with faces in the same place, which would all move alike"
    problems = [Finding(COINCIDENT, obj.name, text, "let them overlap") for obj in alike]
    offsets: dict[bpy.types.Object, np.ndarray] = {}
    for index, move in plan_moves([body for _, body in rows], found, rims=left < PASSES).items():
        obj, body = rows[index]
        names = dict.fromkeys(rows[other][0].name for other in move.others)
        remedy = _remedy(obj, move) if left else "let them overlap"
        if remedy:
            problems.append(
                Finding(COINCIDENT, obj.name, f"has faces in the same place as {listed(tuple(names))}", remedy)
            )
            continue
        # An object that is instanced moves the same everywhere.
        offset = local_offsets(body, move)
        before = offsets.get(obj, offset)
        offsets[obj] = np.where(np.abs(before) >= np.abs(offset), before, offset)
        each = separated.setdefault(obj, _Separated())
        each.distance = max(each.distance, move.unit * float(np.abs(move.heights).max()))
        each.others.update(names)
    return offsets, problems


def users_of_attributes() -> Counter[tuple[bpy.types.Mesh, str]]:
    """Return the numbers of modifiers that read an attribute of a mesh, by both."""
    return Counter(
        (obj.data, attribute_name(modifier))
        for obj in bpy.data.objects
        for modifier in filter(is_offset, obj.modifiers)
    )


def rejoin_separated_faces(scene: bpy.types.Scene) -> list[str]:
    """Take back what :func:`separate_coincident_faces` has moved in a scene, but where another analysed scene shows it.

    :returns: what was changed, in sentences.
    """
    shown = {obj for other in bpy.data.scenes if other != scene and is_analysed(other) for obj in all_objects(other)}
    found = [
        (obj, modifier)
        for obj in sorted(all_objects(scene) - shown, key=lambda obj: obj.name)
        if obj.is_editable
        for modifier in filter(is_offset, obj.modifiers)
    ]
    groups = {modifier.node_group for _, modifier in found}
    moved = {(obj.data, attribute_name(modifier)) for obj, modifier in found if obj.mode == "OBJECT"}
    for obj, modifier in found:
        obj.modifiers.remove(modifier)
    moved -= users_of_attributes().keys()
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
    """Return contacts without what coincides with another instance of the same object, and the objects of which some does."""
    result = []
    alike: dict[bpy.types.Object, None] = {}
    for obj, contact in zip(objects, found):
        others = tuple(each for each in contact.coincident if objects[each[0]] != obj)
        if len(others) < len(contact.coincident):
            alike[obj] = None
            contact = replace(contact, coincident=others)
        result.append(contact)
    return result, list(alike)


def _remedy(obj: bpy.types.Object, move: Move) -> str:
    """Return what to do before faces can be moved; nothing where the points of the mesh are those of the evaluated one."""
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
