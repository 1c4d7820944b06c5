"""The setting Render With of a scene: which body of the materials shows its media."""

from __future__ import annotations

import bpy

from ..model.choice import Choice
from ..model.parameter import ParameterError
from . import compatibility

BACKEND_SETTING = "nd_backend"
"""Custom property of a scene: what its media are rendered with, a keyword of :data:`BACKENDS`; absent is the first."""

AUTO, OSL, NATIVE = "AUTO", "OSL", "NATIVE"

BACKENDS = (
    Choice(
        AUTO,
        "Automatic",
        "Cycles' own nodes on the GPU and without Open Shading Language. With it on the CPU, own nodes for all media that "
        "need nothing more, and the shader for the others, in one picture",
    ),
    Choice(OSL, "OSL", "The shader in Open Shading Language for all media: everything, on the CPU"),
    Choice(
        NATIVE,
        "Cycles' Nodes",
        "Cycles' own nodes for all media, on every device: surfaces are cut where media cross, and what only the shader does "
        "is left out",
    ),
)


def runs_osl(scene: bpy.types.Scene) -> bool:
    """Return whether a scene's renders run shaders in Open Shading Language that trace rays."""
    return compatibility.has_osl() and scene.cycles.shading_system and scene.cycles.device == "CPU"


def get_backend(scene: bpy.types.Scene) -> str:
    """Return what a scene's media are to be rendered with: AUTO, OSL or NATIVE."""
    value = scene.get(BACKEND_SETTING)
    return next((choice.keyword for choice in BACKENDS if choice.keyword == value), AUTO)


def set_backend(scene: bpy.types.Scene, backend: str) -> None:
    """Render the media of a scene with Cycles' own nodes, the shader, or what fits best.

    Raise :class:`ParameterError` for another word.
    """
    words = [choice.keyword for choice in BACKENDS]
    if backend not in words:
        raise ParameterError(f"backend={backend!r}: one of {', '.join(words)} is needed")
    if backend == get_backend(scene):
        return
    if backend == AUTO:
        del scene[BACKEND_SETTING]
    else:
        scene[BACKEND_SETTING] = backend


def is_native(scene: bpy.types.Scene) -> bool:
    """Return whether Cycles' own nodes render all media of a scene."""
    backend = get_backend(scene)
    return backend == NATIVE or (backend == AUTO and not runs_osl(scene))
