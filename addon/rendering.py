"""Rendering one frame to a file, with progress."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from pathlib import Path

import bpy

FILE_FORMATS = {
    ".png": "PNG",
    ".exr": "OPEN_EXR",
    ".jpg": "JPEG",
    ".jpeg": "JPEG",
    ".tif": "TIFF",
    ".tiff": "TIFF",
    ".webp": "WEBP",
    ".hdr": "HDR",
}

_SAMPLE = re.compile(r"Sample (\d+)/(\d+)")


class RenderError(RuntimeError):
    """A render that cannot be started, or that left no picture."""


def render_frame(
    scene: bpy.types.Scene,
    output: Path,
    samples: int | None = None,
    frame: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Path:
    """Render one frame of a scene to a file and return its absolute path.

    The scene's own output settings stay as they were.

    :param output: the file; its ending chooses the format.
    :param samples: samples per pixel; the scene's own unless given.
    :param frame: the frame; the current one unless given.
    :param progress: called with the samples done and to do.
    :raises RenderError: for an ending that no format has, a scene without a camera, or a picture that was not written.
    """
    output = Path(output).resolve()
    file_format = FILE_FORMATS.get(output.suffix.lower())
    if file_format is None:
        raise RenderError(f"{output.name}: the ending must be one of {', '.join(FILE_FORMATS)}")
    if scene.camera is None:
        raise RenderError(f"scene {scene.name!r} has no camera; add one and make it active")
    output.parent.mkdir(parents=True, exist_ok=True)
    if output.exists():
        output.unlink()

    settings = scene.render
    before = settings.filepath, settings.image_settings.file_format, scene.cycles.samples
    report = _progress_handler(progress)
    try:
        settings.filepath = str(output)
        settings.image_settings.file_format = file_format
        if samples is not None:
            scene.cycles.samples = samples
        if frame is not None:
            scene.frame_set(frame)
        bpy.app.handlers.render_stats.append(report)
        bpy.ops.render.render(write_still=True, scene=scene.name)
    finally:
        bpy.app.handlers.render_stats.remove(report)
        settings.filepath, settings.image_settings.file_format, scene.cycles.samples = before
    if not output.is_file():
        raise RenderError(f"Blender wrote no picture to {output}")
    return output


def _progress_handler(progress: Callable[[int, int], None] | None) -> Callable:
    def report(stats: object, *_: object) -> None:
        match = _SAMPLE.search(str(stats))
        if match and progress is not None:
            progress(int(match[1]), int(match[2]))

    return report


class ProgressLine:
    """Prints progress: one line that is written over on a terminal, a line every tenth of the way elsewhere."""

    def __init__(self, stream=None) -> None:
        self.stream = stream or sys.stderr
        self.last = -1

    def __call__(self, done: int, total: int) -> None:
        tenth = 10 * done // max(total, 1)
        if self.stream.isatty():
            print(
                f"\rrendering: {done} of {total} samples",
                end="\n" if done == total else "",
                file=self.stream,
                flush=True,
            )
        elif tenth > self.last:
            print(f"rendering: {done} of {total} samples", file=self.stream, flush=True)
        self.last = tenth
