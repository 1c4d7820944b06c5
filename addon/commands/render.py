"""``render``: a file, prepared in memory, as pictures."""

from __future__ import annotations

import argparse
import os
from contextlib import ExitStack
from typing import Any

import bpy

from ..checking.finding import to_json
from ..model.files import absolute, require_place
from ..model.frames import has_number, path_of_frame
from ..preparation.prepare_scene import prepare
from ..scene.chosen_view import layer_alone, through_camera
from ..scene.devices import use_device
from ..scene.frame_sequences import Frame, Rendered, State, is_there, line_of, number_of, render_frames, require_frames
from ..scene.image_formats import file_format_of
from ..scene.meanwhile import set_meanwhile
from ..scene.progress import ProgressLine
from .render_options import add_options, require_device, view_of
from .shared import AddParser, Failure, json_report, open_file

RENDER_SCHEMA = 1
"""Version of the JSON that ``render`` writes; it is counted on when a key changes its meaning or goes."""


def add_command(add_parser: AddParser) -> None:
    render = add_parser("render", help="prepare a .blend in memory and render frames of it")
    add_options(render)
    render.set_defaults(run=_run)


def _run(options: argparse.Namespace) -> None:
    """Prepare a file in memory and render frames of it."""
    with json_report(options, RENDER_SCHEMA) as report, ExitStack() as undo:
        report |= {"scene": None, "changes": [], "problems": [], "frames": []}
        frames = _frames(options)
        order = {str(absolute(frame.path)): place for place, frame in enumerate(frames)}
        undo.callback(lambda: report["frames"].sort(key=lambda done: order[done["path"]]))
        _require_options(options, frames)
        scene = open_file(options.file, options.scene)
        report["scene"] = scene.name
        _choose(scene, options, undo)
        require_frames(scene, frames, options.samples)
        there = {frame: None for frame in frames if options.skip_existing and is_there(scene, frame)}
        if there:
            print(f"{len(there)} of {len(frames)} frames are there already and are skipped", flush=True)
            skipped = (Rendered(number_of(scene, frame), absolute(frame.path), State.SKIPPED) for frame in there)
            report["frames"] += map(_as_json, skipped)
        wanted = [frame for frame in frames if frame not in there]
        if not wanted:
            return
        preparation = prepare(scene, not options.no_cut, options.backend)
        report["changes"] += preparation.changes
        report["problems"] += map(to_json, preparation.problems)
        print(preparation, flush=True)
        _render(scene, wanted, options, report["frames"])


def _render(
    scene: bpy.types.Scene, frames: list[Frame], options: argparse.Namespace, done: list[dict[str, Any]]
) -> None:
    """Render frames and say so of each; what is done is added to a list.

    :raises Failure: if one fails.
    """
    progress = ProgressLine(len(frames))
    numbered, several = options.frames is not None, len(options.frames or ()) > 1
    for place, rendered in enumerate(render_frames(scene, frames, options.samples, progress, numbered), start=1):
        done.append(_as_json(rendered))
        if rendered.state == State.FAILED:
            raise Failure(f"frame {rendered.number}: {rendered.reason}" if several else rendered.reason)
        print(line_of(rendered, place, len(frames)) if several else rendered.path, flush=True)


def _frames(options: argparse.Namespace) -> list[Frame]:
    """Return the frames to render and their files.

    :raises Failure: if several frames had one file.
    """
    numbers = options.frames or (() if options.frame is None else (options.frame,))
    if not numbers:
        return [Frame(None, options.output)]
    if len(numbers) > 1 and not has_number(options.output):
        example = f"{options.output.stem}_####{options.output.suffix}"
        raise Failure(f"{options.output}: all frames would go to one file; put #### in its name, as in {example}")
    return [Frame(number, path_of_frame(options.output, number)) for number in numbers]


def _require_options(options: argparse.Namespace, frames: list[Frame]) -> None:
    """Make sure that options fit each other and that the files can be written, before any work."""
    file_format_of(options.output)
    if isinstance(options.samples, range) and options.time_limit is not None:
        raise Failure("--time-limit would cut ranges of samples short; leave it out, or name a number of --samples")
    require_device(options)
    first, *others = (frame.path for frame in frames)  # all in one folder, which is tried once
    for path in (first, *filter(os.path.lexists, others)):
        require_place(path)


def _choose(scene: bpy.types.Scene, options: argparse.Namespace, undo: ExitStack) -> None:
    """Let a scene be rendered as the options say, and be afterwards as it was."""
    camera, layer = view_of(scene, options)
    if camera is not None:
        undo.enter_context(through_camera(scene, camera))
    if layer is not None:
        undo.enter_context(layer_alone(scene, layer))
    if options.time_limit is not None:
        undo.enter_context(set_meanwhile(scene.cycles, time_limit=options.time_limit))
    if options.device is not None:
        undo.enter_context(set_meanwhile(scene.cycles, device=scene.cycles.device))
        for gpu in use_device(scene, options.device):
            print(f"renders on: {gpu}", flush=True)


def _as_json(rendered: Rendered) -> dict[str, Any]:
    """Return what became of a frame as JSON."""
    values: dict[str, Any] = {
        "frame": rendered.number,
        "path": str(rendered.path),
        "state": rendered.state,
        "seconds": round(rendered.seconds, 3),
    }
    if rendered.reason:
        values["reason"] = rendered.reason
    return values
