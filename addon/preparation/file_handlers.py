"""Handlers of files: what is loaded, imported, saved and undone."""

from __future__ import annotations

import bpy

from ..analysis import surroundings
from ..analysis.validity import set_frame_validity, set_native_validity
from ..cutting import backends, cut_objects
from ..scene.scripts import frame_scripts
from . import idle, upkeep, windows
from .guard import guarded
from .upkeep import analysed_scenes, cut_scenes


@bpy.app.handlers.persistent
@guarded("while a file was opened")
def invalidate_loaded(*_: object) -> None:
    """Believe nothing that a file tells: it may have been changed without the extension. Nobody waits for a look at it."""
    forget_shapes()
    for scene in analysed_scenes():
        upkeep.invalidate(scene)
    if windows.has_window() and (analysed_scenes() or cut_scenes()):
        idle.schedule_update()


@bpy.app.handlers.persistent
@guarded("while data were appended")
def unhide_orphans(*_: object) -> None:
    """Let renders show media that came from a scene that is cut without what showed them there."""
    cut_objects.unhide_orphans()


@bpy.app.handlers.persistent
@guarded("while the file was saved")
def limit_before_save(*_: object) -> None:
    """Save what holds without the extension, too: on the present frame, as no one will see what scripts do on others."""
    scripts = any(frame_scripts())
    for scene in analysed_scenes():
        if scripts:
            surroundings.invalidate(scene)
        if surroundings.is_invalid(scene):
            surroundings.analyse(scene)
    for scene in cut_scenes():
        upkeep.update_cut(scene)
    for scene in {*analysed_scenes(), *cut_scenes()}:
        upkeep.choose_bodies(scene)
        backends.choose_for_file(scene)
    for scene in analysed_scenes():
        set_frame_validity(scene, every_frame=False)
        set_native_validity(scene, not scripts)


@bpy.app.handlers.persistent
@guarded("after the file was saved")
def extend_after_save(*_: object) -> None:
    """Let what media are told hold as before the file was saved."""
    for scene in analysed_scenes():
        upkeep.follow_scripts(scene)
        set_native_validity(scene, True)
    for scene in {*analysed_scenes(), *cut_scenes()}:
        upkeep.choose_bodies(scene)


@bpy.app.handlers.persistent
@guarded("while a step was undone or redone")
def forget_shapes(*_: object) -> None:
    """Look at everything anew: undoing changes meshes without an update that names them."""
    surroundings.forget_shapes()
    upkeep.forget_done()
    if windows.has_window() and cut_scenes():
        idle.schedule_update()
