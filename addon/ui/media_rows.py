"""Which row of a scene's list of media is active.

It follows the active object, but for a material that is chosen until another object becomes active.

Blender's lists show a collection, so rows have places in one that holds nothing; what stands there is looked up.
"""

from __future__ import annotations

import bpy

from ..nodes.identity import forget_gone_scenes
from ..preparation.guard import guarded
from .media_list import Line, listed_lines, listed_media
from .selecting import select_only

_chosen: dict[int, tuple[int, int]] = {}
"""By the session's number of a scene, those of the material that was chosen and of the object that was active then."""


class NestedDielectricPlace(bpy.types.PropertyGroup):
    """A place for a row; registered by its name, which other extensions must not have."""


def active_line(scene: bpy.types.Scene) -> Line | None:
    """Return the line of the list that is active; None if the active object is no medium of the scene."""
    lines = listed_lines(scene).lines
    index = get_active(scene)
    return lines[index] if 0 <= index < len(lines) else None


def get_active(scene: bpy.types.Scene) -> int:
    """Return the index of the line of the chosen material, or else of the active object, or of its material."""
    places = listed_lines(scene).places
    active = bpy.context.view_layer.objects.active
    number = 0 if active is None else active.session_uid
    material, then = _chosen.get(scene.session_uid, (0, 0))
    if then != number:
        _chosen.pop(scene.session_uid, None)
    elif material in places:
        return places[material]
    if number in places:
        return places[number]
    listed = listed_media(scene)
    row = listed.places.get(number)
    return -1 if row is None else places[listed.rows[row].owner.session_uid]


def set_active(scene: bpy.types.Scene, index: int) -> None:
    """Choose a material, or make the object of a line the active and only selected one.

    As in the Outliner, no object becomes active in another mode than Object Mode.
    """
    lines = listed_lines(scene).lines
    if not 0 <= index < len(lines):
        return
    chosen = lines[index].chosen
    layer = bpy.context.view_layer
    active = layer.objects.active
    if isinstance(chosen, bpy.types.Material):
        _chosen[scene.session_uid] = chosen.session_uid, 0 if active is None else active.session_uid
        forget_gone_scenes(_chosen)
        return
    _chosen.pop(scene.session_uid, None)
    if active is None or active.mode == "OBJECT":
        select_only(layer, [chosen])


def make_places(scene: bpy.types.Scene) -> None:
    """Make room for all lines of a scene's list soon: nothing may be made while panels are drawn."""
    manager = bpy.context.window_manager
    missing = len(listed_lines(scene).lines) - len(manager.nested_dielectric_places)
    if missing > 0 and not bpy.app.timers.is_registered(_make_wanted):
        bpy.app.timers.register(_make_wanted)


@guarded("while media were listed", writes=False)
def _make_wanted() -> None:
    manager = bpy.context.window_manager
    places = manager.nested_dielectric_places
    for window in manager.windows:
        for _ in range(len(listed_lines(window.scene).lines) - len(places)):
            places.add()
        for area in window.screen.areas:
            area.tag_redraw()


def forget_wanted() -> None:
    """Take the timer out that makes room."""
    if bpy.app.timers.is_registered(_make_wanted):
        bpy.app.timers.unregister(_make_wanted)
