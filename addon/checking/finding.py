"""What a check has found, as all checks state it: kind, severity, objects, place, remedy, fix.

It is data alone, so that it can be kept with a scene, written as JSON, and mended by a room above this one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any

from .kinds import KINDS, Kind, Severity


class Action(StrEnum):
    """Ways to mend a scene; the value is what a button says."""

    RECALCULATE_NORMALS = "Recalculate Normals"
    CLOSE_HOLES = "Close Holes"
    FILL_CAPS = "Fill Caps"
    PUSH_INTO_WALL = "Push into Wall"
    PART_FACES = "Part Faces"
    SET_PRIORITY = "Set Priority"
    SET_SETTING = "Change Setting"
    SET_DEPTH = "Fit Depth"
    SET_VALUE = "Bound Value"
    MERGE_COPIES = "Remove Copy"
    APPLY_TRANSFORM = "Apply Scale"
    MOVE_TO_ORIGIN = "Move to Origin"
    MOVE_APART = "Move Apart"
    MEND_NODES = "Mend Nodes"
    MOVE_SLOT = "Move Slot"
    REMOVE_PROPERTY = "Remove Property"
    PREPARE = "Prepare Scene"


@dataclass(frozen=True)
class Fix:
    """What would mend a finding.

    :param names: of the objects, materials or scenes that it changes.
    :param value: what it needs beside: a distance in scene units, a priority, the value of a setting.
    :param path: of the setting, or name of the socket or property, that it changes.
    :param safe: it changes nothing that an artist may have meant, so it is done with all others at once.
    """

    action: Action
    names: tuple[str, ...]
    value: float | int | str | bool | None = None
    path: str = ""
    safe: bool = True


@dataclass(frozen=True)
class Place:
    """Where something is wrong.

    :param faces: indices of polygons of the object's evaluated mesh; of very many the first.
    :param point: in the world, scene units; None where the whole object, or the scene, is meant.
    """

    faces: tuple[int, ...] = ()
    point: tuple[float, float, float] | None = None


NOWHERE = Place()

MOST_FACES = 1000
"""The most faces that a place lists."""


@dataclass(frozen=True)
class Finding:
    """What is wrong with an object, a material, a view layer or a scene, and the remedy.

    :param kind: one of :data:`nested_dielectric.checking.kinds.KINDS`.
    :param name: of what it is about.
    :param text: the rest of a sentence that begins with the name.
    :param remedy: what to do about it, as a request.
    :param others: names of what else is concerned.
    :param fix: None where none is known that leaves all as it is meant.
    """

    kind: Kind
    name: str
    text: str
    remedy: str
    others: tuple[str, ...] = ()
    place: Place = NOWHERE
    fix: Fix | None = None

    @property
    def severity(self) -> Severity:
        """Return how bad it is."""
        return self.kind.severity

    @property
    def shows(self) -> str:
        """Return what the picture would show."""
        return self.kind.shows

    @property
    def objects(self) -> tuple[str, ...]:
        """Return the names of all that is concerned, the finding's own first."""
        return (self.name, *self.others)

    def __str__(self) -> str:
        return f"{self.name!r} {self.text}: {self.remedy}"


def to_json(finding: Finding) -> dict[str, Any]:
    """Return a finding in JSON's types; :func:`from_json` reads it."""
    fix = finding.fix
    return {
        "kind": finding.kind.key,
        "severity": finding.severity.value,
        "objects": list(finding.objects),
        "text": finding.text,
        "shows": finding.shows,
        "remedy": finding.remedy,
        "faces": list(finding.place.faces),
        "point": None if finding.place.point is None else list(finding.place.point),
        "fix": None if fix is None else asdict(fix) | {"action": fix.action.name, "names": list(fix.names)},
    }


def from_json(value: Mapping[str, Any]) -> Finding:
    """Return a finding from what :func:`to_json` made of it.

    :raises KeyError, TypeError, ValueError: if it is none.
    """
    name, *others = map(str, value["objects"])
    point, fix = value["point"], value["fix"]
    place = Place(tuple(map(int, value["faces"])), None if point is None else tuple(float(x) for x in point))
    if fix is not None:
        names = tuple(map(str, fix["names"]))
        fix = Fix(Action[fix["action"]], names, fix["value"], str(fix["path"]), bool(fix["safe"]))
    kind = KINDS[value["kind"]]
    return Finding(kind, name, str(value["text"]), str(value["remedy"]), tuple(others), place, fix)


def severe(findings: list[Finding]) -> list[Finding]:
    """Return findings with the worst first, else in their order."""
    order = list(Severity)
    return sorted(findings, key=lambda finding: order.index(finding.severity))
