"""What a fix would do, said before it is done."""

from __future__ import annotations

from contextlib import suppress

import bpy

from ..analysis.findings import listed
from ..checking.finding import Action, Fix
from ..scene import settings

_WORDS = {
    Action.RECALCULATE_NORMALS: "Let all faces of {first} look outwards",
    Action.CLOSE_HOLES: "Fill the holes in the mesh of {first}, and let its faces look outwards",
    Action.FILL_CAPS: "Close the ends of {first}",
    Action.PUSH_INTO_WALL: "Move the faces of {first} near {others} outwards by {value}, with a modifier that can be removed",
    Action.PART_FACES: "Move faces of {all} that lie in the same place a little apart, with a modifier that can be removed",
    Action.SET_PRIORITY: "Give {all} the priority {value}",
    Action.SET_SETTING: "Set {path} to {value}",
    Action.SET_DEPTH: "Let the medium of {all} have its colour at the thickness of the object",
    Action.SET_VALUE: "Set {path} of {all} to the nearest value within its limits",
    Action.MERGE_COPIES: "Hide {all} in viewports and renders; nothing is deleted",
    Action.APPLY_TRANSFORM: "Apply scale and rotation of {all} to the mesh; nothing moves",
    Action.MOVE_TO_ORIGIN: "Move everything in the scene, with camera and lights, so that the media are at the origin",
    Action.MOVE_APART: "Move {first} by {value} off {others}",
    Action.MEND_NODES: "Let neighbours read the nodes of {all}, and plug in what is missing",
    Action.MOVE_SLOT: "Exchange material slots of {all}, so that neighbours read the medium; faces keep their materials",
    Action.REMOVE_PROPERTY: "Remove the custom property {path} of {all}",
    Action.PREPARE: "Prepare the scene",
}


def in_words(scene: bpy.types.Scene, fix: Fix) -> str:
    """Return what a fix would do to a scene, as a sentence without a full stop."""
    path = fix.path
    if fix.action == Action.SET_SETTING:
        with suppress(KeyError, ValueError):  # as the file has it
            path = settings.label(scene, path)
    value = f"{fix.value:.3g}" if isinstance(fix.value, float) else fix.value
    if isinstance(value, bool):
        value = "on" if value else "off"
    return _WORDS[fix.action].format(
        first=listed(fix.names[:1]), others=listed(fix.names[1:]), all=listed(fix.names), value=value, path=path
    )
