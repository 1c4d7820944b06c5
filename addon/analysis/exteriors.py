"""What each medium of a scene may be told of its exterior."""

from __future__ import annotations

from dataclasses import replace

import bpy
import numpy as np

from ..geometry.contacts import Contact
from ..model.contract import NO_SOLE_PRIORITY, Exterior
from ..nodes.sockets import CLEAR
from .extents import meet_any
from .facts import ExteriorFacts, common_facts
from .material_facts import MaterialFacts
from .snapshot import SceneSnapshot
from .volumes import find_volumes, materials_beside_medium, only_medium


def exterior_facts(snapshot: SceneSnapshot) -> dict[bpy.types.Object, ExteriorFacts]:
    """Return what each medium is told: what holds for all of its instances."""
    doubtful = bool(snapshot.instabilities) or any(
        instance.instability for instance in snapshot.instances if instance.medium
    )
    boxes = np.array([instance.box for instance in snapshot.bodies]).reshape(-1, 2, 3)
    near_objects = meet_any(boxes, [instance.box for instance in snapshot.instances if not instance.medium])
    near_objects |= np.array(
        [bool(materials_beside_medium(snapshot, instance.obj)) for instance in snapshot.bodies], dtype=bool
    )
    # Bodies of one priority that overlap are one: a ray may go from one to the next.
    priorities = np.array([instance.body.priority for instance in snapshot.bodies])
    near_objects = np.isin(priorities, priorities[near_objects])
    near_unclear = meet_any(boxes, [instance.box for instance in snapshot.uncertain_media])
    asking = set(np.flatnonzero(near_unclear | doubtful).tolist())
    volumes, givers = find_volumes(snapshot, boxes, asking)
    told: dict[bpy.types.Object, list[ExteriorFacts]] = {}
    for index, (instance, contact) in enumerate(zip(snapshot.bodies, snapshot.contacts)):
        if index in asking:
            facts = ExteriorFacts(overlaps_itself=contact.overlaps_itself)
        else:
            facts = _facts_of_body(snapshot, contact, bool(near_objects[[index, *contact.partners]].any()), volumes)
        told.setdefault(instance.obj, []).append(facts)
    for instance in snapshot.instances:
        if instance.medium and (instance.body is None or _has_linked_material(instance.obj, snapshot.facts)):
            told[instance.obj] = [ExteriorFacts()]
    merged = _merge_instances(told)
    for obj in merged if volumes else ():
        material = only_medium(snapshot, obj)
        merged[obj] = replace(merged[obj], by_volume=material in volumes, gives_back=material in givers)
    return merged


def _facts_of_body(snapshot: SceneSnapshot, contact: Contact, may_hold_objects: bool, volumes: set) -> ExteriorFacts:
    """Return what a body is told whose neighbours are known.

    :param may_hold_objects: objects that are no media may stand in it; volumes: materials that are left to volumes.
    """
    unsure = contact.sole_priority is None or snapshot.uncertain_media
    sole_priority = NO_SOLE_PRIORITY if unsure else float(contact.sole_priority)
    facts = ExteriorFacts(contact.code, sole_priority, contact.overlaps_itself, may_hold_objects)
    if contact.surrounding_body is None:
        return facts
    around = snapshot.bodies[contact.surrounding_body].body
    if len(around.medium) == 1 or around.priority in snapshot.ambiguous_priorities:
        return replace(facts, code=Exterior.UNKNOWN)
    ior, transmittance, depth = around.medium
    if only_medium(snapshot, snapshot.bodies[contact.surrounding_body].obj) in volumes:
        transmittance = CLEAR
    return replace(facts, medium=(float(around.priority), ior, depth), transmittance=transmittance)


def _has_linked_material(obj: bpy.types.Object, facts: dict[bpy.types.Material, MaterialFacts]) -> bool:
    """Return whether an object is made of a medium that only its own file can tell anything."""
    return any(slot.material in facts and slot.material.library is not None for slot in obj.material_slots)


def _merge_instances(told: dict[bpy.types.Object, list[ExteriorFacts]]) -> dict[bpy.types.Object, ExteriorFacts]:
    """Return what holds for all instances of each object."""
    return {
        obj: common_facts(several) or ExteriorFacts(overlaps_itself=any(facts.overlaps_itself for facts in several))
        for obj, several in told.items()
    }
