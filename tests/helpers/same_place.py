"""Media with faces in exactly the same place."""

import bpy  # before bmesh, which lives inside it
from scenes import add, add_box

import nested_dielectric as nd


def block(name: str, low, high, priority: int) -> bpy.types.Object:
    return add_box(name, low, high, nd.new_material(name, ior=1.2 + 0.1 * priority), priority)


def duplicate(obj: bpy.types.Object, location=(0.0, 0.0, 0.0), priority: int | None = None) -> bpy.types.Object:
    """As Alt+D: with the same mesh."""
    copy = add(f"{obj.name} again", obj.data, location)
    if priority is not None:
        nd.set_priority(copy, priority)
    return copy
