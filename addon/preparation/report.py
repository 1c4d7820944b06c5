"""What *Prepare Scene* found and changed, kept with the scene until it is prepared again.

It is text in a custom property, so that it is saved, undone and copied with the scene; of very much only the beginning.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import bpy

from ..analysis.changes import REPORT_PROPERTY
from ..checking.finding import Finding, from_json, to_json
from ..checking.kinds import Severity
from ..scene.settings import AT_LEAST, LABELS, Changed

MOST_CHARACTERS = 4000
"""The most characters of problems, and of changes, that are kept."""


@dataclass(frozen=True)
class Report:
    """What a scene's last preparation found and changed.

    :param media: number of the scene's media then.
    :param problems: the first of what it left, problems before notes; more_problems, more_notes: how many more there were.
    :param changes: the first of its changes that stay, in sentences; more_changes: how many more there were.
    :param settings: render settings that it, or one before it, has changed.
    """

    media: int = 0
    problems: tuple[Finding, ...] = ()
    more_problems: int = 0
    more_notes: int = 0
    changes: tuple[str, ...] = ()
    more_changes: int = 0
    settings: Changed = field(default_factory=dict)


def keep_report(
    scene: bpy.types.Scene, media: int, problems: Sequence[Finding], changes: Sequence[str], settings: Changed
) -> None:
    """Keep what a preparation found and changed with its scene; nothing where there is nothing to say."""
    stayed = _first(changes)
    value = {"changes": stayed, "more_changes": len(changes) - len(stayed), "settings": settings}
    _keep(scene, _findings_value(media, problems) | value)


def keep_findings(scene: bpy.types.Scene, media: int, problems: Sequence[Finding]) -> None:
    """Keep what a check found with its scene; what preparations have changed stays as it is kept."""
    _keep(scene, _kept_value(scene) | _findings_value(media, problems))


def keep_settings(scene: bpy.types.Scene, settings: Changed) -> None:
    """Keep which render settings have been changed; all else stays as it is kept."""
    _keep(scene, _kept_value(scene) | {"settings": settings})


def _findings_value(media: int, problems: Sequence[Finding]) -> dict[str, Any]:
    """Return what is kept of findings, in JSON's types."""
    shown = _first(problems)
    left = problems[len(shown) :]
    notes = sum(finding.severity == Severity.NOTE for finding in left)
    return {
        "media": media,
        "problems": [_in_short(finding) for finding in shown],
        "more_problems": len(left) - notes,
        "more_notes": notes,
    }


def _kept_value(scene: bpy.types.Scene) -> dict[str, Any]:
    """Return what is kept with a scene, in JSON's types; of a report that cannot be read, nothing."""
    return json.loads(scene[REPORT_PROPERTY]) if last_report(scene) is not None else dict(_NOTHING)


_NOTHING = {
    "media": 0,
    "problems": [],
    "more_problems": 0,
    "more_notes": 0,
    "changes": [],
    "more_changes": 0,
    "settings": {},
}


def _keep(scene: bpy.types.Scene, value: dict[str, Any]) -> None:
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"))
    if not any(value.values()):
        forget_report(scene)
    elif scene.get(REPORT_PROPERTY) != text:
        scene[REPORT_PROPERTY] = text


KEPT_FACES = 16
"""The most faces of a finding that are kept."""


def _in_short(finding: Finding) -> dict[str, Any]:
    """Return a finding in JSON's types with the first of its faces, without what its kind says."""
    place = replace(finding.place, faces=finding.place.faces[:KEPT_FACES])
    value = to_json(replace(finding, place=place))
    return {key: each for key, each in value.items() if key not in ("severity", "shows")}


def _first(items: Sequence) -> list:
    """Return as many of the first items as may be kept."""
    room = MOST_CHARACTERS
    kept = []
    for item in items:
        room -= len(str(item))
        if room < 0:
            break
        kept.append(item)
    return kept


def last_report(scene: bpy.types.Scene) -> Report | None:
    """Return what the last preparation of a scene said; None if there was none, or its text is not one of ours."""
    try:
        value = json.loads(scene[REPORT_PROPERTY])
        return Report(
            int(value["media"]),
            tuple(map(from_json, value["problems"])),
            int(value["more_problems"]),
            int(value.get("more_notes", 0)),
            tuple(map(str, value["changes"])),
            int(value["more_changes"]),
            {path: tuple(pair) for path, pair in value["settings"].items() if path in LABELS or path in AT_LEAST},
        )
    except (KeyError, TypeError, ValueError, AttributeError):
        return None


def forget_report(scene: bpy.types.Scene) -> None:
    """Remove what is kept with a scene."""
    scene.pop(REPORT_PROPERTY, None)
