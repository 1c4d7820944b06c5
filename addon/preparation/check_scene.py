"""Checking a scene, and keeping with it what was found: what it renders stays as it is."""

from __future__ import annotations

import bpy

from ..checking.check import check
from ..checking.finding import Finding, severe
from ..checking.kinds import MUST_ASK, NATIVE_LIMIT, SPECTRAL_TABLE
from ..scene.media import media
from .report import keep_findings, last_report

ONLY_PREPARING_FINDS = (MUST_ASK, NATIVE_LIMIT, SPECTRAL_TABLE)
"""Kinds of findings that no check looks for."""


def check_and_keep(scene: bpy.types.Scene) -> list[Finding]:
    """Check a scene, and keep what was found for its panel; return it, the worst first.

    What only a preparation finds stays as the last one said.
    """
    report = last_report(scene)
    found = check(scene)
    if report is not None:
        found = severe(found + [each for each in report.problems if each.kind in ONLY_PREPARING_FINDS])
    keep_findings(scene, len(media(scene)), found)
    return found
