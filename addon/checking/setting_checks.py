"""Checks of a scene's render settings, and of what renders its media."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ..analysis.surroundings import findings_of
from ..cutting import needs
from ..cutting.cut_plan import CutReport, make_plan
from ..cutting.cut_scene import last_cut
from ..nodes.compatibility import blender_problem, has_osl
from ..nodes.render_settings import achromatic_fault, settings_fault
from ..nodes.render_with import is_native
from ..scene.media import dispersing_materials
from ..scene.scripts import frame_scripts
from ..scene.settings import DEVICE, ENGINE, OSL_SWITCH
from .finding import Action, Finding, Fix
from .inspection import Inspection
from .kinds import MUST_ASK, NATIVE_LIMIT, NO_COLOURS, SETTINGS


def setting_findings(inspection: Inspection) -> Iterator[Finding]:
    """Yield settings of a scene with media that would not show them as they are."""
    scene = inspection.scene
    if not inspection.objects:
        return
    unsuitable = blender_problem()
    if unsuitable:
        reason, _, remedy = unsuitable.partition("; ")
        yield Finding(SETTINGS, scene.name, f"cannot be rendered here: {reason}", remedy)
    elif fault := settings_fault(scene):
        yield Finding(SETTINGS, scene.name, *fault, fix=_switch(scene))
    elif dispersing_materials(scene) and (fault := achromatic_fault(scene)):
        yield Finding(NO_COLOURS, scene.name, *fault, fix=Fix(Action.PREPARE, (scene.name,)))


def _switch(scene: bpy.types.Scene) -> Fix | None:
    """Return the one switch that lets a scene show its media; None if there is none here."""
    if scene.render.engine != "CYCLES":
        return Fix(Action.SET_SETTING, (scene.name,), "CYCLES", ENGINE)
    if not has_osl():
        return None
    if not scene.cycles.shading_system:
        return Fix(Action.SET_SETTING, (scene.name,), True, OSL_SWITCH)
    return Fix(Action.SET_SETTING, (scene.name,), "CPU", DEVICE)


def backend_findings(inspection: Inspection) -> Iterator[Finding]:
    """Yield what Cycles' own nodes, where they render all of a scene, do not render as the shader would."""
    scene = inspection.scene
    if not is_native(scene) or not inspection.objects:
        return
    cut = last_cut(scene)
    if cut is None:
        cut = make_plan(scene, any(frame_scripts()), native=True)[1]
    for need, remedy in needs.shortcomings(scene, cut or CutReport(), findings_of(inspection.snapshot)):
        yield Finding(MUST_ASK if need.is_hard else NATIVE_LIMIT, need.name, need.reason, remedy)
