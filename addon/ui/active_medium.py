"""The medium that operators and panels act on."""

from __future__ import annotations

import bpy

from ..scene.materials import dielectric_node, medium_material


def active_medium(context: bpy.types.Context) -> bpy.types.Material | None:
    """Return the nested dielectric that the Material properties show, or else that of the active object; None without one."""
    shown = getattr(context, "material", None)
    if dielectric_node(shown) is not None:
        return shown
    return None if context.object is None else medium_material(context.object)


def has_editable_medium(cls: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    """Return whether the active object is a medium whose material may change; if not, the operator says why."""
    material = active_medium(context)
    if material is None:
        cls.poll_message_set("The active object is no medium; assign a preset to it first")
    elif not material.is_editable:
        cls.poll_message_set(f"Material {material.name!r} belongs to a library; make it local first")
    return material is not None and material.is_editable
