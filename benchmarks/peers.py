"""Two other renderers on the benchmark's scenes: LuxCore, whose volumes have priorities, and Mitsuba 3, which gets
interfaces split by hand.

They live in an environment of their own, because neither shares a process with bpy. It is looked for at
``benchmarks/.peers``, or where the variable ND_PEERS_PYTHON names its interpreter. To make it::

    python3.13 -m venv benchmarks/.peers
    benchmarks/.peers/bin/pip install numpy==2.5.5 mitsuba==3.9.1 pyluxcore==2.11.2

Mitsuba compiles with LLVM 16 or newer, from the system, the variable DRJIT_LIBLLVM_PATH or the environment's ``lib``;
without it, its slower scalar variant runs. On Debian, without installing anything::

    apt-get download libllvm19 && dpkg-deb -x libllvm19_*.deb llvm
    cp llvm/usr/lib/*/libLLVM.so.19.1 benchmarks/.peers/lib/

What differs from Cycles: Mitsuba does not disperse. LuxCore draws a new wavelength at every refraction, spends bounces
where it leaves a body inside another one, and may take a few samples more than asked for.
"""

from __future__ import annotations

import functools
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from bench_scenes import BenchScene

Piece = tuple[str, np.ndarray, np.ndarray, float]
"""Name, vertices (n, 3), triangles (m, 3) counter-clockwise seen from outside, index inside over index outside."""

KINDS = ("mitsuba", "luxcore")

SEGMENTS = 257
"""Longest path: the 256 bounces of Cycles, and the way to the sky. Both peers count segments."""

LUXCORE_MEDIA = 8
"""Media that LuxCore keeps track of along one path; it forgets those beyond."""


# The benchmark's side -----------------------------------------------------------------------------------------------


def interpreter() -> Path | None:
    """The Python that has the peers, if any."""
    if "ND_PEERS_PYTHON" in os.environ:
        return Path(os.environ["ND_PEERS_PYTHON"])
    default = Path(__file__).resolve().parent / ".peers" / "bin" / "python"
    return default if default.exists() else None


def run_worker(*arguments: str) -> subprocess.CompletedProcess:
    """Run this file in the peers' environment."""
    return subprocess.run(
        [interpreter(), "-I", __file__, *arguments],
        check=False,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


@functools.cache
def available() -> tuple[str, ...]:
    """Those of the peers that can be run."""
    if interpreter() is None:
        return ()
    return tuple(kind for kind in KINDS if run_worker("import", kind).returncode == 0)


@functools.cache
def variant() -> str:
    """The fastest variant of Mitsuba that runs here; too old an LLVM aborts the process that tries."""
    compiled = "llvm_ad_rgb"
    return compiled if run_worker("try", compiled).returncode == 0 else "scalar_rgb"


def why_not(kind: str, scene: BenchScene, pieces: Sequence[Piece] | None) -> str:
    """Why a peer's picture of a scene would mean nothing; empty if it means something."""
    if any(body.smooth for body in scene.bodies):
        return "smooth shading is not handed over"
    if kind == "mitsuba" and not pieces:
        return "Mitsuba has no priorities and needs hand-split pieces"
    if kind == "luxcore" and len(bodies_by_medium(scene)) > LUXCORE_MEDIA:
        return f"LuxCore keeps track of {LUXCORE_MEDIA} media along a path"
    return ""


def write_ply(path: Path, meshes: Iterable[tuple[np.ndarray, np.ndarray]]) -> None:
    """Write meshes (vertices, triangles) as one."""
    vertices, triangles, start = [], [], 0
    for points, corners in meshes:
        vertices.append(points)
        triangles.append(corners + start)
        start += len(points)
    faces = np.empty(sum(map(len, triangles)), np.dtype([("count", "u1"), ("corners", "<i4", 3)]))
    faces["count"] = 3
    faces["corners"] = np.concatenate(triangles)
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {start}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    path.write_bytes(header.encode() + np.concatenate(vertices).astype("<f4").tobytes() + faces.tobytes())


def write_media(folder: Path, media: dict[tuple, list[tuple[np.ndarray, np.ndarray]]]) -> list[dict]:
    """Write one mesh for each medium; returns each one's path and `key`."""
    written = []
    for place, (key, meshes) in enumerate(media.items()):
        path = folder / f"{place}.ply"
        write_ply(path, meshes)
        written.append({"path": str(path), "key": key})
    return written


def grouped(entries: Iterable[tuple[tuple, np.ndarray, np.ndarray]]) -> dict[tuple, list]:
    """Meshes by what comes before them."""
    groups: dict[tuple, list] = {}
    for key, vertices, triangles in entries:
        groups.setdefault(key, []).append((vertices, triangles))
    return groups


def bodies_by_medium(scene: BenchScene) -> dict[tuple, list[tuple[np.ndarray, np.ndarray]]]:
    """Meshes by priority, index and Abbe number. Bodies of one priority do not overlap, so those of a medium are one."""
    return grouped(((body.priority, body.ior, body.abbe), body.vertices, body.triangles) for body in scene.bodies)


def render(
    kind: str, scene: BenchScene, pieces: Sequence[Piece] | None, resolution: int, samples: int, seed: int = 0
) -> tuple[np.ndarray, float, float]:
    """Render a scene with "mitsuba" or "luxcore".

    `pieces` are for Mitsuba alone. Returns the picture, (resolution, resolution, 3) float32, linear, the top row first;
    seconds of rendering without loading, building and compiling; MB that the process held at most, its libraries
    included.
    """
    if reason := why_not(kind, scene, pieces):
        raise ValueError(reason)
    if kind == "mitsuba":
        media = grouped(((ratio,), vertices, triangles) for _, vertices, triangles, ratio in pieces)
    else:
        media = bodies_by_medium(scene)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        np.save(folder / "environment.npy", np.ascontiguousarray(scene.environment, np.float32))
        job = {
            "kind": kind,
            "variant": variant() if kind == "mitsuba" else None,
            "media": write_media(folder, media),
            "location": list(map(float, scene.view.location)),
            "target": list(map(float, scene.view.target)),
            "angle": float(scene.view.angle_degrees),
            "resolution": resolution,
            "samples": samples,
            "seed": seed,
        }
        (folder / "job.json").write_text(json.dumps(job))
        finished = run_worker("worker", name)
        if finished.returncode:
            raise RuntimeError(f"{kind} failed:\n{finished.stdout[-4000:]}")
        result = json.loads((folder / "result.json").read_text())
        return np.load(folder / "picture.npy"), result["seconds"], result["megabytes"]


# The peers' side ----------------------------------------------------------------------------------------------------


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
        "integrator": {"type": "path", "max_depth": SEGMENTS, "rr_depth": 1 << 20},
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
        "path.pathdepth.total": SEGMENTS,
        "path.pathdepth.diffuse": SEGMENTS,
        "path.pathdepth.glossy": SEGMENTS,
        "path.pathdepth.specular": SEGMENTS,
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


def peak_megabytes() -> float:
    """Memory that this process has held at most; NaN where the system does not say.

    Not the one of getrusage, which starts from that of the process this one was forked from.
    """
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
    except FileNotFoundError:
        return math.nan
    return next(float(line.split()[1]) / 1024.0 for line in lines if line.startswith("VmHWM"))


def work(folder: Path) -> None:
    """Render the job in a folder; the picture and figures go there too."""
    job = json.loads((folder / "job.json").read_text())
    draw = mitsuba_picture if job["kind"] == "mitsuba" else luxcore_picture
    picture, seconds = draw(job, np.load(folder / "environment.npy"))
    np.save(folder / "picture.npy", np.ascontiguousarray(picture, np.float32))
    (folder / "result.json").write_text(json.dumps({"seconds": seconds, "megabytes": peak_megabytes()}))


def main(task: str, argument: str) -> None:
    if task == "worker":
        work(Path(argument))
    elif task == "import":
        import_mitsuba("scalar_rgb") if argument == "mitsuba" else import_luxcore()
    elif task == "try":
        mi = import_mitsuba(argument)
        np.array(mi.render(mi.load_dict(mi.cornell_box()), spp=1))
    sys.stdout.flush()
    os._exit(0)  # LuxCore crashes when the interpreter takes itself apart


if __name__ == "__main__":
    main(*sys.argv[1:])
