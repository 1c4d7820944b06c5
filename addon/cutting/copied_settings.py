"""Settings by which renders treat an object beside its shape, copied from a medium to the object that shows its surface."""

from __future__ import annotations

import bpy

from ..nodes.animation import curves
from ..nodes.stored import plain
from ..scene import ray_visibility
from ..scene.media import CUT_OF, HIDDEN_BY_CUT
from .drivers import drive_by

COPIED = (
    *ray_visibility.SETTINGS,
    "is_holdout",
    "is_shadow_catcher",
    "pass_index",
    "color",
    "lightgroup",
    "shadow_terminator_normal_offset",
    "shadow_terminator_geometry_offset",
    "shadow_terminator_shading_offset",
)
"""Properties of the object."""

COPIED_OF_CYCLES = (
    "use_motion_blur",
    "motion_steps",
    "use_camera_cull",
    "use_distance_cull",
    "ao_distance",
    "is_caustics_caster",
    "is_caustics_receiver",
)
"""Properties of Cycles' part of the object."""

SUFFIX = " (cut)"
"""What follows a medium's name in that of the object that shows its surface."""


def copy_settings(surface: bpy.types.Object, obj: bpy.types.Object) -> None:
    """Make a render treat a medium's surface as the medium itself; write only what differs."""
    _copy_render_settings(surface, obj)
    if not surface.name.startswith(obj.name + SUFFIX):
        surface.name = obj.name + SUFFIX
    _copy_slots(surface, obj)
    _copy_custom_properties(surface, obj)
    for path in {curve.data_path for curve in curves(obj.animation_data)}:
        if path in COPIED or path.startswith('["'):
            _drive_copy(surface, obj, path)
    for linking in ("receiver_collection", "blocker_collection"):
        if getattr(surface.light_linking, linking) != getattr(obj.light_linking, linking):
            setattr(surface.light_linking, linking, getattr(obj.light_linking, linking))


def _copy_render_settings(surface: bpy.types.Object, obj: bpy.types.Object) -> None:
    """Copy properties of the object and of Cycles; rays that the artist lets meet the medium meet its surface."""
    for owner, source, names in ((surface, obj, COPIED), (surface.cycles, obj.cycles, COPIED_OF_CYCLES)):
        for name in names:
            if name not in owner.bl_rna.properties:
                continue
            value = ray_visibility.is_seen(obj, name) if name in ray_visibility.SETTINGS else getattr(source, name)
            before = getattr(owner, name)
            if value != before and (isinstance(value, (bool, int, float, str)) or tuple(value) != tuple(before)):
                setattr(owner, name, value)


def _copy_slots(surface: bpy.types.Object, obj: bpy.types.Object) -> None:
    """Copy the materials of an object's slots and what they are linked to, the object or its mesh."""
    while len(surface.data.materials) < len(obj.material_slots):
        surface.data.materials.append(None)
    for own, slot in zip(surface.material_slots, obj.material_slots):
        if own.link != slot.link or own.material != slot.material:
            own.link = slot.link
            own.material = slot.material


def _copy_custom_properties(surface: bpy.types.Object, obj: bpy.types.Object) -> None:
    """Copy custom properties, which materials may read, but those by which the extension tells the two apart."""
    own = {key: plain(value) for key, value in obj.items() if key != HIDDEN_BY_CUT}
    for key in surface.keys() - own.keys() - {CUT_OF}:
        del surface[key]
    for key, value in own.items():
        if key not in surface or plain(surface[key]) != value:
            surface[key] = value


def _drive_copy(surface: bpy.types.Object, obj: bpy.types.Object, path: str) -> None:
    """Drive a property of the surface by the medium's, unless it is driven already."""
    if not any(curve.data_path == path for curve in curves(surface.animation_data)):
        drive_by(surface, path, obj, path)


def copy_light_linking(surfaces: dict[bpy.types.Object, bpy.types.Object]) -> None:
    """Put the surfaces of media into the collections by which lights single these out."""
    for collection in _linking_collections():
        members = set(collection.objects)
        for obj in members & surfaces.keys():
            if surfaces[obj] not in members:
                collection.objects.link(surfaces[obj])
            states = dict(zip(collection.objects, collection.collection_objects))
            states[surfaces[obj]].light_linking.link_state = states[obj].light_linking.link_state


def _linking_collections() -> set[bpy.types.Collection]:
    """Return all collections by which some light lights objects or is blocked by them, with their children."""
    roots = {
        collection
        for each in bpy.data.objects
        for collection in (each.light_linking.receiver_collection, each.light_linking.blocker_collection)
        if collection is not None
    }
    return {each for root in roots for each in (root, *root.children_recursive)}
