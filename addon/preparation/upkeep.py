"""Bringing up to date what is kept with a scene: what its media are told, what is cut, which body renders each.

What has been done for a scene since it was last changed is remembered, so that nothing is done twice.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import bpy

from ..analysis import changes, surroundings
from ..analysis.findings import Found
from ..analysis.validity import is_analysed, set_frame_validity
from ..cutting import backends, cut_collection, cut_plan, cut_scene, views
from ..nodes.lookups import caching_nodes
from ..nodes.mending import repair_nodes
from ..scene.scripts import frame_scripts, update_scripts
from . import windows

ANALYSIS, CUTTING, BODIES = "analysis", "cutting", "bodies"
"""What may have been done for a scene."""

_done: dict[int, tuple[changes.State, set[str]]] = {}
"""What scenes were like when something was last done for them and what that was, by the session's numbers of the scenes."""

_follows = True


def follows_updates() -> bool:
    """Return whether handlers look at what an update changes: not at what the extension itself writes."""
    return _follows


def forget_done() -> None:
    """Do everything anew the next time."""
    _done.clear()


@contextmanager
def writing(scene: bpy.types.Scene, looks: bool) -> Iterator[set[str]]:
    """Yield what has been done for a scene since it was last changed, to be added to.

    What is written in the block is no change. Where others' scripts may change the scene at any time, nothing has been done.

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


@contextmanager
def writing_for_windows() -> Iterator[None]:
    """Let what is written in the block, and what follows from it in windows, be no change that handlers look at."""
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


def analysed_scenes() -> list[bpy.types.Scene]:
    """Return the file's own scenes that are kept analysed."""
    return [scene for scene in bpy.data.scenes if is_analysed(scene) and scene.library is None]


def cut_scenes() -> list[bpy.types.Scene]:
    """Return the file's own scenes whose surfaces are cut, or that still show such."""
    return [
        scene
        for scene in bpy.data.scenes
        if scene.library is None and (cut_scene.is_cut(scene) or cut_collection.is_shown(scene))
    ]


def analyse_scene(scene: bpy.types.Scene) -> Found:
    """Look at the media of a scene, and tell each what surrounds it; return what was found."""
    with writing(scene, looks=True) as done:
        return analyse_within(scene, done)


def analyse_within(scene: bpy.types.Scene, done: set[str]) -> Found:
    """Do what :func:`analyse_scene` does within a block of :func:`writing`, which yielded `done`."""
    mend_nodes_of(bpy.data.materials)
    found = surroundings.analyse(scene)
    follow_scripts(scene)
    done.add(ANALYSIS)
    return found


def follow_scripts(scene: bpy.types.Scene) -> None:
    """Let what media are told hold on every frame, unless scripts may change the scene."""
    set_frame_validity(scene, every_frame=not any(frame_scripts()))


def invalidate(scene: bpy.types.Scene) -> None:
    """Let the media of an analysed scene ask, rendered by the shader, until it is analysed again."""
    surroundings.invalidate(scene)
    backends.fall_back_to_osl(scene)


def update_or_invalidate(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> bool:
    """Do as :func:`surroundings.update_or_invalidate`; media that begin to ask are left to the shader."""
    were_asking = surroundings.is_invalid(scene)
    ask = surroundings.update_or_invalidate(scene, depsgraph)
    if ask and not were_asking:
        backends.fall_back_to_osl(scene)
    return ask


def update_cut(scene: bpy.types.Scene) -> cut_plan.CutReport:
    """Bring what renders show of a scene up to date if its surfaces are cut; return what was found."""
    if not cut_scene.is_cut(scene):
        cut_scene.end_cut(scene)
        return cut_plan.CutReport()
    with writing(scene, looks=False) as done:
        return update_cut_within(scene, done)


def update_cut_within(scene: bpy.types.Scene, done: set[str]) -> cut_plan.CutReport:
    """Cut the surfaces of a scene anew within a block of :func:`writing`, which yielded `done`."""
    views.unfreeze(scene)
    found = cut_scene.cut_surfaces(scene, scripted=any(frame_scripts()))
    done.add(CUTTING)
    show_in_views(scene)
    return found


def choose_bodies(scene: bpy.types.Scene) -> backends.BackendChoice:
    """Let each material of a scene be rendered by the body that is right for it; return what was found."""
    with writing(scene, looks=False) as done:
        return choose_bodies_within(scene, done)


def choose_bodies_within(scene: bpy.types.Scene, done: set[str]) -> backends.BackendChoice:
    """Do what :func:`choose_bodies` does within a block of :func:`writing`, which yielded `done`."""
    chosen = backends.choose(scene, scripted=any(frame_scripts()))
    done.add(BODIES)
    return chosen


def show_in_views(scene: bpy.types.Scene) -> None:
    """Let viewports show cut surfaces where one of them shows materials, else the artist's objects."""
    shown = bpy.context.window_manager.windows if windows.has_window() else ()
    views.show(scene, scene in views.lit_scenes(shown), shown)


@caching_nodes()
def mend_nodes_of(changed: Iterable[bpy.types.ID]) -> None:
    """Let media read what artists have plugged in since, in materials and groups that have changed."""
    if any(isinstance(data, bpy.types.ShaderNodeTree) and not data.is_embedded_data for data in changed):
        changed = bpy.data.materials
    for data in changed:
        if isinstance(data, bpy.types.Material):
            repair_nodes(data)
