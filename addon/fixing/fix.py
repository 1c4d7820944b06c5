"""Mending what a check has found: one finding, or all that is safe."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import bpy

from ..checking.check import check
from ..checking.finding import Action, Finding, Fix
from ..model.parameter import ParameterError
from ..nodes.compatibility import UnsupportedError
from .medium_fixes import mend_nodes, move_slot, remove_property, set_depth, set_priority, set_value
from .mesh_fixes import close_holes, fill_caps, recalculate_normals
from .place_fixes import hide_copies, move_apart, part_faces, push_into_wall
from .setting_fixes import prepare_scene, set_setting
from .transform_fixes import apply_transform, move_to_origin

ACTIONS: dict[Action, Callable[[bpy.types.Scene, Fix], list[str]]] = {
    Action.RECALCULATE_NORMALS: recalculate_normals,
    Action.CLOSE_HOLES: close_holes,
    Action.FILL_CAPS: fill_caps,
    Action.PUSH_INTO_WALL: push_into_wall,
    Action.PART_FACES: part_faces,
    Action.SET_PRIORITY: set_priority,
    Action.SET_SETTING: set_setting,
    Action.SET_DEPTH: set_depth,
    Action.SET_VALUE: set_value,
    Action.MERGE_COPIES: hide_copies,
    Action.APPLY_TRANSFORM: apply_transform,
    Action.MOVE_TO_ORIGIN: move_to_origin,
    Action.MOVE_APART: move_apart,
    Action.MEND_NODES: mend_nodes,
    Action.MOVE_SLOT: move_slot,
    Action.REMOVE_PROPERTY: remove_property,
    Action.PREPARE: prepare_scene,
}
"""What does each: it changes a scene by a fix and returns what was changed, in sentences. It changes nothing where it raises
:class:`ParameterError`.
"""

LEAST_NAMES = {
    Action.PUSH_INTO_WALL: 2,
    Action.MOVE_APART: 2,
    Action.SET_SETTING: 0,
    Action.MOVE_TO_ORIGIN: 0,
    Action.PREPARE: 0,
}
"""How many names a fix needs, where that is not one."""

ROUNDS = 8
"""How often a scene is looked at again: what is mended may show what else is wrong."""


@dataclass(frozen=True)
class Fixed:
    """What :func:`fix_all` did.

    :param changes: in sentences; left: what is still there, the worst first.
    """

    changes: tuple[str, ...] = ()
    left: tuple[Finding, ...] = ()

    def __str__(self) -> str:
        lines = [f"changed: {change}" for change in self.changes] or ["nothing to change"]
        return "\n".join([*lines, *(f"left: {finding}" for finding in self.left)])


def fix(scene: bpy.types.Scene, finding: Finding) -> list[str]:
    """Mend what a check has found in a scene; return what was changed, in sentences.

    :raises ParameterError: if it cannot be, with the reason and the remedy: the finding has no fix, the object is gone, linked
        or being edited. Nothing has been changed then.
    """
    wanted = finding.fix
    if wanted is None:
        raise ParameterError(f"{finding.name!r} {finding.text}: {finding.remedy}")
    if not scene.is_editable:
        raise ParameterError(f"Scene {scene.name!r} comes from another file; mend it there")
    if len(wanted.names) < LEAST_NAMES.get(wanted.action, 1):
        raise ParameterError(f"{wanted.action.value} does not say what to change; check the scene again")
    try:
        changes = ACTIONS[wanted.action](scene, wanted)
    except UnsupportedError as error:
        raise ParameterError(str(error)) from None
    scene.view_layers[0].update()
    return changes


def fix_all(scene: bpy.types.Scene) -> Fixed:
    """Mend all that can be without changing anything that may have been meant, until nothing of that is left.

    One change may end another's reason, so each thing is changed once before all is looked at again.
    """
    changes: list[str] = []
    findings = check(scene)
    for _ in range(ROUNDS):
        made = _fix_each_once(scene, findings)
        if not made:
            break
        changes += made
        findings = check(scene)
    return Fixed(tuple(changes), tuple(findings))


def _fix_each_once(scene: bpy.types.Scene, findings: list[Finding]) -> list[str]:
    """Mend of some findings those that are safe, but nothing that has just been changed; return what was changed."""
    changes: list[str] = []
    touched: set[tuple[str, str]] = set()
    for finding in findings:
        wanted = finding.fix
        if wanted is None or not wanted.safe:
            continue
        concerned = {(name, wanted.path) for name in wanted.names}
        if concerned & touched:
            continue
        try:
            made = fix(scene, finding)
        except ParameterError:
            continue  # it is among what is left
        if made:
            changes += made
            touched |= concerned
    return changes
