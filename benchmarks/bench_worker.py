"""One way to render the benchmark's scenes, in a process of its own.

:class:`Worker` starts the process; a second call of :meth:`Worker.build` begins again with an empty file. Pictures are
rendered on the CPU, through OSL but for :data:`WITHOUT_OSL`, with the same settings for every way otherwise.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "tests" / "helpers"))

import bpy
import numpy as np
from bench_arrays import BenchScene, Body
from bench_shapes import mesh_of
from hand_split import Piece, Split, split
from mathutils import Matrix
from scenes import add, add_camera, cycles_glass, native, new_scene, render

import nested_dielectric as nd
from nested_dielectric.model.dispersion import abbe_ior
from nested_dielectric.scene.material_spectra import material_table

FIRST, LAST = "| Sample 0/", "| Finished"
"""What Cycles says before its first sample, when all is loaded and compiled, and after its last."""

NESTED = {
    "cut": {"cut": True, "backend": "OSL"},
    "asking": {"cut": False, "backend": "OSL"},
    "native": {"cut": True, "backend": "NATIVE"},
}
"""Ways of nested dielectrics, and how scenes are prepared for them."""

WITHOUT_OSL = ("native", "plain")
"""Ways for which Open Shading Language is switched off."""

WAVELENGTHS = 32
"""Renders that one picture by brute force is put together from, at most."""


@dataclass(frozen=True)
class Cost:
    """Seconds: of all cores together, and of the clock on the wall."""

    cpu: float
    wall: float

    def __sub__(self, other: Cost) -> Cost:
        return Cost(self.cpu - other.cpu, self.wall - other.wall)


@dataclass(frozen=True)
class Built:
    """What a scene costs before its samples: `prepare`, which only our own media have, and the first sample with all
    that Cycles does before it; MB that the process held at most, and before.
    """

    prepare: Cost
    first_render: Cost
    megabytes: float
    megabytes_before: float


class Worker:
    """A process that renders in one way.

    `way` is "naive": Cycles' Glass on overlapping bodies, each with its own index; "split": Cycles' Glass on hand-split
    pieces; "passed": the same, with the surfaces that are inside a winner for a path to pass; "cut": nested dielectrics
    whose surfaces are cut where media cross; "asking": those that ask the scene there; "native": cut ones in Cycles' own nodes;
    "plain": as "split", without OSL; "brute": Glass on hand-split
    pieces, one render a wavelength. `state` is the class of this process's :class:`State`, with its module.
    """

    def __init__(self, way: str, state: str = "bench_worker.State") -> None:
        # Not by multiprocessing: it hands over sys.path with Blender's own folders, which hide the package bpy.
        # What Blender prints, from its import on, is kept out of the answers.
        task = (
            "import os, sys; answers = os.dup(1); os.dup2(os.open(os.devnull, os.O_WRONLY), 1); "
            f"sys.path.insert(0, {str(HERE)!r}); import bench_worker, {state.rpartition('.')[0]}; "
            f"bench_worker.serve({state}({way!r}), answers)"
        )
        self._process = subprocess.Popen(
            [sys.executable, "-c", task], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        )

    def build(self, folder: Path, resolution: int) -> Built:
        """Build the scene that :func:`save` wrote and render its first sample."""
        return self.ask("build", folder, resolution)

    def costs(self, samples: int) -> tuple[Cost, Cost]:
        """What a picture costs but for its samples, the scene being loaded, and what its samples cost."""
        return self.ask("costs", samples)

    def picture(self, samples: int, seed: int) -> np.ndarray:
        """A picture, (resolution, resolution, 3), the top row first."""
        return self.ask("picture", samples, seed)

    def close(self) -> None:
        """End the process."""
        self._process.stdin.close()
        self._process.wait()

    def ask(self, command: str, *arguments):
        """What a method of its :class:`State` returns."""
        write(self._process.stdin, (command, arguments))
        try:
            ok, answer = pickle.load(self._process.stdout)
        except EOFError:
            raise RuntimeError(f"the process that was to answer {command!r} has died") from None
        if not ok:
            raise RuntimeError(answer)
        return answer


def write(stream: BinaryIO, value) -> None:
    """Send a value to the other process."""
    pickle.dump(value, stream)
    stream.flush()


BODIES, PIECES, HIDDEN = "bodies.pickle", "pieces.pickle", "hidden.pickle"


def save(folder: Path, scene: BenchScene, split_up: Split) -> None:
    """Write what :meth:`Worker.build` needs: no way is to hold the other's meshes."""
    for name, parts in ((BODIES, scene.bodies), (PIECES, split_up.pieces), (HIDDEN, split_up.hidden)):
        (folder / name).write_bytes(pickle.dumps((scene.view, scene.environment, parts)))


def serve(state: State, answers: int) -> None:
    """Answer commands on an open file until standard input is closed."""
    stream = os.fdopen(answers, "wb")
    while True:
        try:
            command, arguments = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        try:
            answer = True, getattr(state, command)(*arguments)
        except Exception:
            answer = False, traceback.format_exc()
        write(stream, answer)


class State:
    """What the process of a :class:`Worker` does, by command."""

    def __init__(self, way: str) -> None:
        self.way = way
        self.before = held("VmRSS")
        self.bodies: Sequence[Body] = ()
        self.glass: list[bpy.types.Material] = []

    def build(self, folder: Path, resolution: int) -> Built:
        glass = self.way in ("split", "passed", "plain")
        view, environment, parts = pickle.loads((folder / (PIECES if glass else BODIES)).read_bytes())
        scene = new_scene(resolution)
        scene.cycles.shading_system = self.way not in WITHOUT_OSL
        set_sky(environment)
        add_camera(view.location, view.target, angle=view.angle_degrees)
        if self.way in NESTED:
            self.add_media(parts)
        elif self.way == "naive":
            add_bodies(parts, lambda body: cycles_glass(body.ior))
        elif glass:
            add_pieces(parts)
        else:
            self.bodies, self.glass = parts, add_pieces(split(parts).pieces)
        if self.way == "passed":
            add_hidden(pickle.loads((folder / HIDDEN).read_bytes())[-1])
        scene.render.use_persistent_data = True
        start = now()
        if self.way in NESTED:
            nd.prepare(scene, **NESTED[self.way])
        prepared = now()
        draw(1, 0)
        return Built(prepared - start, now() - prepared, held("VmHWM"), self.before)

    def add_media(self, bodies: Sequence[Body]) -> None:
        """Objects of bodies as nested dielectrics."""
        add_bodies(bodies, nested)

    def costs(self, samples: int) -> tuple[Cost, Cost]:
        start = now()
        sampling = sampling_of(lambda: draw(samples, 0))
        return (now() - start) - sampling, sampling

    def picture(self, samples: int, seed: int) -> np.ndarray:
        return self.every_wavelength(samples, seed) if self.way == "brute" else draw(samples, seed)

    def every_wavelength(self, samples: int, seed: int) -> np.ndarray:
        """A picture put together from one of each of some wavelengths, which are others for another seed."""
        table = material_table(nested(self.bodies[0]))
        count = min(WAVELENGTHS, samples)
        shift = (seed * 0.618034) % 1.0
        rows = table[((np.arange(count) + shift) * len(table) / count).astype(int)].astype(np.float64)
        weights = rows[:, :3] / np.maximum(rows[:, :3].sum(axis=0), 1e-9)  # white stays white
        picture = 0.0
        for place, wavelength in enumerate(rows[:, 3]):
            bodies = [coloured(body, wavelength) for body in self.bodies]
            for material, piece in zip(self.glass, split(bodies).pieces, strict=True):
                material.node_tree.nodes["Glass BSDF"].inputs["IOR"].default_value = piece.ior_ratio
            picture = picture + draw(samples // count, 1000 * seed + place) * weights[place]
        return picture


def sampling_of(draw: Callable[[], object]) -> Cost:
    """What the samples of a picture cost."""
    moments: dict[str, Cost] = {}

    def listen(status: str) -> None:
        for moment in (FIRST, LAST):
            if moment in status:
                moments.setdefault(moment, now())

    bpy.app.handlers.render_stats.append(listen)
    try:
        draw()
    finally:
        bpy.app.handlers.render_stats.remove(listen)
    if len(moments) < 2:
        raise RuntimeError(f"Cycles no longer says {FIRST!r} and {LAST!r}")
    return moments[LAST] - moments[FIRST]


def draw(samples: int, seed: int) -> np.ndarray:
    """Render a part of Cycles' sequence that leaves out the first sample, aligned where `samples` is a power of two.

    The first one always goes through the middle of a pixel and would weigh too much where there are few.
    """
    cycles = bpy.context.scene.cycles
    cycles.use_sample_subset = True
    cycles.sample_offset = cycles.sample_subset_length = samples
    return render(2 * samples, seed)


def now() -> Cost:
    """Time of this process so far."""
    return Cost(time.process_time(), time.perf_counter())


def held(what: str) -> float:
    """MB that this process holds, "VmRSS", or has held at most, "VmHWM"; NaN where the system does not say."""
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
    except FileNotFoundError:
        return float("nan")
    return next(float(line.split()[1]) / 1024.0 for line in lines if line.startswith(what))


def coloured(body: Body, wavelength: float) -> Body:
    """A body that does not disperse, with the index of one that does at a wavelength in nm."""
    return Body(
        body.name, body.vertices, body.triangles, body.priority, abbe_ior(body.ior, body.abbe, wavelength), body.smooth
    )


def nested(body: Body) -> bpy.types.Material:
    """A nested dielectric of a body's medium."""
    dispersion = {"disperse": True, "dispersion_model": "ABBE", "abbe": body.abbe} if body.abbe else {}
    return nd.new_material(body.name, ior=body.ior, shadow_mode="BLACK", **dispersion)


def add_bodies(bodies: Sequence[Body], medium) -> None:
    """Objects of bodies; those of one medium share the material `medium(body)`, and those of one shape a mesh."""
    materials: dict[tuple, bpy.types.Material] = {}
    shapes: dict[tuple, tuple[Body, bpy.types.Mesh]] = {}
    for body in bodies:
        key = (body.ior, body.abbe)
        if key not in materials:
            materials[key] = medium(body)
        shape = (id(body.triangles), *key)
        if shape not in shapes:
            shapes[shape] = body, centred(body, materials[key])
        first, mesh = shapes[shape]
        obj = add(body.name, mesh)
        obj.matrix_world = placement(first, body)
        nd.set_priority(obj, body.priority)


def centred(body: Body, material: bpy.types.Material) -> bpy.types.Mesh:
    """A body's mesh around the origin of its own coordinates, see :func:`placement`."""
    mesh = mesh_of(body.name, body.vertices - body.vertices.mean(axis=0), body.triangles, body.smooth)
    mesh.materials.append(material)
    return mesh


def placement(first: Body, body: Body) -> Matrix:
    """Where a body of the shape of `first` is, and how much larger."""
    shape, centre = first.vertices - first.vertices.mean(axis=0), body.vertices.mean(axis=0)
    size = np.linalg.norm(body.vertices - centre) / np.linalg.norm(shape)
    if not np.allclose(shape * size + centre, body.vertices, rtol=0.0, atol=1e-9):
        raise ValueError(f"{body.name} is not {first.name} moved and scaled; give it triangles of its own")
    return Matrix.LocRotScale(centre, None, (size, size, size))


def add_pieces(pieces: Sequence[Piece]) -> list[bpy.types.Material]:
    """Objects of pieces, those of one ratio with the same Glass; returns each piece's."""
    materials: dict[float, bpy.types.Material] = {}
    for piece in pieces:
        if piece.ior_ratio not in materials:
            materials[piece.ior_ratio] = cycles_glass(piece.ior_ratio)
        add_piece(piece, materials[piece.ior_ratio])
    return [materials[piece.ior_ratio] for piece in pieces]


def add_hidden(pieces: Sequence[Piece]) -> None:
    """Objects of pieces that let everything through."""
    clear = native("Clear", "ShaderNodeBsdfTransparent")
    for piece in pieces:
        add_piece(piece, clear)


def add_piece(piece: Piece, material: bpy.types.Material) -> None:
    """An object of a piece."""
    mesh = mesh_of(piece.name, piece.vertices, piece.triangles)
    mesh.materials.append(material)
    add(piece.name, mesh)


def set_sky(environment: np.ndarray) -> None:
    """A world that shows a picture, which paths alone find."""
    height, width, _ = environment.shape
    image = bpy.data.images.new("Sky", width, height, float_buffer=True, is_data=True)
    image.use_half_precision = False
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = environment[::-1]
    image.pixels.foreach_set(pixels.ravel())
    world = bpy.data.worlds.new("Sky")
    world.cycles.sampling_method = "NONE"
    tree = world.node_tree
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    bpy.context.scene.world = world
