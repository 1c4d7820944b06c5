"""The asset library, and media that are dragged from it."""

import subprocess
import sys
from pathlib import Path

import bpy

from nested_dielectric.ui.asset_library import FILE

ROOT = Path(__file__).resolve().parents[2]


def build_library(place: Path) -> Path:
    """Build the library in a place, as ``make extension`` does; return its folder."""
    folder = place / "nested_dielectric" / "library"
    done = subprocess.run(
        [sys.executable, ROOT / "presets" / "assets" / "library.py", folder], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


def append(library: Path, *names: str) -> list[bpy.types.Material]:
    """Append materials one after the other, as dropping them does."""
    for name in names:
        bpy.ops.wm.append(directory=f"{library / FILE.name}/Material/", filename=name)
    return [bpy.data.materials[name] for name in names]
