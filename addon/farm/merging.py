"""Parts of a picture, each with a range of its samples, put together to the picture."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import bpy
import numpy as np

from ..model.files import WriteError, absolute, replacing
from ..model.frames import parse_samples
from ..scene.output import check_picture, picture_files
from ..scene.sample_ranges import SAMPLES, tell_samples
from .layered_files import LayeredFileError, opened, read_rows, write
from .merged_denoising import DENOISED, denoise
from .merged_passes import mend, plan

_SAME = ("Scene", "Frame", "Camera")
"""What parts of one picture have in common, where Blender is set to write it; files lie elsewhere on each machine."""


class MergeError(RuntimeError):
    """Files that are no parts of one picture."""


@dataclass(frozen=True)
class Part:
    """A file with some of a picture's samples."""

    path: Path
    samples: range
    size: tuple[int, int]
    """Width and height in pixels."""
    channels: tuple[str, ...]
    told: dict[str, str]
    """What it says of the picture."""
    denoised: bool = False


def merge(
    paths: Sequence[Path], output: Path, denoised: tuple[bpy.types.Scene, bpy.types.ViewLayer] | None = None
) -> range:
    """Merge parts of a picture and return the samples that it then has. What was there stays until the new file is whole.

    :param denoised: a scene and a layer whose settings denoise the picture; the parts hold what that needs.
    :raises MergeError: for files that are no parts of one picture, before anything is written.
    :raises LayeredFileError: for a part that is not whole.
    :raises WriteError: if the picture cannot be written, or not whole.
    """
    if output.suffix.lower() != ".exr":
        raise MergeError(f"{output}: the ending must be .exr")
    require_apart(paths, output)
    parts = sorted(map(_part, paths), key=lambda part: part.samples.start)
    _require_one_picture(parts)
    samples = range(parts[0].samples.start, parts[-1].samples.stop)
    with replacing(output) as draft:
        _merge(parts, draft, output)
        tell_samples(draft, output, samples)
        if denoised is not None:
            denoise(draft, *denoised)
        check_picture(draft, output, parts[0].size, len(parts[0].channels))
    return samples


def require_apart(paths: Sequence[Path], output: Path) -> None:
    """Make sure that no part lies where the picture is to go.

    :raises MergeError: if one does.
    """
    if absolute(output) in map(absolute, paths):
        raise MergeError(f"{output}: is one of the parts, which would be lost; name another file")


def is_merged(paths: Sequence[Path], output: Path) -> bool:
    """Return whether a file is a whole picture that holds the samples of those parts that are still there."""
    if not output.is_file():
        return False
    try:
        check_picture(output, output)
        whole = _part(output)
        return all(_holds(whole, _part(path)) for path in paths if path.is_file())
    except (LayeredFileError, MergeError, WriteError):
        return False


def _holds(whole: Part, part: Part) -> bool:
    return (
        (whole.size, set(whole.channels)) == (part.size, set(part.channels))
        and all(whole.told[key] == part.told[key] for key in whole.told.keys() & part.told.keys())
        and whole.samples.start <= part.samples.start < part.samples.stop <= whole.samples.stop
    )


def _part(path: Path) -> Part:
    """Return what a file says of itself.

    :raises MergeError: if it is no part of a picture.
    """
    if not path.is_file():
        raise MergeError(f"{path}: no such file; render that part again")
    with opened(path) as picture:
        spec = picture.spec()
        told = {each.name: str(each.value) for each in spec.extra_attribs}
        found = spec.width, spec.height, tuple(spec.channelnames)
    if not re.fullmatch(r"\d+:\d+", told.get(SAMPLES, "")):
        raise MergeError(f"{path}: says not which samples it holds; render it with --samples A:B")
    same = {key: told[key] for key in _SAME if key in told}
    return Part(path, parse_samples(told[SAMPLES]), found[:2], found[2], same, DENOISED in told)


def _require_one_picture(parts: Sequence[Part]) -> None:
    """Make sure that parts, in their order, are those of one picture, each once, and none between them is missing.

    :raises MergeError: naming the part that is not.
    """
    if len(parts) < 2:
        raise MergeError("there is nothing to merge; name two parts at least")
    first = parts[0]
    for part in parts:
        if part.denoised:
            raise MergeError(
                f"{part.path}: is denoised, so that nothing can be added to it; merge its parts and all others at once"
            )
    for part in parts[1:]:
        if part.size != first.size:
            text = " and ".join(f"{width} x {height}" for width, height in (first.size, part.size))
            raise MergeError(f"{part.path}: is of another size than {first.path} ({text})")
        if set(part.channels) != set(first.channels):
            missing = sorted(set(part.channels) ^ set(first.channels))
            raise MergeError(f"{part.path}: has other passes than {first.path} ({', '.join(missing[:4])})")
        for key in part.told.keys() & first.told.keys():
            if part.told[key] != first.told[key]:
                text = f"{key.lower()} {first.told[key]} and {part.told[key]}"
                raise MergeError(f"{part.path}: is no part of the same picture as {first.path} ({text})")
    for earlier, later in pairwise(parts):
        if later.samples.start < earlier.samples.stop:
            raise MergeError(f"{later.path}: holds samples that {earlier.path} holds, too; name each part once")
        if later.samples.start > earlier.samples.stop:
            gap = f"{earlier.samples.stop}:{later.samples.start}"
            raise MergeError(f"samples {gap} are missing, between {earlier.path} and {later.path}; render them")


def _merge(parts: Sequence[Part], draft: Path, output: Path) -> None:
    """Let Cycles merge parts, and mend what it merges wrongly.

    :raises MergeError: if it cannot.
    """
    import _cycles

    try:
        _cycles.merge(input=[str(absolute(part.path)) for part in parts], output=str(draft))
    except Exception as error:  # of whatever kind Cycles' is
        raise MergeError(f"{output}: cannot be merged ({error}); render what cannot be read again") from None
    check_picture(draft, output)  # Cycles says nothing of a full disk
    with opened(draft) as merged:
        names = tuple(merged.spec().channelnames)
    if plan(names):
        _mend(parts, draft, names)


def _mend(parts: Sequence[Part], draft: Path, names: tuple[str, ...]) -> None:
    """Write a merged file anew with its passes mended."""
    oiio = picture_files()
    channels = plan(names)
    total = sum(len(part.samples) for part in parts)
    shares = [len(part.samples) / total for part in parts]
    orders = [[part.channels.index(name) for name in names] for part in parts]
    mended = draft.with_name(f"{draft.stem}_mended.exr")
    with ExitStack() as stack:
        merged = stack.enter_context(opened(draft))
        pictures = [stack.enter_context(opened(part.path)) for part in parts]

        def rows(begin: int, end: int) -> np.ndarray:
            band = read_rows(merged, begin, end)
            mend(
                channels,
                band,
                [read_rows(each, begin, end)[..., order] for each, order in zip(pictures, orders)],
                shares,
            )
            return band

        write(mended, oiio.ImageSpec(merged.spec()), rows)
    mended.replace(draft)
