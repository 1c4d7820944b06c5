"""Build the asset library: a .blend of the materials of all presets, with their previews, catalogues and tags.

It takes seconds, as the previews are rendered already; ``make extension`` puts it into the zip.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from uuid import UUID, uuid5

import bpy
import numpy as np

import nested_dielectric as nd
from nested_dielectric.model.files import replacing
from nested_dielectric.model.presets import GROUPS, Preset, all_presets
from nested_dielectric.ui.presets.preset_pictures import picture_path

bpy.utils.expose_bundled_modules()
import OpenImageIO as oiio

FILE_NAME = "nested_dielectric.blend"
CATALOGUES = "blender_assets.cats.txt"
ROOT_CATALOGUE = "Nested Dielectric"
NAMESPACE = UUID("6d2f0c0e-6f3a-5f2b-9a35-6b1d5d6a1c77")
"""Catalogues keep their numbers by it from one version to the next."""

LICENCE = "CC0-1.0"
LICENCE_PAGE = "https://creativecommons.org/publicdomain/zero/1.0/"
AUTHOR = "Nested Dielectric developers"
COPYRIGHT = "None: public domain (CC0-1.0)"


def catalogue_id(group: str) -> str:
    """Return the number of a group's catalogue."""
    return str(uuid5(NAMESPACE, group))


def catalogue_text() -> str:
    """Return the file of catalogues as Blender reads it."""
    lines = ["VERSION 1", "", f"{catalogue_id('')}:{ROOT_CATALOGUE}:{ROOT_CATALOGUE}"]
    lines += [f"{catalogue_id(group)}:{ROOT_CATALOGUE}/{group}:{ROOT_CATALOGUE}-{group}" for group in GROUPS]
    return "\n".join(lines) + "\n"


def add_asset(preset: Preset) -> bpy.types.Material:
    """Make a preset's material an asset of the open file."""
    material = nd.new_material(preset.name, preset=preset.key)
    material.asset_mark()
    data = material.asset_data
    data.catalog_id = catalogue_id(preset.group)
    data.description = f"{preset.description} {preset.source}"
    data.author, data.license, data.copyright = AUTHOR, LICENCE, COPYRIGHT
    for tag in dict.fromkeys((preset.group.lower(), *preset.tags)):
        data.tags.new(tag, skip_if_exists=True)
    path = picture_path(preset.key)
    if path.is_file():
        set_preview(material, oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT))
    return material


def set_preview(material: bpy.types.Material, picture: np.ndarray) -> None:
    """Give a material a picture, (height, width, 3) with the top row first."""
    height, width = picture.shape[:2]
    pixels = np.ones((height, width, 4), dtype=np.float32)
    pixels[..., :3] = picture[::-1, :, :3]
    preview = material.preview_ensure()
    preview.image_size = (width, height)
    preview.image_pixels_float.foreach_set(pixels.ravel())


def build(folder: Path) -> Path:
    """Write the library into a folder and return its file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    materials = {add_asset(preset) for preset in all_presets()}
    text = bpy.data.texts.new("Licence")
    text.write(f"These materials are in the public domain: {LICENCE}, {LICENCE_PAGE}\n")
    path = folder / FILE_NAME
    with replacing(path) as draft:
        bpy.data.libraries.write(str(draft), materials | {text}, fake_user=True, compress=True)
    with replacing(folder / CATALOGUES) as draft:
        draft.write_text(catalogue_text(), encoding="utf-8")
    return path


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?", default=Path("library"), help="where to (default: library)")
    path = build(parser.parse_args().folder)
    print(f"wrote {len(all_presets())} media, {os.path.getsize(path) / 1e6:.1f} MB: {path}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
