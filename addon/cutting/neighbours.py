"""Which media of a scene may meet each other, or things that are no media."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix

from ..analysis import extents, stability, surroundings
from ..model.contract import Exterior
from ..scene.foreign import light_box
from ..scene.lights import scene_lights
from ..scene.media import is_cut_surface


@dataclass(frozen=True)
class Surroundings:
    """What the analysis knows of a medium that stays where it is, among others that do.

    :param code: as of a :class:`~nested_dielectric.geometry.contacts.Contact`; around: the medium of Exterior.MEDIUM.
    :param partners: media whose surfaces cross its own or that hold part of it.
    :param is_simple: its surface is in one piece; coincides: some of it is in the same place as another's.
    :param is_told: it knows by the analysis alone what lies outside it.
    """

    code: int
    around: bpy.types.Object | None
    partners: tuple[bpy.types.Object, ...]
    is_simple: bool
    coincides: bool
    is_told: bool

    @property
    def may_cross(self) -> bool:
        """Return whether not all of its surface has the same outside."""
        return self.code not in (Exterior.AIR, Exterior.MEDIUM, Exterior.WINNER)


def known_surroundings(
    scene: bpy.types.Scene, objects: Sequence[bpy.types.Object]
) -> dict[bpy.types.Object, Surroundings] | None:
    """Return what the analysis of a scene found of each medium; None if it does not know all of them."""
    found = surroundings.last_found(scene)
    rows, contacts = surroundings.last_contacts(scene)
    if found is None or found.doubts or len(rows) != len(objects) or {obj for obj, _ in rows} != set(objects):
        return None
    told = set(found.known)
    return {
        obj: Surroundings(
            contact.code,
            None if contact.surrounding_body is None else rows[contact.surrounding_body][0],
            tuple(rows[partner][0] for partner in contact.partners),
            len(body.solid.by_island[1]) == 2,
            bool(contact.coincident),
            obj.name in told,
        )
        for (obj, body), contact in zip(rows, contacts)
    }


def touching_media(
    objects: Sequence[bpy.types.Object], moving: set[bpy.types.Object], known: dict | None = None
) -> dict[bpy.types.Object, list[bpy.types.Object]]:
    """Return the media that each medium may meet.

    :param moving: media that may meet all others.
    :param known: what is known of each medium, which leaves those that do meet; else those may whose boxes do.
    """
    if known is not None:
        pairs = {
            frozenset((obj, other)) for obj in objects for other in (*known[obj].partners, known[obj].around) if other
        }
    else:
        boxes = np.array([extents.EVERYWHERE if obj in moving else _box(obj) for obj in objects]).reshape(-1, 2, 3)
        pairs = set()
        for obj, box in zip(objects, boxes):
            pairs |= {frozenset((obj, objects[other])) for other in np.flatnonzero(extents.meet_any(boxes, [box]))}
    touching: dict[bpy.types.Object, list[bpy.types.Object]] = {obj: [] for obj in objects}
    for pair in pairs:
        if len(pair) == 2:
            first, second = pair
            touching[first].append(second)
            touching[second].append(first)
    return touching


def _box(obj: bpy.types.Object, matrix: Matrix | None = None) -> np.ndarray:
    """Return the lowest and the highest corner of an object's box, (2, 3), in the world or where a matrix places it."""
    corners = np.array([tuple(corner) for corner in obj.bound_box])
    matrix = np.array(obj.matrix_world if matrix is None else matrix)
    corners = corners @ matrix[:3, :3].T + matrix[:3, 3]
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def connected_groups(
    objects: Iterable[bpy.types.Object], touching: dict[bpy.types.Object, list[bpy.types.Object]]
) -> Iterable[list[bpy.types.Object]]:
    """Yield the connected components of media: those that may meet, directly or through others."""
    left = dict.fromkeys(objects)
    while left:
        pending = [next(iter(left))]
        group = dict.fromkeys(pending)
        while pending:
            for other in touching[pending.pop()]:
                if other not in group:
                    group[other] = None
                    pending.append(other)
        yield [obj for obj in left if obj in group]
        for obj in group:
            left.pop(obj, None)


def near_foreign_objects(scene: bpy.types.Scene, objects: Sequence[bpy.types.Object]) -> set[bpy.types.Object]:
    """Return media in whose boxes things that are no media, lights or the camera may be."""
    if not objects:
        return set()
    own = set(objects)
    boxes = np.array([extents.EVERYWHERE if stability.may_change(obj) else _box(obj) for obj in objects])
    others = [extents.EVERYWHERE if stability.may_change(light) else light_box(light) for light in scene_lights(scene)]
    shown = set()
    for instance in scene.view_layers[0].depsgraph.object_instances:
        obj = instance.object.original
        shown.add(obj)
        if obj.type in extents.SHAPED and obj not in own and not is_cut_surface(obj):
            moves = stability.may_change(instance.parent.original if instance.is_instance else obj)
            others.append(extents.EVERYWHERE if moves else _box(instance.object, instance.matrix_world))
    for obj in scene.objects:
        if obj.type == "CAMERA":
            place = np.array(obj.matrix_world)[:3, 3]
            others.append(extents.EVERYWHERE if stability.may_change(obj) else np.array([place, place]))
        elif obj.type in extents.SHAPED and obj not in shown | own and not obj.hide_render and not is_cut_surface(obj):
            others.append(extents.EVERYWHERE)
    return {obj for obj, near in zip(objects, extents.meet_any(boxes, others)) if near}
