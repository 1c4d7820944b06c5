"""From panels to a file: beside each other, each with its name below."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np

bpy.utils.expose_bundled_modules()
import OpenImageIO as oiio

PAPER = (250, 250, 248)
INK = "#2a2a2a"
GAP = 6
"""Pixels between panels."""

LABEL_HEIGHT = 26
QUALITY = "jpeg:88"


def read(path: Path) -> np.ndarray:
    """Read a picture; (height, width, 3) bytes."""
    pixels = oiio.ImageBuf(str(path)).get_pixels(oiio.UINT8)
    if pixels is None:
        raise OSError(f"{path} is no picture")
    return np.asarray(pixels)[..., :3]


def save(pixels: np.ndarray, path: Path) -> None:
    """Write bytes of (height, width, 3) as a JPEG."""
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, oiio.UINT8)
    spec.attribute("Compression", QUALITY)
    picture = oiio.ImageBuf(spec)
    picture.set_pixels(spec.roi, np.ascontiguousarray(pixels))
    if not picture.write(str(path)):
        raise OSError(f"{path}: {picture.geterror()}")


def resized(pixels: np.ndarray, width: int, height: int) -> np.ndarray:
    """Return a picture in another size, filtered."""
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, oiio.UINT8)
    picture = oiio.ImageBuf(spec)
    picture.set_pixels(spec.roi, np.ascontiguousarray(pixels))
    small = oiio.ImageBufAlgo.resize(picture, roi=oiio.ROI(0, width, 0, height, 0, 1, 0, 3))
    return np.asarray(small.get_pixels(oiio.UINT8))


def text(
    words: str, width: int, height: int = LABEL_HEIGHT, size: float = 13.0, bold: bool = False, centred: bool = True
) -> np.ndarray:
    """Return words as a picture of a given size, in its middle or at its left."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width / 100.0, height / 100.0), dpi=100, facecolor=np.array(PAPER) / 255.0)
    canvas = FigureCanvasAgg(figure)
    weight = "bold" if bold else "normal"
    place, side = (0.5, "center") if centred else (2.0 / width, "left")
    figure.text(place, 0.5, words, ha=side, va="center", fontsize=size * 0.72, color=INK, weight=weight)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def sheet(rows: Sequence[Sequence[np.ndarray]]) -> np.ndarray:
    """Return rows of pictures as one, on paper; rows may differ in height, and the last ones be shorter."""
    bands = [_beside(row) for row in rows]
    width = max(band.shape[1] for band in bands)
    height = sum(band.shape[0] for band in bands) + GAP * (len(bands) - 1)
    whole = np.full((height, width, 3), PAPER, np.uint8)
    top = 0
    for band in bands:
        whole[top : top + band.shape[0], : band.shape[1]] = band
        top += band.shape[0] + GAP
    return whole


def _beside(pictures: Sequence[np.ndarray]) -> np.ndarray:
    height = max(picture.shape[0] for picture in pictures)
    width = sum(picture.shape[1] for picture in pictures) + GAP * (len(pictures) - 1)
    band = np.full((height, width, 3), PAPER, np.uint8)
    left = 0
    for picture in pictures:
        band[: picture.shape[0], left : left + picture.shape[1]] = picture
        left += picture.shape[1] + GAP
    return band


def labelled(picture: np.ndarray, words: str) -> np.ndarray:
    """Return a picture with its name below."""
    return np.concatenate((picture, text(words, picture.shape[1])))


def grid(panels: Sequence[tuple[str, np.ndarray]], columns: int) -> np.ndarray:
    """Return panels with their names below them, in so many columns."""
    named = [labelled(picture, words) for words, picture in panels]
    return sheet([named[first : first + columns] for first in range(0, len(named), columns)])
