"""Render the previews of the presets that have none, or have changed since: ``make assets``.

The pictures lie in ``presets/previews``; each holds the digest of what it shows.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import sys
import tempfile
from pathlib import Path
from time import perf_counter, process_time

import bpy

import nested_dielectric as nd
from nested_dielectric.model.files import replacing
from nested_dielectric.model.presets import Preset, load_preset, preset_names
from nested_dielectric.ui.presets.preset_pictures import picture_path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from preview_scenes import build, kind_of

bpy.utils.expose_bundled_modules()
import OpenImageIO as oiio

EDITION = 1
"""To be counted on when the scenes change, so that all previews are rendered anew."""

SIZE = 160
SAMPLES = 24
QUALITY = 84
LICENCE = "CC0-1.0"


def digest(preset: Preset) -> str:
    """Return what a preview depends on in a few letters."""
    content = json.dumps([EDITION, kind_of(preset), preset.parameters], sort_keys=True)
    return hashlib.sha256(content.encode()).hexdigest()[:16]


def shown_digest(path: Path) -> str:
    """Return the digest that a preview was rendered with; empty if there is none."""
    if not path.is_file():
        return ""
    spec = oiio.ImageBuf(str(path)).spec()
    return spec.get_string_attribute("ImageDescription").rpartition(" ")[2]


def render(preset: Preset, path: Path) -> None:
    """Render a preset's preview and write it."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = build(preset)
    preparation = nd.prepare(scene)
    for problem in preparation.problems:
        print(f"{preset.key}: {problem}", file=sys.stderr)
    set_render(scene)
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder, "preview.png"))
        bpy.ops.render.render(write_still=True)
        pixels = oiio.ImageBuf(scene.render.filepath)
        spec = oiio.ImageSpec(SIZE, SIZE, 3, oiio.UINT8)
        spec.attribute("CompressionQuality", QUALITY)
        spec.attribute("jpeg:subsampling", "4:4:4")
        spec.attribute("ImageDescription", f"{preset.name} {digest(preset)}")
        spec.attribute("Copyright", LICENCE)
        with replacing(path) as draft:
            file = oiio.ImageOutput.create("jpg")
            done = file.open(os.fsencode(draft), spec) and file.write_image(pixels.get_pixels(oiio.UINT8)[..., :3])
            if not (file.close() and done):
                raise OSError(f"{path}: {file.geterror()}")


def set_render(scene: bpy.types.Scene) -> None:
    """Few samples that a denoiser smooths, and colours that are not bleached."""
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "PNG"
    scene.view_settings.view_transform = "Khronos PBR Neutral"
    cycles = scene.cycles
    cycles.samples = SAMPLES
    cycles.use_adaptive_sampling = True
    cycles.adaptive_threshold = 0.02
    cycles.use_denoising = True
    cycles.denoiser = "OPENIMAGEDENOISE"
    cycles.max_bounces = cycles.transmission_bounces = cycles.glossy_bounces = 24
    cycles.sample_clamp_indirect = 8.0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("keys", nargs="*", help="presets to render whatever they have (default: those that need it)")
    keys = parser.parse_args().keys
    for key in keys or preset_names():
        preset = load_preset(key)
        path = picture_path(key)
        if keys or shown_digest(path) != digest(preset):
            wall, cpu = perf_counter(), process_time()
            render(preset, path)
            print(f"{key}: {perf_counter() - wall:.1f} s, {process_time() - cpu:.1f} CPU s", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
