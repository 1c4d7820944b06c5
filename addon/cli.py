"""The command line: ``python -m nested_dielectric`` and ``blender -b FILE.blend -c nested_dielectric``.

Blender takes only identifiers for commands, hence the underscore there.

Exit codes: 0 done, 1 failed, 2 wrong usage, 3 something is wrong with the file that was checked; Ctrl-C ends it as it ends
other programs, which shells report as 130.
"""

from __future__ import annotations

import argparse
import io
import os
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import bpy

from .commands import (
    PROGRAM,
    Failure,
    run_bake,
    run_check,
    run_demo,
    run_import_jf,
    run_prepare,
    run_presets,
    run_render,
    run_update,
)
from .importers.jf_parameters import JfError
from .model.colour_science import SpectrumError
from .model.distributions import DISTRIBUTIONS
from .model.files import ending_at_once
from .model.gamuts import GAMUTS
from .model.parameter import ParameterError
from .nodes.render_with import BACKENDS
from .preparation.guard import faults

DEMO_OUTPUT = Path("out/iced_water.png")

_AddParser = Callable[..., argparse.ArgumentParser]


def main(arguments: list[str] | None = None) -> int:
    """Run one command and return its exit code."""
    try:
        options = _parser().parse_args(arguments)
    except SystemExit as stop:
        return int(stop.code or 0)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # for file names that are no text
    bpy.utils.expose_bundled_modules()  # Script nodes of a file that is opened keep their sockets with it alone
    try:
        with ending_at_once(bpy.app.tempdir):
            code = options.run(options)
            sys.stdout.flush()
        if faults():
            raise Failure(str(faults()[0]))
    except BrokenPipeError:  # whoever read it has enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except (Failure, JfError, ParameterError, SpectrumError, OSError, RuntimeError) as error:
        named = isinstance(error, OSError) and error.filename
        text = f"{error.filename}: {error.strerror}" if named else str(error).replace("Error: ", "")
        print(f"{PROGRAM}: error: {' '.join(text.split())}", file=sys.stderr)
        return 1
    return code or 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog=PROGRAM, description="Nested dielectrics for Cycles.", allow_abbrev=False)
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for add in (_add_demo, _add_render, _add_check, _add_prepare, _add_update, _add_presets, _add_bake, _add_import_jf):
        add(partial(commands.add_parser, allow_abbrev=False))
    return parser


def _add_demo(add_parser: _AddParser) -> None:
    demo = add_parser("demo", help="model the glass of iced water and render it")
    demo.add_argument(
        "-o", "--output", type=_file, default=DEMO_OUTPUT, help=f"picture to write (default: {DEMO_OUTPUT})"
    )
    demo.add_argument("--samples", type=_positive, help="samples per pixel")
    demo.add_argument("--save", type=_blend, metavar="FILE.blend", help="also save the scene")
    demo.set_defaults(run=run_demo)


def _add_render(add_parser: _AddParser) -> None:
    render = add_parser("render", help="prepare a .blend in memory and render a frame of it")
    _add_file(render)
    render.add_argument(
        "-o", "--output", type=_file, required=True, help="picture to write; its ending chooses the format"
    )
    render.add_argument("--samples", type=_positive, help="samples per pixel (default: the scene's)")
    render.add_argument("--frame", type=int, help="frame to render (default: the current one)")
    render.add_argument(
        "--no-cut",
        action="store_true",
        help="render media as they are; the default cuts their surfaces where they cross",
    )
    _add_backend(render)
    render.set_defaults(run=run_render)


def _add_check(add_parser: _AddParser) -> None:
    check = add_parser("check", help="say what is wrong with the media of a .blend, where, and what would mend it")
    _add_file(check)
    check.add_argument("--json", action="store_true", help="write it as JSON")
    check.add_argument("--strict", action="store_true", help="take what is slow for wrong, too")
    check.add_argument("--fix", action="store_true", help="mend what can be mended safely, and save that as OUT.blend")
    check.add_argument("-o", "--output", type=_blend, metavar="OUT.blend", help="file to write, with --fix")
    check.set_defaults(run=run_check)


def _add_prepare(add_parser: _AddParser) -> None:
    preparation = add_parser("prepare", help="set what a .blend needs, list problems, and save it")
    _add_file(preparation)
    _add_saved(preparation)
    preparation.add_argument(
        "--cut",
        action=argparse.BooleanOptionalAction,
        help="let renders of the file show surfaces cut where media cross, that of its frame kept in the file for farms; or "
        "not (default: as the file has it)",
    )
    _add_backend(preparation)
    preparation.set_defaults(run=run_prepare)


def _add_update(add_parser: _AddParser) -> None:
    update = add_parser("update", help="bring a .blend's materials to this version of the extension, and save it")
    _add_file(update)
    _add_saved(update)
    update.set_defaults(run=run_update)


def _add_presets(add_parser: _AddParser) -> None:
    add_parser("presets", help="list the presets").set_defaults(run=run_presets)


def _add_bake(add_parser: _AddParser) -> None:
    bake = add_parser("bake", help="write the table that light is split into colours with")
    bake.add_argument(
        "--distribution",
        default="DAYLIGHT",
        help=f"{', '.join(choice.keyword for choice in DISTRIBUTIONS)}, a CIE illuminant such as FL11, or a CSV file "
        "of wavelength (nm) and power (default: DAYLIGHT)",
    )
    bake.add_argument(
        "--gamut",
        type=str.upper,
        choices=[choice.keyword for choice in GAMUTS],
        default="SCENE",
        help="colour space of the colours (default: SCENE, the working space of the file that Blender has open)",
    )
    bake.add_argument("--saturation", type=float, default=1.0, help="0 (grey) to 1 (default)")
    bake.add_argument(
        "--keep-negative", action="store_true", help="keep the negative parts of colours outside the gamut"
    )
    bake.add_argument(
        "-o", "--output", type=_file, required=True, metavar="TABLE.exr", help="picture to write, a pixel an entry"
    )
    bake.add_argument("--plot", type=_file, metavar="PLOT.png", help="also draw it; needs matplotlib")
    bake.set_defaults(run=run_bake)


def _add_import_jf(add_parser: _AddParser) -> None:
    migration = add_parser(
        "import-jf",
        help="make materials of Arnold's jf_nested_dielectric nodes, in the open .blend or an empty one",
    )
    migration.add_argument("file", type=Path, metavar="FILE", help="an Arnold scene (.ass), or parameters (.json)")
    migration.add_argument(
        "-o", "--output", type=_file, metavar="FILE.blend", help="file to write (default: beside FILE, if it is new)"
    )
    migration.set_defaults(run=run_import_jf)


def _add_file(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "file", type=Path, nargs="?", metavar="FILE", help="the .blend (default: the one Blender has open)"
    )


def _add_saved(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("-o", "--output", type=_blend, metavar="OUT.blend", help="file to write (default: FILE itself)")


def _add_backend(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--backend",
        type=str.upper,
        choices=[choice.keyword for choice in BACKENDS],
        help="what renders media: Cycles' own nodes, the shader in OSL, or what fits best (default: as the file has it)",
    )


def _file(text: str) -> Path:
    if not text or text.endswith(("/", os.sep)):
        raise argparse.ArgumentTypeError(f"{text!r} is no file's name")
    return Path(text)


def _blend(text: str) -> Path:
    path = _file(text)
    if path.suffix.lower() != ".blend":
        raise argparse.ArgumentTypeError(f"{text}: the ending must be .blend")
    return path


def _positive(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{number} is not a positive number")
    return number
