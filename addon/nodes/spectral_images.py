"""Spectral tables in the file: rows of one packed image, which the node group reads."""

from __future__ import annotations

import hashlib

import bpy
import numpy as np

IMAGE_NAME = "Nested Dielectric Spectra"
TABLES = "nd_tables"
"""Custom property that tells the image from others: a digest of every row's table, from the bottom up. What a row holds
is read from the row itself, since anybody may paint on an image.
"""


def digest(table: np.ndarray) -> str:
    """Name a table by its content."""
    return hashlib.sha256(table.astype(np.float32).tobytes()).hexdigest()[:16]


def read_rows(image: bpy.types.Image | None) -> np.ndarray | None:
    """Return an image's tables, from the bottom up, (rows, entries, 4); None if it is none of tables, or is lost."""
    if image is None or TABLES not in image or image.channels != 4 or not len(image.pixels):
        return None
    width, height = image.size
    rows = np.empty((height, width, 4), dtype=np.float32)
    image.pixels.foreach_get(rows.ravel())
    return rows


def holds(image: bpy.types.Image | None, row: int, table: np.ndarray) -> bool:
    """Return whether a row of an image is that table, and is read as it is."""
    rows = read_rows(image)
    if rows is None or not 0 <= row < len(rows) or not np.array_equal(rows[row], table.astype(np.float32)):
        return False
    return image.colorspace_settings.is_data and image.alpha_mode == "CHANNEL_PACKED"


def ensure_row(image: bpy.types.Image | None, table: np.ndarray) -> tuple[bpy.types.Image, int]:
    """Return an image that holds a table of shape (entries, 4), and the table's row in it.

    Without an image of such tables one is made. Rows are only ever added, so those that materials already use stay. A new
    row needs a taller image, which then takes the old one's place everywhere.
    """
    old = read_rows(image)
    if old is None or old.shape[1:] != table.shape or image.library is not None:
        image, old = None, np.empty((0, *table.shape), dtype=np.float32)
    new = table.astype(np.float32)
    for row in range(len(old)):
        if np.array_equal(old[row], new):
            image.colorspace_settings.is_data = True
            image.alpha_mode = "CHANNEL_PACKED"
            return image, row
    rows = np.concatenate([old, new[None]])

    taller = bpy.data.images.new(IMAGE_NAME, len(table), len(rows), alpha=True, float_buffer=True, is_data=True)
    taller.alpha_mode = "CHANNEL_PACKED"
    taller.pixels.foreach_set(rows.ravel())
    taller.pack()
    taller[TABLES] = [digest(row) for row in rows]
    if image is not None:
        image.user_remap(taller)
        bpy.data.images.remove(image)
        taller.name = IMAGE_NAME
    return taller, len(old)
