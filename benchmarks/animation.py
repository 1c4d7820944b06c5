"""CPU time of an animation: ice that turns in a tumbler of water.

Run as ``.venv/bin/python benchmarks/animation.py [--frames N] [--samples N] [--resolution N]``; without arguments, about
half an hour, it renews its table in ``README.md``. Of nested dielectrics all that a frame takes in a render of an animation
counts, cutting included; of hand-split Glass sampling alone, its meshes having been split for every frame beforehand. All
ways render a frame before any goes on to the next; the one that takes longest, asking the scene, leaves most frames out.
Fewer frames are spread over the same turn.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack, closing
from math import pi
from pathlib import Path

import bpy  # before mathutils, which lives inside it
import numpy as np
from mathutils import Euler

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench_arrays import BenchScene, Body, View, banded_sky
from bench_errors import block_means, relative_error
from bench_report import LABELS, markdown, millionths, renew
from bench_scenes import GLASS, GLASS_PRIORITY, ICE, ICE_PRIORITY, WATER, WATER_PRIORITY
from bench_shapes import moved, taken_arrays, turned, turned_profile
from bench_worker import Cost, State, Worker, now, sampling_of, save
from hand_split import split
from scenes import read_picture

from nested_dielectric.demo import glassware

FRAMES = 24
EVERY = {"split": 1, "cut": 1, "asking": 4}
"""Of how many frames a way renders one."""

TUMBLING = "Ice"
PLACE = (0.04, -0.03, 0.66)
WATER_PROFILE: tuple[glassware.Corner, ...] = (
    (0.0, 0.142, 0.0),
    (0.38, 0.152, 0.083),
    (0.4155, 0.74, 0.0),
    (0.0, 0.74, 0.0),
)
"""The tumbler's inside grown by 0.008, up to the water's level."""


def turn(frame: int) -> Euler:
    """How the ice is turned on a frame."""
    part = (frame - 1) / FRAMES
    return Euler((0.3 + pi * part, 0.2, 0.5 * pi * part))


def scene_on(frame: int) -> BenchScene:
    """An ice cube that floats in a tumbler of water, as it is turned on a frame; on frame 0, before it is placed."""
    ice = moved(taken_arrays(glassware.ice_mesh(1)), (0.0, 0.0, 0.0), 1.3)
    ice = ice[0] - ice[0].mean(axis=0), ice[1]
    if frame:
        ice = turned(ice, turn(frame))
    bodies = (
        Body("Tumbler", *turned_profile(glassware.TUMBLER_OUTSIDE + glassware.TUMBLER_INSIDE), GLASS_PRIORITY, GLASS),
        Body(TUMBLING, *moved(ice, PLACE), ICE_PRIORITY, ICE),
        Body("Water", *turned_profile(WATER_PROFILE), WATER_PRIORITY, WATER),
    )
    view = View((0.0, -4.3, 1.75), (0.012, 0.0, 0.49), 17.0)
    return BenchScene("turning", "ice turning in water", bodies, view, banded_sky(), True)


class Turning(State):
    """Renders frames; the ice of nested dielectrics has keyframes."""

    def add_media(self, bodies: Sequence[Body]) -> None:
        super().add_media(bodies)
        ice = bpy.data.objects[TUMBLING]
        for frame in range(1, FRAMES + 1):
            ice.rotation_euler = turn(frame)
            ice.keyframe_insert("rotation_euler", frame=frame)

    def frame(self, frame: int, samples: int) -> tuple[Cost, Cost, np.ndarray]:
        """What a frame of an animation costs in all, and its samples alone; its picture."""
        scene = bpy.context.scene
        scene.cycles.use_sample_subset = False
        scene.cycles.samples = samples
        moments: list[Cost] = []

        def listen(*_) -> None:
            moments.append(now())

        # Around the frame alone: before and after an animation Blender evaluates the view layer, too.
        handlers = (bpy.app.handlers.render_pre, bpy.app.handlers.render_post)
        for each in handlers:
            each.append(listen)
        try:
            with tempfile.TemporaryDirectory() as folder:
                scene.render.filepath = str(Path(folder, "frame"))
                sampling = sampling_of(
                    lambda: bpy.ops.render.render(animation=True, frame_start=frame, frame_end=frame)
                )
                picture = read_picture(scene.render.frame_path(frame=frame))
        finally:
            for each in handlers:
                each.remove(listen)
        begin, end = moments
        return end - begin, sampling, picture


Rendered = dict[str, dict[int, tuple[Cost, Cost, np.ndarray]]]
"""What :meth:`Turning.frame` returns, by way and frame."""


def measure(frames: Sequence[int], samples: int, resolution: int) -> Rendered:
    """Render frames in all ways."""
    found: Rendered = {way: {} for way in EVERY}
    with ExitStack() as stack:
        workers = {way: stack.enter_context(closing(Worker(way, "animation.Turning"))) for way in EVERY}
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        bpy.ops.wm.read_factory_settings(use_empty=True)
        save(folder, scene_on(0), split(()))
        for way in ("cut", "asking"):
            workers[way].build(folder, resolution)
        for place, frame in enumerate(frames):
            scene = scene_on(frame)
            save(folder, scene, split(scene.bodies))
            workers["split"].build(folder, resolution)
            for way, every in EVERY.items():
                if place % every == 0:
                    found[way][frame] = workers[way].ask("frame", frame, samples)
    return found


def table(found: Rendered) -> str:
    """Medians of a frame's CPU seconds, also as multiples of hand-split Glass's, and how far pictures are from its."""
    rows = []
    for way, frames in found.items():
        glass = {frame: found["split"][frame] for frame in frames}
        counted = [(sampling if way == "split" else everything).cpu for everything, sampling, _ in frames.values()]
        ratios = [spent / sampling.cpu for spent, (_, sampling, _) in zip(counted, glass.values(), strict=True)]
        apart = [
            relative_error(*map(block_means, (ours, truth)))
            for (*_, ours), (*_, truth) in zip(frames.values(), glass.values(), strict=True)
        ]
        rows.append(
            [
                f"{LABELS[way]}, {'sampling alone' if way == 'split' else 'everything'}",
                str(len(frames)),
                f"{statistics.median(counted):.2f}",
                f"{statistics.median(sampling.cpu for _, sampling, _ in frames.values()):.2f}",
                f"{statistics.median(ratios):.2f} ({min(ratios):.2f}–{max(ratios):.2f})",
                "" if way == "split" else millionths(max(apart)),
            ]
        )
    header = ["CPU s of a frame", "frames", "all that counts", "its samples", "hand-split Glass = 1"]
    return markdown([*header, "blocks differ by (relMSE × 10⁶), at most"], rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--frames", type=int, default=FRAMES)
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--resolution", type=int, default=256)
    arguments = parser.parse_args()
    if not 1 <= arguments.frames <= FRAMES:
        parser.error(f"there are {FRAMES} frames")
    frames = [1 + FRAMES * place // arguments.frames for place in range(arguments.frames)]
    found = measure(frames, arguments.samples, arguments.resolution)
    shown = table(found)
    if arguments == parser.parse_args([]):
        renew("animation", shown)
    print(f"{arguments.resolution} x {arguments.resolution}, {arguments.samples} samples\n\n{shown}")


if __name__ == "__main__":
    main()
