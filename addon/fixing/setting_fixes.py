"""Fixes of settings and of a scene as a whole."""

from __future__ import annotations

import bpy

from ..checking.finding import Fix
from ..model.parameter import ParameterError
from ..preparation.prepare_scene import prepare
from ..preparation.report import keep_settings, last_report
from ..scene import settings


def set_setting(scene: bpy.types.Scene, fix: Fix) -> list[str]:
    """Give a setting a value, and remember what it was, so that *Put Back* takes it back."""
    _require_setting(scene, fix.path)
    report = last_report(scene)
    changed = dict(report.settings) if report is not None else {}
    try:
        changes = settings.change(scene, changed, fix.path, fix.value)
    except (TypeError, ValueError) as error:
        name = settings.label(scene, fix.path)
        raise ParameterError(f"{name} cannot be {fix.value!r}: {str(error).strip()}") from None
    if changes:
        keep_settings(scene, changed)
    return changes


def _require_setting(scene: bpy.types.Scene, path: str) -> None:
    """Hold a path to a switch, a number or a choice of how a scene renders: it may come from a file.

    :raises ParameterError: if it is none.
    """
    owner, _, name = path.rpartition(".")
    known = scene.path_resolve(owner).bl_rna.properties if owner in ("render", "cycles") else {}
    if path != settings.SHUTTER_CURVE and (name not in known or known[name].type not in _KINDS):
        raise ParameterError(f"{path!r} is no setting of how a scene renders; check the scene again")


_KINDS = ("BOOLEAN", "INT", "FLOAT", "ENUM")


def prepare_scene(scene: bpy.types.Scene, _: Fix) -> list[str]:
    """Prepare a scene."""
    return list(prepare(scene).changes)
