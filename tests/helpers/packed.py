"""Files that are packed, taken away from where they were, and rendered as farms do without the extension."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
from scenes import read_picture

from nested_dielectric.farm.packing import Packed, pack

JOB = Path(__file__).with_name("stock_job.py")

WITHOUT_OSL = {"cycles.shading_system": False}
"""What a GPU makes of a file, on the CPU: Cycles runs no Script node."""

ON_GPU = {"cycles.device": "GPU"}


def packed_away(folder: Path, **options: object) -> tuple[Path, Packed]:
    """Save the open scene in a folder of its own, pack it into an empty one, and take the first away."""
    studio, farm = folder / "studio", folder / "farm"
    for each in (studio, farm):
        each.mkdir(exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(studio / "scene.blend"))
    packed = pack(farm / "packed.blend", **options)
    shutil.rmtree(studio)
    return farm / "packed.blend", packed


def on_farm(file: Path, *changes: dict[str, object], **job: object) -> list[np.ndarray]:
    """Render a file in a process of its own, in an empty folder, each time with other changes; return the pictures.

    :param job: `frame`.
    :raises AssertionError: if the file needs any other.
    """
    folder = file.parent / "pictures"
    folder.mkdir(exist_ok=True)
    pictures = [folder / f"{place}.exr" for place in range(len(changes))]
    jobs = [
        {"file": str(file), "output": str(picture), "settings": settings, **job}
        for picture, settings in zip(pictures, changes)
    ]
    assert run_jobs(folder, jobs) == []
    return [read_picture(picture) for picture in pictures]


def run_jobs(folder: Path, jobs: list[dict[str, object]]) -> list[str]:
    """Do jobs in a process of its own that begins in a folder; return the paths of what their files need besides themselves."""
    listing = folder / "jobs.json"
    listing.write_text(json.dumps(jobs), encoding="utf-8")
    done = subprocess.run(
        [sys.executable, str(JOB), str(listing)], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return [line.removeprefix("NEEDS ") for line in done.stdout.splitlines() if line.startswith("NEEDS ")]


def alarm(picture: np.ndarray) -> float:
    """Return which part of a picture is magenta."""
    red, green, blue = np.moveaxis(picture, 2, 0)
    return float(((green < 0.02) & (red > 0.05) & (blue > 0.05)).mean())
