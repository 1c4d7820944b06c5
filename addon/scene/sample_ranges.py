"""Parts of a picture: of each pixel's samples those of a range, in files that Cycles' own merging puts together."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import bpy

from ..model.files import WriteError
from .image_formats import LAYERS_FORMAT, image_format
from .meanwhile import set_meanwhile
from .output import picture_files, reason
from .passes import compositors
from .render_error import RenderError

SAMPLES = "nested_dielectric.samples"
"""Metadata that says which samples a file holds, as ``A:B``."""

_COUNTS = re.compile(r"cycles\..*\.samples")
"""Metadata by which Cycles' merging weighs the layers of a file."""


def require_part(scene: bpy.types.Scene, output: Path | str, samples: range) -> None:
    """Make sure that some of a scene's samples are a part of the picture that it renders in one go.

    :raises RenderError: if they are not, if the scene has fewer samples, or for an ending other than ``.exr``.
    """
    if Path(output).suffix.lower() != ".exr":
        raise RenderError(f"{output}: a range of samples is kept in OpenEXR alone; let the ending be .exr")
    name = f"scene {scene.name!r}"
    if scene.render.engine != "CYCLES":
        raise RenderError(f"{name} does not render with Cycles, which alone renders ranges of samples")
    if not 0 <= samples.start < samples.stop <= scene.cycles.samples:
        raise RenderError(
            f"samples {samples.start}:{samples.stop}: {name} has {scene.cycles.samples}, so name a range within "
            f"0:{scene.cycles.samples}"
        )
    if scene.render.use_compositing and compositors(scene):
        raise RenderError(
            f"{name} has a compositor, which would work on each range of samples; render its frames whole, or switch "
            "Output > Post Processing > Compositing off"
        )
    if scene.render.use_multiview:
        raise RenderError(f"{name} has several views, which cannot be merged; render its frames whole")
    own = [layer for layer in scene.view_layers if layer.use and layer.samples]
    if own and scene.cycles.use_layer_samples != "IGNORE":
        raise RenderError(
            f"view layer {own[0].name!r} of {name} has samples of its own; set Layer Samples to Ignore, or render whole frames"
        )


def denoised_layers(scene: bpy.types.Scene) -> list[bpy.types.ViewLayer]:
    """Return the view layers of a scene whose pictures are denoised."""
    return [
        layer for layer in scene.view_layers if scene.cycles.use_denoising and layer.use and layer.cycles.use_denoising
    ]


@contextmanager
def rendering_part(scene: bpy.types.Scene, samples: range) -> Iterator[None]:
    """Let renders of a scene draw some of its samples alone, and nothing work on their result.

    The number of the scene's samples stays, as the places of all of them hang on it. What denoising needs is in the files of
    scenes that denoise.
    """
    cycles = scene.cycles
    with ExitStack() as undo:
        for layer in denoised_layers(scene):
            undo.enter_context(set_meanwhile(layer.cycles, denoising_store_passes=True))
        undo.enter_context(
            set_meanwhile(
                cycles,
                use_adaptive_sampling=False,
                use_denoising=False,
                time_limit=0.0,
                use_sample_subset=True,
                sample_offset=samples.start,
                sample_subset_length=len(samples),
            )
        )
        undo.enter_context(image_format(scene, LAYERS_FORMAT))
        yield


def tell_samples(file: Path, path: Path | str, samples: range) -> None:
    """Write into a part which samples it holds; their number weighs it where parts of different length are merged.

    Cycles writes the number of the whole picture's samples.

    :param path: what the file is to be called.
    :raises WriteError: if the file cannot be read or written.
    """
    oiio = picture_files()
    name = os.fsencode(file)
    picture = oiio.ImageInput.open(name)
    if picture is None:
        raise WriteError(f"{path}: was not written whole ({reason(oiio.geterror(), file, path)}); is the disk full?")
    try:
        spec = oiio.ImageSpec(picture.spec())
        pixels = picture.read_image(0, 0, 0, spec.nchannels, oiio.FLOAT)
        whole = pixels is not None and not picture.has_error
    finally:
        picture.close()
    counts = [each.name for each in spec.extra_attribs if _COUNTS.fullmatch(each.name)]
    if not whole or not counts:
        raise WriteError(f"{path}: was not written whole; is the disk full?")
    for each in counts:
        spec.attribute(each, str(len(samples)))
    spec.attribute(SAMPLES, f"{samples.start}:{samples.stop}")
    output = oiio.ImageOutput.create("exr")
    done = output.open(name, spec) and output.write_image(pixels)
    if not (output.close() and done):
        raise WriteError(f"{path}: was not written whole ({reason(output.geterror(), file, path)}); is the disk full?")
