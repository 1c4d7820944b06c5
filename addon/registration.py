"""Putting the extension into Blender and taking it out again."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterable
from contextlib import ExitStack

import bpy

from . import analysis, operators, panels, versions
from .checks import material_problems
from .compatibility import blender_note, blender_problem, settings_problem
from .media import media
from .trees import mend_nodes

REST = 0.3
"""Seconds without a change after which a scene in a window is analysed."""

_registered: ExitStack | None = None
"""How to take out what :func:`register` put in; None while nothing is in."""


def register() -> None:
    """Put operators, panels, menus and the command line's command into Blender; a second call changes nothing.

    If any of it fails, what went before is taken out again and the error is raised.
    """
    global _registered
    if _registered is not None:
        return
    with ExitStack() as undo:
        for cls in (*operators.CLASSES, *panels.CLASSES):
            bpy.utils.register_class(cls)
            undo.callback(bpy.utils.unregister_class, cls)

        panels.open_pictures()
        undo.callback(panels.close_pictures)

        bpy.types.Scene.nested_dielectric_active = bpy.props.IntProperty(
            name="Active Medium", get=panels.get_active, set=panels.set_active, options=set()
        )
        undo.callback(delattr, bpy.types.Scene, "nested_dielectric_active")

        bpy.types.VIEW3D_MT_object.append(operators.draw_preset_menu)
        undo.callback(bpy.types.VIEW3D_MT_object.remove, operators.draw_preset_menu)

        for handlers, handler in (
            (bpy.app.handlers.render_init, analyse_before_render),
            (bpy.app.handlers.render_init, warn_before_render),
            (bpy.app.handlers.depsgraph_update_post, analyse_after_update),
            (bpy.app.handlers.load_post, mend_materials),
            (bpy.app.handlers.load_post, analyse_after_load),
            (bpy.app.handlers.blend_import_post, mend_materials),
            (bpy.app.handlers.save_pre, analyse_what_is_left),
            (bpy.app.handlers.undo_post, forget_shapes),
            (bpy.app.handlers.redo_post, forget_shapes),
        ):
            handlers.append(handler)
            undo.callback(handlers.remove, handler)

        undo.callback(stop_timer)

        command = bpy.utils.register_cli_command("nested_dielectric", run_command)
        undo.callback(bpy.utils.unregister_cli_command, command)

        _registered = undo.pop_all()
    text = blender_problem() or blender_note()
    if text:
        print(f"Nested Dielectric: {text}", file=sys.stderr)


def unregister() -> None:
    """Take out everything that :func:`register` put in."""
    global _registered
    if _registered is not None:
        undo, _registered = _registered, None
        undo.close()


@bpy.app.handlers.persistent
def warn_before_render(scene: bpy.types.Scene, *_: object) -> None:
    """Say on the terminal why the media of a scene will not look right, where no panel is open to say so."""
    problem = blender_problem() or settings_problem(scene)
    if problem and media(scene):
        print(f"Nested Dielectric: {problem}", file=sys.stderr)
    for each in material_problems(scene):
        print(f"Nested Dielectric: {each}", file=sys.stderr)


@bpy.app.handlers.persistent
def analyse_before_render(scene: bpy.types.Scene, *_: object) -> None:
    """Make sure that the media know what surrounds them now. Where the render has a thread of its own there is a window,
    and updates have been followed.
    """
    if analysis.is_analysed(scene) and threading.current_thread() is threading.main_thread():
        mend_nodes_of(bpy.data.materials)
        analysis.analyse(scene)


@bpy.app.handlers.persistent
def analyse_after_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Follow what moves, changes, comes and goes. In a window nothing is to wait while the mouse drags it."""
    if not analysis.is_analysed(scene):
        return
    mend_nodes_of({update.id.original for update in depsgraph.updates})
    if not has_window():
        analysis.follow(scene, depsgraph)
    elif analysis.hold(scene, depsgraph):
        stop_timer()
        bpy.app.timers.register(analyse_at_rest, first_interval=REST)


def mend_nodes_of(changed: Iterable[bpy.types.ID]) -> None:
    """Let media read what artists have plugged in since, in materials and groups that have changed."""
    if any(isinstance(data, bpy.types.ShaderNodeTree) and not data.is_embedded_data for data in changed):
        changed = bpy.data.materials
    for data in changed:
        if isinstance(data, bpy.types.Material):
            mend_nodes(data)


def analyse_at_rest() -> float | None:
    """Analyse what has changed in windows, or return the seconds to wait before another call."""
    if is_at_work():
        return REST
    analyse_what_is_left()
    return None


@bpy.app.handlers.persistent
def analyse_what_is_left(*_: object) -> None:
    """Analyse what has changed in windows."""
    for scene in bpy.data.scenes:
        if analysis.is_analysed(scene):
            analysis.settle(scene)


def stop_timer() -> None:
    """Do not analyse at rest any more."""
    if bpy.app.timers.is_registered(analyse_at_rest):
        bpy.app.timers.unregister(analyse_at_rest)


def has_window() -> bool:
    """Whether somebody may wait for Blender to answer the mouse."""
    return not bpy.app.background


def is_at_work() -> bool:
    """Whether the mouse transforms or shapes something, or a picture is rendered."""
    return bpy.app.is_job_running("RENDER") or any(
        operator.bl_idname.startswith(("TRANSFORM_OT_", "SCULPT_OT_"))
        for window in bpy.context.window_manager.windows
        for operator in window.modal_operators
    )


@bpy.app.handlers.persistent
def mend_materials(*_: object) -> None:
    """Make materials right that a file, or what is appended from one, has from a Blender or an extension to which this
    Blender's Cycles was unknown.
    """
    if blender_problem():
        return
    for change in versions.mend_materials():
        print(f"Nested Dielectric: updated {change}", file=sys.stderr)
    for problem in versions.version_problems():
        print(f"Nested Dielectric: {problem}", file=sys.stderr)


@bpy.app.handlers.persistent
def analyse_after_load(*_: object) -> None:
    """Look at a file anew: it may have been changed without the extension."""
    analysis.forget_shapes()
    for scene in bpy.data.scenes:
        if analysis.is_analysed(scene):
            analysis.analyse(scene)


@bpy.app.handlers.persistent
def forget_shapes(*_: object) -> None:
    """Undoing changes meshes without an update that names them."""
    analysis.forget_shapes()


def run_command(arguments: list[str]) -> int:
    """``blender --command nested_dielectric``."""
    from . import cli

    return cli.main(arguments)
