"""Mending what stands in a scene's panel, which may be older than the scene."""

from __future__ import annotations

import bpy

from ..checking.check import check
from ..checking.finding import Action, Finding
from ..checking.kinds import SPECTRAL_TABLE


def as_it_is_now(scene: bpy.types.Scene, kept: Finding) -> Finding | None:
    """Return a finding as a check finds it now, which may mend it no more; None if it is there no more.

    What only preparing finds is as it was kept.
    """
    if kept.kind == SPECTRAL_TABLE:
        return kept
    found = [each for each in check(scene) if (each.kind, each.objects) == (kept.kind, kept.objects)]
    return next(
        (each for each in found if _way(each) == _way(kept)), next((each for each in found if each.fix is None), None)
    )


def _way(finding: Finding) -> tuple[Action, str] | None:
    """Return how a finding would be mended, whatever numbers that takes."""
    return None if finding.fix is None else (finding.fix.action, finding.fix.path)
