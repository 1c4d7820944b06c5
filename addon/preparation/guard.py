"""The one place where errors of handlers, timers and drawing are caught, told to the artist and made harmless.

An error in a handler would reach nobody but a console, and leave what was being written half done. So the media of all scenes
ask from then on, which is always right; the panels say what happened; and the details are kept for a report.
"""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import wraps
from typing import Any

import bpy

from ..nodes.names import ANALYSED, FACTS_SCENE
from . import upkeep, windows

MOST_FAULTS = 20
"""Errors that are kept; they mostly repeat the first."""


@dataclass(frozen=True)
class Fault:
    """An error that was caught.

    :param when: what went on, such as "after a change"; error: what was raised, in one line; details: where.
    """

    when: str
    error: str
    details: str

    def __str__(self) -> str:
        return (
            f"an error {self.when} ({self.error}): nothing of yours is lost, and media ask the scene; press Prepare Scene, "
            "and report it if it comes back"
        )


_faults: dict[Fault, None] = {}


def faults() -> tuple[Fault, ...]:
    """Return the errors since the file was opened or a scene was prepared, the first one first."""
    return tuple(_faults)


def forget_faults() -> None:
    """Forget the errors that were caught."""
    _faults.clear()


def guarded(when: str, writes: bool = True) -> Callable[[Callable], Callable]:
    """Let a handler, a timer or a drawing function raise nothing: what it raises becomes a :class:`Fault`.

    :param when: what goes on then, in words.
    :param writes: it may have left what media are told half written, so they are to ask.
    """

    def decorate(function: Callable) -> Callable:
        @wraps(function)
        def safe(*arguments: Any) -> Any:
            try:
                return function(*arguments)
            except Exception as error:
                _note(when, error)
                if writes and windows.in_main_thread():
                    _let_media_ask()
                return None

        return safe

    return decorate


def _note(when: str, error: Exception) -> None:
    """Keep an error, and say so on the terminal the first time."""
    text = " ".join(f"{type(error).__name__}: {error}".split())
    fault = Fault(when, text, "".join(traceback.format_exception(error)))
    if fault in _faults or len(_faults) >= MOST_FAULTS:
        return
    _faults[fault] = None
    with suppress(OSError, ValueError, AttributeError):  # a Blender without a console
        print(f"Nested Dielectric: {fault.details if bpy.app.debug_python else fault}", file=sys.stderr)


def _let_media_ask() -> None:
    """Let the media of all scenes ask, whatever is wrong with what is kept of them."""
    for scene in upkeep.analysed_scenes():
        with suppress(Exception):
            upkeep.invalidate(scene)
            continue
        with suppress(Exception):
            for name in (ANALYSED, FACTS_SCENE):
                scene.pop(name, None)
    upkeep.forget_done()
