"""Rendering media as surfaces that are cut where they cross, while the artist's own objects stay as they are.

Beside each medium that may cross others stands an object that shows its surface as far as it exists
(:mod:`nested_dielectric.nodes.cutting`). It reads the artist's object, which is hidden from renders only, and is
evaluated with the scene: what moves, deforms or is exchanged is cut as it is then. All of these objects live in one collection.

Media that cannot be cut, and all that they may meet, are rendered as ever: they ask the scene.
"""

from __future__ import annotations

from collections.abc import Container

import bpy

from ..model.contract import CUT
from ..nodes.cutting.names import BODY_INPUT, CUT_INPUT, END_INPUT, OWN_INPUT
from ..nodes.cutting.plan import Plan
from ..nodes.cutting.surfaces import PART, ensure_part_tree, ensure_surface_tree
from ..nodes.wholeness import is_whole
from ..scene import ray_visibility
from ..scene.media import CUT_OF, HIDDEN_BY_CUT
from .copied_settings import SUFFIX, copy_light_linking, copy_settings
from .cut_collection import (
    CUTTER,
    ensure_collection,
    ensure_nodes_modifier,
    find_collection,
    move_out_others,
    remove_object,
    remove_unused_tree,
    surfaces_of,
)
from .cutter import ensure_cutter_nodes, ensure_cutters, set_inputs, told_by_faces


def show_plan(scene: bpy.types.Scene, plan: Plan) -> None:
    """Let renders of a scene show what a plan cuts in place of the artist's objects."""
    if not plan.layers:
        remove_cut_objects(scene)
        return
    tells = told_by_faces(plan)
    if scene.get(CUT) != tells:
        scene[CUT] = tells
        scene.update_tag()
    numbers = plan.numbers()
    collection = ensure_collection(scene)
    move_out_others(scene, collection)
    surfaces = _take_surfaces(collection, numbers)
    for obj in scene.objects:
        if HIDDEN_BY_CUT in obj and obj not in numbers:
            _unhide(obj)
    cutter, *parts = ensure_cutters(collection, len(numbers))
    ensure_cutter_nodes(cutter, plan)
    for place, part in enumerate(parts):
        modifier = ensure_nodes_modifier(part)
        before, modifier.node_group = modifier.node_group, ensure_part_tree()
        remove_unused_tree(before)
        set_inputs(modifier, {CUT_INPUT: cutter, BODY_INPUT: place * PART, END_INPUT: (place + 1) * PART})
    tree = ensure_surface_tree()
    for obj, number in numbers.items():
        if obj not in surfaces:
            surfaces[obj] = _new_surface(obj, collection)
        surface = surfaces[obj]
        modifier = ensure_nodes_modifier(surface)
        if not is_whole(modifier.node_group):
            before, modifier.node_group = modifier.node_group, tree
            remove_unused_tree(before)
        source = parts[number // PART] if parts else cutter
        set_inputs(modifier, {OWN_INPUT: obj, CUT_INPUT: source, BODY_INPUT: number})
        copy_settings(surface, obj)
        if HIDDEN_BY_CUT not in obj:
            obj[HIDDEN_BY_CUT] = True
        if not obj.hide_render:
            obj.hide_render = True
    copy_light_linking(surfaces)


def _take_surfaces(
    collection: bpy.types.Collection, media: Container[bpy.types.Object]
) -> dict[bpy.types.Object, bpy.types.Object]:
    """Return one surface of each of some media that a collection has, by the media, and remove all other surfaces."""
    surfaces = {}
    for obj in list(collection.objects):
        source = obj.get(CUT_OF)
        if source in media and source not in surfaces:
            surfaces[source] = obj
        elif source != CUTTER:
            remove_object(obj)
    return surfaces


def _new_surface(obj: bpy.types.Object, collection: bpy.types.Collection) -> bpy.types.Object:
    """Return a new object that is to show a medium's surface, where the medium is."""
    name = obj.name + SUFFIX
    surface = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    surface[CUT_OF] = obj
    surface.parent = obj
    surface.hide_viewport = surface.hide_select = True
    for slot in obj.material_slots:
        surface.data.materials.append(slot.material)
    collection.objects.link(surface)
    return surface


def remove_cut_objects(scene: bpy.types.Scene) -> None:
    """Remove what renders of a scene show in place of media, and let them show the media again."""
    if CUT in scene:
        del scene[CUT]
        scene.update_tag()
    collection = find_collection(scene)
    if collection is not None:
        move_out_others(scene, collection)
        for obj in list(collection.objects):
            remove_object(obj)
        bpy.data.collections.remove(collection)
    for obj in scene.objects:
        _unhide(obj)


def _unhide(obj: bpy.types.Object) -> None:
    """Let renders and rays meet an object again if it was hidden in favour of its surface."""
    if HIDDEN_BY_CUT in obj:
        ray_visibility.show(obj)
        del obj[HIDDEN_BY_CUT]
        obj.hide_render = False


def unhide_orphans() -> None:
    """Let renders show media that are hidden in favour of surfaces that are not there."""
    shown = {obj for scene in bpy.data.scenes for obj in surfaces_of(scene)}
    for obj in bpy.data.objects:
        if obj not in shown:
            _unhide(obj)
