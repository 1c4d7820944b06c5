"""Spectral tables in the file: rows of one packed image, which the node group reads."""

from __future__ import annotations

import hashlib

import bpy
import numpy as np

IMAGE_NAME = "Nested Dielectric Spectra"
TABLES = "nd_tables"
"""Custom property of the image: a digest of every row's table, from the bottom up."""


def digest(table: np.ndarray) -> str:
    """Name a table by its content."""
    return hashlib.sha256(table.tobytes()).hexdigest()[:16]


def read_rows(image: bpy.types.Image) -> np.ndarray:
    """Return an image's tables, from the bottom up; (rows, entries, 4)."""
    width, height = image.size
    rows = np.empty((height, width, image.channels), dtype=np.float32)
    image.pixels.foreach_get(rows.ravel())
    return rows


def ensure_row(image: bpy.types.Image | None, table: np.ndarray) -> tuple[bpy.types.Image, int]:
    """Return an image that holds a table of shape (entries, 4), and the table's row in it.

    Without an image one is made. Rows are only ever added, so those that materials already use stay. A new row
    needs a taller image, which then takes the old one's place everywhere.
    """
    name = digest(table)
    known = [] if image is None else list(image[TABLES])
    if name in known:
        return image, known.index(name)
    old = np.empty((0, *table.shape), dtype=np.float32) if image is None else read_rows(image)
    rows = np.concatenate([old, table[None].astype(np.float32)])

    taller = bpy.data.images.new(IMAGE_NAME, len(table), len(rows), alpha=True, float_buffer=True, is_data=True)
    taller.alpha_mode = "CHANNEL_PACKED"
    taller.pixels.foreach_set(rows.ravel())
    taller.pack()
    taller[TABLES] = [*known, name]
    if image is not None:
        image.user_remap(taller)
        bpy.data.images.remove(image)
        taller.name = IMAGE_NAME
    return taller, len(known)
