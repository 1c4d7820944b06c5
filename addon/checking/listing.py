"""What a check has found, as lines of text; and whether it is too bad to go on."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from .finding import Finding
from .kinds import Severity

WRONG, STRICT = "wrong", "strict"
"""How strict a check is: it takes what would show a wrong picture for wrong, or also what is slow."""

_COUNT = {WRONG: {Severity.WRONG}, STRICT: {Severity.WRONG, Severity.SLOW}}


def is_refused(found: Iterable[Finding], level: str | None) -> bool:
    """Return whether any finding counts for a check of a level, :data:`WRONG` or :data:`STRICT`; for None none does."""
    return any(finding.severity in _COUNT.get(level, ()) for finding in found)


def in_lines(scene: str, found: Sequence[Finding], changes: Iterable[str] = ()) -> list[str]:
    """Return what a check has found in a scene, and what was changed before, as lines of text."""
    lines = [f"{scene}: {_headline(found)}", *(f"changed: {change}" for change in changes)]
    for finding in found:
        lines += [f"{finding.severity}: {finding}", f"  shows: {finding.shows}"]
        if finding.place.point is not None:
            lines.append("  at: " + ", ".join(f"{x:.6g}" for x in finding.place.point))
    return lines


def _headline(found: Sequence[Finding]) -> str:
    """Return in one line how much of each severity was found."""
    counts = {severity: sum(finding.severity == severity for finding in found) for severity in Severity}
    return ", ".join(f"{count} {severity}" for severity, count in counts.items() if count) or "nothing is wrong"
