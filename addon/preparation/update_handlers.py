"""Handlers of updates and frames: following what moves, changes, comes and goes.

In a window nothing is to wait while the mouse drags: media ask then, until :mod:`idle` analyses them.
"""

from __future__ import annotations

import bpy

from ..analysis import changes, surroundings
from ..analysis.validity import is_analysed
from ..cutting import cut_scene, views
from ..scene.scripts import frame_scripts
from . import idle, upkeep, windows
from .guard import guarded


@bpy.app.handlers.persistent
@guarded("on a new frame")
def analyse_after_frame_change(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph | None = None) -> None:
    """Follow what scripts change on a frame, of which no update tells.

    Between frames, where only motion blur looks, nothing may be told anew. The scene is looked at as the viewport evaluates
    it: to update the render's own evaluation here would hide from Cycles what has changed.
    """
    if depsgraph is not None and depsgraph.mode == "VIEWPORT":
        changes.count(depsgraph)
    if not is_analysed(scene) or scene.frame_subframe != 0.0 or not windows.in_main_thread():
        return
    if not any(frame_scripts()):
        return
    if windows.has_window():
        upkeep.invalidate(scene)
        idle.schedule_update()
        return
    upkeep.analyse_scene(scene)
    upkeep.choose_bodies(scene)


@bpy.app.handlers.persistent
@guarded("before a change")
def freeze_cut_before_update(scene: bpy.types.Scene, *_: object) -> None:
    """Cut nothing anew for viewports while changes follow on each other, as the mouse drags: to cut may take seconds."""
    if (
        not upkeep.follows_updates()
        or not windows.has_window()
        or not windows.in_main_thread()
        or windows.is_playing()
        or not cut_scene.is_cut(scene)
    ):
        return
    if not windows.is_shaping() and not idle.is_update_scheduled():
        return
    for window in bpy.context.window_manager.windows:
        if window.scene == scene:
            views.freeze(scene, window.view_layer)


@bpy.app.handlers.persistent
@guarded("after a change")
def analyse_after_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Analyse what has changed at once, or in a window let media ask until nobody works."""
    changes.count(depsgraph)
    if windows.has_window() and cut_scene.may_change_cut(scene, depsgraph):
        idle.schedule_update()
    if not is_analysed(scene):
        return
    upkeep.mend_nodes_of({update.id.original for update in depsgraph.updates})
    if not upkeep.follows_updates():
        return
    if not windows.has_window():
        surroundings.update(scene, depsgraph)
    elif upkeep.update_or_invalidate(scene, depsgraph):
        idle.schedule_update()
    upkeep.follow_scripts(scene)
