"""What 3D viewports show of media that are cut: their surfaces where light is seen, else the artist's own objects.

A viewport that shows renders or previews of materials is to show what a render shows. So while there is one, viewports show
the cut surfaces, and no ray meets the artist's objects for which they stand: Cycles and EEVEE leave these out, while he goes on
selecting and editing them. Elsewhere cut surfaces are hidden.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import bpy

from ..scene import ray_visibility
from .baked_cut import is_baked
from .copied_settings import copy_settings
from .cut_collection import exchange_mesh, find_nodes_modifier, surfaces_of

LIT = ("MATERIAL", "RENDERED")
"""Kinds of shading of viewports that show materials."""


def lit_scenes(windows: Iterable[bpy.types.Window]) -> set[bpy.types.Scene]:
    """Return the scenes of which some viewport shows materials. Where an animation plays, to preview them is to be quick."""
    return {window.scene for window in windows for space in _viewports(window) if _is_lit(window, space)}


def _is_lit(window: bpy.types.Window, space: bpy.types.SpaceView3D) -> bool:
    """Return whether a viewport shows materials: rendered, or previewed while no animation plays."""
    kind = space.shading.type
    if kind == "RENDERED":
        return window.scene.render.engine != "BLENDER_WORKBENCH"
    return kind in LIT and not window.screen.is_animation_playing


def _viewports(window: bpy.types.Window) -> Iterator[bpy.types.SpaceView3D]:
    return (area.spaces.active for area in window.screen.areas if area.type == "VIEW_3D")


def show(scene: bpy.types.Scene, lit: bool, windows: Iterable[bpy.types.Window] = ()) -> None:
    """Let viewports show the cut surfaces of a scene where its artist's objects would be seen, or these objects.

    :param lit: some viewport shows materials; windows: those in which a viewport may show a few objects alone.
    """
    surfaces = surfaces_of(scene)
    lit = lit and all(map(ray_visibility.may_hide, surfaces))
    alone = [space for window in windows if window.scene == scene for space in _viewports(window) if space.local_view]
    for obj, surface in surfaces.items():
        (ray_visibility.hide if lit else ray_visibility.show)(obj)
        hidden = not lit or obj.hide_viewport
        if surface.hide_viewport != hidden:
            surface.hide_viewport = hidden
        for layer in scene.view_layers:
            hidden = lit and obj.hide_get(view_layer=layer)
            if surface.hide_get(view_layer=layer) != hidden:
                surface.hide_set(hidden, view_layer=layer)
        for space in alone if lit else ():
            if surface.local_view_get(space) != obj.local_view_get(space):
                surface.local_view_set(space, obj.local_view_get(space))
    if not lit:
        unfreeze(scene)


def is_edited(scene: bpy.types.Scene) -> bool:
    """Return whether a medium that is cut is in Edit Mode. Renders do not cut it; viewports go on as they are meanwhile."""
    return any(obj.mode == "EDIT" for obj in surfaces_of(scene))


def freeze(scene: bpy.types.Scene, layer: bpy.types.ViewLayer) -> None:
    """Freeze the surfaces of a scene: viewports go on showing them as they are, moving with their objects, and cut nothing."""
    if is_baked(scene):
        return
    for surface in surfaces_of(scene).values():
        evaluated = surface.evaluated_get(layer.depsgraph)
        modifier = find_nodes_modifier(surface)
        if surface.hide_viewport or modifier is None or not modifier.show_viewport or not evaluated.is_evaluated:
            continue
        mesh = bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=layer.depsgraph)
        exchange_mesh(surface, mesh)
        modifier.show_viewport = False


def unfreeze(scene: bpy.types.Scene) -> None:
    """Let viewports show surfaces of a scene as they are cut again."""
    for obj, surface in surfaces_of(scene).items():
        modifier = find_nodes_modifier(surface)
        if modifier is not None and not modifier.show_viewport:
            exchange_mesh(surface, bpy.data.meshes.new(surface.name))
            copy_settings(surface, obj)
            modifier.show_viewport = True
