"""``merge``: parts of pictures, each with a range of the samples, put together."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import bpy

from ..farm.merging import is_merged, merge, require_apart
from ..model.files import absolute
from ..model.frames import has_number, parse_frames, path_of_frame
from ..scene.sample_ranges import denoised_layers
from .shared import AddParser, Failure, add_scene, blend_name, file_name, open_file, parsed

KEEP, REMOVE = "keep", "remove"
"""What becomes of parts that are merged."""


def add_command(add_parser: AddParser) -> None:
    merging = add_parser("merge", help="put pictures together that hold ranges of samples, rendered with --samples A:B")
    merging.add_argument("parts", type=file_name, nargs="+", metavar="PART.exr", help="the parts, in any order")
    merging.add_argument("-o", "--output", type=file_name, required=True, metavar="OUT.exr", help="picture to write")
    merging.add_argument(
        "--frames",
        type=parsed(parse_frames),
        metavar="LIST",
        help="merge the parts of each of these frames, for which #### stands in all names",
    )
    merging.add_argument(
        "--denoise",
        type=blend_name,
        metavar="FILE.blend",
        help="denoise what is merged as the scene that was rendered does",
    )
    add_scene(merging)
    merging.add_argument(
        "--skip-existing", action="store_true", help="leave out frames whose picture is there, whole and of these parts"
    )
    merging.add_argument(
        "--parts",
        dest="afterwards",
        choices=(KEEP, REMOVE),
        default=KEEP,
        help="what becomes of the parts of a whole picture (default: keep)",
    )
    merging.set_defaults(run=_run)


def _run(options: argparse.Namespace) -> None:
    """Merge the parts of each frame."""
    frames = options.frames or ()
    for path in (*options.parts, options.output):
        if len(frames) > 1 and not has_number(path):
            raise Failure(f"{path}: would be the same for all frames; put #### in its name")
    denoised = _denoised(options.denoise, options.scene) if options.denoise else None
    for frame in frames or (None,):
        output, *parts = (
            path if frame is None else path_of_frame(path, frame) for path in (options.output, *options.parts)
        )
        require_apart(parts, output)
        if options.skip_existing and is_merged(parts, output):
            print(f"{output} is there")
        else:
            samples = merge(parts, output, denoised)
            print(f"{absolute(output)}: samples {samples.start}:{samples.stop} of {len(parts)} parts", flush=True)
        if options.afterwards == REMOVE:
            _remove(parts)


def _denoised(file: Path, name: str | None) -> tuple[bpy.types.Scene, bpy.types.ViewLayer]:
    """Return a file's scene and the layer whose settings denoise.

    :raises Failure: if it does not denoise.
    """
    scene = open_file(file, name)
    layers = denoised_layers(scene)
    if not layers:
        raise Failure(f"{file}: scene {scene.name!r} does not denoise; leave out --denoise")
    return scene, layers[0]


def _remove(parts: Sequence[Path]) -> None:
    """Remove parts, and the folders that then are empty, their own and the one that held those."""
    for part in parts:
        part.unlink(missing_ok=True)
        with suppress(OSError):
            part.parent.rmdir()
            part.parent.parent.rmdir()
