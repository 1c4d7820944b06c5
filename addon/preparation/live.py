"""Keeping what media are told true while a session lasts: after updates, on every frame, before renders and saving.

The handlers are put in by :func:`analyse`, too, so that a script that never registers the extension renders what is there.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager

import bpy

from ..analysis import analysis, changes
from ..cutting import backends, cutting, views
from ..nodes.identity import NO_SCENE, known_number
from ..nodes.lookups import unchanged_nodes
from ..nodes.trees import mend_nodes
from ..scene.lights import update_lights

REST = 0.3
"""Seconds without a change after which a scene in a window is analysed."""

GLANCE = 0.1
"""Seconds after a viewport is drawn until what it shows of cut surfaces is looked at: drawing may change nothing."""

ANALYSIS, CUTTING, BODIES = "analysis", "cutting", "bodies"

_done: dict[int, tuple[changes.State, set[str]]] = {}
"""What scenes were like when something was last done for them and what that was, by the session's numbers of the scenes."""


def analyse(scene: bpy.types.Scene) -> analysis.Found:
    """Look at the media of a scene, and tell each what surrounds it. The scene's media are kept analysed from then on, in
    this session by handlers of frames, updates and renders.

    Linked materials and objects are left as they are: they ask the scene.
    """
    install()
    return _analyse(scene)


_drawing: object | None = None
"""What Blender calls when it draws a viewport."""

_follows = True
"""Whether handlers look at what an update changes."""


@contextmanager
def _writing(scene: bpy.types.Scene, looks: bool) -> Iterator[set[str]]:
    """Yield what has been done for a scene since it was last changed, to be added to. What is written in the block is no change.

    Where others' scripts may change the scene at any time, nothing has been done.

    :param looks: the block looks at the scene itself if it was changed, so that no handler has to.
    """
    global _follows
    outer, _follows = _follows, _follows and not looks
    try:
        scene.view_layers[0].update()
        _follows = False
        before, done = _done.get(scene.session_uid, (None, set()))
        if before != changes.state_of(scene) or any(frame_scripts()) or any(update_scripts()):
            done = set()
        with changes.uncounted():
            yield done
            scene.view_layers[0].update()
        _done[scene.session_uid] = changes.state_of(scene), done
    finally:
        _follows = outer


def install() -> None:
    """Put the handlers in; a second call changes nothing."""
    global _drawing
    for handlers, handler in _handlers():
        if handler not in handlers:
            handlers.append(handler)
    if _drawing is None and has_window():
        _drawing = bpy.types.SpaceView3D.draw_handler_add(look_at_views_soon, (), "WINDOW", "POST_PIXEL")


def remove() -> None:
    """Take the handlers and the timers out; viewports show the artist's own objects again."""
    global _drawing
    for handlers, handler in _handlers():
        while handler in handlers:
            handlers.remove(handler)
    _done.clear()
    stop_timers()
    if _drawing is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_drawing, "WINDOW")
        _drawing = None
    for scene in _cut_scenes():
        views.show(scene, False)


def _handlers() -> tuple[tuple[list, Callable], ...]:
    handlers = bpy.app.handlers
    return (
        (handlers.render_init, analyse_before_render),
        (handlers.render_pre, come_last),
        (handlers.frame_change_post, analyse_after_frame_change),
        (handlers.depsgraph_update_pre, hold_before_update),
        (handlers.depsgraph_update_post, analyse_after_update),
        (handlers.load_post, distrust_loaded),
        (handlers.blend_import_post, show_strays),
        (handlers.save_pre, narrow_before_save),
        (handlers.save_post, widen_after_save),
        (handlers.undo_post, forget_shapes),
        (handlers.redo_post, forget_shapes),
    )


def frame_scripts() -> Iterator[Callable]:
    """Yield others' handlers that may change a scene on every frame."""
    return _scripts("frame_change_pre", "frame_change_post", "render_pre", "render_init")


def update_scripts() -> Iterator[Callable]:
    """Yield others' handlers that may change a scene whenever anything changes."""
    return _scripts("depsgraph_update_pre", "depsgraph_update_post")


def _scripts(*names: str) -> Iterator[Callable]:
    ours = analyse_before_render.__module__.rpartition(".")[0]
    for name in names:
        for handler in getattr(bpy.app.handlers, name):
            if not getattr(handler, "__module__", "").startswith(ours):
                yield handler


def _analyse(scene: bpy.types.Scene) -> analysis.Found:
    with _writing(scene, looks=True) as done:
        return _look(scene, done)


def _look(scene: bpy.types.Scene, done: set[str]) -> analysis.Found:
    mend_nodes_of(bpy.data.materials)
    found = analysis.analyse(scene)
    _trust(scene)
    done.add(ANALYSIS)
    return found


def _distrust(scene: bpy.types.Scene) -> None:
    analysis.distrust(scene)
    backends.let_ask(scene)


def _follow_or_distrust(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> bool:
    """As :func:`analysis.follow_or_distrust`; media that begin to ask are left to the shader."""
    were_asking = analysis.is_distrusted(scene)
    ask = analysis.follow_or_distrust(scene, depsgraph)
    if ask and not were_asking:
        backends.let_ask(scene)
    return ask


def update_cut(scene: bpy.types.Scene) -> cutting.Cut:
    """Bring what renders show of a scene up to date if its surfaces are cut; return what was found. The scene is kept so from
    then on, as by :func:`analyse`.
    """
    if not cutting.is_cut(scene):
        cutting.end_cut(scene)
        return cutting.Cut()
    install()
    with _writing(scene, looks=False) as done:
        return _update_cut(scene, done)


def _update_cut(scene: bpy.types.Scene, done: set[str]) -> cutting.Cut:
    views.let_go(scene)
    found = cutting.cut_surfaces(scene, scripted=any(frame_scripts()))
    done.add(CUTTING)
    _show_in_views(scene)
    return found


def choose_bodies(scene: bpy.types.Scene) -> backends.Chosen:
    """Let each material of a scene be rendered by the body that is right for it; return what was found."""
    with _writing(scene, looks=False) as done:
        return _choose_bodies(scene, done)


def _choose_bodies(scene: bpy.types.Scene, done: set[str]) -> backends.Chosen:
    chosen = backends.choose(scene, scripted=any(frame_scripts()))
    done.add(BODIES)
    return chosen


def _show_in_views(scene: bpy.types.Scene) -> None:
    windows = bpy.context.window_manager.windows if has_window() else ()
    views.show(scene, scene in views.lit_scenes(windows), windows)


def keep_cut(scene: bpy.types.Scene) -> str:
    """Keep the cut of the present frame in the file; return why that cannot be, or nothing."""
    update_cut(scene)
    return cutting.keep_in_file(scene, scripted=any(frame_scripts()))


def _cut_scenes() -> list[bpy.types.Scene]:
    return [
        scene
        for scene in bpy.data.scenes
        if scene.library is None and (cutting.is_cut(scene) or cutting.is_shown(scene))
    ]


def _trust(scene: bpy.types.Scene) -> None:
    analysis.trust(scene, every_frame=not any(frame_scripts()))


def _analysed_scenes() -> list[bpy.types.Scene]:
    return [scene for scene in bpy.data.scenes if analysis.is_analysed(scene) and scene.library is None]


def in_main_thread() -> bool:
    """Whether data may be written: a render in a window has a thread of its own."""
    return threading.current_thread() is threading.main_thread()


def has_window() -> bool:
    """Whether somebody may wait for Blender to answer the mouse."""
    return not bpy.app.background


@bpy.app.handlers.persistent
def analyse_before_render(scene: bpy.types.Scene, *_: object) -> None:
    """Make sure that the media know what surrounds them now, and the lamps that their lobes carry. In a window updates have
    been followed.
    """
    is_numbered, is_analysed, is_cut = (
        known_number(scene) != NO_SCENE,
        analysis.is_analysed(scene),
        cutting.is_cut(scene),
    )
    if not in_main_thread() or not (is_numbered or is_analysed or is_cut):
        return
    with _writing(scene, looks=True) as done:
        if is_numbered:
            update_lights(scene)
        if is_analysed and ANALYSIS not in done:
            _look(scene, done)
        if is_cut and CUTTING not in done:
            _update_cut(scene, done)
        if BODIES not in done:
            _choose_bodies(scene, done)


@bpy.app.handlers.persistent
def come_last(*_: object) -> None:
    """See each frame after all scripts have changed it."""
    handlers = bpy.app.handlers.frame_change_post
    if handlers[-1:] != [analyse_after_frame_change] and in_main_thread():
        handlers.remove(analyse_after_frame_change)
        handlers.append(analyse_after_frame_change)


@bpy.app.handlers.persistent
def analyse_after_frame_change(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph | None = None) -> None:
    """Follow what scripts change on a frame, of which no update tells. Between frames, where only motion blur looks, nothing
    may be told anew.

    The scene is looked at as the viewport evaluates it: to update the render's own evaluation here would hide from Cycles
    what has changed.
    """
    if depsgraph is not None and depsgraph.mode == "VIEWPORT":
        changes.count(depsgraph)
    if not analysis.is_analysed(scene) or scene.frame_subframe != 0.0 or not in_main_thread():
        return
    if not any(frame_scripts()):
        return
    if has_window():
        _distrust(scene)
        _wait_for_rest()
        return
    _analyse(scene)
    choose_bodies(scene)


@bpy.app.handlers.persistent
def analyse_after_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Follow what moves, changes, comes and goes. In a window nothing is to wait while the mouse drags it."""
    changes.count(depsgraph)
    if has_window() and cutting.concerns(scene, depsgraph):
        _wait_for_rest()
    if not analysis.is_analysed(scene):
        return
    mend_nodes_of({update.id.original for update in depsgraph.updates})
    if not _follows:
        return
    if not has_window():
        analysis.follow(scene, depsgraph)
    elif _follow_or_distrust(scene, depsgraph):
        _wait_for_rest()
    _trust(scene)


@unchanged_nodes()
def mend_nodes_of(changed: Iterable[bpy.types.ID]) -> None:
    """Let media read what artists have plugged in since, in materials and groups that have changed."""
    if any(isinstance(data, bpy.types.ShaderNodeTree) and not data.is_embedded_data for data in changed):
        changed = bpy.data.materials
    for data in changed:
        if isinstance(data, bpy.types.Material):
            mend_nodes(data)


def _wait_for_rest() -> None:
    if bpy.app.timers.is_registered(analyse_at_rest):
        bpy.app.timers.unregister(analyse_at_rest)
    bpy.app.timers.register(analyse_at_rest, first_interval=REST)


def analyse_at_rest() -> float | None:
    """Analyse what has changed in windows, or return the seconds to wait before another call."""
    if is_at_work():
        return REST
    with _writing_for_windows():
        for scene in filter(analysis.is_distrusted, _analysed_scenes()):
            _analyse(scene)
        for scene in _cut_scenes():
            if views.is_edited(scene):
                views.let_go(scene)
            else:
                update_cut(scene)
        for scene in {*_analysed_scenes(), *_cut_scenes()}:
            choose_bodies(scene)
    return None


@contextmanager
def _writing_for_windows() -> Iterator[None]:
    """Let what is written in the block, and what follows from it in windows, be no change that has to be followed."""
    global _follows
    layers = [window.view_layer for window in bpy.context.window_manager.windows]
    for layer in layers:
        layer.update()
    _follows = False
    try:
        yield
        for layer in layers:
            layer.update()
    finally:
        _follows = True


def stop_timers() -> None:
    """Analyse nothing at rest, and look at no viewport, any more."""
    for timer in (analyse_at_rest, look_at_views):
        if bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)


def is_at_work() -> bool:
    """Whether the mouse transforms or shapes something, an animation plays, or a picture is rendered."""
    return bpy.app.is_job_running("RENDER") or _plays() or _is_shaping()


def _plays() -> bool:
    return any(window.screen.is_animation_playing for window in bpy.context.window_manager.windows)


def _is_shaping() -> bool:
    return any(
        operator.bl_idname.startswith(("TRANSFORM_OT_", "SCULPT_OT_"))
        for window in bpy.context.window_manager.windows
        for operator in window.modal_operators
    )


def look_at_views_soon() -> None:
    """See to it that what a viewport shows that is drawn is right."""
    if not bpy.app.timers.is_registered(look_at_views):
        bpy.app.timers.register(look_at_views, first_interval=GLANCE)


def look_at_views() -> float | None:
    """Let viewports show cut surfaces or the artist's objects, or return the seconds to wait before another call."""
    if bpy.app.is_job_running("RENDER"):
        return REST
    with _writing_for_windows():
        for scene in _cut_scenes():
            _show_in_views(scene)
    return None


@bpy.app.handlers.persistent
def hold_before_update(scene: bpy.types.Scene, *_: object) -> None:
    """Cut nothing anew for viewports while changes follow on each other, as the mouse drags or a button is held: to cut may take
    seconds.
    """
    if not _follows or not has_window() or not in_main_thread() or _plays() or not cutting.is_cut(scene):
        return
    if not _is_shaping() and not bpy.app.timers.is_registered(analyse_at_rest):
        return
    for window in bpy.context.window_manager.windows:
        if window.scene == scene:
            views.hold(scene, window.view_layer)


@bpy.app.handlers.persistent
def distrust_loaded(*_: object) -> None:
    """Believe nothing that a file tells: it may have been changed without the extension. Nobody waits for a look at it."""
    forget_shapes()
    for scene in _analysed_scenes():
        _distrust(scene)
    if has_window() and (_analysed_scenes() or _cut_scenes()):
        _wait_for_rest()


@bpy.app.handlers.persistent
def show_strays(*_: object) -> None:
    """Let renders show media that came from a scene that is cut without what showed them there."""
    cutting.show_strays()


@bpy.app.handlers.persistent
def narrow_before_save(*_: object) -> None:
    """Save what holds without the extension, too: on the present frame, as no one will see what scripts do on others."""
    scripts = any(frame_scripts())
    for scene in _analysed_scenes():
        if scripts:
            analysis.distrust(scene)
        if analysis.is_distrusted(scene):
            analysis.analyse(scene)
    for scene in _cut_scenes():
        update_cut(scene)
    for scene in {*_analysed_scenes(), *_cut_scenes()}:
        choose_bodies(scene)
        backends.let_choose(scene)
    for scene in _analysed_scenes():
        analysis.trust(scene, every_frame=False)
        analysis.tell_natives(scene, not scripts)


@bpy.app.handlers.persistent
def widen_after_save(*_: object) -> None:
    """Go on as before."""
    for scene in _analysed_scenes():
        _trust(scene)
        analysis.tell_natives(scene, True)
    for scene in {*_analysed_scenes(), *_cut_scenes()}:
        choose_bodies(scene)


@bpy.app.handlers.persistent
def forget_shapes(*_: object) -> None:
    """Undoing changes meshes without an update that names them."""
    analysis.forget_shapes()
    _done.clear()
    if has_window() and _cut_scenes():
        _wait_for_rest()
