"""The media of a scene as panels show them: looked for anew when something but a place has changed, not at every redraw."""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from .media import media


@dataclass(frozen=True)
class Listed:
    """Media of a scene in winning order.

    :param own: those of the scene itself.
    :param instanced: those that instances of collections bring in.
    """

    own: tuple[bpy.types.Object, ...]
    instanced: tuple[bpy.types.Object, ...]


_listed: dict[int, Listed] = {}
"""By the session's number of the scene."""


def listed_media(scene: bpy.types.Scene) -> Listed:
    """Return the media of a scene as of its last change; as of now while the extension is not registered."""
    found = _listed.get(scene.session_uid)
    if found is None:
        own = set(scene.objects)
        ordered = media(scene)
        parts = (tuple(obj for obj in ordered if (obj in own) == is_own) for is_own in (True, False))
        found = Listed(*parts)
        if forget_media in bpy.app.handlers.depsgraph_update_post:
            _listed[scene.session_uid] = found
    return found


@bpy.app.handlers.persistent
def forget_media(_: bpy.types.Scene = None, depsgraph: bpy.types.Depsgraph = None) -> None:
    """Look for media again: after an update of more than places, undoing, another frame or another file."""
    if not isinstance(depsgraph, bpy.types.Depsgraph) or any(map(_is_more_than_a_move, depsgraph.updates)):
        _listed.clear()


def _is_more_than_a_move(update: bpy.types.DepsgraphUpdate) -> bool:
    if isinstance(update.id, bpy.types.Scene):
        return False
    return update.is_updated_geometry or update.is_updated_shading or not update.is_updated_transform
