"""What the commands share: their options, their failures and the file that they open."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, redirect_stdout
from pathlib import Path
from typing import Any

import bpy

from ..checking.listing import STRICT, WRONG
from ..model.files import absolute
from ..model.manifest import manifest
from ..model.streams import log_to_stderr
from ..nodes.render_with import BACKENDS
from ..preparation.guard import faults

PROGRAM = "nested-dielectric"

FOUND = 3
"""Exit code where something is wrong with the file that was looked at."""

AddParser = Callable[..., argparse.ArgumentParser]


class Failure(Exception):
    """A failure with its one line of explanation."""


def one_line(error: Exception) -> str:
    """Return in one line what went wrong."""
    named = isinstance(error, OSError) and error.filename
    text = f"{error.filename}: {error.strerror}" if named else str(error).replace("Error: ", "")
    return " ".join(text.split())


def open_file(file: Path | None, scene: str | None = None) -> bpy.types.Scene:
    """Open a file, or take the one that Blender has open, and return its scene.

    :param scene: the name of one of its scenes; the one that it was saved with unless given.
    :raises Failure: if there is none.
    """
    if file is None:
        if not bpy.data.filepath:
            raise Failure("no file is open; name a .blend")
    elif not file.is_file():
        raise Failure(f"{file}: no such file")
    else:
        try:
            bpy.ops.wm.open_mainfile(filepath=str(absolute(file)))
        except RuntimeError as error:
            raise Failure(f"{file}: {error}") from None
    if scene is not None:
        show(named(bpy.data.scenes, scene, "scene", "the file"))
    return bpy.context.scene


def show(scene: bpy.types.Scene) -> None:
    """Make a scene the one that Blender has open, and with which the file opens once it is saved."""
    for window in bpy.context.window_manager.windows:
        window.scene = scene


def named(things: Mapping[str, Any] | bpy.types.bpy_prop_collection, name: str, kind: str, owner: str) -> Any:
    """Return what has a name.

    :raises Failure: if there is none, with the names that there are.
    """
    thing = things.get(name)
    if thing is None:
        there = ", ".join(repr(each) for each, _ in things.items()) or "none"
        raise Failure(f"{owner} has no {kind} {name!r}; there is: {there}")
    return thing


def add_scene(parser: argparse.ArgumentParser, otherwise: str = "the one that it was saved with") -> None:
    parser.add_argument("--scene", metavar="S", help=f"scene of the file (default: {otherwise})")


def add_file(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "file", type=Path, nargs="?", metavar="FILE", help="the .blend (default: the one Blender has open)"
    )


def add_saved(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "-o", "--output", type=blend_name, metavar="OUT.blend", help="file to write (default: FILE itself)"
    )


def add_backend(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--backend",
        type=str.upper,
        choices=[choice.keyword for choice in BACKENDS],
        help="what renders media: Cycles' own nodes, the shader in OSL, or what fits best (default: as the file has it)",
    )


def add_json(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="write what was done as JSON")


@contextmanager
def json_report(options: argparse.Namespace, schema: int) -> Iterator[dict[str, Any]]:
    """Yield what a command has to report, to be added to; with ``--json`` it is written at the end.

    It is all that the standard output then holds, and is written, too, if the block fails: the key ``error`` holds why, or
    None. What else is printed goes to the standard error output.

    :param schema: version of the report, to be counted on when a key changes its meaning or goes.
    """
    report: dict[str, Any] = {
        "schema": schema,
        "version": manifest()["version"],
        "blender": bpy.app.version_string,
        "file": bpy.data.filepath,
        "error": None,
    }
    if not options.json:
        yield report
        return
    with log_to_stderr() as output, redirect_stdout(sys.stderr):
        try:
            yield report
            if faults():
                report["error"] = str(faults()[0])
        except Exception as error:
            report["error"] = one_line(error)
            raise
        finally:
            report["file"] = bpy.data.filepath
            print(json.dumps(report, indent=2, ensure_ascii=False), file=output, flush=True)


def parsed(parse: Callable[[str], Any]) -> Callable[[str], Any]:
    """Return a type of an option's value, from a function that raises ValueError in words for users."""

    def convert(text: str) -> Any:
        try:
            return parse(text)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from None

    return convert


def add_check(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--check",
        choices=(WRONG, STRICT),
        help="save nothing where pictures would be wrong, or with strict also where they would be slow",
    )


def file_name(text: str) -> Path:
    if not text or text.endswith(("/", os.sep)):
        raise argparse.ArgumentTypeError(f"{text!r} is no file's name")
    return Path(text)


def blend_name(text: str) -> Path:
    path = file_name(text)
    if path.suffix.lower() != ".blend":
        raise argparse.ArgumentTypeError(f"{text}: the ending must be .blend")
    return path


def positive(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{number} is not a positive number")
    return number
