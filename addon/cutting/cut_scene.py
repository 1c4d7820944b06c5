"""The cut of a scene: whether there is one, making it, keeping it up to date, ending it."""

from __future__ import annotations

import bpy

from ..nodes.cutting.plan import Plan
from ..nodes.identity import forget_gone_scenes
from ..nodes.names import VERSION_PROPERTY
from ..nodes.render_with import is_native
from ..scene.media import CUT_SETTING
from .baked_cut import delete_outdated_bake
from .cut_collection import is_shown, surfaces_of
from .cut_objects import remove_cut_objects, show_plan, unhide_orphans
from .cut_plan import CutReport, make_plan


def is_set_to_cut(scene: bpy.types.Scene) -> bool:
    """Return whether the artist wants a scene's surfaces cut where media cross: a setting of the scene."""
    return bool(scene.get(CUT_SETTING))


def is_cut(scene: bpy.types.Scene) -> bool:
    """Return whether a scene's surfaces are cut where media cross.

    Its setting says so, or Cycles' own nodes render all media, which cannot ask.
    """
    return is_set_to_cut(scene) or (is_native(scene) and any(VERSION_PROPERTY in tree for tree in bpy.data.node_groups))


def set_cut(scene: bpy.types.Scene, cut: bool) -> None:
    """Render the media of a scene as surfaces that are cut where they cross, or as they are, as far as they can ask.

    Nothing of the artist's is changed but that media are hidden from renders, which goes back.
    """
    if cut:
        scene[CUT_SETTING] = True
    else:
        scene.pop(CUT_SETTING, None)
        end_cut(scene)


def cut_surfaces(scene: bpy.types.Scene, scripted: bool = False) -> CutReport:
    """Cut the media of a scene for renders, or bring what is cut up to date; return what was found.

    :param scripted: a script may change any object on any frame.
    """
    plan, found = make_plan(scene, scripted, is_native(scene))
    show_plan(scene, plan)
    delete_outdated_bake(scene, plan)
    unhide_orphans()
    _last[scene.session_uid] = found, _settings(scene), plan
    forget_gone_scenes(_last)
    return found


def end_cut(scene: bpy.types.Scene) -> None:
    """Let renders show the artist's own objects again if the scene is not cut any more."""
    if is_cut(scene):
        return
    if is_shown(scene):
        remove_cut_objects(scene)
    _last.pop(scene.session_uid, None)


_last: dict[int, tuple[CutReport, tuple, Plan]] = {}
"""What was found of each scene in this session, by its number, with which settings, and what is cut."""


def last_cut(scene: bpy.types.Scene) -> CutReport | None:
    """Return what was last found of a scene that is cut; None if it is not, or nobody has looked in this session."""
    return _last[scene.session_uid][0] if is_cut(scene) and scene.session_uid in _last else None


def last_plan(scene: bpy.types.Scene) -> Plan | None:
    """Return what is cut of a scene as :func:`cut_surfaces` last found it; None if it is not cut, or nobody has looked."""
    return _last[scene.session_uid][2] if is_cut(scene) and scene.session_uid in _last else None


def _settings(scene: bpy.types.Scene) -> tuple:
    """Return the settings of a scene by which media are cut or not."""
    return scene.render.use_motion_blur, scene.render.motion_blur_shutter > 0.0, is_native(scene)


def remove_cut(scene: bpy.types.Scene) -> bool:
    """Remove the setting of a scene and all that shows surfaces; return whether there was any."""
    was_cut = is_set_to_cut(scene) or is_shown(scene)
    scene.pop(CUT_SETTING, None)
    remove_cut_objects(scene)
    _last.pop(scene.session_uid, None)
    return was_cut


_KINDS = (
    bpy.types.Object,
    bpy.types.Mesh,
    bpy.types.Material,
    bpy.types.ShaderNodeTree,
    bpy.types.Collection,
)
"""Kinds of data-blocks by whose changes media may cross otherwise."""


def may_change_cut(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> bool:
    """Return whether an update may change which media of a scene that is cut cross, or how they are shown.

    To select does not, nor do cut surfaces that follow.
    """
    if not is_cut(scene):
        return is_shown(scene)
    known = _last.get(scene.session_uid)
    if known is None or known[1] != _settings(scene):
        return True
    changed = {
        update.id.original
        for update in depsgraph.updates
        if isinstance(update.id, _KINDS)
        and (update.is_updated_geometry or update.is_updated_transform or update.is_updated_shading)
    }
    return bool(changed) and not changed <= {
        each for surface in surfaces_of(scene).values() for each in (surface, surface.data)
    }
