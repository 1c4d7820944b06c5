"""What waits in a window until nobody works: analysing, cutting, and what viewports show."""

from __future__ import annotations

import bpy

from ..analysis.surroundings import is_invalid
from ..cutting import views
from . import windows
from .guard import guarded
from .upkeep import (
    analyse_scene,
    analysed_scenes,
    choose_bodies,
    cut_scenes,
    show_in_views,
    update_cut,
    writing_for_windows,
)

IDLE_SECONDS = 0.3
"""Time without a change after which a scene in a window is analysed."""

VIEW_SECONDS = 0.1
"""Time after a viewport is drawn until what it shows of cut surfaces is looked at: drawing may change nothing."""


def schedule_update() -> None:
    """Let changed scenes be analysed and cut when nothing has changed for a while."""
    if bpy.app.timers.is_registered(update_idle_scenes):
        bpy.app.timers.unregister(update_idle_scenes)
    bpy.app.timers.register(update_idle_scenes, first_interval=IDLE_SECONDS)


def is_update_scheduled() -> bool:
    """Return whether changed scenes wait to be analysed."""
    return bpy.app.timers.is_registered(update_idle_scenes)


@guarded("while changed scenes were analysed")
def update_idle_scenes() -> float | None:
    """Analyse and cut what has changed in windows, or return the seconds to wait before another call."""
    if windows.is_at_work():
        return IDLE_SECONDS
    with writing_for_windows():
        for scene in filter(is_invalid, analysed_scenes()):
            analyse_scene(scene)
        for scene in cut_scenes():
            if views.is_edited(scene):
                views.unfreeze(scene)
            else:
                update_cut(scene)
        for scene in {*analysed_scenes(), *cut_scenes()}:
            choose_bodies(scene)
    return None


@guarded("while a viewport was drawn", writes=False)
def schedule_views() -> None:
    """Let what viewports show be looked at soon after one is drawn."""
    if not bpy.app.timers.is_registered(update_views):
        bpy.app.timers.register(update_views, first_interval=VIEW_SECONDS)


@guarded("while viewports were looked at")
def update_views() -> float | None:
    """Let viewports show cut surfaces or the artist's objects, or return the seconds to wait before another call."""
    if windows.is_rendering():
        return IDLE_SECONDS
    with writing_for_windows():
        for scene in cut_scenes():
            show_in_views(scene)
    return None


def stop_timers() -> None:
    """Analyse nothing more that waits, and look at no viewport."""
    for timer in (update_idle_scenes, update_views):
        if bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)
