"""``check``: what is wrong with a file, and what mends it."""

from __future__ import annotations

import argparse
from typing import Any

import bpy

from ..checking.check import check
from ..checking.finding import Finding, to_json
from ..checking.listing import STRICT, WRONG, in_lines, is_refused
from ..fixing.fix import fix_all
from ..model.files import require_place
from ..scene.output import save_blend
from .shared import FOUND, AddParser, Failure, add_file, add_json, add_scene, blend_name, json_report, open_file

CHECK_SCHEMA = 1
"""Version of the JSON that ``check`` writes; it is counted on when a key changes its meaning or goes."""


def add_command(add_parser: AddParser) -> None:
    check = add_parser("check", help="say what is wrong with the media of a .blend, where, and what would mend it")
    add_file(check)
    add_scene(check, "all")
    check.add_argument("--strict", action="store_true", help="take what is slow for wrong, too")
    check.add_argument("--fix", action="store_true", help="mend what can be mended safely, and save that as OUT.blend")
    check.add_argument("-o", "--output", type=blend_name, metavar="OUT.blend", help="file to write, with --fix")
    add_json(check)
    check.set_defaults(run=_run)


def _run(options: argparse.Namespace) -> int:
    """Say what is wrong with the media of all scenes of a file, or of one, and with ``--fix`` mend what is safe and save it.

    :returns: 0, or :data:`FOUND` where pictures would be wrong; with ``--strict`` also where they would be slow.
    """
    with json_report(options, CHECK_SCHEMA) as report:
        report |= {"saved": None, "scenes": []}
        if options.fix and options.output is None:
            raise Failure("--fix needs a file to write: name it with --output")
        if options.fix:
            require_place(options.output)
        opened = open_file(options.file, options.scene)
        scenes = list(bpy.data.scenes) if options.scene is None else [opened]
        changes = {scene.name: list(fix_all(scene).changes) if options.fix else [] for scene in scenes}
        findings = {scene.name: check(scene) for scene in scenes}
        saved = save_blend(options.output) if options.fix else None
        report |= {"saved": None if saved is None else str(saved), "scenes": _as_json(findings, changes)}
        for name, found in findings.items():
            print("\n".join(in_lines(name, found, changes[name])))
        if saved:
            print(f"wrote {saved}")
    level = STRICT if options.strict else WRONG
    return FOUND if any(is_refused(found, level) for found in findings.values()) else 0


def _as_json(findings: dict[str, list[Finding]], changes: dict[str, list[str]]) -> list[dict[str, Any]]:
    """Return what ``check`` has found in each scene as JSON."""
    return [
        {"scene": name, "findings": list(map(to_json, found)), "changes": changes[name]}
        for name, found in findings.items()
    ]
