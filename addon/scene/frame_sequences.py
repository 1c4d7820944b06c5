"""Rendering frames of a scene one after the other, each to a file of its own."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import bpy

from ..model.files import WriteError, absolute
from ..model.time_left import in_words
from .held_outputs import require_output_folders
from .progress import ProgressLine
from .rendering import check_whole, render_frame, require_picture, require_within


@dataclass(frozen=True)
class Frame:
    """A frame to render, None for the current one, and the file that it goes to."""

    number: int | None
    path: Path


class State(StrEnum):
    """What became of a frame."""

    WRITTEN = "written"
    SKIPPED = "skipped"
    FAILED = "failed"


@dataclass(frozen=True)
class Rendered:
    """What became of a frame that was to be rendered.

    :param number: of the frame; path: of its file, absolute.
    :param seconds: that it took; left: that those after it will take, as far as is known.
    :param reason: why it failed, in one line.
    """

    number: int
    path: Path
    state: State
    seconds: float = 0.0
    left: float = 0.0
    reason: str = ""


def require_frames(scene: bpy.types.Scene, frames: Sequence[Frame], samples: int | range | None) -> None:
    """Make sure that frames of a scene can be rendered, and that its compositor can write its files.

    :raises RenderError, WriteError: if not, as by :func:`render_frame`.
    """
    for frame in frames:
        require_within(scene, "frame_current", frame.number)
    require_picture(scene, frames[0].path, samples)
    require_output_folders(scene)


def is_there(scene: bpy.types.Scene, frame: Frame) -> bool:
    """Return whether a frame's picture is there, whole and of the size that a scene's have."""
    try:
        check_whole(scene, frame.path, frame.path)
    except (OSError, WriteError):
        return False
    return True


def number_of(scene: bpy.types.Scene, frame: Frame) -> int:
    """Return the number of a frame of a scene."""
    return scene.frame_current if frame.number is None else frame.number


def render_frames(
    scene: bpy.types.Scene,
    frames: Sequence[Frame],
    samples: int | range | None = None,
    progress: ProgressLine | None = None,
    numbered: bool = True,
) -> Iterator[Rendered]:
    """Render frames of a scene one after the other and yield what became of each; the first that fails is the last.

    The scene's frame is at the end what it was; else as :func:`render_frame` for each.
    """
    progress = progress or ProgressLine(len(frames))
    with ExitStack() as undo:
        undo.callback(scene.frame_set, scene.frame_current, subframe=scene.frame_subframe)
        for place, frame in enumerate(frames):
            number = number_of(scene, frame)
            progress.begin("rendering" if progress.alone else f"frame {number} ({place + 1} of {len(frames)})")
            try:
                if frame.number is not None:
                    scene.frame_set(frame.number)
                render_frame(scene, frame.path, samples, progress=progress, numbered=numbered)
            except (OSError, RuntimeError) as error:
                seconds, _ = progress.end()
                yield Rendered(number, absolute(frame.path), State.FAILED, seconds, reason=" ".join(str(error).split()))
                return
            yield Rendered(number, absolute(frame.path), State.WRITTEN, *progress.end())


def line_of(rendered: Rendered, place: int, frames: int) -> str:
    """Return the line that tells of a frame, one of several."""
    text = f"frame {rendered.number} ({place} of {frames}): {rendered.path}, {in_words(rendered.seconds)}"
    return f"{text}, {in_words(rendered.left)} left" if place < frames else text
