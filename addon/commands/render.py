"""``render``: a file, prepared in memory, as pictures."""

from __future__ import annotations

import argparse

from ..preparation.prepare_scene import prepare
from ..scene.rendering import ProgressLine, file_format_of, render_frame
from .shared import AddParser, add_backend, add_file, file_name, open_file, positive


def add_command(add_parser: AddParser) -> None:
    render = add_parser("render", help="prepare a .blend in memory and render a frame of it")
    add_file(render)
    render.add_argument(
        "-o", "--output", type=file_name, required=True, help="picture to write; its ending chooses the format"
    )
    render.add_argument("--samples", type=positive, help="samples per pixel (default: the scene's)")
    render.add_argument("--frame", type=int, help="frame to render (default: the current one)")
    render.add_argument(
        "--no-cut",
        action="store_true",
        help="render media as they are; the default cuts their surfaces where they cross",
    )
    add_backend(render)
    render.set_defaults(run=_run)


def _run(options: argparse.Namespace) -> None:
    """Prepare a file in memory and render a frame of it."""
    file_format_of(options.output)
    scene = open_file(options.file)
    print(prepare(scene, not options.no_cut, options.backend), flush=True)
    print(render_frame(scene, options.output, options.samples, options.frame, ProgressLine()))
