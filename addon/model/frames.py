"""Lists of frames and ranges of samples as they are typed, and the names of the files that frames go to."""

from __future__ import annotations

import re
from pathlib import Path

FIRST_FRAME, LAST_FRAME = -1048574, 1048574
"""The first and the last frame that Blender has."""

_PIECE = re.compile(r"(-?\d{1,9})(?:-(-?\d{1,9})(?::(\d{1,9}))?)?", re.ASCII)
_RANGE = re.compile(r"(\d{1,9}):(\d{1,9})", re.ASCII)
_COUNT = re.compile(r"\d{1,9}", re.ASCII)
_RUN = re.compile(r"#+(?=[^#]*$)")
"""The last run of ``#`` in a name, which Blender takes, too."""


def parse_frames(text: str) -> tuple[int, ...]:
    """Return the frames of a list such as ``1-100,120,200-240:2``, each once, in their order there.

    A range holds its last frame if its steps meet it; frames may be negative, as in ``-5--1``.

    :raises ValueError: naming the piece that is none.
    """
    frames: dict[int, None] = {}
    for piece in text.split(","):
        frames.update(dict.fromkeys(_parse_piece(piece.strip())))
    return tuple(frames)


def _parse_piece(piece: str) -> range:
    match = _PIECE.fullmatch(piece)
    if match is None:
        raise ValueError(f"{piece!r} is no frame and no range of frames, such as 12, 1-100 or 1-100:2")
    first, last, step = match.groups()
    begin, end, stride = int(first), int(last or first), int(step or 1)
    for frame in (begin, end):
        if not FIRST_FRAME <= frame <= LAST_FRAME:
            raise ValueError(f"{piece!r}: frames must be {FIRST_FRAME} to {LAST_FRAME}")
    if end < begin:
        raise ValueError(f"{piece!r} ends before it begins; write {end}-{begin}")
    if stride < 1:
        raise ValueError(f"{piece!r}: the step must be 1 or more")
    return range(begin, end + 1, stride)


def list_frames(frames: tuple[int, ...]) -> str:
    """Return frames as a list that :func:`parse_frames` reads: runs that count up by one are ranges."""
    runs: list[list[int]] = []
    for frame in frames:
        if runs and frame == runs[-1][-1] + 1:
            runs[-1][1:] = [frame]
        else:
            runs.append([frame])
    return ",".join("-".join(map(str, run)) for run in runs)


def parse_samples(text: str) -> int | range:
    """Return a number of samples, or of ``A:B`` the samples from A up to B, which is left out.

    :raises ValueError: for anything else, a number below 1, or a range that holds none.
    """
    ends = _RANGE.fullmatch(text)
    if ends is not None:
        begin, end = map(int, ends.groups())
        if begin >= end:
            raise ValueError(f"{text!r} holds no samples; A:B holds those from A up to B, and B must be the larger one")
        return range(begin, end)
    if _COUNT.fullmatch(text) is None:
        raise ValueError(f"{text!r} is no number of samples and no range such as 0:128")
    if int(text) < 1:
        raise ValueError(f"{text} is not a positive number")
    return int(text)


def has_number(path: Path) -> bool:
    """Return whether the name of a file has a place for the number of a frame: a run of ``#``."""
    return "#" in path.name


def path_of_frame(path: Path, frame: int) -> Path:
    """Return the file of a frame: the last run of ``#`` in the name becomes the frame, with as many digits at least."""

    def number(run: re.Match) -> str:
        return f"{'-' * (frame < 0)}{abs(frame):0{len(run[0])}d}"

    return path.parent / _RUN.sub(number, path.name)
