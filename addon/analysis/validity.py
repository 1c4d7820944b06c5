"""In which scenes, and on which frames, what media are told holds."""

from __future__ import annotations

from dataclasses import astuple, dataclass

import bpy

from ..nodes.identity import scene_number
from ..nodes.names import ANALYSED, FACTS_SCENE, LEFT_TO_SHADER
from ..nodes.validity import evaluate_every_frame


@dataclass(frozen=True)
class Validity:
    """On which frames what the media of a scene are told holds; materials read these numbers of the scene.

    :param holds: 1 if it holds at all; frame: that frame alone, unless every_frame is 1.
    """

    holds: float = 0.0
    frame: float = 0.0
    every_frame: float = 0.0


def is_analysed(scene: bpy.types.Scene) -> bool:
    """Return whether the media of a scene are kept analysed."""
    return ANALYSED in scene


def validity_of(scene: bpy.types.Scene) -> Validity:
    """Read the validity of a scene; nothing holds if it has none."""
    value = scene.get(ANALYSED)
    try:
        return Validity(*map(float, value))
    except (TypeError, ValueError):  # an older file's, or somebody else's
        return Validity()


def set_validity(scene: bpy.types.Scene, validity: Validity) -> None:
    """Write the validity of a scene if it changes."""
    numbers = astuple(validity)
    before = scene.get(ANALYSED)
    if not hasattr(before, "__len__") or tuple(before) != numbers:
        scene[ANALYSED] = numbers
        scene.update_tag()


def current_frame(scene: bpy.types.Scene) -> float:
    """Return the present frame as it is stored."""
    return float(scene.frame_current)


def set_frame_validity(scene: bpy.types.Scene, every_frame: bool) -> None:
    """Let what the media of an analysed scene are told hold on every frame, or on one alone.

    That is the present frame if it held on every frame before.
    """
    validity = validity_of(scene)
    frame = current_frame(scene) if validity.every_frame else validity.frame
    set_validity(scene, Validity(validity.holds, frame, float(every_frame)))
    analysed = [each for each in bpy.data.scenes if is_analysed(each) and each.library is None]
    evaluate_every_frame(not all(validity_of(each).every_frame for each in analysed))


def set_native_validity(scene: bpy.types.Scene, valid: bool) -> None:
    """Let Cycles' own nodes believe what the media of an analysed scene are told, on every frame, or show the alarm."""
    number = scene_number(scene) if valid else None
    if scene.get(FACTS_SCENE) != number:
        if valid:
            scene[FACTS_SCENE] = number
        else:
            del scene[FACTS_SCENE]
        scene.update_tag()


def leave_scene_to_shader(scene: bpy.types.Scene) -> None:
    """Let Cycles' own nodes show the alarm in a scene until it is analysed again, whatever its media are told."""
    scene[FACTS_SCENE] = LEFT_TO_SHADER
    scene.update_tag()
