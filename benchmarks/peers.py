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
import os
import subprocess
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from bench_arrays import BenchScene

Piece = tuple[str, np.ndarray, np.ndarray, float]
"""Name, vertices (n, 3), triangles (m, 3) counter-clockwise seen from outside, index inside over index outside."""

HERE = Path(__file__).resolve().parent
WORKER = HERE / "peer_worker.py"

KINDS = ("mitsuba", "luxcore")

SEGMENTS = 257
"""Longest path: the 256 bounces of Cycles, and the way to the sky. Both peers count segments."""

LUXCORE_MEDIA = 8
"""Media that LuxCore keeps track of along one path; it forgets those beyond."""


def interpreter() -> Path | None:
    """The Python that has the peers, if any."""
    if "ND_PEERS_PYTHON" in os.environ:
        return Path(os.environ["ND_PEERS_PYTHON"])
    default = HERE / ".peers" / "bin" / "python"
    return default if default.exists() else None


def run_worker(*arguments: str) -> subprocess.CompletedProcess:
    """Run the peers' side in their environment."""
    return subprocess.run(
        [interpreter(), "-I", str(WORKER), *arguments],
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
            "segments": SEGMENTS,
        }
        (folder / "job.json").write_text(json.dumps(job))
        finished = run_worker("worker", name)
        if finished.returncode:
            raise RuntimeError(f"{kind} failed:\n{finished.stdout[-4000:]}")
        result = json.loads((folder / "result.json").read_text())
        return np.load(folder / "picture.npy"), result["seconds"], result["megabytes"]
