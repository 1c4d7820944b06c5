"""Making a scene ready to render nested dielectrics."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

import bpy

from .analysis import Found, last_found
from .checks import Problem, find_problems
from .compatibility import achromatic_reason, require_blender
from .lights import update_lights
from .live import analyse
from .materials import refresh_spectrum
from .media import dispersing_materials, media
from .parameters import ParameterError
from .parting import part_coincident
from .trees import complete_nodes, mend_nodes
from .versions import mend_materials, version_problems

AT_LEAST = {
    "max_bounces": 64,
    "transmission_bounces": 64,
    "glossy_bounces": 64,
    "transparent_max_bounces": 256,
}
"""Limits a path through nested media needs: an invalid surface costs a transparent bounce, an interface a transmission
or glossy one. In a white world the glass of iced water loses 4.7 % of its light at Blender's 12 bounces, 0.3 % at 64
and 0.08 % at 256.
"""


@dataclass(frozen=True)
class Preparation:
    """What :func:`prepare` changed, in sentences, the problems it found and left, and what the media of the scene now know
    of each other.
    """

    changes: tuple[str, ...]
    problems: tuple[Problem, ...]
    found: Found = Found()

    def __str__(self) -> str:
        lines = [f"changed: {change}" for change in self.changes] or ["nothing to change"]
        lines += [f"analysis: {line}" for line in str(self.found).splitlines()]
        return "\n".join(lines + [f"warning: {problem}" for problem in self.problems])


def prepare(scene: bpy.types.Scene) -> Preparation:
    """Set what a scene needs to render nested dielectrics, and look for problems with its media.

    Cycles on the CPU with Open Shading Language, and enough bounces; where a medium disperses, the motion blur that
    carries the wavelengths, with a shutter of 0 unless it is in use, and spectral tables in the file's working space;
    where none does any more, no motion blur with a shutter of 0; the
    lamps that direct refraction and reflection carry; and what surrounds each medium, so that it need not ask the scene.
    Larger limits stay. A second call changes nothing. Raises
    :class:`~nested_dielectric.compatibility.UnsupportedError` if this Blender cannot.
    """
    require_blender()
    changes = list(mend_materials())
    for material in bpy.data.materials:
        changes += mend_nodes(material) + complete_nodes(material)
    ensure = partial(_ensure, changes)
    ensure(scene.render, "engine", "CYCLES", "Render Engine")
    ensure(scene.cycles, "shading_system", True, "Open Shading Language")
    ensure(scene.cycles, "device", "CPU", "Device")
    for attribute, least in AT_LEAST.items():
        label = scene.cycles.bl_rna.properties[attribute].name
        ensure(scene.cycles, attribute, max(least, getattr(scene.cycles, attribute)), label)
    if media(scene) and update_lights(scene):
        changes.append("Lamps of direct refraction and reflection: listed again")
    problems = version_problems()
    dispersing = dispersing_materials(scene)
    if dispersing:
        _ensure_random_time(changes, scene)
    else:
        _end_random_time(changes, scene)
    for material in dispersing:
        try:
            if refresh_spectrum(material):
                changes.append(f"Spectral Table of {material.name}: baked again")
        except ParameterError as error:
            problems.append(Problem(material.name, f"keeps its old spectral table, because {error}", "choose another"))
    found = Found()
    if media(scene):
        found = analyse(scene)
        parted, coincident = part_coincident(scene)
        changes += parted
        problems += coincident
        if parted:
            found = last_found(scene)
    return Preparation(tuple(changes), tuple(problems + find_problems(scene)), found)


def _ensure(changes: list[str], owner: Any, attribute: str, value: Any, label: str) -> None:
    before = getattr(owner, attribute)
    if before != value:
        setattr(owner, attribute, value)
        changes.append(f"{label}: {before} -> {value}")


def _ensure_random_time(changes: list[str], scene: bpy.types.Scene) -> None:
    """Make Cycles draw a time for every path, evenly. Motion blur that is in use stays as it is."""
    if not scene.render.use_motion_blur:
        _ensure(changes, scene.render, "motion_blur_shutter", 0.0, "Shutter")
        _ensure(changes, scene.render, "use_motion_blur", True, "Motion Blur")
    if achromatic_reason(scene):
        _ensure(changes, scene.cycles, "rolling_shutter_type", "NONE", "Rolling Shutter")
        mapping = scene.render.motion_blur_shutter_curve
        for point in mapping.curves[0].points:
            point.location[1] = 1.0
        mapping.update()
        changes.append("Shutter Curve: flat")


def _end_random_time(changes: list[str], scene: bpy.types.Scene) -> None:
    """Switch off motion blur that blurs nothing, which only :func:`_ensure_random_time` leaves on."""
    if scene.render.use_motion_blur and scene.render.motion_blur_shutter == 0.0:
        shutter = scene.render.bl_rna.properties["motion_blur_shutter"].default
        _ensure(changes, scene.render, "use_motion_blur", False, "Motion Blur")
        _ensure(changes, scene.render, "motion_blur_shutter", shutter, "Shutter")
