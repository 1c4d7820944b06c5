"""How far a render has come: what Cycles says of it, and lines that show it."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import TextIO

import bpy

from ..model.time_left import in_words, time_left

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
    """Shows how far renders have come, on the standard error output.

    On a terminal that is one line that is written over. Elsewhere it is a line every tenth of the way of a single picture, and
    nothing of one of several, as the caller prints a line for each.

    :param frames: how many pictures there will be.
    """

    def __init__(self, frames: int = 1, stream: TextIO | None = None) -> None:
        self.stream = stream or sys.stderr
        self.to_come = frames
        self.alone = frames == 1
        self.finished: list[float] = []
        self.width = 0
        self.begin("rendering")

    def begin(self, label: str) -> None:
        """Begin a picture, whose lines begin with a label."""
        self.label = label
        self.began = self.sampling_began = perf_counter()
        self.last = -1

    def __call__(self, done: int, total: int) -> None:
        """Show how many of the samples of the present picture are done."""
        now = perf_counter()
        if done == 0:
            self.sampling_began = now
        share = done / max(total, 1)
        begun, sampled = self.sampling_began - self.began, now - self.sampling_began
        left = time_left(self.finished, self.to_come - 1, begun, sampled, share)
        text = f"{self.label}: {done} of {total} samples"
        if left is not None and share < 1.0:
            text += f", {in_words(left)} left"
        if self.stream.isatty():
            # What Blender prints next then begins where the line does.
            print(f"\r{text.ljust(self.width)}", end="\r", file=self.stream, flush=True)
            self.width = len(text)
        elif self.alone and int(10 * share) > self.last:
            print(text, file=self.stream, flush=True)
        self.last = int(10 * share)

    def end(self) -> tuple[float, float]:
        """End a picture, and wipe the line off; return the seconds that it took, and those that are left of all."""
        self.clear()
        seconds = perf_counter() - self.began
        self.finished.append(seconds)
        self.to_come -= 1
        return seconds, time_left(self.finished, self.to_come) or 0.0

    def clear(self) -> None:
        """Wipe the line off."""
        if self.width:
            print(f"\r{' ' * self.width}", end="\r", file=self.stream, flush=True)
            self.width = 0
