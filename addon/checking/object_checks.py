"""Checks of objects that have media: their kinds, slots, priorities."""

from __future__ import annotations

import bpy

from ..model.contract import MATERIAL_SLOTS
from ..model.parameter import MAX_PRIORITY, PRIORITY_PROPERTY
from ..nodes.animation import curves
from ..scene.materials import dielectric_node, dielectrics
from ..scene.media import NO_SOLIDS, get_priority, own_priority
from .finding import Problem


def kind_problems(depsgraph: bpy.types.Depsgraph) -> list[Problem]:
    """Return what has a nested dielectric and no inside: objects, and what modifiers make of them."""
    found = {}
    for instance in depsgraph.object_instances:
        obj = instance.object
        if obj.type in NO_SOLIDS and any(dielectric_node(m.original) for m in obj.data.materials if m is not None):
            owner = instance.parent if instance.is_instance else obj
            found[owner.original] = obj.type
    for obj in depsgraph.scene.objects:
        if any(_is_hair(obj.original, system) for system in obj.particle_systems):
            found[obj.original] = "CURVES"
    problems = []
    for obj, kind in found.items():
        what, remedy = NO_SOLIDS[kind]
        text = f"is {what}" if obj.type == kind else f"makes {what} of a nested dielectric"
        remedy = f"{remedy}, or give it another material"
        problems.append(Problem(obj.name, f"{text}, which Cycles knows no inside of", remedy))
    return problems


def _is_hair(obj: bpy.types.Object, system: bpy.types.ParticleSystem) -> bool:
    """Return whether particles are rendered as strands of a nested dielectric."""
    slots, settings = obj.material_slots, system.settings
    if settings.render_type != "PATH" or not slots:
        return False
    return dielectric_node(slots[min(settings.material, len(slots)) - 1].material) is not None


def object_problems(obj: bpy.types.Object) -> list[Problem]:
    """Return what is wrong with the priority and the slots of an object."""
    problems = _priority_problems(obj)
    for slot, _ in dielectrics(obj):
        if slot >= MATERIAL_SLOTS:
            problems.append(
                Problem(
                    obj.name,
                    f"has a nested dielectric in slot {slot + 1}, where its neighbours do not look",
                    f"move it to one of the first {MATERIAL_SLOTS} slots",
                )
            )
    return problems


def _priority_problems(obj: bpy.types.Object) -> list[Problem]:
    """Return what is wrong with an object's own priority: no whole number, or keyframes beyond what counts."""
    value = obj.get(PRIORITY_PROPERTY)
    if value is None:
        return []
    problems = []
    own = own_priority(obj)
    if own is None or type(value) is not int:
        counts = f"counts as {own}" if own is not None else f"does not count: {get_priority(obj)}, its material's, does"
        problems.append(
            Problem(
                obj.name,
                f"has the custom property {PRIORITY_PROPERTY!r} with no whole number from 0 to {MAX_PRIORITY} in it, "
                f"which {counts}",
                "delete it, or set its priority again",
            )
        )
    path = f'["{PRIORITY_PROPERTY}"]'
    keys = [key for curve in curves(obj.animation_data) if curve.data_path == path for key in curve.keyframe_points]
    if any(not 0.0 <= key.co[1] <= MAX_PRIORITY for key in keys):
        problems.append(
            Problem(
                obj.name,
                f"has keyframes of its priority beyond 0 to {MAX_PRIORITY}, where its material's counts",
                "move them, or delete them",
            )
        )
    return problems
