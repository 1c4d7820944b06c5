"""The number of a scene, by which what a file keeps for one scene is told from what it keeps for another.

Materials, groups and objects go from scene to scene and from file to file: shared, copied, appended, linked. What they carry
of one scene holds there alone, and Cycles can compare a number of the scene that is rendered (a View Layer attribute, which
is a constant to it) with the one they carry, without the extension too.
"""

from __future__ import annotations

import secrets
from typing import Any

import bpy

SCENE_PROPERTY = "nd_scene"
"""Custom property of a scene: its number."""

NO_SCENE = 0
"""The number of no scene, and what Cycles reads where a scene has none."""

NUMBERS = 1 << 20
"""All below keep their value where Cycles sums and divides them in single precision."""


def known_number(scene: bpy.types.Scene) -> int:
    """Return a scene's number, or :data:`NO_SCENE`."""
    number = scene.get(SCENE_PROPERTY)
    return number if type(number) is int and NO_SCENE < number < NUMBERS else NO_SCENE


def forget_gone_scenes(known: dict[int, Any]) -> None:
    """Remove scenes that are gone from what a session keeps by the session's numbers of its scenes."""
    for gone in known.keys() - {scene.session_uid for scene in bpy.data.scenes}:
        del known[gone]


def scene_number(scene: bpy.types.Scene) -> int:
    """Return a scene's number, made on first use, and anew where a copied scene shares its original's."""
    number = known_number(scene)
    others = {known_number(other) for other in bpy.data.scenes if other != scene}
    while number == NO_SCENE or number in others:
        number = 1 + secrets.randbelow(NUMBERS - 1)
    if number != known_number(scene):
        scene[SCENE_PROPERTY] = number
        scene.update_tag()
    return number
