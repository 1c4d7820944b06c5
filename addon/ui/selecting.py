"""Selecting objects and bringing them into view, and why that cannot be done."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ..analysis.mesh_modifiers import keeps_mesh


def select_only(layer: bpy.types.ViewLayer, objects: Sequence[bpy.types.Object]) -> list[str]:
    """Make those of some objects that are visible the only selected ones, the first of them active.

    If none is visible, the selection stays.

    :return: why the others are not selected, in sentences.
    """
    chosen = [obj for obj in objects if not unreachable(layer, obj)]
    if chosen:
        for other in layer.objects.selected:
            other.select_set(False, view_layer=layer)
        for obj in chosen:
            obj.select_set(True, view_layer=layer)
        layer.objects.active = chosen[0]
    return [f"{obj.name!r} {reason}" for obj in objects if (reason := unreachable(layer, obj))]


def select_faces(context: bpy.types.Context, obj: bpy.types.Object, faces: Sequence[int]) -> bool:
    """Make some polygons of an object's evaluated mesh the only selected ones, as Edit Mode will show them, by faces.

    Return whether they are: modifiers must leave the mesh as it is, and it must be the file's own.
    """
    mesh = obj.data
    if obj.type != "MESH" or not mesh.is_editable or not all(map(keeps_mesh, obj.modifiers)):
        return False
    chosen = np.zeros(len(mesh.polygons), dtype=bool)
    chosen[[index for index in faces if index < len(chosen)]] = True
    if not chosen.any():
        return False
    polygons = [mesh.polygons[index] for index in np.flatnonzero(chosen)]
    loops = [index for polygon in polygons for index in polygon.loop_indices]
    points, edges = np.zeros(len(mesh.vertices), dtype=bool), np.zeros(len(mesh.edges), dtype=bool)
    points[[mesh.loops[index].vertex_index for index in loops]] = True
    edges[[mesh.loops[index].edge_index for index in loops]] = True
    for items, values in ((mesh.polygons, chosen), (mesh.edges, edges), (mesh.vertices, points)):
        items.foreach_set("select", values)
    context.tool_settings.mesh_select_mode = (False, False, True)
    mesh.update_tag()
    return True


def unreachable(layer: bpy.types.ViewLayer, obj: bpy.types.Object) -> str:
    """Return why an object cannot be selected, after its name; empty if it can."""
    if layer.objects.get(obj.name) != obj:
        return f"is not in view layer {layer.name!r}; include its collection (Outliner > View Layer)"
    if not obj.visible_get(view_layer=layer):
        return "is hidden in the viewport; show it (Outliner, or Object > Show/Hide)"
    if obj.hide_select:
        return "may not be selected; allow it (Outliner > Selectable)"
    return ""


def instancers(scene: bpy.types.Scene, obj: bpy.types.Object) -> list[bpy.types.Object]:
    """Return the objects of a scene whose instanced collections bring an object in."""
    return [
        each
        for each in scene.objects
        if each.instance_collection is not None and obj.name in each.instance_collection.all_objects
    ]


def frame_selected(context: bpy.types.Context) -> None:
    """Bring what is selected into view: in the 3D view that was clicked in, else in all of the window."""
    areas = [context.area] if context.area is not None and context.area.type == "VIEW_3D" else context.screen.areas
    for area in (area for area in areas if area.type == "VIEW_3D"):
        region = next(region for region in area.regions if region.type == "WINDOW")
        with context.temp_override(area=area, region=region):
            if bpy.ops.view3d.view_selected.poll():
                bpy.ops.view3d.view_selected()
