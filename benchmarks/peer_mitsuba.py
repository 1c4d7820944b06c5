"""Mitsuba 3 on a scene of the benchmark."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterable
from pathlib import Path

import numpy as np


def import_mitsuba(variant: str):
    """Mitsuba, with the newest LLVM of this environment unless another one is named."""
    if libraries := sorted(Path(sys.prefix, "lib").glob("libLLVM*.so*")):
        os.environ.setdefault("DRJIT_LIBLLVM_PATH", str(libraries[-1]))
    import mitsuba

    mitsuba.set_variant(variant)
    return mitsuba


def pole_to_pole(environment: np.ndarray) -> np.ndarray:
    """The same sky for a renderer that puts the first and the last row of the picture on the poles, not half a row off.

    (h, w, 3) to (2 h + 1, w, 3): the rows, and what linear interpolation makes halfway between them.
    """
    height, width, channels = environment.shape
    padded = np.pad(environment, ((1, 1), (0, 0), (0, 0)), mode="edge")
    rows = np.empty((2 * height + 1, width, channels), np.float32)
    rows[0::2] = (padded[:-1] + padded[1:]) / 2.0
    rows[1::2] = environment
    return rows


def mitsuba_scene(mi, job: dict, environment: np.ndarray):
    """The scene as Mitsuba wants it."""
    to_world = mi.ScalarTransform4f
    description = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": job["segments"], "rr_depth": 1 << 20},
        "sensor": {
            "type": "perspective",
            "fov": job["angle"],
            "near_clip": 1e-3,
            "far_clip": 1e5,
            "to_world": to_world().look_at(origin=job["location"], target=job["target"], up=[0, 0, 1]),
            "film": {
                "type": "hdrfilm",
                "width": job["resolution"],
                "height": job["resolution"],
                "pixel_format": "rgb",
                "component_format": "float32",
                "rfilter": {"type": "box"},
            },
            "sampler": {"type": "multijitter"},
        },
        "sky": {
            "type": "envmap",
            "bitmap": mi.Bitmap(pole_to_pole(environment)),
            # Mitsuba's Y is up, and its Z is in the middle of the picture.
            "to_world": to_world([[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]]),
        },
    }
    for place, medium in enumerate(job["media"]):
        (ratio,) = medium["key"]
        description[f"medium{place}"] = {
            "type": "ply",
            "filename": medium["path"],
            "face_normals": True,
            "bsdf": {"type": "dielectric", "int_ior": ratio, "ext_ior": 1.0},
        }
    return mi.load_dict(description)


def mitsuba_picture(job: dict, environment: np.ndarray) -> tuple[np.ndarray, float]:
    """Picture and seconds."""
    mi = import_mitsuba(job["variant"])
    scene = mitsuba_scene(mi, job, environment)
    import drjit

    # A kernel is good for one number of samples, so that a small picture beforehand would not spare compiling.
    drjit.set_flag(drjit.JitFlag.KernelHistory, True)
    start = time.perf_counter()
    picture = np.array(mi.render(scene, spp=job["samples"], seed=job["seed"]))
    seconds = time.perf_counter() - start
    return picture, seconds - compiling_seconds(drjit.kernel_history())


def compiling_seconds(kernels: Iterable[dict]) -> float:
    """What a history of kernels, in milliseconds, says of their compilation; cached ones take none."""
    return sum(kernel.get("codegen_time", 0.0) + kernel.get("backend_time", 0.0) for kernel in kernels) / 1000.0
