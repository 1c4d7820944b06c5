"""The contact sheet of the library: the previews of all presets, by groups."""

from __future__ import annotations

import hashlib
from pathlib import Path

import frames
import numpy as np

from nested_dielectric.model.presets import GROUPS, PRESET_FOLDER, Preset, load_preset, preset_names

PREVIEWS = PRESET_FOLDER / "previews"
COLUMNS = 9
CELL = 92
LABEL = 18
HEADING = 24


def previews() -> dict[str, Path]:
    """Return the previews that there are, by presets' keys."""
    return {key: path for key in preset_names() for path in sorted(PREVIEWS.glob(f"{key}.*"))[:1]}


def digest() -> str:
    """Return what changes whenever the sheet does."""
    sources = [Path(__file__), Path(frames.__file__), *previews().values()]
    return hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()[:16]


def contact_sheet() -> np.ndarray:
    """Return the previews by groups, each with its preset's name."""
    found = previews()
    rows = []
    for group in GROUPS:
        presets = sorted((load_preset(key) for key in found), key=lambda preset: preset.name)
        cells = [_cell(preset, found[preset.key]) for preset in presets if preset.group == group]
        if cells:
            width = COLUMNS * (CELL + frames.GAP) - frames.GAP
            rows.append([frames.text(group, width, HEADING, bold=True, centred=False)])
            rows += [cells[first : first + COLUMNS] for first in range(0, len(cells), COLUMNS)]
    return frames.sheet(rows)


def _cell(preset: Preset, path: Path) -> np.ndarray:
    picture = frames.resized(frames.read(path), CELL, CELL)
    size = min(10.0, 10.0 * 15 / max(len(preset.name), 1))
    return np.concatenate((picture, frames.text(preset.name, CELL, LABEL, size)))
