"""How far a render has come: what Cycles says of it, and lines that show it."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import bpy

_SAMPLE = re.compile(r"Sample (\d+)/(\d+)")


@contextmanager
def reporting_samples(progress: Callable[[int, int], None] | None) -> Iterator[None]:
    """Let renders call a function with the samples done and to do."""

    def report(stats: object, *_: object) -> None:
        match = _SAMPLE.search(str(stats))
        if match and progress is not None:
            progress(int(match[1]), int(match[2]))

    bpy.app.handlers.render_stats.append(report)
    try:
        yield
    finally:
        bpy.app.handlers.render_stats.remove(report)


class ProgressLine:
    """Prints progress: one line that is written over on a terminal, a line every tenth of the way elsewhere."""

    def __init__(self, stream=None) -> None:
        self.stream = stream or sys.stderr
        self.last = -1

    def __call__(self, done: int, total: int) -> None:
        tenth = 10 * done // max(total, 1)
        if self.stream.isatty():
            print(
                f"\rrendering: {done} of {total} samples",
                end="\n" if done == total else "",
                file=self.stream,
                flush=True,
            )
        elif tenth > self.last:
            print(f"rendering: {done} of {total} samples", file=self.stream, flush=True)
        self.last = tenth
