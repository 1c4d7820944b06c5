"""The command line: ``python -m nested_dielectric`` and ``blender -b FILE.blend -c nested_dielectric``.

Blender takes only identifiers for commands, hence the underscore there.

Exit codes: 0 done, 1 failed, 2 wrong usage, 3 something is wrong with the file, for which nothing was written; Ctrl-C ends
it as it ends other programs, which shells report as 130.
"""

from __future__ import annotations

import argparse
import io
import os
import sys
import traceback
from functools import partial

import bpy

from .commands import check, demo, import_jf, merge, pack, prepare, render, submit, tables
from .commands.shared import PROGRAM, Failure, one_line
from .importers.jf_parameters import JfError
from .model.colour_science import SpectrumError
from .model.files import ending_at_once
from .model.manifest import manifest
from .model.parameter import ParameterError
from .preparation.guard import faults

COMMANDS = (
    demo.add_command,
    render.add_command,
    merge.add_command,
    check.add_command,
    prepare.add_prepare,
    prepare.add_update,
    pack.add_command,
    submit.add_command,
    tables.add_presets,
    tables.add_bake,
    import_jf.add_command,
)


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
        if options.traceback:
            traceback.print_exc()
        print(f"{PROGRAM}: error: {one_line(error)}", file=sys.stderr)
        return 1
    return code or 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog=PROGRAM, description="Nested dielectrics for Cycles.", allow_abbrev=False)
    version = f"{PROGRAM} {manifest()['version']}, Blender {bpy.app.version_string}"
    parser.add_argument("--version", action="version", version=version)
    every = argparse.ArgumentParser(add_help=False)
    every.add_argument("--traceback", action="store_true", help="where it fails, also say where in the program")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for add_command in COMMANDS:
        add_command(partial(commands.add_parser, allow_abbrev=False, parents=[every]))
    return parser
