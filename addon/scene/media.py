"""Media in a scene: giving objects a material and a priority, and listing who wins over whom.

A material's priority is the default; an object's own custom property overrides it.
"""

from __future__ import annotations

from collections.abc import Iterable
from ctypes import c_float
from typing import Any

import bpy

from ..model.parameter import GROUP_NAME, MAX_PRIORITY, PRIORITY_PROPERTY, ParameterError
from ..model.parameters import BY_KEYWORD
from ..nodes.lookups import cached_by_nodes, caching_nodes
from ..nodes.mending import repair_nodes
from .materials import dielectric_node, dielectrics, may_disperse, medium_material
from .preset_materials import preset_material

SOLID_TYPES = frozenset(("MESH", "CURVE", "SURFACE", "FONT", "META"))
"""Types of objects whose surface may enclose something."""

CUT_OF = "nd_cut_of"
"""Custom property of an object that shows another's surface in renders, cut where media cross: that other one."""

CUT_SETTING = "nd_cut_surfaces"
"""Custom property of a scene: whether its surfaces are to be cut."""

HIDDEN_BY_CUT = "nd_cut"
"""Custom property of a medium that is hidden from renders because such an object shows it."""

NO_SOLIDS = {
    "POINTCLOUD": (
        "a point cloud",
        "instance a closed ball on its points instead (Geometry Nodes: Instance on Points)",
    ),
    "CURVES": (
        "hair curves",
        "turn it into a closed mesh (Geometry Nodes: Curve to Mesh with a profile and Fill Caps; Object > Convert > Mesh)",
    ),
    "VOLUME": ("a volume", "turn it into a mesh (the modifier Volume to Mesh of an empty mesh object)"),
    "GREASEPENCIL": (
        "grease pencil",
        "turn it into a curve (Object > Convert > Curve) with a Bevel Depth and Fill Caps",
    ),
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
        repair_nodes(material)
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
    """Return ``priority`` as a whole number from 0 to 1000.

    :raises ParameterError: if it is none.
    """
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
    """Return the priority in a custom property's value, or None, as is_priority() in osl/medium.h does.

    Cycles gives the shader four numbers in single precision.
    """
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
    """Return the priority that an object renders with.

    :raises ParameterError: if it is no medium.
    """
    material = medium_material(obj)
    if material is None:
        raise ParameterError(f"{obj.name!r} has no nested dielectric material; give it one with assign()")
    own = own_priority(obj)
    return material_priority(material) if own is None else own


@cached_by_nodes
def material_priority(material: bpy.types.Material) -> int:
    """Return the priority that a nested dielectric gives objects without their own."""
    return BY_KEYWORD["priority"].bounded(dielectric_node(material).inputs["Priority"].default_value)


def is_cut_surface(obj: bpy.types.Object) -> bool:
    """Return whether an object only shows another's surface in renders."""
    return CUT_OF in obj


def is_rendered(obj: bpy.types.Object) -> bool:
    """Return whether an artist lets renders show an object."""
    return not obj.hide_render or HIDDEN_BY_CUT in obj


def all_objects(scene: bpy.types.Scene) -> set[bpy.types.Object]:
    """Return the artist's objects of a scene and those in instanced collections."""
    objects = {obj for obj in scene.objects if not is_cut_surface(obj)}
    pending = [obj.instance_collection for obj in objects if obj.instance_collection is not None]
    seen = set()
    while pending:
        collection = pending.pop()
        if collection in seen:
            continue
        seen.add(collection)
        for obj in collection.all_objects:
            if is_cut_surface(obj):
                continue
            objects.add(obj)
            if obj.instance_collection is not None:
                pending.append(obj.instance_collection)
    return objects


@caching_nodes()
def media(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """Return every object of a scene that is a medium, those in instanced collections too, in winning order."""
    return winning_order(all_objects(scene))


@caching_nodes()
def dispersing_materials(scene: bpy.types.Scene) -> list[bpy.types.Material]:
    """Return the nested dielectrics of a scene that split light into colours, or are animated to."""
    found = {material for obj in media(scene) for _, material in dielectrics(obj)}
    return sorted(filter(may_disperse, found), key=lambda material: material.name_full)


@caching_nodes()
def winning_order(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Object]:
    """Return the media among ``objects``, the one that wins over all others first."""
    found = [obj for obj in objects if medium_material(obj) is not None]
    return sorted(found, key=lambda obj: (get_priority(obj), obj.name))
