"""Renders the manual's pictures: those whose scripts have changed since, or those that are named."""

from __future__ import annotations

import hashlib
import json
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import bpy
import colours
import frames
import lamps
import library
import nesting
import numpy as np

import nested_dielectric as nd
from nested_dielectric.scene.rendering import render_frame

HERE = Path(__file__).resolve().parent
FOLDER = HERE.parent / "pictures"
MADE = FOLDER / "made.json"
"""By picture the digest of the scripts that it was made by."""

MODULES = (nesting, colours, lamps)
SHEET = "presets"
"""The contact sheet of the library."""


def everything() -> dict[str, tuple]:
    """Return all pictures by name, each with the module that it comes from."""
    return {name: (module, *picture) for module in MODULES for name, picture in module.PICTURES.items()}


def digest(module) -> str:
    """Return what changes whenever a picture's scripts do."""
    sources = [HERE / "studio.py", HERE / "frames.py", Path(module.__file__)]
    return hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()[:16]


def make(names: list[str]) -> None:
    """Render the named pictures, or all that are missing or older than their scripts."""
    known = everything()
    unknown = sorted(set(names) - {*known, SHEET})
    if unknown:
        raise SystemExit(f"no picture {', '.join(unknown)}; known are: {', '.join((*known, SHEET))}")
    made = json.loads(MADE.read_text()) if MADE.is_file() else {}
    for name, (module, columns, panels) in known.items():
        if _is_wanted(name, names, made, digest(module)):
            start = time.process_time()
            pictures = [(words, photographed(build)) for words, build in panels.items()]
            _keep(name, frames.grid(pictures, columns) if len(pictures) > 1 else pictures[0][1], made, digest(module))
            print(f"{name}: {time.process_time() - start:.0f} CPU s", flush=True)
    if library.previews() and _is_wanted(SHEET, names, made, library.digest()):
        _keep(SHEET, library.contact_sheet(), made, library.digest())


def _is_wanted(name: str, names: list[str], made: dict[str, str], now: str) -> bool:
    if names:
        return name in names
    return made.get(name) != now or not (FOLDER / f"{name}.jpg").is_file()


def _keep(name: str, pixels: np.ndarray, made: dict[str, str], now: str) -> None:
    path = FOLDER / f"{name}.jpg"
    frames.save(pixels, path)
    made[name] = now
    MADE.write_text(json.dumps(made, indent=1, sort_keys=True) + "\n")
    print(f"{path}: {path.stat().st_size / 1024:.0f} kB", flush=True)


def photographed(build: Callable[[], bpy.types.Scene]) -> np.ndarray:
    """Build a scene, prepare and render it; (height, width, 3) bytes."""
    scene = build()
    prepared = nd.prepare(scene)
    for problem in prepared.problems:
        print(f"  {problem}")
    with tempfile.TemporaryDirectory() as folder:
        return frames.read(render_frame(scene, Path(folder, "panel.png")))
