"""``demo``: the glass of iced water."""

from __future__ import annotations

import argparse
from pathlib import Path

import bpy

from ..demo.iced_water import build_scene
from ..model.files import require_place
from ..nodes.compatibility import require_blender
from ..nodes.render_with import OSL
from ..preparation.prepare_scene import prepare
from ..scene.image_formats import file_format_of
from ..scene.output import save_blend
from ..scene.progress import ProgressLine
from ..scene.rendering import render_frame, sampling_time
from .shared import AddParser, blend_name, file_name, positive, show

OUTPUT = Path("out/iced_water.png")

TRIAL_SAMPLES, TRIAL_PERCENTAGE = 32, 15
"""Of the small pictures that are compared."""


def add_command(add_parser: AddParser) -> None:
    demo = add_parser("demo", help="model the glass of iced water and render it")
    demo.add_argument("-o", "--output", type=file_name, default=OUTPUT, help=f"picture to write (default: {OUTPUT})")
    demo.add_argument("--samples", type=positive, help="samples per pixel")
    demo.add_argument("--save", type=blend_name, metavar="FILE.blend", help="also save the scene")
    demo.set_defaults(run=_run)


def _run(options: argparse.Namespace) -> None:
    """Model the glass of iced water, render it and say what cutting it saves."""
    require_blender()
    file_format_of(options.output)  # before any work is done
    for place in filter(None, (options.output, options.save)):
        require_place(place)
    scene = build_scene()
    show(scene)
    print(prepare(scene, cut=True), flush=True)
    if options.save:
        save_blend(options.save)
    progress = ProgressLine()
    picture = render_frame(scene, options.output, options.samples, progress=progress)
    progress.end()
    print(picture)
    print(_saving(scene))


def _saving(scene: bpy.types.Scene) -> str:
    """Say in a sentence what a scene saves by being cut."""
    cut = sampling_time(scene, TRIAL_SAMPLES, TRIAL_PERCENTAGE)
    prepare(scene, cut=False, backend=OSL)
    asking = sampling_time(scene, TRIAL_SAMPLES, TRIAL_PERCENTAGE)
    return f"a sample takes {cut / asking:.2f} of the time that it takes without cut surfaces (CPU, a small picture)"
