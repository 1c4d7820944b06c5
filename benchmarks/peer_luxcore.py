"""LuxCore on a scene of the benchmark."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np


def cauchy(ior: float, abbe: float) -> tuple[float, float]:
    """A and B in square micrometres of n = A + B / wavelength**2 with that index at 587.56 nm and that Abbe number."""
    if abbe == 0.0:
        return ior, 0.0
    b = (ior - 1.0) / abbe / (0.48613**-2 - 0.65627**-2)
    return ior - b * 0.58756**-2, b


def import_luxcore():
    """LuxCore, silent."""
    import pyluxcore

    pyluxcore.Init(lambda message: None)
    return pyluxcore


def luxcore_scene(lux, job: dict, environment: np.ndarray):
    """The scene as LuxCore wants it."""
    scene = lux.Scene()
    height, width, channels = environment.shape
    scene.DefineImageMap("sky", environment.tobytes(), 1.0, channels, width, height)
    # Its pictures lie one pixel low.
    shift = 2.0 / job["resolution"]
    properties = {
        "scene.camera.type": "perspective",
        "scene.camera.lookat.orig": job["location"],
        "scene.camera.lookat.target": job["target"],
        "scene.camera.up": [0.0, 0.0, 1.0],
        "scene.camera.fieldofview": job["angle"],
        "scene.camera.screenwindow": [-1.0, 1.0, -1.0 - shift, 1.0 - shift],
        "scene.camera.autovolume.enable": False,
        "scene.lights.sky.type": "infinite",
        "scene.lights.sky.file": "sky",
        "scene.lights.sky.gamma": 1.0,
        # Columns run the other way around, from +X.
        "scene.lights.sky.transformation": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],
    }
    for place, medium in enumerate(job["media"]):
        priority, ior, abbe = medium["key"]
        a, b = cauchy(ior, abbe)
        properties |= {
            f"scene.volumes.volume{place}.type": "clear",
            f"scene.volumes.volume{place}.ior": a,
            f"scene.volumes.volume{place}.priority": luxcore_priority(priority, job["media"]),
            f"scene.materials.glass{place}.type": "glass",
            f"scene.materials.glass{place}.kr": [1.0, 1.0, 1.0],
            f"scene.materials.glass{place}.kt": [1.0, 1.0, 1.0],
            f"scene.materials.glass{place}.cauchyb": b,
            f"scene.materials.glass{place}.volume.interior": f"volume{place}",
            f"scene.objects.body{place}.material": f"glass{place}",
            f"scene.objects.body{place}.ply": medium["path"],
        }
    scene.Parse(luxcore_properties(lux, properties))
    return scene


def luxcore_priority(priority: int, media: Sequence[dict]) -> int:
    """The rank among all priorities, from 1: in LuxCore the highest wins."""
    return sum(other >= priority for other in {medium["key"][0] for medium in media})


def luxcore_properties(lux, values: dict):
    """LuxCore's own kind of dictionary."""
    properties = lux.Properties()
    for name, value in values.items():
        properties.Set(lux.Property(name, value))
    return properties


def luxcore_picture(job: dict, environment: np.ndarray) -> tuple[np.ndarray, float]:
    """Picture and seconds."""
    lux = import_luxcore()
    resolution = job["resolution"]
    settings = {
        "renderengine.type": "PATHCPU",
        "renderengine.seed": 10007 * job["seed"] + 1,  # every thread takes one of the seeds that follow
        "sampler.type": "RANDOM",  # takes less time than SOBOL and leaves less noise
        "sampler.random.adaptive.strength": 0.0,
        "path.pathdepth.total": job["segments"],
        "path.pathdepth.diffuse": job["segments"],
        "path.pathdepth.glossy": job["segments"],
        "path.pathdepth.specular": job["segments"],
        "path.russianroulette.depth": 1 << 20,
        "path.clamping.variance.maxvalue": 0.0,
        "film.width": resolution,
        "film.height": resolution,
        "film.filter.type": "BOX",
        "film.filter.width": 0.5,
        "film.imagepipeline.0.type": "NOP",
        "film.outputs.0.type": "RGB",
        "film.outputs.0.filename": "unused.exr",
        "film.noiseestimation.warmup": 1 << 30,
        "batch.haltthreshold": 0.0,
        "batch.haltspp": job["samples"],
    }
    config = lux.RenderConfig(luxcore_properties(lux, settings), luxcore_scene(lux, job, environment))
    session = lux.RenderSession(config)
    session.Start()
    start = time.perf_counter()
    while not session.HasDone():
        time.sleep(0.01)
        session.UpdateStats()
    seconds = time.perf_counter() - start
    session.Stop()
    picture = np.empty((resolution, resolution, 3), np.float32)
    session.GetFilm().GetOutputFloat(lux.FilmOutputType.RGB, picture, 0, True)
    return picture[::-1], seconds
