"""The media of a scene as panels show them: looked for anew when something but a place has changed, not at every redraw."""

from __future__ import annotations

from dataclasses import dataclass, field

import bpy

from ..analysis.mesh_modifiers import is_offset
from ..checking.finding import Finding
from ..checking.material_checks import material_problems
from ..checking.version_checks import version_problems
from ..nodes.lookups import caching_nodes
from ..nodes.material_version import group_version
from ..nodes.problems import has_lost_group
from ..preparation.guard import guarded
from ..scene.materials import dielectric_node, may_disperse
from ..scene.media import all_objects
from ..scene.priorities import Row, priority_rows


@dataclass(frozen=True)
class Listed:
    """Media of a scene.

    :param rows: their places in the winning order.
    :param problems: what is wrong with the scene's materials and their nodes.
    :param parted: number of media whose faces have been moved off others in the same place.
    :param disperses: whether a medium splits light into colours.
    :param places: the index of the row of each object, by the object's number in this session.
    """

    rows: tuple[Row, ...] = ()
    problems: tuple[Finding, ...] = ()
    parted: int = 0
    disperses: bool = False
    places: dict[int, int] = field(default_factory=dict)

    @property
    def objects(self) -> tuple[bpy.types.Object, ...]:
        """All media, those in instanced collections too, in winning order."""
        return tuple(obj for row in self.rows for obj in row.objects)


@dataclass(frozen=True)
class Line:
    """One line of the list: a place in the order, or one of its objects beneath it."""

    row: Row
    obj: bpy.types.Object | None = None

    @property
    def chosen(self) -> bpy.types.Material | bpy.types.Object:
        """What is chosen, and moved, with the line."""
        return self.obj or self.row.owner


@dataclass(frozen=True)
class Lines:
    """The lines of a list.

    :param places: their indices by the numbers of what they show, in this session.
    """

    lines: tuple[Line, ...]
    places: dict[int, int]


_listed: dict[int, Listed] = {}
"""By the session's number of the scene."""

_lines: dict[int, tuple[Listed, frozenset[int], Lines]] = {}
"""The same for lines, with what they were made from."""

_opened: set[int] = set()
"""Materials whose objects the list shows, by their numbers in this session."""


def listed_media(scene: bpy.types.Scene) -> Listed:
    """Return the media of a scene as of its last change; as of now while the extension is not registered."""
    found = _listed.get(scene.session_uid)
    if found is None:
        found = _look(scene)
        if forget_media in bpy.app.handlers.depsgraph_update_post:
            _listed[scene.session_uid] = found
    return found


@caching_nodes()
def _look(scene: bpy.types.Scene) -> Listed:
    lost = any(map(has_lost_group, bpy.data.materials))
    if not lost and all(group_version(tree) is None for tree in bpy.data.node_groups):
        return Listed()
    rows = priority_rows(all_objects(scene))
    places = {obj.session_uid: index for index, row in enumerate(rows) for obj in row.objects}
    parted = sum(any(map(is_offset, obj.modifiers)) for row in rows for obj in row.objects)
    dispersing = {material for material in bpy.data.materials if dielectric_node(material) and may_disperse(material)}
    disperses = bool(dispersing) and any(
        slot.material in dispersing for row in rows for obj in row.objects for slot in obj.material_slots
    )
    problems = version_problems()
    if problems:
        used = {slot.material for row in rows for obj in row.objects for slot in obj.material_slots} - {None}
        names = {material.name for material in used}
        problems = [problem for problem in problems if problem.name in names]
    return Listed(rows, tuple(problems + material_problems(scene)), parted, disperses, places)


def listed_lines(scene: bpy.types.Scene) -> Lines:
    """Return the lines of the list of a scene's media."""
    listed = listed_media(scene)
    kept = _lines.get(scene.session_uid)
    if kept is not None and kept[0] is listed and kept[1] == _opened:
        return kept[2]
    lines = []
    for row in listed.rows:
        lines.append(Line(row))
        if is_open(row):
            lines += [Line(row, obj) for obj in row.objects]
    found = Lines(tuple(lines), {line.chosen.session_uid: index for index, line in enumerate(lines)})
    _lines[scene.session_uid] = listed, frozenset(_opened), found
    return found


def is_open(row: Row) -> bool:
    """Return whether the list shows the objects of a material."""
    return not row.is_own and row.owner.session_uid in _opened


def open_or_close(material: int) -> None:
    """Show the objects of a material, by its number in this session, or hide them; forget materials that are gone."""
    _opened.intersection_update(each.session_uid for each in bpy.data.materials)
    _opened.symmetric_difference_update((material,))


@bpy.app.handlers.persistent
@guarded("after a change", writes=False)
def forget_media(_: bpy.types.Scene = None, depsgraph: bpy.types.Depsgraph = None) -> None:
    """Forget the media, so that they are looked for again.

    This handler is called after an update of more than places, after undoing, on another frame and with another file.
    """
    if not isinstance(depsgraph, bpy.types.Depsgraph) or any(map(_is_more_than_a_move, depsgraph.updates)):
        _listed.clear()
        _lines.clear()


def _is_more_than_a_move(update: bpy.types.DepsgraphUpdate) -> bool:
    if isinstance(update.id, bpy.types.Scene):
        return False
    return update.is_updated_geometry or update.is_updated_shading or not update.is_updated_transform
