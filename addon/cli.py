"""The command line: ``python -m nested_dielectric`` and ``blender -b FILE.blend -c nested_dielectric``.

Blender takes only identifiers for commands, hence the underscore there.

Exit codes: 0 done, 1 failed, 2 wrong usage.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import bpy

from .compatibility import require_blender
from .iced_water import build_scene
from .parameters import ParameterError
from .preparation import prepare
from .presets import load_preset, preset_names
from .rendering import ProgressLine, render_frame

PROGRAM = "nested-dielectric"
DEMO_OUTPUT = Path("out/iced_water.png")


class _Failure(Exception):
    """A failure with its one line of explanation."""


def main(arguments: list[str] | None = None) -> int:
    """Run one command and return its exit code."""
    try:
        options = _parser().parse_args(arguments)
    except SystemExit as stop:
        return int(stop.code or 0)
    try:
        options.run(options)
    except (_Failure, ParameterError, OSError, RuntimeError) as error:
        print(f"{PROGRAM}: error: {' '.join(str(error).split())}", file=sys.stderr)
        return 1
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog=PROGRAM, description="Nested dielectrics for Cycles.", allow_abbrev=False)
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    demo = commands.add_parser("demo", help="model the glass of iced water and render it", allow_abbrev=False)
    demo.add_argument(
        "-o", "--output", type=Path, default=DEMO_OUTPUT, help=f"picture to write (default: {DEMO_OUTPUT})"
    )
    demo.add_argument("--samples", type=_positive, help="samples per pixel")
    demo.add_argument("--save", type=Path, metavar="FILE.blend", help="also save the scene")
    demo.set_defaults(run=_demo)

    render = commands.add_parser(
        "render", help="prepare a .blend in memory and render a frame of it", allow_abbrev=False
    )
    _add_file(render)
    render.add_argument(
        "-o", "--output", type=Path, required=True, help="picture to write; its ending chooses the format"
    )
    render.add_argument("--samples", type=_positive, help="samples per pixel (default: the scene's)")
    render.add_argument("--frame", type=int, help="frame to render (default: the current one)")
    render.set_defaults(run=_render)

    preparation = commands.add_parser(
        "prepare", help="set what a .blend needs, list problems, and save it", allow_abbrev=False
    )
    _add_file(preparation)
    preparation.set_defaults(run=_prepare)

    presets = commands.add_parser("presets", help="list the presets", allow_abbrev=False)
    presets.set_defaults(run=_presets)
    return parser


def _add_file(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "file", type=Path, nargs="?", metavar="FILE", help="the .blend (default: the one Blender has open)"
    )


def _positive(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{number} is not a positive number")
    return number


def _open(file: Path | None) -> bpy.types.Scene:
    if file is None:
        if not bpy.data.filepath:
            raise _Failure("no file is open; name a .blend")
    elif not file.is_file():
        raise _Failure(f"{file}: no such file")
    else:
        try:
            bpy.ops.wm.open_mainfile(filepath=str(file.resolve()))
        except RuntimeError as error:
            raise _Failure(f"{file}: {error}") from None
    return bpy.context.scene


def _demo(options: argparse.Namespace) -> None:
    require_blender()
    scene = build_scene()
    print(prepare(scene))
    if options.save:
        bpy.ops.wm.save_as_mainfile(filepath=str(options.save.resolve()), copy=True)
    print(render_frame(scene, options.output, options.samples, progress=ProgressLine()))


def _render(options: argparse.Namespace) -> None:
    scene = _open(options.file)
    print(prepare(scene))
    print(render_frame(scene, options.output, options.samples, options.frame, ProgressLine()))


def _prepare(options: argparse.Namespace) -> None:
    scene = _open(options.file)
    print(prepare(scene))
    bpy.ops.wm.save_mainfile()


def _presets(options: argparse.Namespace) -> None:
    for key in preset_names():
        preset = load_preset(key)
        print(f"{key:12} {preset.parameters['ior']:<8} {preset.description}")
