"""CPU time until the first sample of 50 balls, each of its own material: mostly the compilation of their shaders.

Run as ``.venv/bin/python benchmarks/compile_time.py [ROUNDS]``. Cycles' own Glass through OSL, media that know they are alone, and
media that ask the scene are loaded in turn; the medians over the rounds and their ratios to Glass are printed.
"""

import statistics
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))

import bpy  # noqa: E402

import nested_dielectric as nd  # noqa: E402
from scenes import add_camera, add_sphere, cycles_glass, new_scene, render, set_world  # noqa: E402

MATERIALS = 50
KINDS = ("Cycles' Glass", "media, analysed", "media, asking")


def build(kind: str) -> None:
    """Balls in a row that do not touch."""
    new_scene(8)
    set_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=26)
    for index in range(MATERIALS):
        ior = 1.3 + 0.001 * index
        material = cycles_glass(ior) if kind == KINDS[0] else nd.new_material(f"M{index}", ior=ior)
        add_sphere(f"S{index}", 0.1, material, location=(0.3 * (index - MATERIALS / 2), 0, 0), segments=8)
    if kind == KINDS[1]:
        nd.analyse(bpy.context.scene)


def seconds(kind: str) -> float:
    build(kind)
    start = time.process_time()
    render(1)
    return time.process_time() - start


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    times = [[seconds(kind) for kind in KINDS] for _ in range(rounds)]
    for index, kind in enumerate(KINDS):
        median = statistics.median(row[index] for row in times)
        ratio = statistics.median(row[index] / row[0] for row in times)
        print(f"{kind}: {median:.2f} s for {MATERIALS} materials, {ratio:.2f} times Glass")


if __name__ == "__main__":
    main()
