"""Time on the wall of looking at a scene, and of what Blender waits for while one of its objects is moved.

Run as ``.venv/bin/python benchmarks/analysis_time.py [ROUNDS]``. Printed for each scene: the first look at all of it, what a
window waits for with every step of the mouse (the first lets media ask), and the look once the mouse rests; medians over the
rounds, in milliseconds.
"""

import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "helpers"))

import bpy
from bench_arrays import Body
from bench_report import markdown
from bench_scenes import droplets, iced_water_scene
from bench_shapes import ball
from bench_worker import add_bodies, nested
from scenes import new_scene

import nested_dielectric as nd
from nested_dielectric.analysis import surroundings
from nested_dielectric.preparation import live

STEPS = 5


def row_of_balls(count: int, subdivisions: int) -> list[Body]:
    """Balls of which each crosses the next two, all of different priority, in two media."""
    vertices, triangles = ball(subdivisions)
    return [
        Body(
            f"Ball {index}",
            vertices + (0.7 * index, 0.1 * index, 0.0),
            triangles.copy(),
            index,
            1.3 + 0.1 * (index % 2),
        )
        for index in range(count)
    ]


SCENES: dict[str, tuple[Callable[[], list[Body]], str]] = {
    "48 balls in a row": (lambda: row_of_balls(48, 6), "Ball 20"),
    "12 balls in a row": (lambda: row_of_balls(12, 7), "Ball 5"),
    "3 balls in a row": (lambda: row_of_balls(3, 8), "Ball 1"),
    "iced water, an ice cube": (lambda: iced_water_scene().bodies, "Ice Cube 2"),
    "500 droplets on a pane": (lambda: droplets().bodies, "Droplet 5"),
}


def milliseconds(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return 1e3 * (time.perf_counter() - start)


def measured(title: str) -> list[float]:
    """The number of triangles, and the milliseconds of the first look, of the first step, of the median of the further
    steps, and of the look at rest.
    """
    build, name = SCENES[title]
    new_scene()
    bodies = build()
    scene = new_scene()
    add_bodies(bodies, nested)
    scene.view_layers[0].update()
    first = milliseconds(lambda: nd.analyse(scene))
    live.remove()
    scene.view_layers[0].update()
    obj = bpy.data.objects[name]
    steps: list[float] = []

    def follow(_, depsgraph) -> None:
        steps.append(milliseconds(lambda: surroundings.update_or_invalidate(scene, depsgraph)))

    bpy.app.handlers.depsgraph_update_post.append(follow)
    try:
        for _ in range(1 + STEPS):
            obj.location.x += 0.001
            scene.view_layers[0].update()
    finally:
        bpy.app.handlers.depsgraph_update_post.remove(follow)
    rest = milliseconds(lambda: nd.analyse(scene))
    triangles = sum(len(body.triangles) for body in bodies)
    return [triangles, first, steps[0], statistics.median(steps[1:]), rest]


def measured_apart(title: str) -> list[float]:
    """As :func:`measured`, in a process of its own, since an analysis remembers the meshes and pairs of the one before."""
    done = subprocess.run([sys.executable, __file__, title], capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    rows = []
    for title in SCENES:
        triangles, *times = (
            statistics.median(column) for column in zip(*(measured_apart(title) for _ in range(rounds)))
        )
        rows.append([title, f"{triangles:,.0f}", *(f"{time:.0f}" for time in times)])
    print(markdown(["ms", "triangles", "first look", "first step", "further steps", "look at rest"], rows))


if __name__ == "__main__":
    if sys.argv[1:] and sys.argv[1] in SCENES:
        print(json.dumps(measured(sys.argv[1])))
    else:
        main()
