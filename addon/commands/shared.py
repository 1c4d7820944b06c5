"""What the commands share: their options, their failures and the file that they open."""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable
from pathlib import Path

import bpy

from ..model.files import absolute
from ..nodes.render_with import BACKENDS

PROGRAM = "nested-dielectric"

AddParser = Callable[..., argparse.ArgumentParser]


class Failure(Exception):
    """A failure with its one line of explanation."""


def open_file(file: Path | None) -> bpy.types.Scene:
    """Open a file, or take the one that Blender has open, and return its scene.

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
    return bpy.context.scene


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
