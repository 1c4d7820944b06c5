"""OpenEXR files of many layers, as arrays by the names of their channels."""

from pathlib import Path

import numpy as np
from scenes import oiio


def channels_of(path: Path | str) -> dict[str, np.ndarray]:
    """Read the channels of a file of one part; each (height, width)."""
    buffer = oiio.ImageBuf(str(path))
    pixels = np.asarray(buffer.get_pixels(oiio.FLOAT))
    assert buffer.nsubimages == 1 and pixels.size, path
    return {name: pixels[..., place] for place, name in enumerate(buffer.spec().channelnames)}


def coverage(channels: dict[str, np.ndarray], matte: str) -> dict[int, np.ndarray]:
    """Return what each number of a matte covers of the pixels; each (height, width)."""
    found: dict[int, np.ndarray] = {}
    for name, numbers in channels.items():
        if name.startswith(f"ViewLayer.{matte}") and name[-1] in "rb":
            covered = channels[name[:-1] + {"r": "g", "b": "a"}[name[-1]]]
            bits = np.ascontiguousarray(numbers).view(np.uint32)
            for number in np.unique(bits):
                found[number] = found.get(number, 0.0) + np.where(bits == number, covered, 0.0)
    return {number: covered for number, covered in found.items() if covered.any()}
