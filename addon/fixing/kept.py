"""Mending what stands in a scene's panel, which may be older than the scene."""

from __future__ import annotations

import bpy

from ..checking.check import check
from ..checking.finding import Finding
from ..checking.kinds import SPECTRAL_TABLE


def as_it_is_now(scene: bpy.types.Scene, kept: Finding) -> Finding | None:
    """Return a finding as a check finds it now; None if it is there no more. What only preparing finds is as it was kept."""
    if kept.kind == SPECTRAL_TABLE:
        return kept
    return next((each for each in check(scene) if _is_same(each, kept)), None)


def _is_same(one: Finding, other: Finding) -> bool:
    """Return whether two findings are of the same thing and mended the same way, whatever numbers they hold."""
    alike = (one.kind, one.objects, one.fix is None) == (other.kind, other.objects, other.fix is None)
    return alike and (one.fix is None or (one.fix.action, one.fix.path) == (other.fix.action, other.fix.path))
