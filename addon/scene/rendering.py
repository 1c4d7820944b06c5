"""Rendering one frame to a file."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from time import process_time
from typing import Any

import bpy

from ..model.files import absolute, ending_at_once, replacing
from .held_outputs import file_outputs_held_back
from .image_formats import CHANNELS, file_format_of, image_format
from .meanwhile import set_meanwhile, set_path_meanwhile
from .output import check_picture, picture_files, reason
from .progress import reporting_samples
from .render_error import RenderError
from .sample_ranges import rendering_part, require_part, tell_samples

_SAMPLING = ("| Sample 0/", "| Finished")
"""What Cycles says before its first sample, and after its last."""


def render_frame(
    scene: bpy.types.Scene,
    output: Path | str,
    samples: int | range | None = None,
    frame: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    numbered: bool = False,
) -> Path:
    """Render one frame of a scene to a file and return its absolute path.

    The scene's own settings and frame are afterwards as they were. A file that was there stays until the new one could
    be read back whole; the same holds for what the compositor's File Output nodes write.

    Ctrl-C and other signals to end, unless the caller handles them or sits at a prompt, end the process at once: Blender
    cannot be made to stop rendering within seconds.

    :param output: the file; its ending chooses the format. Braces, ``#`` and ``//`` stand for themselves.
    :param samples: samples per pixel; the scene's own unless given. A range is those of the scene's samples alone: the file
        is a part of the picture that Cycles' merging puts together, in OpenEXR with all layers.
    :param frame: the frame; the current one unless given.
    :param progress: called with the samples done and to do.
    :param numbered: files of File Output nodes bear the frame's number, as in animations.
    :raises RenderError: for an ending that no format has, a scene without a camera, numbers out of range, or a render
        that fails.
    :raises WriteError: for a file that cannot be written, before anything is rendered, or was not written whole.
    """
    require_picture(scene, output, samples)
    require_within(scene, "frame_current", frame)
    with ending_at_once(bpy.app.tempdir), ExitStack() as undo:
        enter = undo.enter_context
        if frame is not None:
            undo.callback(scene.frame_set, scene.frame_current, subframe=scene.frame_subframe)
            scene.frame_set(frame)
        enter(file_outputs_held_back(scene, numbered))
        draft = enter(replacing(output))
        if isinstance(samples, range):
            enter(rendering_part(scene, samples))
        else:
            if samples is not None:
                enter(set_meanwhile(scene.cycles, samples=samples))
            enter(image_format(scene, file_format_of(output)))
        enter(set_path_meanwhile(scene.render, "filepath", draft))
        enter(reporting_samples(progress))
        try:
            with bpy.context.temp_override(scene=scene):
                done = bpy.ops.render.render(write_still=True)
        except RuntimeError as error:
            text = reason(error, draft, output)
            remedy = "; is the disk full?" if "cannot save" in text else ""
            raise RenderError(f"{output}: was not written ({text}){remedy}") from None
        if done != {"FINISHED"}:
            raise RenderError(f"scene {scene.name!r}: the render was cancelled")
        if isinstance(samples, range):
            tell_samples(draft, output, samples)
        check_whole(scene, draft, output)
    return absolute(output)


def require_picture(scene: bpy.types.Scene, output: Path | str, samples: int | range | None) -> None:
    """Make sure that a scene can be rendered to a file.

    :raises RenderError: if not, or if no picture would be written.
    """
    file_format_of(output)
    picture_files()
    if scene.camera is None:
        raise RenderError(f"scene {scene.name!r} has no camera; add one and make it active")
    if not any(layer.use for layer in scene.view_layers):
        # Blender would write black, or crash on writing OpenEXR.
        raise RenderError(f"scene {scene.name!r} has no view layer that is used for rendering; switch one on")
    if scene.render.use_multiview and scene.render.image_settings.views_format == "INDIVIDUAL":
        raise RenderError(f"scene {scene.name!r} has a picture for each view; choose Stereo 3D as Views Format")
    if isinstance(samples, range):
        require_part(scene, output, samples)
    else:
        require_within(scene.cycles, "samples", samples)


def check_whole(scene: bpy.types.Scene, file: Path, output: Path | str) -> None:
    """Make sure that a file holds a whole picture of the size that a scene's have.

    :param output: what the file is to be called.
    :raises WriteError: if it does not.
    """
    check_picture(file, output, _size(scene.render), CHANNELS[scene.render.image_settings.color_mode])


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
            set_meanwhile(scene.render, resolution_percentage=percentage),
            set_meanwhile(scene.cycles, samples=samples, use_adaptive_sampling=False),
            bpy.context.temp_override(scene=scene),
        ):
            bpy.ops.render.render()
    finally:
        bpy.app.handlers.render_stats.remove(listen)
    if len(moments) < len(_SAMPLING):
        raise RenderError("Cycles does not say when it samples")
    begin, end = (moments[moment] for moment in _SAMPLING)
    return end - begin


def require_within(owner: Any, name: str, value: int | None) -> None:
    """Refuse a number that Blender would replace by its nearest."""
    limits = owner.bl_rna.properties[name]
    if value is not None and not limits.hard_min <= value <= limits.hard_max:
        raise RenderError(f"{limits.name} {value}: must be {limits.hard_min} to {limits.hard_max}")


def _size(render: bpy.types.RenderSettings) -> tuple[int, int] | None:
    """Return the width and height of the pictures in pixels; None where a border cuts them or views share them."""
    if render.use_multiview or (render.use_border and render.use_crop_to_border):
        return None
    return tuple(side * render.resolution_percentage // 100 for side in (render.resolution_x, render.resolution_y))
