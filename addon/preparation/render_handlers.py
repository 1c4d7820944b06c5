"""Handlers of renders: media know what surrounds them, and surfaces are cut, as of the frame that is rendered."""

from __future__ import annotations

import bpy

from ..analysis.validity import is_analysed
from ..cutting import cut_scene
from ..nodes.identity import NO_SCENE, known_number
from ..nodes.script_mending import mend_scripts
from ..scene.lights import update_lights
from . import upkeep, windows
from .guard import guarded
from .update_handlers import analyse_after_frame_change


@bpy.app.handlers.persistent
@guarded("before a render")
def analyse_before_render(scene: bpy.types.Scene, *_: object) -> None:
    """Make sure that the media know what surrounds them now, and the lights that their lobes carry.

    In a window updates have been followed.
    """
    numbered, analysed, cut = known_number(scene) != NO_SCENE, is_analysed(scene), cut_scene.is_cut(scene)
    if not windows.in_main_thread():
        return
    mend_scripts()
    if not (numbered or analysed or cut):
        return
    with upkeep.writing(scene, looks=True) as done:
        if numbered:
            update_lights(scene)
        if analysed and upkeep.ANALYSIS not in done:
            upkeep.analyse_within(scene, done)
        if cut and upkeep.CUTTING not in done:
            upkeep.update_cut_within(scene, done)
        if upkeep.BODIES not in done:
            upkeep.choose_bodies_within(scene, done)


@bpy.app.handlers.persistent
@guarded("before a render")
def move_frame_handler_last(*_: object) -> None:
    """Let the handler of frames see each after all scripts have changed it."""
    handlers = bpy.app.handlers.frame_change_post
    if handlers[-1:] != [analyse_after_frame_change] and windows.in_main_thread():
        handlers.remove(analyse_after_frame_change)
        handlers.append(analyse_after_frame_change)
