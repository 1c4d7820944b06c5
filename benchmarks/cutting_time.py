"""Time of preparing a scene and of cutting its surfaces where media cross.

Run as ``.venv/bin/python benchmarks/cutting_time.py [ROUNDS]``; it renews its table in ``README.md``. For each scene: what
preparing takes, uncut and cut, and what a render takes longer to evaluate the objects of a frame that are cut, first and
after one body has moved a little. CPU seconds, and on the wall; medians over the rounds, each in a process of its own.
"""

import json
import statistics
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "helpers"))

import bpy
from bench_arrays import BenchScene
from bench_report import markdown, renew
from bench_scenes import bucket, droplets, iced_water_scene
from bench_worker import NESTED, Cost, add_bodies, draw, nested, now
from scenes import add_camera, new_scene

import nested_dielectric as nd

SCENES: dict[str, tuple[Callable[[], BenchScene], str]] = {
    "iced water, an ice cube": (iced_water_scene, "Ice Cube 2"),
    "a bottle in a bucket of ice and water, a cube": (bucket, "Ice 3"),
    "500 droplets on a pane, a droplet": (droplets, "Droplet 5"),
    "2,000 droplets on a pane, a droplet": (lambda: droplets(2000), "Droplet 5"),
}
"""How each is made, and the body that moves."""


def evaluation() -> Cost:
    """What it takes in a render of the current scene to evaluate its objects."""
    moments: dict[str, Cost] = {}

    def begin(*_) -> None:
        moments["begin"] = now()

    def end(_, depsgraph: bpy.types.Depsgraph) -> None:
        if depsgraph.mode == "RENDER":
            moments["spent"] = now() - moments["begin"]

    # Whatever else has handlers of frames may move anything, and all is cut as if it did.
    begin.__module__ = end.__module__ = nd.__name__
    # Next to the evaluation, so that what others do on a new frame is left out.
    before, after = bpy.app.handlers.frame_change_pre, bpy.app.handlers.frame_change_post
    before.append(begin)
    after.insert(0, end)
    try:
        draw(1, 0)
    finally:
        before.remove(begin)
        after.remove(end)
    return moments["spent"]


def measured(title: str, way: str) -> tuple[int, list[Cost]]:
    """The number of triangles, and what preparing costs, and evaluating a frame, first and after the body has moved."""
    make, moving = SCENES[title]
    new_scene()
    made = make()
    scene = new_scene(8)
    add_camera(made.view.location, made.view.target, angle=made.view.angle_degrees)
    add_bodies(made.bodies, nested)
    scene.render.use_persistent_data = True
    scene.view_layers[0].update()
    start = now()
    nd.prepare(scene, **NESTED[way])
    costs = [now() - start, evaluation()]
    bpy.data.objects[moving].location.x += 1e-4
    costs.append(evaluation())
    return sum(len(body.triangles) for body in made.bodies), costs


def measured_rounds(title: str, way: str, rounds: int) -> tuple[int, list[list[Cost]]]:
    """As :func:`measured`, every cost in all rounds, each in a process of its own: meshes and pairs are remembered."""
    found = []
    for _ in range(rounds):
        done = subprocess.run([sys.executable, __file__, title, way], capture_output=True, text=True, check=True)
        triangles, costs = json.loads(done.stdout.splitlines()[-1])
        found.append([Cost(**cost) for cost in costs])
    return triangles, [list(step) for step in zip(*found, strict=True)]


def cell(costs: list[Cost]) -> str:
    """Medians of CPU seconds and, in brackets, of those on the wall."""
    cpu, wall = (statistics.median(getattr(cost, clock) for cost in costs) for clock in ("cpu", "wall"))
    return f"{cpu:.2f} ({wall:.2f})"


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    rows = []
    for title in SCENES:
        triangles, uncut = measured_rounds(title, "asking", rounds)
        _, cut = measured_rounds(title, "cut", rounds)
        cells = [cell(uncut[0]), cell(cut[0])]
        for with_cut, without in zip(cut[1:], uncut[1:], strict=True):
            cells.append(cell([a - b for a, b in zip(with_cut, without, strict=True)]))
        rows.append([title, f"{triangles:,}", *cells])
    header = ["CPU s (on the wall)", "triangles", "preparing, uncut", "preparing, cut", "cutting", "after a move"]
    table = markdown(header, rows)
    renew("cutting", table)
    print(table)


if __name__ == "__main__":
    if sys.argv[1:] and sys.argv[1] in SCENES:
        triangles, costs = measured(*sys.argv[1:])
        print(json.dumps([triangles, [vars(cost) for cost in costs]]))
    else:
        main()
