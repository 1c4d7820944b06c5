"""Formats of pictures: which one a path's ending names, and scenes that write it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy

from .render_error import RenderError

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

LAYERS_FORMAT = "OPEN_EXR_MULTILAYER"
"""OpenEXR with all layers and passes, whatever the scene's depth and compression are as 32-bit floats without loss."""

CHANNELS = {"BW": 1, "RGB": 3, "RGBA": 3}
"""Fewest channels of a picture by its colour mode: WebP drops alpha that is 1 all over."""

_BOUND_SETTINGS = ("media_type", "file_format", "color_mode", "color_depth", "exr_codec", "use_exr_interleave")
"""Each bounds the next one's values, so their order matters."""


def file_format_of(output: Path | str) -> str:
    """Return what Blender calls the format that a path's ending names.

    :raises RenderError: if it names none.
    """
    file_format = FILE_FORMATS.get(Path(output).suffix.lower())
    if file_format is None:
        raise RenderError(f"{Path(output).name}: the ending must be one of {', '.join(FILE_FORMATS)}")
    return file_format


@contextmanager
def image_format(scene: bpy.types.Scene, file_format: str) -> Iterator[None]:
    """Let a scene write a format meanwhile."""
    settings = scene.render.image_settings
    before = {name: getattr(settings, name) for name in _BOUND_SETTINGS}
    try:
        settings.media_type = "MULTI_LAYER_IMAGE" if file_format == LAYERS_FORMAT else "IMAGE"
        settings.file_format = file_format
        if file_format == LAYERS_FORMAT:
            settings.color_depth = "32"
            settings.exr_codec = "ZIP"
            settings.use_exr_interleave = True  # of several parts in a file Cycles' merging would keep the first alone
        if file_format == "WEBP" and settings.color_mode == "BW":
            settings.color_mode = "RGB"  # which WebP has no other than
        yield
    finally:
        for name, value in before.items():
            setattr(settings, name, value)
