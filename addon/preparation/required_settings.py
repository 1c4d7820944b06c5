"""Render settings that media need, changed while they do and put back when they do not any more."""

from __future__ import annotations

import bpy

from ..analysis.surroundings import last_found
from ..cutting import needs
from ..cutting.cut_plan import make_plan
from ..nodes.compatibility import has_osl
from ..nodes.render_settings import achromatic_reason
from ..nodes.render_with import NATIVE, OSL, get_backend
from ..scene import settings
from ..scene.scripts import frame_scripts
from ..scene.settings import (
    DEVICE,
    MOTION_BLUR,
    OSL_SWITCH,
    RANDOM_TIME,
    ROLLING_SHUTTER,
    SHUTTER,
    SHUTTER_CURVE,
    Changed,
)


def ensure_osl(scene: bpy.types.Scene, changed: Changed) -> list[str]:
    """Let renders run Open Shading Language where media need it, and be as the artist has them where none does any more."""
    held = settings.held(scene, changed, (DEVICE, OSL_SWITCH))
    wanted = {path: held[path][0] if path in held else settings.read(scene, path) for path in (DEVICE, OSL_SWITCH)}
    why = _why_osl(scene, on_cpu=wanted[DEVICE] == "CPU", switched_on=wanted[OSL_SWITCH])
    if why is not None:
        wanted = {DEVICE: "CPU", OSL_SWITCH: True}
    changes = [each for path, value in wanted.items() for each in settings.change(scene, changed, path, value)]
    return [f"{each}, because {why}" if why else each for each in changes]


def _why_osl(scene: bpy.types.Scene, on_cpu: bool, switched_on: bool) -> str | None:
    """Return why media of a scene need Open Shading Language on the CPU, empty where the artist says so.

    None if they do not, or have it with these settings.
    """
    backend = get_backend(scene)
    if not has_osl() or backend == NATIVE:
        return None
    if backend == OSL:
        return ""
    if on_cpu and switched_on:
        return None
    _, cut = make_plan(scene, any(frame_scripts()), native=True)
    found_needs = needs.find_needs(scene, cut, last_found(scene))
    return next((str(need) for need in found_needs if on_cpu or need.is_hard), None)


def ensure_random_time(scene: bpy.types.Scene, changed: Changed) -> list[str]:
    """Make Cycles draw a time for every path, evenly. Motion blur that is in use stays as it is."""
    changes = []
    if not scene.render.use_motion_blur:
        changes += settings.change(scene, changed, SHUTTER, 0.0)
        changes += settings.change(scene, changed, MOTION_BLUR, True)
    if achromatic_reason(scene):
        changes += settings.change(scene, changed, ROLLING_SHUTTER, "NONE")
        points = len(settings.read(scene, SHUTTER_CURVE))
        changes += settings.change(scene, changed, SHUTTER_CURVE, [1.0] * points)
    return changes


def end_random_time(scene: bpy.types.Scene, changed: Changed) -> list[str]:
    """Let motion blur be what it was; switch off what blurs nothing, which only an older version's preparation leaves on."""
    changes = settings.go_back(scene, changed, RANDOM_TIME)
    if scene.render.use_motion_blur and scene.render.motion_blur_shutter == 0.0:
        default = scene.render.bl_rna.properties["motion_blur_shutter"].default
        changes += settings.change(scene, changed, MOTION_BLUR, False)
        changes += settings.change(scene, changed, SHUTTER, default)
    return changes
