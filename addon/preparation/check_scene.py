"""Checking a scene, and keeping with it what was found: what it renders stays as it is."""

from __future__ import annotations

import bpy

from ..checking.check import check
from ..checking.finding import Finding, severe
from ..checking.kinds import SPECTRAL_TABLE
from ..scene.media import media
from .report import keep_findings, last_report


def check_and_keep(scene: bpy.types.Scene) -> list[Finding]:
    """Check a scene, and keep what was found for its panel; return it, the worst first."""
    return keep(scene, check(scene))


def keep(scene: bpy.types.Scene, found: list[Finding]) -> list[Finding]:
    """Keep what a check of a scene has just found for its panel; return what is kept, the worst first.

    Spectral tables that could not be baked stay as the last preparation said.
    """
    report = last_report(scene)
    if report is not None:
        found = severe(found + [each for each in report.problems if each.kind == SPECTRAL_TABLE])
    keep_findings(scene, len(media(scene)), found)
    return found
