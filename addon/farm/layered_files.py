"""OpenEXR files of many layers, read and written a band of rows at a time: large frames would not fit in memory whole."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from ..scene.output import picture_files

BAND = 64
"""Rows at a time."""


class LayeredFileError(RuntimeError):
    """A file of layers that cannot be read or written."""


@contextmanager
def opened(path: Path) -> Iterator[Any]:
    """Yield a file's OpenImageIO ``ImageInput``.

    :raises LayeredFileError: if it is no picture.
    """
    oiio = picture_files()
    picture = oiio.ImageInput.open(os.fsencode(path))
    if picture is None:
        raise LayeredFileError(f"{path}: cannot be read ({' '.join(oiio.geterror().split())}); render it again")
    try:
        yield picture
    finally:
        picture.close()


def read_rows(picture: Any, begin: int, end: int) -> np.ndarray:
    """Return rows of an open file, counted from its first; (rows, width, channels) floats.

    :raises LayeredFileError: if the file is not whole.
    """
    oiio = picture_files()
    spec = picture.spec()
    rows = picture.read_scanlines(spec.y + begin, spec.y + end, 0, 0, spec.nchannels, oiio.FLOAT)
    if rows is None or picture.has_error:
        raise LayeredFileError(f"a picture is not whole ({' '.join(picture.geterror().split())})")
    return np.asarray(rows, dtype=np.float32).reshape(end - begin, spec.width, spec.nchannels)


def write(path: Path, spec: Any, rows: Callable[[int, int], np.ndarray]) -> None:
    """Write a file of an OpenImageIO ``ImageSpec``.

    :param rows: returns those from a first up to a last, which is left out; (rows, width, channels).
    :raises LayeredFileError: if it cannot be written.
    """
    oiio = picture_files()
    output = oiio.ImageOutput.create("exr")
    done = output.open(os.fsencode(path), spec)
    for begin in range(0, spec.height, BAND) if done else ():
        end = min(begin + BAND, spec.height)
        band = np.ascontiguousarray(rows(begin, end), dtype=np.float32)
        done = done and output.write_scanlines(spec.y + begin, spec.y + end, 0, band)
    text = output.geterror()
    if not (output.close() and done):
        raise LayeredFileError(f"{path.name}: cannot be written ({' '.join(text.split())}); is the disk full?")
