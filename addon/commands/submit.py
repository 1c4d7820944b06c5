"""``submit``: a file as a job of the Open Job Description."""

from __future__ import annotations

import argparse
from itertools import pairwise
from pathlib import Path

import bpy

from ..farm.job import NotPacked, write_job
from ..farm.job_template import CHECKS, Job
from ..model.files import absolute
from ..model.frames import has_number, list_frames, parse_frames
from ..scene.devices import DEVICES
from ..scene.image_formats import FILE_FORMATS, file_format_of
from ..scene.rendering import require_picture
from ..scene.sample_ranges import denoised_layers
from .render_options import add_view, require_device, view_of
from .shared import (
    FOUND,
    AddParser,
    Failure,
    add_backend,
    add_file,
    file_name,
    open_file,
    parsed,
    positive,
)

_FORWARDED = ("camera", "view_layer", "device")
"""Options that are ``render``'s, too. The scene is not among them, as the job's file opens with it."""


def add_command(add_parser: AddParser) -> None:
    job = add_parser("submit", help="write a job of the Open Job Description that renders a .blend on many machines")
    add_file(job)
    job.add_argument(
        "--to", type=_folder_name, required=True, metavar="DIR", help="folder to write, which must be new or empty"
    )
    job.add_argument("--name", help="name of the job (default: the file's)")
    job.add_argument(
        "--frames",
        type=parsed(_frames),
        metavar="LIST",
        help="frames to render, such as 1-100,120,200-240:2 (default: the scene's; with --ranges its current one)",
    )
    job.add_argument(
        "-o",
        "--output",
        type=file_name,
        metavar="NAME",
        help="name of the pictures, with #### (default: the file's, and the scene's format)",
    )
    split = job.add_mutually_exclusive_group()
    split.add_argument("--chunk", type=positive, default=1, metavar="N", help="frames a task (default: 1)")
    split.add_argument(
        "--ranges",
        type=positive,
        metavar="N",
        help="split the samples of each frame among N tasks, and merge what they render",
    )
    job.add_argument(
        "--check",
        choices=CHECKS,
        default=CHECKS[0],
        help="let the job begin with a check that ends it where pictures would be "
        "wrong (default), with strict also where they would be slow; or not",
    )
    add_view(job)
    job.add_argument(
        "--device", type=str.upper, choices=DEVICES, help="what renders on the workers (default: as the file has it)"
    )
    job.add_argument("--no-cut", action="store_true", help="render media as they are")
    add_backend(job)
    job.add_argument(
        "--keep-outside",
        action="store_true",
        help="write the job though the file needs others, which workers must see where they are; the report lists them",
    )
    job.set_defaults(run=_run)


def _run(options: argparse.Namespace) -> int:
    """Write the job.

    :returns: 0, or :data:`FOUND` where nothing was written, as the file lacks something.
    """
    require_device(options)
    scene = open_file(options.file, options.scene)
    file = Path(bpy.data.filepath)
    output = options.output or Path(f"{file.stem}_####{_ending(scene, options.ranges)}")
    ranges = _ranges(scene, options.ranges or 0)
    _require_output(scene, output, ranges)
    view_of(scene, options)  # which names what is not there
    job = Job(
        options.name or file.stem,
        options.frames or _scene_frames(scene, ranges),
        str(output),
        options.chunk,
        ranges,
        bool(denoised_layers(scene)),
        options.check,
        (*_forwarded(options), *(["--no-cut"] if options.no_cut else [])),
    )
    try:
        packed = write_job(options.to, job, not options.no_cut, options.backend, options.keep_outside)
    except NotPacked as refused:
        print(refused)
        return FOUND
    print(packed)
    print(f"wrote the job {job.name!r} to {absolute(options.to)}")
    return 0


def _folder_name(text: str) -> Path:
    if not text:
        raise argparse.ArgumentTypeError(f"{text!r} is no folder's name")
    return Path(text)


def _frames(text: str) -> str:
    """Return a list of frames as jobs take it, each frame once."""
    frames = parse_frames(text)
    plain = text.replace(" ", "")
    return (
        plain
        if sum(len(parse_frames(piece)) for piece in plain.split(",")) == len(frames)
        else list_frames(tuple(sorted(frames)))
    )


def _scene_frames(scene: bpy.types.Scene, ranges: tuple[range, ...]) -> str:
    if ranges:
        return str(scene.frame_current)
    if scene.frame_end <= scene.frame_start:
        return str(scene.frame_start)
    return f"{scene.frame_start}-{scene.frame_end}" + (f":{scene.frame_step}" if scene.frame_step > 1 else "")


def _ending(scene: bpy.types.Scene, ranges: int | None) -> str:
    """Return the ending of the format that a scene writes; of OpenEXR for others than the command line writes."""
    endings = {name: ending for ending, name in reversed(FILE_FORMATS.items())}
    return ".exr" if ranges else endings.get(scene.render.image_settings.file_format, ".exr")


def _ranges(scene: bpy.types.Scene, count: int) -> tuple[range, ...]:
    """Return the samples of a scene in so many ranges, whose lengths differ by one at most; none for 0.

    :raises Failure: if there are fewer samples.
    """
    if count == 0:
        return ()
    samples = scene.cycles.samples
    if not 2 <= count <= samples:
        raise Failure(f"--ranges {count}: scene {scene.name!r} has {samples} samples, so name 2 to {samples}")
    return tuple(range(*ends) for ends in pairwise(samples * place // count for place in range(count + 1)))


def _require_output(scene: bpy.types.Scene, output: Path, ranges: tuple[range, ...]) -> None:
    """Make sure that pictures of this name can be rendered.

    :raises Failure, RenderError: if they cannot.
    """
    if len(output.parts) > 1:
        raise Failure(f"{output}: is no plain name; the job's parameter OutputDir names the folder")
    file_format_of(output)
    if not has_number(output):
        raise Failure(f"{output}: all frames would go to one file; put #### in its name")
    require_picture(scene, output, ranges[0] if ranges else None)


def _forwarded(options: argparse.Namespace) -> list[str]:
    """Return the options of ``render`` that were given."""
    given = {name: getattr(options, name) for name in _FORWARDED}
    return [f"--{name.replace('_', '-')}={value}" for name, value in given.items() if value is not None]
