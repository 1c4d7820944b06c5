"""The options of ``render``."""

from __future__ import annotations

import argparse
import math

import bpy

from ..model.frames import parse_frames, parse_samples
from ..nodes.render_with import OSL
from ..scene.chosen_view import cameras
from ..scene.devices import DEVICES, GPU
from .shared import Failure, add_backend, add_file, add_json, add_scene, file_name, named, parsed


def add_options(render: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    add_file(render)
    render.add_argument(
        "-o",
        "--output",
        type=file_name,
        required=True,
        help="picture to write; its ending chooses the format, and #### in its name stands for the frame",
    )
    _add_what(render)
    _add_how(render)
    add_json(render)


def _add_what(render: argparse.ArgumentParser) -> None:
    """Add the options that say what is rendered."""
    frames = render.add_mutually_exclusive_group()
    frames.add_argument("--frame", type=int, metavar="F", help="frame to render (default: the current one)")
    frames.add_argument(
        "--frames",
        type=parsed(parse_frames),
        metavar="LIST",
        help="frames to render, such as 1-100,120,200-240:2; --frames=-5-5 where the first is negative",
    )
    render.add_argument(
        "--skip-existing",
        action="store_true",
        help="leave frames out whose picture is there, whole and of the right size",
    )
    add_view(render)


def add_view(parser: argparse.ArgumentParser) -> None:
    """Add the options that name what of a file is rendered."""
    add_scene(parser)
    parser.add_argument(
        "--camera", metavar="C", help="camera to render through (default: the scene's, and its markers')"
    )
    parser.add_argument("--view-layer", metavar="L", help="the one view layer to render (default: all that are in use)")


def view_of(
    scene: bpy.types.Scene, options: argparse.Namespace
) -> tuple[bpy.types.Object | None, bpy.types.ViewLayer | None]:
    """Return the camera and the view layer of a scene that options name; None for what they leave to the scene.

    :raises Failure: for a name that there is not.
    """
    owner = f"scene {scene.name!r}"
    camera = None if options.camera is None else named(cameras(scene), options.camera, "camera", owner)
    if options.view_layer is None:
        return camera, None
    return camera, named(scene.view_layers, options.view_layer, "view layer", owner)


def _add_how(render: argparse.ArgumentParser) -> None:
    """Add the options that say how it is rendered."""
    render.add_argument(
        "--samples",
        type=parsed(parse_samples),
        metavar="N|A:B",
        help="samples per pixel (default: the scene's); A:B renders the scene's from A up to B alone, to be merged",
    )
    render.add_argument(
        "--time-limit", type=parsed(_seconds), metavar="S", help="seconds after which a frame gets no more samples"
    )
    render.add_argument(
        "--device",
        type=str.upper,
        choices=DEVICES,
        help="what renders: the processor, or all GPUs that Cycles finds (default: as the file has it)",
    )
    render.add_argument(
        "--no-cut",
        action="store_true",
        help="render media as they are; the default cuts their surfaces where they cross",
    )
    add_backend(render)


def require_device(options: argparse.Namespace) -> None:
    """Make sure that the device that was named runs the backend that was.

    :raises Failure: if it does not.
    """
    if options.device == GPU and options.backend == OSL:
        raise Failure("--backend osl renders on the CPU alone; leave --device gpu out, or choose another backend")


def _seconds(text: str) -> float:
    try:
        seconds = float(text)
    except ValueError:
        seconds = math.nan
    if not 0.0 < seconds < math.inf:
        raise ValueError(f"{text!r} is no number of seconds above 0")
    return seconds
