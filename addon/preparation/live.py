"""Keeping what media are told true while a session lasts: after updates, on every frame, before renders and saving.

The handlers are put in by :func:`analyse`, too, so that a script that never registers the extension renders what is there.
"""

from __future__ import annotations

from collections.abc import Callable

import bpy

from ..analysis.findings import Found
from ..cutting import baked_cut, cut_plan, cut_scene, views
from . import file_handlers, idle, render_handlers, update_handlers, upkeep, windows

_drawing: object | None = None
"""What Blender calls when it draws a viewport."""


def analyse(scene: bpy.types.Scene) -> Found:
    """Look at the media of a scene, and tell each what surrounds it; return what was found.

    The scene's media are kept analysed from then on, in this session by handlers of frames, updates and renders. Linked
    materials and objects are left as they are: they ask the scene.
    """
    install()
    return upkeep.analyse_scene(scene)


def update_cut(scene: bpy.types.Scene) -> cut_plan.CutReport:
    """Bring what renders show of a scene up to date if its surfaces are cut; return what was found.

    The scene is kept so from then on, as by :func:`analyse`.
    """
    if cut_scene.is_cut(scene):
        install()
    return upkeep.update_cut(scene)


def bake_cut(scene: bpy.types.Scene) -> str:
    """Keep the cut of the present frame in the file; return why that cannot be, or nothing."""
    update_cut(scene)
    return baked_cut.bake_frame(scene, cut_scene.last_plan(scene))


def install() -> None:
    """Put the handlers in; a second call changes nothing."""
    global _drawing
    for handlers, handler in _handlers():
        if handler not in handlers:
            handlers.append(handler)
    if _drawing is None and windows.has_window():
        _drawing = bpy.types.SpaceView3D.draw_handler_add(idle.schedule_views, (), "WINDOW", "POST_PIXEL")


def remove() -> None:
    """Take the handlers and the timers out; viewports show the artist's own objects again."""
    global _drawing
    for handlers, handler in _handlers():
        while handler in handlers:
            handlers.remove(handler)
    upkeep.forget_done()
    idle.stop_timers()
    if _drawing is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_drawing, "WINDOW")
        _drawing = None
    for scene in upkeep.cut_scenes():
        views.show(scene, False)


def _handlers() -> tuple[tuple[list, Callable], ...]:
    """Return Blender's lists of handlers, and the handlers that stand in them."""
    handlers = bpy.app.handlers
    return (
        (handlers.render_init, render_handlers.analyse_before_render),
        (handlers.render_pre, render_handlers.move_frame_handler_last),
        (handlers.frame_change_post, update_handlers.analyse_after_frame_change),
        (handlers.depsgraph_update_pre, update_handlers.freeze_cut_before_update),
        (handlers.depsgraph_update_post, update_handlers.analyse_after_update),
        (handlers.load_post, file_handlers.invalidate_loaded),
        (handlers.blend_import_post, file_handlers.unhide_orphans),
        (handlers.save_pre, file_handlers.limit_before_save),
        (handlers.save_post, file_handlers.extend_after_save),
        (handlers.undo_post, file_handlers.forget_shapes),
        (handlers.redo_post, file_handlers.forget_shapes),
    )
