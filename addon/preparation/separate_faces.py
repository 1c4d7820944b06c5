"""Separating media whose faces lie in the same place, and taking that back.

What moves how far is planned in :mod:`nested_dielectric.geometry.coincident_faces`.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

import bpy
import numpy as np

from ..analysis.findings import listed
from ..analysis.mesh_modifiers import is_offset
from ..analysis.surroundings import last_contacts
from ..analysis.validity import is_analysed
from ..checking.coincident_checks import partings
from ..geometry.coincident_faces import local_offsets
from ..nodes.names import OFFSET_GROUP
from ..scene.media import all_objects
from .live import analyse
from .offset_modifier import add_offset, attribute_name

PASSES = 8
"""How often faces may move: those beside them may then lie in one plane with others, so all is looked at again."""


def separate_coincident_faces(scene: bpy.types.Scene) -> list[str]:
    """Separate what coincides in a scene, which has just been analysed, and analyse it again.

    :returns: what was changed, in sentences.
    """
    separated: dict[bpy.types.Object, _Separated] = {}
    for number in range(PASSES):
        offsets = _next_offsets(scene, number > 0, separated)
        if not offsets:
            break
        users = users_of_attributes()
        for obj, offset in offsets.items():
            add_offset(obj, offset, users)
        analyse(scene)
    return [
        f"{obj.name}: {each.distance:.2g} parted from {listed(tuple(each.others))}, which has faces in the same place "
        f"(modifier {OFFSET_GROUP!r})"
        for obj, each in separated.items()
    ]


@dataclass
class _Separated:
    """How far an object's faces have moved, in scene units, and the names of those that they were separated from, in order."""

    distance: float = 0.0
    others: dict[str, None] = field(default_factory=dict)


def _next_offsets(
    scene: bpy.types.Scene, rims: bool, separated: dict[bpy.types.Object, _Separated]
) -> dict[bpy.types.Object, np.ndarray]:
    """Return how far to move objects' points, (n, 3) in their own space.

    :param rims: faces have moved before, as in :func:`~nested_dielectric.geometry.coincident_faces.plan_moves`.
    :param separated: objects that have been moved; brought up to date.
    """
    rows, found = last_contacts(scene)
    offsets: dict[bpy.types.Object, np.ndarray] = {}
    for parting in partings(rows, found, rims):
        if parting.remedy:
            continue
        obj, body = rows[parting.index]
        # An object that is instanced moves the same everywhere.
        offset = local_offsets(body, parting.move)
        before = offsets.get(obj, offset)
        offsets[obj] = np.where(np.abs(before) >= np.abs(offset), before, offset)
        each = separated.setdefault(obj, _Separated())
        each.distance = max(each.distance, parting.distance)
        each.others.update(dict.fromkeys(parting.others))
    return offsets


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
