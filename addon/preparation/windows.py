"""What goes on in Blender's windows."""

from __future__ import annotations

import threading

import bpy


def in_main_thread() -> bool:
    """Return whether data may be written: a render in a window has a thread of its own."""
    return threading.current_thread() is threading.main_thread()


def has_window() -> bool:
    """Return whether somebody may wait for Blender to answer the mouse."""
    return not bpy.app.background


def is_at_work() -> bool:
    """Return whether the mouse transforms or shapes something, an animation plays, or a picture is rendered."""
    return is_rendering() or is_playing() or is_shaping()


def is_rendering() -> bool:
    """Return whether a picture is rendered."""
    return bpy.app.is_job_running("RENDER")


def is_playing() -> bool:
    """Return whether an animation plays in a window."""
    return any(window.screen.is_animation_playing for window in bpy.context.window_manager.windows)


def is_shaping() -> bool:
    """Return whether the mouse transforms or shapes something."""
    return any(
        operator.bl_idname.startswith(("TRANSFORM_OT_", "SCULPT_OT_"))
        for window in bpy.context.window_manager.windows
        for operator in window.modal_operators
    )
