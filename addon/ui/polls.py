"""Why operators are greyed out, where several are for the same reason."""

from __future__ import annotations

import bpy

from ..nodes.compatibility import blender_problem
from .media_list import listed_media


def supported(cls: type[bpy.types.Operator]) -> bool:
    """Return whether this Blender can render nested dielectrics; if not, the operator says why."""
    problem = blender_problem()
    if problem:
        cls.poll_message_set(problem)
    return not problem


def has_media(cls: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    """Return whether the scene has media; if not, the operator says what to do."""
    if not listed_media(context.scene).rows:
        cls.poll_message_set("The scene has no medium; assign a preset first")
        return False
    return True


def in_object_mode(cls: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    """Return whether objects may be selected and changed; if not, the operator says what to do."""
    if context.mode != "OBJECT":
        cls.poll_message_set("Leave this mode for Object Mode first")
        return False
    return True
