"""What 3D viewports show of media that are cut: their surfaces where light is seen, else the artist's own objects.

A viewport that shows renders or previews of materials is to show what a render shows. So while there is one, viewports show
the cut surfaces, and no ray meets the artist's objects for which they stand: Cycles and EEVEE leave these out, while he goes on
selecting and editing them. Elsewhere cut surfaces are hidden.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import bpy

from ..scene import rays
from . import cutting

LIT = ("MATERIAL", "RENDERED")
"""Kinds of shading of viewports that show materials."""


def lit_scenes(windows: Iterable[bpy.types.Window]) -> set[bpy.types.Scene]:
    """Return the scenes of which some viewport shows materials. Where an animation plays, to preview them is to be quick."""
    return {window.scene for window in windows for space in _viewports(window) if _is_lit(window, space)}


def _is_lit(window: bpy.types.Window, space: bpy.types.SpaceView3D) -> bool:
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
    surfaces = cutting.surfaces_of(scene)
    lit = lit and all(map(rays.may_hide, surfaces))
    alone = [space for window in windows if window.scene == scene for space in _viewports(window) if space.local_view]
    for obj, surface in surfaces.items():
        (rays.hide if lit else rays.show)(obj)
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
        let_go(scene)


def is_edited(scene: bpy.types.Scene) -> bool:
    """Whether a medium that is cut is in Edit Mode. A render would not cut it; viewports go on as they are meanwhile."""
    return any(obj.mode == "EDIT" for obj in cutting.surfaces_of(scene))


def hold(scene: bpy.types.Scene, layer: bpy.types.ViewLayer) -> None:
    """Let viewports go on showing cut surfaces as they are, which move with their objects, and cut nothing anew."""
    if cutting.is_kept(scene):
        return
    for surface in cutting.surfaces_of(scene).values():
        evaluated = surface.evaluated_get(layer.depsgraph)
        if surface.hide_viewport or not surface.modifiers[0].show_viewport or not evaluated.is_evaluated:
            continue
        mesh = bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=layer.depsgraph)
        cutting.exchange_mesh(surface, mesh)
        surface.modifiers[0].show_viewport = False


def let_go(scene: bpy.types.Scene) -> None:
    """Cut for viewports again."""
    for obj, surface in cutting.surfaces_of(scene).items():
        if not surface.modifiers[0].show_viewport:
            cutting.exchange_mesh(surface, bpy.data.meshes.new(surface.name))
            cutting.liken(surface, obj)
            surface.modifiers[0].show_viewport = True
