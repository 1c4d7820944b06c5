"""Merged pictures denoised as Cycles denoises what it renders."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ..scene.output import picture_files
from .layered_files import opened, read_rows, write

_MOTION = tuple(f"Vector.{axis}" for axis in "XYZW")
"""Without which Cycles denoises no file, though a single picture needs none of it."""

_NORMAL = ".Denoising Normal.X"

DENOISED = "nested_dielectric.denoised"
"""Metadata of what is denoised, with which nothing can be merged any more."""


class DenoiseError(RuntimeError):
    """A file that Cycles cannot denoise."""


def denoise(file: Path, scene: bpy.types.Scene, layer: bpy.types.ViewLayer) -> None:
    """Denoise the layers of a file that hold what denoising needs.

    Its rows are turned upside down meanwhile: Cycles denoises files with the top row first and renders with the bottom row
    first, and denoisers give another picture for the mirrored one.

    :param file: named as nothing else in its folder is, with whatever its name goes on with.
    :param layer: of the scene; its settings hold.
    :raises DenoiseError: if Cycles cannot.
    """
    import _cycles

    oiio = picture_files()
    turned, clean = (file.with_name(f"{file.stem}_{word}.exr") for word in ("turned", "clean"))
    with opened(file) as picture:
        spec = oiio.ImageSpec(picture.spec())
        names = tuple(spec.channelnames)
        motion = [each for each in _motion(names) if each not in names]
        _turn(picture, turned, _with_channels(spec, (*names, *motion)), len(motion))
    try:
        _cycles.denoise(
            bpy.context.preferences.as_pointer(),
            scene.as_pointer(),
            layer.as_pointer(),
            input=[str(turned)],
            output=[str(clean)],
        )
    except Exception as error:  # of whatever kind Cycles' is
        raise DenoiseError(f"scene {scene.name!r}: the merged picture cannot be denoised ({error})") from None
    with opened(clean) as picture:
        places = [picture.spec().channelnames.index(name) for name in names]
        spec.attribute(DENOISED, 1)
        _turn(picture, file, spec, 0, places)
    for each in (turned, clean):
        each.unlink()


def _motion(names: tuple[str, ...]) -> list[str]:
    """Return the channels of motion that the layers to be denoised need."""
    layers = [name.removesuffix(_NORMAL) for name in names if name.endswith(_NORMAL)]
    return [f"{layer}.{channel}" for layer in layers for channel in _MOTION]


def _with_channels(spec: Any, names: tuple[str, ...]) -> Any:
    """Return a copy of an OpenImageIO ``ImageSpec`` with channels of these names."""
    oiio = picture_files()
    copy = oiio.ImageSpec(spec)
    copy.nchannels, copy.channelnames, copy.channelformats = len(names), names, ()
    return copy


def _turn(picture: Any, path: Path, spec: Any, added: int, places: list[int] | None = None) -> None:
    """Write an open file upside down, with channels of zeros added at the end, or with some of its channels alone."""

    def rows(begin: int, end: int) -> np.ndarray:
        band = read_rows(picture, spec.height - end, spec.height - begin)[::-1]
        band = band if places is None else band[..., places]
        return np.pad(band, ((0, 0), (0, 0), (0, added)))

    write(path, spec, rows)
