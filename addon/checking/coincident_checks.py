"""Checks of media with faces in the same place: what can be parted, how, and what stands in the way."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import bpy
import numpy as np

from ..analysis.findings import listed
from ..geometry.coincident_faces import Move, plan_moves
from ..geometry.contacts import Contact
from ..geometry.solids import Body
from .finding import Action, Finding, Fix
from .inspection import Inspection, Medium
from .kinds import COINCIDENT, DUPLICATE
from .own_mesh import before_changing
from .signatures import medium_signature


@dataclass(frozen=True, eq=False)
class Parting:
    """Faces of a medium that are to be moved off those of others in the same place.

    :param index: of the medium among those that were looked at; others: names of those that it is parted from.
    :param remedy: what to do before; empty where they can be moved.
    """

    index: int
    move: Move
    others: tuple[str, ...]
    remedy: str

    @property
    def distance(self) -> float:
        """Return the largest distance by which a face is to rise or sink, scene units."""
        return self.move.unit * float(np.abs(self.move.heights).max())


def partings(
    rows: Sequence[tuple[bpy.types.Object, Body]], found: Sequence[Contact], rims: bool = False
) -> list[Parting]:
    """Return how to part media whose faces lie in the same place, but for instances of one object.

    :param found: the contacts of each; rims: as in :func:`~nested_dielectric.geometry.coincident_faces.plan_moves`.
    """
    between = [
        replace(contact, coincident=tuple(each for each in contact.coincident if rows[each[0]][0] != obj))
        for (obj, _), contact in zip(rows, found)
    ]
    result = []
    for index, move in plan_moves([body for _, body in rows], between, rims).items():
        others = dict.fromkeys(rows[other][0].name for other in move.others)
        result.append(Parting(index, move, tuple(others), _remedy(rows[index][0], move)))
    return result


def _remedy(obj: bpy.types.Object, move: Move) -> str:
    """Return what to do before faces can be moved; nothing where the points of the mesh are those of the evaluated one."""
    if move.wall:
        thin = f"the wall there thicker than {move.least:.2g}, which is {move.wall:.2g}"
        return f"let them overlap, or make {thin}: then they are parted"
    first = before_changing(obj)
    return f"let them overlap, or {', '.join(first)}: then they are parted" if first else ""


def coincident_findings(inspection: Inspection) -> Iterator[Finding]:
    """Yield copies in the same place, and media with faces in the same place as others."""
    media, found = inspection.media, inspection.contacts
    if not any(contact.coincident for contact in found):
        return
    copies = {
        (index, entry[0])
        for index, contact in enumerate(found)
        for entry in contact.coincident
        if _is_copy(media[index], media[entry[0]], entry)
    }
    yield from _copy_findings(media, copies)
    found = [
        replace(contact, coincident=tuple(each for each in contact.coincident if (index, each[0]) not in copies))
        for index, contact in enumerate(found)
    ]
    yield from _instance_findings(media, found)
    rows = [(medium.obj, medium.body) for medium in media]
    seen = set()
    for parting in partings(rows, found):
        medium = media[parting.index]
        if (medium.obj, parting.others) in seen:
            continue
        seen.add((medium.obj, parting.others))
        triangles = np.concatenate(
            [each[1] for each in found[parting.index].coincident if each[0] in parting.move.others]
        )
        yield Finding(
            COINCIDENT,
            medium.obj.name,
            f"has faces in the same place as {listed(parting.others)}",
            parting.remedy or f"prepare the scene, which parts them by {parting.distance:.2g}, or let them overlap",
            parting.others,
            medium.at(triangles),
            None if parting.remedy else Fix(Action.PART_FACES, (medium.obj.name, *parting.others)),
        )


def _is_copy(one: Medium, other: Medium, entry: tuple[int, np.ndarray, np.ndarray, np.ndarray]) -> bool:
    """Return whether a medium is the same mesh in the same place as another, filled with the same.

    :param entry: the faces that they share, as in :class:`~nested_dielectric.geometry.contacts.Contact`.
    """
    _, faces, signs, whole = entry
    return (
        one.body.solid is other.body.solid
        and len(faces) == len(one.body.solid.triangles)
        and bool((signs > 0).all() and whole.all())
        and medium_signature(one.obj) == medium_signature(other.obj)
    )


def _copy_findings(media: Sequence[Medium], copies: set[tuple[int, int]]) -> Iterator[Finding]:
    """Yield all of several copies in one place but the first by name."""
    first: dict[int, int] = {}
    for one, other in copies:
        best = min((one, other, first.get(one, one)), key=lambda index: (media[index].obj.name, index))
        first[one] = best
    named = set()
    for index, original in sorted(first.items()):
        obj, name = media[index].obj, media[original].obj.name
        if index == original or obj in named:
            continue
        named.add(obj)
        place = media[index].at(np.arange(1))
        if obj.name == name:
            text, remedy = "is shown twice in the same place by instances", "remove one of what instances it there"
            yield Finding(DUPLICATE, name, text, remedy, place=replace(place, faces=()))
            continue
        yield Finding(
            DUPLICATE,
            obj.name,
            f"lies in exactly the same place as {name!r}, with the same mesh and medium",
            "delete it (Object > Delete), or move it to its place",
            (name,),
            replace(place, faces=()),
            Fix(Action.MERGE_COPIES, (obj.name,), safe=False),
        )


def _instance_findings(media: Sequence[Medium], found: Sequence[Contact]) -> Iterator[Finding]:
    """Yield objects of which instances have faces in the same place as each other."""
    seen = set()
    for medium, contact in zip(media, found):
        alike = [faces for other, faces, *_ in contact.coincident if media[other].obj == medium.obj]
        if alike and medium.obj not in seen:
            seen.add(medium.obj)
            text = "has instances with faces in the same place, which would all move alike"
            place = medium.at(np.concatenate(alike))
            yield Finding(COINCIDENT, medium.obj.name, text, "let them overlap", place=place)
