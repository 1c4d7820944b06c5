"""Media in a scene: giving objects a material and a priority, and listing who wins over whom.

A material's priority is the default; an object's own custom property overrides it.
"""

from __future__ import annotations

from collections.abc import Iterable
from ctypes import c_float
from typing import Any

import bpy

from .animation import is_animated
from .materials import (
    dielectric_node,
    dielectrics,
    looked_up_once,
    may_disperse,
    medium_material,
    unchanged_nodes,
)
from .parameters import BY_KEYWORD, GROUP_NAME, MAX_PRIORITY, PRIORITY_PROPERTY, ParameterError
from .preset_materials import preset_material
from .trees import mend_nodes

SOLID_TYPES = frozenset(("MESH", "CURVE", "SURFACE", "FONT", "META"))
"""Types of objects whose surface may enclose something."""

NO_SOLIDS = {
    "POINTCLOUD": ("a point cloud", "instance a closed ball on its points instead (Geometry Nodes: Instance on Points)"),
    "CURVES": (
        "hair curves",
        "turn it into a closed mesh (Geometry Nodes: Curve to Mesh with a profile and Fill Caps; Object > Convert > Mesh)",
    ),
    "VOLUME": ("a volume", "turn it into a mesh (the modifier Volume to Mesh of an empty mesh object)"),
    "GREASEPENCIL": ("grease pencil", "turn it into a curve (Object > Convert > Curve) with a Bevel Depth and Fill Caps"),
}
"""Types that take a material and have no inside that Cycles' rays could be in: what they are, and what to do instead."""


def assign(
    obj: bpy.types.Object, material: bpy.types.Material | str, priority: int | None = None
) -> bpy.types.Material:
    """Make an object a medium.

    The material takes the place of the object's active material, or its first slot. ``material`` may be the name of a
    preset: then its colour is that of the preset through as much of it as the object is thick, and a material of that
    preset that is already in the file is used again where its depth comes near.

    :param priority: the object's own priority; None leaves that of the material in force.
    :raises ParameterError: if the object cannot enclose a medium, or the preset or the priority is unknown.
    """
    if obj.type not in SOLID_TYPES:
        kind, remedy = NO_SOLIDS.get(obj.type, (obj.type.lower(), "choose another object"))
        raise ParameterError(
            f"{obj.name!r} is {kind}; a medium needs a closed mesh, curve, surface, text or metaball: {remedy}"
        )
    if priority is not None:
        check_priority(priority)
    if isinstance(material, str):
        material = preset_material(material, [obj])
    else:
        mend_nodes(material)
        if dielectric_node(material) is None:
            raise ParameterError(
                f"material {material.name!r} has no node {GROUP_NAME!r} that reaches its output; "
                "make it with new_material()"
            )
    if obj.material_slots:
        obj.active_material = material
    else:
        obj.data.materials.append(material)
    if priority is not None:
        set_priority(obj, priority)
    return material


def check_priority(priority: int) -> int:
    """Return ``priority`` as a whole number from 0 to 1000; :class:`ParameterError` if it is none."""
    return BY_KEYWORD["priority"].check(priority)


def set_priority(obj: bpy.types.Object, priority: int | None) -> None:
    """Give an object a priority of its own, or with None return it to that of its material.

    It is a custom property of the object, so it is copied, undone, animated and saved as any other.
    """
    if priority is None:
        obj.pop(PRIORITY_PROPERTY, None)
    else:
        number = check_priority(priority)
        obj.pop(PRIORITY_PROPERTY, None)  # or it may keep another type
        obj[PRIORITY_PROPERTY] = number
        obj.id_properties_ui(PRIORITY_PROPERTY).update(
            min=0, max=MAX_PRIORITY, description="Where media overlap, the lowest number wins"
        )
    obj.update_tag()


def own_priority(obj: bpy.types.Object) -> int | None:
    """Return the priority that overrides the material's, or None.

    A custom property may hold anything. What the shader reads of it as a whole number from 0 to 1000 counts, here as
    there; all else leaves the material's in force.
    """
    value = obj.get(PRIORITY_PROPERTY)
    return None if value is None else _priority_in(value)


def _priority_in(value: Any) -> int | None:
    """As is_priority() in osl/medium.h: Cycles gives the shader four numbers in single precision."""
    if isinstance(value, (int, float)):
        numbers = (value, value, value, 1.0)
    elif getattr(value, "typecode", None) in ("i", "f", "d") and len(value) <= 4:
        numbers = (*value, *(0.0, 0.0, 0.0, 1.0)[len(value) :])
    else:
        return None
    first, second, third, there = (c_float(number).value for number in numbers)
    counts = there > 0.0 and first == second == third and 0.0 <= first <= MAX_PRIORITY and first == int(first)
    return int(first) if counts else None


def get_priority(obj: bpy.types.Object) -> int:
    """Return the priority an object renders with. Raises :class:`ParameterError` if it is no medium."""
    material = medium_material(obj)
    if material is None:
        raise ParameterError(f"{obj.name!r} has no nested dielectric material; give it one with assign()")
    own = own_priority(obj)
    return material_priority(material) if own is None else own


@looked_up_once
def material_priority(material: bpy.types.Material) -> int:
    """Return the priority that a nested dielectric gives objects without their own."""
    return BY_KEYWORD["priority"].bounded(dielectric_node(material).inputs["Priority"].default_value)


def all_objects(scene: bpy.types.Scene) -> set[bpy.types.Object]:
    """Return the objects of a scene and those in instanced collections."""
    objects = set(scene.objects)
    pending = [obj.instance_collection for obj in objects if obj.instance_collection is not None]
    seen = set()
    while pending:
        collection = pending.pop()
        if collection in seen:
            continue
        seen.add(collection)
        for obj in collection.all_objects:
            objects.add(obj)
            if obj.instance_collection is not None:
                pending.append(obj.instance_collection)
    return objects


@unchanged_nodes()
def media(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """Return every object of a scene that is a medium, those in instanced collections too, in winning order."""
    return winning_order(all_objects(scene))


@unchanged_nodes()
def dispersing_materials(scene: bpy.types.Scene) -> list[bpy.types.Material]:
    """Return the nested dielectrics of a scene that split light into colours, or are animated to."""
    found = {material for obj in media(scene) for _, material in dielectrics(obj)}
    return sorted(filter(may_disperse, found), key=lambda material: material.name_full)


@unchanged_nodes()
def winning_order(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Object]:
    """Return the media among ``objects``, the one that wins over all others first."""
    found = [obj for obj in objects if medium_material(obj) is not None]
    return sorted(found, key=lambda obj: (get_priority(obj), obj.name))


def move_priority(scene: bpy.types.Scene, obj: bpy.types.Object, step: int) -> bool:
    """Move an object one place up (-1) or down (+1) in the winning order; False if it is at the end already.

    An object that shares its priority with others is parted from them; one that has its own passes the next level. The
    object gets a free number next to that level. Where there is none, levels make room by one number each, those of a
    material whose objects all rely on it in the material. Raises :class:`ParameterError` if that cannot be done.
    """
    objects = media(scene)
    levels: dict[int, list[bpy.types.Object]] = {}
    for medium in objects:
        if medium != obj:
            levels.setdefault(get_priority(medium), []).append(medium)
    numbers = sorted(levels)
    priority = get_priority(obj)
    place = sum(number < priority for number in numbers)
    if priority in levels:
        place += step > 0
    elif not 0 <= place + min(step, 0) < len(numbers):
        return False
    else:
        place += step
    if not obj.is_editable:
        raise ParameterError(f"{obj.name!r} belongs to a library; make it local")
    relying = _relying_on_materials(objects, obj)
    ways = []
    for number, shifts in _places_between(numbers, place, step):
        writes = [(owner, level + by) for level, by in shifts.items() for owner in _owners(levels[level], relying)]
        if all(owner.is_editable for owner, _ in writes):
            ways.append((number, writes))
    if not ways:
        raise ParameterError(
            f"{obj.name!r} finds no free number from 0 to {MAX_PRIORITY} there; "
            "give media that need not differ equal priorities, or make those local that belong to a library"
        )
    number, writes = min(ways, key=lambda way: len(way[1]))
    for owner, other in writes:
        if isinstance(owner, bpy.types.Material):
            dielectric_node(owner).inputs["Priority"].default_value = other
        else:
            set_priority(owner, other)
    set_priority(obj, number)
    return True


def _places_between(numbers: list[int], place: int, step: int) -> list[tuple[int, dict[int, int]]]:
    """Ways to a number before ``numbers[place]`` and behind the one before: the number, and how far levels go for it.

    A free one next to the level that is passed, or that of a level which makes room with those that stand in its way.
    """
    before = numbers[place - 1] if place else -1
    behind = numbers[place] if place < len(numbers) else MAX_PRIORITY + 1
    if behind - before > 1:
        return [(behind - 1 if step < 0 else before + 1, {})]
    ways = []
    for number, shift, run in ((behind, 1, numbers[place:]), (before, -1, numbers[:place][::-1])):
        moved = {level: shift for index, level in enumerate(run) if level == number + index * shift}
        if all(0 <= each <= MAX_PRIORITY for each in (number, *(level + shift for level in moved))):
            ways.append((number, moved))
    return ways


def _relying_on_materials(objects: list[bpy.types.Object], moved: bpy.types.Object) -> set[bpy.types.Material]:
    """Materials whose priority may change in place of that of objects: it concerns none but those of the scene that rely
    on it, and no other dielectric of theirs.
    """
    here = {obj for obj in objects if obj != moved}
    found = {medium_material(obj) for obj in here if own_priority(obj) is None}
    for other in bpy.data.objects:
        for _, material in dielectrics(other):
            depends = other != moved and own_priority(other) is None
            if depends and (other not in here or medium_material(other) != material):
                found.discard(material)
    return {material for material in found if material.is_editable and not _is_moved(material)}


def _is_moved(material: bpy.types.Material) -> bool:
    """Whether a keyframe, a driver or a link sets the material's priority."""
    socket = dielectric_node(material).inputs["Priority"]
    return socket.is_linked or is_animated(material.node_tree, socket)


def _owners(level: list[bpy.types.Object], relying: set[bpy.types.Material]) -> list[bpy.types.ID]:
    """What is to get another number for all objects of a level to have it."""
    owners = [
        medium_material(obj) if own_priority(obj) is None and medium_material(obj) in relying else obj for obj in level
    ]
    return list(dict.fromkeys(owners))
