"""Whether a render shows objects where the viewport does, with the same shape; and why it may not."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import bpy

from ..scene.media import is_cut_surface, is_rendered
from ..scene.ray_visibility import is_seen_by_all
from .extents import CONVERTED
from .material_facts import MaterialFacts
from .mesh_modifiers import is_deterministic, is_same_in_renders

VELOCITY = "velocity"
"""Attribute of points by which Cycles moves them while the shutter is open."""


class Unstable(Exception):
    """Why nothing may be told to anyone: an object may be anywhere, or fill space that it does not show."""


def may_change(obj: bpy.types.Object) -> str:
    """Return why an object may be elsewhere or have another shape in a render, or on another frame; empty if it stays."""
    try:
        require_stable(obj)
    except Unstable as instability:
        return str(instability)
    return ""


def require_stable(obj: bpy.types.Object) -> None:
    """Raise :class:`Unstable` if an object may be elsewhere, or without bounds, when the file is rendered."""
    if obj.mode == "EDIT":
        raise Unstable("is being edited")
    if is_rendered(obj) == obj.hide_viewport:
        raise Unstable("is hidden in the viewport alone, or in renders alone")
    if may_move(obj):
        raise Unstable("may move")
    if _is_animated(obj.data) or _is_animated(getattr(obj.data, "shape_keys", None)):
        raise Unstable("may change its shape")
    for other in shaping_objects(obj):
        hidden = obj.type == "META" and other.hide_render != other.hide_viewport
        if hidden or may_move(other) or _is_animated(other.data) or other.modifiers:
            raise Unstable(f"may change its shape with {other.name!r}")
    for modifier in obj.modifiers:
        if modifier.show_render and not modifier.show_viewport:
            raise Unstable(f"has the modifier {modifier.name!r} in renders alone")
        if modifier.show_render and not is_deterministic(modifier):
            raise Unstable(f"has the modifier {modifier.name!r}, which may move it")


def may_move(obj: bpy.types.Object) -> bool:
    """Return whether anything but an object's own numbers, or those of its parents, may place it."""
    while obj is not None:
        if (
            _is_animated(obj)
            or (obj.parent is not None and _is_animated(obj.parent.data))
            or obj.constraints
            or obj.rigid_body is not None
            or (obj.parent is not None and obj.parent_type != "OBJECT")
            or obj.instance_type not in ("NONE", "COLLECTION")
            or obj.particle_systems
        ):
            return True
        obj = obj.parent
    return False


def has_velocity(evaluated: bpy.types.Object) -> bool:
    """Return whether motion blur moves the points of an object by an attribute, as caches of simulations bring it."""
    return VELOCITY in getattr(evaluated.data, "attributes", ())


def _is_animated(data: bpy.types.ID | None) -> bool:
    """Return whether keyframes or drivers may change some data."""
    return data is not None and data.animation_data is not None


def shaping_objects(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """Return the other objects that a curve, a text or a metaball takes its shape from."""
    if obj.type == "META":
        return [other for other in bpy.data.objects if other != obj and is_relative(other, obj)]
    paths = ("bevel_object", "taper_object", "follow_curve")
    return [other for path in paths if (other := getattr(obj.data, path, None)) is not None]


def is_relative(obj: bpy.types.Object, other: bpy.types.Object) -> bool:
    """Return whether two are metaballs of one family, which merge into one object: their names differ in a number at most."""
    return obj.type == other.type == "META" and _family(obj) == _family(other)


def _family(obj: bpy.types.Object) -> str:
    """Return the name of a metaball without its number."""
    stem, _, number = obj.name.rpartition(".")
    return stem if stem and number.isdigit() else obj.name


def is_exact(scene: bpy.types.Scene, obj: bpy.types.Object) -> bool:
    """Return whether a render shows the very mesh that the viewport does, to all rays."""
    return (
        not scene.render.use_simplify
        and is_seen_by_all(obj)
        and all(map(is_same_in_renders, obj.modifiers))
        and (obj.type not in CONVERTED or _is_as_fine_in_renders(obj))
    )


def _is_as_fine_in_renders(obj: bpy.types.Object) -> bool:
    """Return whether a render divides a curve as the viewport does."""
    data = obj.data
    return not shaping_objects(obj) and all(
        getattr(data, f"render_{resolution}", 0) in (0, getattr(data, resolution, 0))
        for resolution in ("resolution_u", "resolution_v", "resolution")
    )


def instancing_instability(instancer: bpy.types.Object | None = None) -> str:
    """Return why an object's instances may be elsewhere in a render, or with None those of all objects; empty if not."""
    instancers = {instancer}
    if instancer is None:
        if any(collection.hide_render != collection.hide_viewport for collection in bpy.data.collections):
            return "is instanced where a collection is hidden in the viewport alone, or in renders alone"
        instancers = {obj for obj in bpy.data.objects if obj.instance_collection is not None}
    try:
        for obj in instancers:
            require_stable(obj)
            if obj.type != "EMPTY":
                raise Unstable(f"is instanced by {obj.name!r}, which may do so in another way in a render")
    except Unstable as instability:
        return str(instability)
    return ""


def scene_instabilities(
    scene: bpy.types.Scene, facts: dict[bpy.types.Material, MaterialFacts]
) -> Iterator[tuple[str, str]]:
    """Yield what makes a render see other objects than the viewport does: names and reasons."""

    def shown(objects: Iterable[bpy.types.Object]) -> set[bpy.types.Object]:
        return {
            obj
            for obj in objects
            if not is_cut_surface(obj) and any(slot.material in facts for slot in obj.material_slots)
        }

    for collection in scene.collection.children_recursive:
        if collection.hide_viewport != collection.hide_render and shown(collection.all_objects):
            yield collection.name, "is hidden in the viewport alone, or in renders alone"
    first, *others = scene.view_layers
    for layer in others:
        if shown(first.objects) != shown(layer.objects):
            yield layer.name, f"shows other media than {first.name!r}"
