"""Time on the wall of looking at a scene, and of what Blender waits for while one of its objects is moved.

Run as ``.venv/bin/python benchmarks/analysis_time.py [ROUNDS]``. Printed for each scene: the first look at all of it, what a
window waits for with every step of the mouse (the first step tells media to ask), and the look once the mouse rests; medians
over the rounds, in milliseconds.
"""

import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))

import bpy  # noqa: E402

import nested_dielectric as nd  # noqa: E402
from bench_report import markdown  # noqa: E402
from bench_scenes import Body, ball, droplets, iced_water_scene  # noqa: E402
from bench_worker import add_bodies, nested  # noqa: E402
from nested_dielectric import analysis  # noqa: E402
from scenes import new_scene  # noqa: E402

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


def measured(bodies: list[Body], name: str) -> list[float]:
    """Milliseconds of the first look, of the first step, of the median of the further steps, and of the look at rest."""
    scene = new_scene()
    add_bodies(bodies, nested)
    scene.view_layers[0].update()
    first = milliseconds(lambda: nd.analyse(scene))
    scene.view_layers[0].update()
    obj = bpy.data.objects[name]
    steps: list[float] = []

    def hold(_, depsgraph) -> None:
        steps.append(milliseconds(lambda: analysis.hold(scene, depsgraph)))

    bpy.app.handlers.depsgraph_update_post.append(hold)
    try:
        for _ in range(1 + STEPS):
            obj.location.x += 0.001
            scene.view_layers[0].update()
    finally:
        bpy.app.handlers.depsgraph_update_post.remove(hold)
    return [first, steps[0], statistics.median(steps[1:]), milliseconds(lambda: analysis.settle(scene))]


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    rows = []
    for title, (build, name) in SCENES.items():
        new_scene()
        bodies = build()
        times = [measured(bodies, name) for _ in range(rounds)]
        triangles = sum(len(body.triangles) for body in bodies)
        rows.append([title, f"{triangles:,}", *(f"{statistics.median(column):.0f}" for column in zip(*times))])
    print(markdown(["ms", "triangles", "first look", "first step", "further steps", "look at rest"], rows))


if __name__ == "__main__":
    main()
