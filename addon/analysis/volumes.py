"""Which media of a scene are left to Cycles' own volumes."""

from __future__ import annotations

from functools import cache

import bpy
import numpy as np

from ..scene.foreign import is_clear, light_box, sends_light_on
from ..scene.lights import scene_lights
from .charging import Filling, left_to_volumes
from .extents import EVERYWHERE, meet_any
from .snapshot import SceneSnapshot
from .stability import may_move

NOTHING_ABSORBED = (0.0, 0.0, 0.0)
"""Absorption coefficients of a clear medium."""


def find_volumes(snapshot: SceneSnapshot, boxes: np.ndarray, asking: set[int]) -> tuple[set, set]:
    """Return materials whose volumes absorb for all rays, and those that give back what volumes take where they win.

    :param boxes: (n, 2, 3) of the bodies; asking: bodies that are told nothing.
    """
    materials = [only_medium(snapshot, instance.obj) for instance in snapshot.bodies]
    if not any(snapshot.facts[material].coefficients != NOTHING_ABSORBED for material in materials):
        return set(), set()
    unclear = {only_medium(snapshot, instance.obj) for instance in snapshot.uncertain_media}
    unclear |= {each for each, facts in snapshot.facts.items() if not facts.can_be_told or each.library is not None}
    wanted = meet_any(boxes, _boxes_of_volume_needs(snapshot))
    fillings = []
    for index, (instance, material, contact) in enumerate(zip(snapshot.bodies, materials, snapshot.contacts)):
        facts = snapshot.facts[material]
        certain = index not in asking and material not in unclear
        fillings.append(
            Filling(
                material,
                instance.body.priority,
                instance.body.solid.mean_chord * abs(np.linalg.det(instance.body.matrix[:3, :3])) ** (1 / 3),
                facts.coefficients,
                certain,
                certain
                and not contact.overlaps_itself
                and facts.has_volume
                and instance.obj.material_slots[0].material == material
                and not any(map(is_clear, materials_beside_medium(snapshot, instance.obj))),
                bool(wanted[index]) or facts.has_own_volume,
            )
        )
    pairs = {tuple(sorted((index, other))) for index, each in enumerate(snapshot.contacts) for other in each.partners}
    return left_to_volumes(fillings, pairs)


def only_medium(snapshot: SceneSnapshot, obj: bpy.types.Object) -> bpy.types.Material | None:
    """Return the nested dielectric of an object, or None if it has several."""
    found = {slot.material for slot in obj.material_slots} & snapshot.facts.keys()
    return found.pop() if len(found) == 1 else None


def materials_beside_medium(snapshot: SceneSnapshot, obj: bpy.types.Object) -> list[bpy.types.Material | None]:
    """Return the materials of an object that are no nested dielectrics."""
    return [slot.material for slot in obj.material_slots if slot.material not in snapshot.facts]


def _boxes_of_volume_needs(snapshot: SceneSnapshot) -> list[np.ndarray]:
    """Return the boxes of what lets rays on or scatters them inside a medium, and of lights: no surface knows of these."""
    sends_on = cache(sends_light_on)
    boxes = [instance.box for instance in snapshot.instances if not instance.medium and sends_on(instance.obj)]
    boxes += [EVERYWHERE if may_move(light) else light_box(light) for light in scene_lights(snapshot.scene)]
    instanced = {obj.instance_collection for obj in snapshot.scene.objects if obj.instance_collection is not None}
    return boxes + [EVERYWHERE for each in instanced if any(obj.type == "LIGHT" for obj in each.all_objects)]
