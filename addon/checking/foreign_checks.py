"""Checks of what is no medium: faces in the place of a medium's, objects, lights and the camera inside one."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np

from ..analysis.findings import listed
from ..geometry.coincident_faces import ROUNDED_SEPARATION
from ..geometry.resting import resting_surfaces
from ..geometry.solids import Solid
from ..geometry.winding import winding_numbers
from ..scene.lights import scene_lights
from .evaluated_shapes import Shape, sample_points
from .finding import Action, Finding, Fix, Kind, Place
from .inspection import Inspection, Medium
from .kinds import CAMERA_INSIDE, FOREIGN_ACROSS, FOREIGN_COINCIDENT, FOREIGN_INSIDE, LIGHT_INSIDE
from .own_mesh import before_changing

NEAR = 1e-4
"""Distance by which to move what touches something else, in diagonals of its box."""


ASIDE = np.array([0.61, 0.55, 0.57])
"""A way along which no surface is likely to lie."""


def foreign_findings(inspection: Inspection) -> Iterator[Finding]:
    """Yield media whose faces lie in the same place as those of what is no medium, of which a ray meets either.

    Then what is no medium and stands in one, or crosses its surface: a note for each object.
    """
    media = inspection.media
    if not media:
        return
    low, high = np.array([medium.place.box for medium in media]).swapaxes(0, 1)
    margin = NEAR * np.linalg.norm(high - low, axis=1)[:, None]
    resting: dict[int, dict[str, np.ndarray]] = {}
    notes: dict[bpy.types.Object, Finding] = {}
    for foreign in inspection.foreign(low - margin, high + margin):
        meets = (low - margin <= foreign.box[1]) & (high + margin >= foreign.box[0])
        near = np.flatnonzero(meets.all(axis=1))
        found = resting_surfaces([media[index].place for index in near], Solid(foreign.vertices, foreign.triangles))
        for index, faces in found.items():
            resting.setdefault(int(near[index]), {})[foreign.obj.name] = faces
        if foreign.obj not in notes:
            # Of what lies on a surface rounding decides on which side it is.
            note = _place_of(foreign, [media[index] for number, index in enumerate(near) if number not in found])
            if note is not None:
                notes[foreign.obj] = note
    yield from (_resting_finding(inspection, index, others) for index, others in sorted(resting.items()))
    yield from notes.values()


def _resting_finding(inspection: Inspection, index: int, others: dict[str, np.ndarray]) -> Finding:
    """Return what is wrong with a medium that lies on foreign objects.

    :param others: its triangles that lie on each, by name.
    """
    medium, names = inspection.media[index], tuple(others)
    box = medium.place.box
    distance = NEAR * float(np.linalg.norm(np.subtract(*box))) + ROUNDED_SEPARATION * float(np.abs(box).max())
    is_one = sum(other.obj == medium.obj for other in inspection.media) == 1
    can_move = is_one and medium.obj.is_editable and not before_changing(medium.obj)
    return Finding(
        FOREIGN_COINCIDENT,
        medium.obj.name,
        f"has faces in the same place as {listed(names)}, which is no medium",
        f"move them {distance:.2g} apart, which leaves air between them, or let them overlap as much, which leaves none",
        names,
        medium.at(np.concatenate(list(others.values()))),
        Fix(Action.MOVE_APART, (medium.obj.name, *names), distance) if can_move else None,
    )


def _place_of(foreign: Shape, near: list[Medium]) -> Finding | None:
    """Return whether an object that is no medium stands in media or crosses their surfaces."""
    points = sample_points(foreign)
    holders, crossed = [], []
    where = None
    for medium in near:
        # What only touches a surface may lie on either side of it by rounding.
        aside = NEAR * float(np.linalg.norm(np.subtract(*medium.place.box))) * ASIDE
        within = _held(medium, points + aside) & _held(medium, points - aside)
        if within.all():
            holders.append(medium)
        elif within.any():
            crossed.append(medium)
        if where is None and within.any():
            where = points[np.argmax(within)]
    if crossed:
        names = tuple(dict.fromkeys(medium.obj.name for medium in crossed))
        text = f"crosses the surface of {listed(names)}, whose inside ends at it"
        remedy = "nothing to do if that is meant; else move it out"
        return _note(FOREIGN_ACROSS, foreign.obj.name, text, remedy, names, where)
    if holders:
        winner = min(holders, key=lambda medium: medium.body.priority)
        text, remedy = f"stands inside {winner.obj.name!r}", "nothing to do if that is meant; else move it out"
        return _note(FOREIGN_INSIDE, foreign.obj.name, text, remedy, (winner.obj.name,), where)
    return None


def view_findings(inspection: Inspection) -> Iterator[Finding]:
    """Yield the camera and lights that are inside a medium."""
    camera = inspection.scene.camera
    rows: list[tuple[Kind, bpy.types.Object, str, str]] = []
    if camera is not None:
        rows.append((CAMERA_INSIDE, camera, "looks from inside", "nothing to do if that is meant; else move it out"))
    for light in scene_lights(inspection.scene):
        if light.data.type != "SUN" and not light.hide_render:
            remedy = "nothing to do if that is meant; else move it out"
            rows.append((LIGHT_INSIDE, light, "shines from inside", remedy))
    if not rows:
        return
    places = (obj.evaluated_get(inspection.depsgraph).matrix_world.translation for _, obj, *_ in rows)
    points = np.array([tuple(place) for place in places], dtype=np.float64)
    holders: dict[int, Medium] = {}
    for medium in inspection.media:
        for index in np.flatnonzero(_held(medium, points)).tolist():
            best = holders.get(index, medium)
            holders[index] = min(best, medium, key=lambda each: each.body.priority)
    for index, medium in sorted(holders.items()):
        kind, obj, does, remedy = rows[index]
        yield _note(kind, obj.name, f"{does} {medium.obj.name!r}", remedy, (medium.obj.name,), points[index])


def _held(medium: Medium, points: np.ndarray) -> np.ndarray:
    """Return which of (n, 3) points in the world a medium holds, (n,)."""
    low, high = medium.place.box
    within = ((points >= low) & (points <= high)).all(axis=1)
    if within.any():
        within[within] = winding_numbers(points[within], medium.place) >= 1
    return within


def _note(kind: Kind, name: str, text: str, remedy: str, others: tuple[str, ...], point: np.ndarray) -> Finding:
    return Finding(kind, name, text, remedy, others, Place(point=tuple(point.tolist())))
