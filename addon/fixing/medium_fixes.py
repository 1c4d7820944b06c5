"""Fixes of what media are: priorities, values and nodes of their materials, slots, stray properties."""

from __future__ import annotations

import bpy
import numpy as np

from ..checking.finding import Fix
from ..model.contract import MATERIAL_SLOTS
from ..model.parameter import MAX_PRIORITY, PRIORITY_PROPERTY, ParameterError
from ..model.parameters import SOCKETS
from ..nodes.animation import is_animated
from ..nodes.lookups import caching_nodes
from ..nodes.mending import complete_nodes, repair_nodes
from ..scene.materials import dielectric_node, dielectrics, medium_material, parameter_socket
from ..scene.media import all_objects, get_priority, material_priority
from ..scene.preset_materials import DEPTH, fit_depth
from ..scene.priorities import Owner, hindrance, set_number
from ..scene.shapes import thickness
from .access import length_in, own_data, own_material, own_object, require_dielectric, shown_object, users_of


def set_priority(scene: bpy.types.Scene, fix: Fix) -> list[str]:
    """Give objects, or materials, a number. A name of both is that of the object."""
    if isinstance(fix.value, bool) or not isinstance(fix.value, int) or not 0 <= fix.value <= MAX_PRIORITY:
        raise ParameterError(f"A priority is a whole number from 0 to {MAX_PRIORITY}; check the scene again")
    owners = [_owner_named(scene, name) for name in fix.names]
    for owner in owners:
        reason = hindrance(owner)
        if reason:
            raise ParameterError(f"{owner.name!r} {reason}")
    changes = []
    for owner in owners:
        before = get_priority(owner) if isinstance(owner, bpy.types.Object) else material_priority(owner)
        if before != fix.value:
            set_number(owner, fix.value)
            changes.append(f"{owner.name}: priority {before} -> {fix.value}")
    return changes


def _owner_named(scene: bpy.types.Scene, name: str) -> Owner:
    """Return the medium of that name, or else the material."""
    if any(obj.name == name for obj in all_objects(scene)):
        obj = own_object(scene, name)
        if medium_material(obj) is None:
            raise ParameterError(f"{name!r} is no medium any more; check the scene again")
        return obj
    material = own_material(name)
    require_dielectric(material)
    return material


def set_depth(scene: bpy.types.Scene, fix: Fix) -> list[str]:
    """Let the colours of objects' media be at the thickness of the objects, or at a distance that the fix holds."""
    deepest: dict[bpy.types.Material, float] = {}
    for name in fix.names:
        obj = shown_object(scene, name)
        material = medium_material(obj)
        if material is None:
            raise ParameterError(f"{name!r} is no medium any more; check the scene again")
        own_material(material.name)
        depth = thickness(obj) if fix.value is None else length_in(fix)
        if depth <= 0.0:
            raise ParameterError(f"{name!r} is flat; give it a thickness first")
        deepest[material] = max(deepest.get(material, 0.0), depth)
    before = {material: _depth_of(material) for material in deepest}
    for material, depth in deepest.items():
        fit_depth(material, depth)
        repair_nodes(material)
    return [
        f"{material.name}: {DEPTH.name} {before[material]:.4g} -> {depth:.4g}"
        for material, depth in deepest.items()
        if not np.isclose(before[material], depth, rtol=1e-5)
    ]


def _depth_of(material: bpy.types.Material) -> float:
    """Return the depth that an artist has set.

    :raises ParameterError: if it is not a number of its own.
    """
    socket = parameter_socket(material, DEPTH.name)
    if socket is None or is_animated(socket.id_data, socket):
        raise ParameterError(f"{material.name!r}: other nodes, keyframes or a driver set {DEPTH.name}; change it there")
    return socket.default_value


def set_value(_: bpy.types.Scene, fix: Fix) -> list[str]:
    """Give a socket of materials the value that it counts as, or one that the fix holds."""
    parameter = next((each for each in SOCKETS if each.name == fix.path and each.kind != "SHADER"), None)
    if parameter is None:
        raise ParameterError(f"{fix.path!r} is no value of a nested dielectric; check the scene again")
    sockets = []
    for name in fix.names:
        material = own_material(name)
        require_dielectric(material)
        socket = parameter_socket(material, parameter.name)
        if socket is None or not socket.id_data.is_editable or is_animated(socket.id_data, socket):
            raise ParameterError(f"{name!r}: other nodes, keyframes or a driver set {fix.path!r}; change it there")
        sockets.append((material, socket))
    changes = []
    for material, socket in sockets:
        before = (
            socket.default_value if isinstance(socket.default_value, (int, float, str)) else tuple(socket.default_value)
        )
        value = parameter.bounded(before if fix.value is None else fix.value)
        if before != value:
            try:
                socket.default_value = value
            except (TypeError, ValueError):
                raise ParameterError(f"{fix.path!r} cannot be {fix.value!r}; check the scene again") from None
            repair_nodes(material)
            changes.append(f"{material.name}: {fix.path} {_in_words(before)} -> {_in_words(value)}")
    return changes


def _in_words(value: float | str | tuple[float, ...]) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(f'{each:.4g}' for each in value[:3])})"
    return value if isinstance(value, str) else f"{value:.4g}"


@caching_nodes()
def mend_nodes(_: bpy.types.Scene, fix: Fix) -> list[str]:
    """Let neighbours read what is plugged into materials, and plug in what is missing."""
    materials = [own_material(name) for name in fix.names]
    changes = []
    for material in materials:
        changes += repair_nodes(material) + complete_nodes(material)
        if dielectric_node(material) is not None and not material.use_transparent_shadow:
            material.use_transparent_shadow = True
            changes.append(f"{material.name}: Transparent Shadows on")
    return changes


def remove_property(scene: bpy.types.Scene, fix: Fix) -> list[str]:
    """Remove a custom property of ours from objects."""
    if fix.path != PRIORITY_PROPERTY and not fix.path.startswith("nd_"):
        raise ParameterError(f"{fix.path!r} is no property of nested dielectrics; remove it by hand")
    objects = [own_object(scene, name) for name in fix.names]
    found = [obj for obj in objects if fix.path in obj]
    for obj in found:
        del obj[fix.path]
        obj.update_tag()
    return [f"{obj.name}: custom property {fix.path!r} removed" for obj in found]


def move_slot(scene: bpy.types.Scene, fix: Fix) -> list[str]:
    """Exchange slots of objects so that neighbours read the nested dielectrics; faces keep their materials."""
    plans = [(obj, *_slots_to_exchange(obj)) for obj in (own_object(scene, name) for name in fix.names)]
    for obj, low, high in plans:
        _exchange_slots(obj, low, high)
    return [f"{obj.name}: slots {low + 1} and {high + 1} exchanged" for obj, low, high in plans]


def _slots_to_exchange(obj: bpy.types.Object) -> tuple[int, int]:
    """Return a slot that neighbours read and one with a nested dielectric that they do not.

    :raises ParameterError: if there is no such exchange.
    """
    own_data(obj)
    name = repr(obj.name)
    if obj.type != "MESH":
        raise ParameterError(f"{name} is no mesh; turn it into one first (Object > Convert > Mesh)")
    for user in users_of(obj.data):
        if not user.is_editable:
            raise ParameterError(
                f"{user.name!r} shares the mesh of {name} and comes from another file; make that local"
            )
        counted = next(filter(_counts_slots, user.modifiers), None)
        if counted is not None:
            raise ParameterError(f"{user.name!r} has the modifier {counted.name!r}, which counts slots; apply it first")
    held = {slot for slot, _ in dielectrics(obj)}
    high = next((slot for slot in sorted(held) if slot >= MATERIAL_SLOTS), None)
    if high is None:
        raise ParameterError(f"{name} has no nested dielectric in a far slot any more; check the scene again")
    low = next((slot for slot in range(MATERIAL_SLOTS) if slot not in held), None)
    if low is None:
        raise ParameterError(
            f"{name} has a nested dielectric in each of its first slots; remove one, or part the object"
        )
    return low, high


def _counts_slots(modifier: bpy.types.Modifier) -> bool:
    """Return whether a modifier gives faces slots by their numbers."""
    own = [getattr(modifier, name, 0) for name in ("material_offset", "material_offset_rim")]
    return any(own) or getattr(modifier, "material", -1) not in (-1, None) or modifier.type in ("NODES", "BOOLEAN")


def _exchange_slots(obj: bpy.types.Object, low: int, high: int) -> None:
    """Exchange two slots of all objects that share a mesh, and the faces that have them."""
    mesh = obj.data
    slots = np.empty(len(mesh.polygons), dtype=np.int32)
    mesh.polygons.foreach_get("material_index", slots)
    order = np.arange(max(int(slots.max(initial=0)), high) + 1)
    order[[low, high]] = high, low
    mesh.polygons.foreach_set("material_index", order[slots].astype(np.int32))
    mesh.materials[low], mesh.materials[high] = mesh.materials[high], mesh.materials[low]
    for user in users_of(mesh):
        kept = [(user.material_slots[slot].link, user.material_slots[slot].material) for slot in (low, high)]
        for slot, (link, material) in zip((high, low), kept):
            user.material_slots[slot].link = link
            if link == "OBJECT":
                user.material_slots[slot].material = material
    mesh.update_tag()
