"""``render``: a file, prepared in memory, as pictures."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..model.frames import has_number, parse_frames, parse_samples, path_of_frame
from ..preparation.prepare_scene import prepare
from ..scene.image_formats import file_format_of
from ..scene.progress import ProgressLine
from ..scene.rendering import render_frame, require_picture
from .shared import AddParser, Failure, add_backend, add_file, add_scene, file_name, open_file, parsed


def add_command(add_parser: AddParser) -> None:
    render = add_parser("render", help="prepare a .blend in memory and render frames of it")
    add_file(render)
    render.add_argument(
        "-o",
        "--output",
        type=file_name,
        required=True,
        help="picture to write; its ending chooses the format, and #### in its name stands for the frame",
    )
    render.add_argument(
        "--samples",
        type=parsed(parse_samples),
        metavar="N|A:B",
        help="samples per pixel (default: the scene's); A:B renders the scene's from A up to B alone, to be merged",
    )
    frames = render.add_mutually_exclusive_group()
    frames.add_argument("--frame", type=int, help="frame to render (default: the current one)")
    frames.add_argument(
        "--frames",
        type=parsed(parse_frames),
        metavar="LIST",
        help="frames to render, such as 1-100,120,200-240:2; --frames=-5-5 where the first is negative",
    )
    add_scene(render)
    render.add_argument(
        "--no-cut",
        action="store_true",
        help="render media as they are; the default cuts their surfaces where they cross",
    )
    add_backend(render)
    render.set_defaults(run=_run)


def _run(options: argparse.Namespace) -> None:
    """Prepare a file in memory and render frames of it."""
    file_format_of(options.output)
    frames = _frames(options)
    scene = open_file(options.file, options.scene)
    require_picture(scene, options.output, options.samples)
    print(prepare(scene, not options.no_cut, options.backend), flush=True)
    for frame, path in frames:
        print(render_frame(scene, path, options.samples, frame, ProgressLine()), flush=True)


def _frames(options: argparse.Namespace) -> list[tuple[int | None, Path]]:
    """Return the frames to render, None for the current one, and their files.

    :raises Failure: if several frames had one file.
    """
    numbers = options.frames or (() if options.frame is None else (options.frame,))
    if not numbers:
        return [(None, options.output)]
    if len(numbers) > 1 and not has_number(options.output):
        example = f"{options.output.stem}_####{options.output.suffix}"
        raise Failure(f"{options.output}: all frames would go to one file; put #### in its name, as in {example}")
    return [(number, path_of_frame(options.output, number)) for number in numbers]
