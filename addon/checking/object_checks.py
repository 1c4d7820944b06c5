"""Checks of objects that have media: their kinds, slots, priorities."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ..model.contract import MATERIAL_SLOTS
from ..model.parameter import MAX_PRIORITY, PRIORITY_PROPERTY
from ..nodes.animation import curves
from ..scene.materials import dielectric_node, dielectrics
from ..scene.media import NO_SOLIDS, get_priority, own_priority
from .finding import Action, Finding, Fix
from .inspection import Inspection
from .kinds import BAD_PRIORITY, NO_INSIDE, SLOT_LIMIT


def kind_findings(inspection: Inspection) -> list[Finding]:
    """Return what has a nested dielectric and no inside: objects, and what modifiers make of them."""
    depsgraph = inspection.depsgraph
    found = {}
    for instance in depsgraph.object_instances:
        obj = instance.object
        if obj.type in NO_SOLIDS and any(dielectric_node(m.original) for m in obj.data.materials if m is not None):
            owner = instance.parent if instance.is_instance else obj
            found[owner.original] = obj.type
    for obj in depsgraph.scene.objects:
        if any(_is_hair(obj.original, system) for system in obj.particle_systems):
            found[obj.original] = "CURVES"
    findings = []
    for obj, kind in found.items():
        what, remedy = NO_SOLIDS[kind]
        text = f"is {what}" if obj.type == kind else f"makes {what} of a nested dielectric"
        remedy = f"{remedy}, or give it another material"
        findings.append(Finding(NO_INSIDE, obj.name, f"{text}, which Cycles knows no inside of", remedy))
    return findings


def _is_hair(obj: bpy.types.Object, system: bpy.types.ParticleSystem) -> bool:
    """Return whether particles are rendered as strands of a nested dielectric."""
    slots, settings = obj.material_slots, system.settings
    if settings.render_type != "PATH" or not slots:
        return False
    return dielectric_node(slots[min(settings.material, len(slots)) - 1].material) is not None


def object_findings(inspection: Inspection) -> Iterator[Finding]:
    """Yield what is wrong with the priorities and the slots of media."""
    for obj in inspection.objects:
        yield from _priority_findings(obj)
        yield from _slot_findings(obj)


def _slot_findings(obj: bpy.types.Object) -> list[Finding]:
    """Return the slots of an object that neighbours do not see."""
    findings = []
    for slot, _ in dielectrics(obj):
        if slot >= MATERIAL_SLOTS:
            findings.append(
                Finding(
                    SLOT_LIMIT,
                    obj.name,
                    f"has a nested dielectric in slot {slot + 1}, where its neighbours do not look",
                    f"move it to one of the first {MATERIAL_SLOTS} slots",
                    fix=_if_editable(obj, Fix(Action.MOVE_SLOT, (obj.name,))),
                )
            )
    return findings


def _if_editable(obj: bpy.types.Object, fix: Fix) -> Fix | None:
    """Return what mends an object, if it belongs to this file."""
    return fix if obj.library is None else None


def _priority_findings(obj: bpy.types.Object) -> list[Finding]:
    """Return what is wrong with an object's own priority: no whole number, or keyframes beyond what counts."""
    value = obj.get(PRIORITY_PROPERTY)
    if value is None:
        return []
    findings = []
    own = own_priority(obj)
    if own is None or type(value) is not int:
        counts = f"counts as {own}" if own is not None else f"does not count: {get_priority(obj)}, its material's, does"
        findings.append(
            Finding(
                BAD_PRIORITY,
                obj.name,
                f"has the custom property {PRIORITY_PROPERTY!r} with no whole number from 0 to {MAX_PRIORITY} in it, "
                f"which {counts}",
                "delete it, or set its priority again",
                fix=_if_editable(
                    obj, Fix(Action.REMOVE_PROPERTY, (obj.name,), path=PRIORITY_PROPERTY, safe=own is None)
                ),
            )
        )
    path = f'["{PRIORITY_PROPERTY}"]'
    keys = [key for curve in curves(obj.animation_data) if curve.data_path == path for key in curve.keyframe_points]
    if any(not 0.0 <= key.co[1] <= MAX_PRIORITY for key in keys):
        findings.append(
            Finding(
                BAD_PRIORITY,
                obj.name,
                f"has keyframes of its priority beyond 0 to {MAX_PRIORITY}, where its material's counts",
                "move them, or delete them",
            )
        )
    return findings
