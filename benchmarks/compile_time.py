"""CPU time until the first sample of 50 balls, each of its own material: mostly the compilation of their shaders.

Run as ``.venv/bin/python benchmarks/compile_time.py [ROUNDS]``. Cycles' own Glass through OSL, media that know they are alone,
media that ask the scene, and Glass and media in Cycles' own nodes without OSL are loaded in turn. The medians over the rounds
and their ratios to Glass of the same kind are printed.
"""

import statistics
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "helpers"))

from scenes import add_camera, add_sphere, cycles_glass, new_scene, render, set_world

import nested_dielectric as nd

MATERIALS = 50
GLASS, ANALYSED, ASKING, PLAIN, NATIVE = KINDS = (
    "Cycles' Glass",
    "media, analysed",
    "media, asking",
    "Cycles' Glass, no OSL",
    "media, native",
)


def build(kind: str) -> None:
    """Balls in a row that do not touch."""
    scene = new_scene(8)
    set_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=26)
    for index in range(MATERIALS):
        ior = 1.3 + 0.001 * index
        material = cycles_glass(ior) if kind in (GLASS, PLAIN) else nd.new_material(f"M{index}", ior=ior)
        add_sphere(f"S{index}", 0.1, material, location=(0.3 * (index - MATERIALS / 2), 0, 0), segments=8)
    scene.cycles.shading_system = kind not in (PLAIN, NATIVE)
    if kind == ANALYSED:
        nd.prepare(scene, backend="OSL")
    elif kind == NATIVE:
        nd.prepare(scene, backend="NATIVE")


def seconds(kind: str) -> float:
    build(kind)
    start = time.process_time()
    render(1)
    return time.process_time() - start


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    times = [{kind: seconds(kind) for kind in KINDS} for _ in range(rounds)]
    for kind in KINDS:
        glass = PLAIN if kind in (PLAIN, NATIVE) else GLASS
        median = statistics.median(row[kind] for row in times)
        ratio = statistics.median(row[kind] / row[glass] for row in times)
        print(f"{kind}: {median:.2f} s for {MATERIALS} materials, {ratio:.2f} times Glass")


if __name__ == "__main__":
    main()
