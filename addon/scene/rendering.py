"""Rendering one frame to a file, with progress."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import process_time
from typing import Any

import bpy

from ..model.files import WriteError, absolute, ending_at_once, replacing, replacing_in
from .output import check_picture, reason
from .passes import file_outputs

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

_CHANNELS = {"BW": 1, "RGB": 3, "RGBA": 3}
"""Fewest channels of a picture by its colour mode: WebP drops alpha that is 1 all over."""

_SAMPLING = ("| Sample 0/", "| Finished")
"""What Cycles says before its first sample, and after its last."""

_SAMPLE = re.compile(r"Sample (\d+)/(\d+)")


class RenderError(RuntimeError):
    """A render that cannot be started, or that left no picture."""


def file_format_of(output: Path | str) -> str:
    """Return what Blender calls the format that a path's ending names.

    :raises RenderError: if it names none.
    """
    file_format = FILE_FORMATS.get(Path(output).suffix.lower())
    if file_format is None:
        raise RenderError(f"{Path(output).name}: the ending must be one of {', '.join(FILE_FORMATS)}")
    return file_format


def render_frame(
    scene: bpy.types.Scene,
    output: Path | str,
    samples: int | None = None,
    frame: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Path:
    """Render one frame of a scene to a file and return its absolute path.

    The scene's own settings and frame are afterwards as they were. A file that was there stays until the new one could
    be read back whole; the same holds for what the compositor's File Output nodes write.

    Ctrl-C and other signals to end, unless the caller handles them or sits at a prompt, end the process at once: Blender
    cannot be made to stop rendering within seconds.

    :param output: the file; its ending chooses the format. Braces, ``#`` and ``//`` stand for themselves.
    :param samples: samples per pixel; the scene's own unless given.
    :param frame: the frame; the current one unless given.
    :param progress: called with the samples done and to do.
    :raises RenderError: for an ending that no format has, a scene without a camera, numbers out of range, or a render
        that fails.
    :raises WriteError: for a file that cannot be written, before anything is rendered, or was not written whole.
    """
    file_format = file_format_of(output)
    _require_renderable(scene)
    _require_within(scene, "frame_current", frame)
    _require_within(scene.cycles, "samples", samples)
    with ending_at_once(bpy.app.tempdir), ExitStack() as undo:
        enter = undo.enter_context
        enter(_file_outputs_held_back(scene))
        draft = enter(replacing(output))
        if frame is not None:
            undo.callback(scene.frame_set, scene.frame_current, subframe=scene.frame_subframe)
            scene.frame_set(frame)
        if samples is not None:
            enter(_set(scene.cycles, samples=samples))
        enter(_image_format(scene, file_format))
        enter(_set_path(scene.render, "filepath", draft))
        report = _progress_handler(progress)
        bpy.app.handlers.render_stats.append(report)
        undo.callback(bpy.app.handlers.render_stats.remove, report)
        try:
            with bpy.context.temp_override(scene=scene):
                done = bpy.ops.render.render(write_still=True)
        except RuntimeError as error:
            text = reason(error, draft, output)
            remedy = "; is the disk full?" if "cannot save" in text else ""
            raise RenderError(f"{output}: was not written ({text}){remedy}") from None
        if done != {"FINISHED"}:
            raise RenderError(f"scene {scene.name!r}: the render was cancelled")
        check_picture(draft, output, _size(scene.render), _CHANNELS[scene.render.image_settings.color_mode])
    return absolute(output)


def sampling_time(scene: bpy.types.Scene, samples: int, percentage: int) -> float:
    """Return the seconds of CPU time that samples take, without what comes before them.

    :param percentage: of the scene's resolution.
    :raises RenderError: if Cycles does not say when it begins and ends.
    """
    moments: dict[str, float] = {}

    def listen(stats: object, *_: object) -> None:
        for moment in _SAMPLING:
            if moment in str(stats):
                moments.setdefault(moment, process_time())

    bpy.app.handlers.render_stats.append(listen)
    try:
        with (
            _set(scene.render, resolution_percentage=percentage),
            _set(scene.cycles, samples=samples, use_adaptive_sampling=False),
            bpy.context.temp_override(scene=scene),
        ):
            bpy.ops.render.render()
    finally:
        bpy.app.handlers.render_stats.remove(listen)
    if len(moments) < len(_SAMPLING):
        raise RenderError("Cycles does not say when it samples")
    begin, end = (moments[moment] for moment in _SAMPLING)
    return end - begin


def _require_renderable(scene: bpy.types.Scene) -> None:
    if scene.camera is None:
        raise RenderError(f"scene {scene.name!r} has no camera; add one and make it active")
    if not any(layer.use for layer in scene.view_layers):
        # Blender would write black, or crash on writing OpenEXR.
        raise RenderError(f"scene {scene.name!r} has no view layer that is used for rendering; switch one on")
    if scene.render.use_multiview and scene.render.image_settings.views_format == "INDIVIDUAL":
        raise RenderError(f"scene {scene.name!r} has a picture for each view; choose Stereo 3D as Views Format")


def _require_within(owner: Any, name: str, value: int | None) -> None:
    """Refuse a number that Blender would replace by its nearest."""
    limits = owner.bl_rna.properties[name]
    if value is not None and not limits.hard_min <= value <= limits.hard_max:
        raise RenderError(f"{limits.name} {value}: must be {limits.hard_min} to {limits.hard_max}")


@contextmanager
def _set(owner: Any, **values: Any) -> Iterator[None]:
    """Give properties other values meanwhile."""
    before = {name: getattr(owner, name) for name in values}
    try:
        for name, value in values.items():
            setattr(owner, name, value)
        yield
    finally:
        for name, value in before.items():
            setattr(owner, name, value)


@contextmanager
def _set_path(owner: Any, name: str, path: Path) -> Iterator[None]:
    """Let a property hold a path as it is meanwhile, though Blender would read templates in it."""
    text = str(path).replace("{", "{{").replace("}", "}}")
    with _set(owner, **{name: text}):
        if getattr(owner, name) != text or (os.sep == "/" and "\\" in text):
            raise WriteError(f"{path.parent}: too long for Blender, or with a backslash; name another folder")
        yield


@contextmanager
def _image_format(scene: bpy.types.Scene, file_format: str) -> Iterator[None]:
    """Let a scene write a format meanwhile. Each setting bounds the next one's values, so their order matters."""
    settings = scene.render.image_settings
    before = {name: getattr(settings, name) for name in ("media_type", "file_format", "color_mode", "color_depth")}
    try:
        settings.media_type = "IMAGE"
        settings.file_format = file_format
        if file_format == "WEBP" and settings.color_mode == "BW":
            settings.color_mode = "RGB"  # which WebP has no other than
        yield
    finally:
        for name, value in before.items():
            setattr(settings, name, value)


def _size(render: bpy.types.RenderSettings) -> tuple[int, int] | None:
    """Return the width and height of the pictures in pixels; None where a border cuts them or views share them."""
    if render.use_multiview or (render.use_border and render.use_crop_to_border):
        return None
    return tuple(side * render.resolution_percentage // 100 for side in (render.resolution_x, render.resolution_y))


@contextmanager
def _file_outputs_held_back(scene: bpy.types.Scene) -> Iterator[None]:
    """Let what the compositor's File Output nodes write take its place when all of it is whole."""
    with ExitStack() as undo:
        held = []
        for node in file_outputs(scene):
            folder = _folder(scene, node)
            if folder is not None:
                draft = undo.enter_context(replacing_in(folder))
                undo.enter_context(_set_path(node, "directory", draft))
                held.append((node, folder, draft))
        yield
        for node, folder, draft in held:
            files = [path for path in draft.rglob("*") if path.is_file()]
            if not files:
                raise WriteError(f"{node.name!r} of the compositor wrote no file to {folder}; look at its File Name")
            for file in files:
                check_picture(file, folder / file.relative_to(draft))


def _folder(scene: bpy.types.Scene, node: bpy.types.CompositorNodeOutputFile) -> Path | None:
    """Return where a File Output node writes; None where its own name is part of that, which scenes cannot tell."""
    if "{node_name}" in node.directory:
        return None
    with _set(scene.render, filepath=f"{node.directory}/x"):
        try:
            return Path(scene.render.frame_path(frame=scene.frame_current)).parent
        except RuntimeError as error:
            text = " ".join(str(error).split()).removeprefix("Error: ")
            raise RenderError(f"{node.name!r} of the compositor: {text}") from None


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
