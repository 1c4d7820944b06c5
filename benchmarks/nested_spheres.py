"""Render time of nested media against the same interfaces split by hand in Cycles' own Glass, both through OSL.

Run as ``.venv/bin/python benchmarks/nested_spheres.py [ROUNDS]``. The two are rendered in turn, with their shaders
compiled and the scene kept, so a round's ratio is of sampling alone; the median over the rounds is printed.
"""

import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))

import bpy  # noqa: E402

import nested_dielectric as nd  # noqa: E402
from scenes import add_camera, add_sphere, cycles_glass, new_scene, render, set_striped_world  # noqa: E402

RESOLUTION = 192
SAMPLES = 64

ONE = (("Glass", 1.0, 1.5, 1.5),)
NESTED = (("Glass", 1.0, 1.5, 1.5), ("Water", 0.8, 1.33, 1.33 / 1.5), ("Bubble", 0.5, 1.0, 1 / 1.33))
"""Name, radius, index of the medium, ratio of indices of the interface."""


def build(shells: tuple, split: bool) -> None:
    new_scene(RESOLUTION)
    set_striped_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=26)
    for place, (name, radius, ior, ratio) in enumerate(shells):
        material = cycles_glass(ratio) if split else nd.new_material(name, ior=ior, shadow_mode="BLACK")
        add_sphere(name, radius, material, None if split else len(shells) - place, segments=96)


def seconds(samples: int) -> float:
    start = time.perf_counter()
    render(samples)
    return time.perf_counter() - start


def sampling_time(make: Callable[[], None]) -> float:
    """Seconds that SAMPLES more samples take once everything is loaded."""
    make()
    bpy.context.scene.render.use_persistent_data = True
    seconds(1)
    return seconds(SAMPLES) - seconds(1)


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    for label, shells in (("one sphere", ONE), ("three nested spheres", NESTED)):
        ratios, times = [], []
        for _ in range(rounds):
            reference = sampling_time(lambda: build(shells, split=True))
            ours = sampling_time(lambda: build(shells, split=False))
            ratios.append(ours / reference)
            times.append(ours)
        print(
            f"{label}: {statistics.median(times):.2f} s, {statistics.median(ratios):.2f} times hand-split Glass "
            f"({min(ratios):.2f} to {max(ratios):.2f})"
        )


if __name__ == "__main__":
    main()
