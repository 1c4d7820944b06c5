"""What a farm pays for a frame: start, file, preparing, what comes before the samples, samples, writing, merging.

Run as ``.venv/bin/python benchmarks/farm.py [ROUNDS]``, under 5 minutes; it writes ``results/farm.json`` and
``results/farm.png`` and renews the tables of ``docs/farm.md``. Every measurement is a process of its own, as a task of a farm
is, that renders two frames of an animation in which one medium moves. CPU seconds, and on the wall.
"""

from __future__ import annotations

import json
import os
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "tests" / "helpers"))

RESOLUTION = 128

SAMPLES = (8, 32)
"""Of the frames that a process renders, each. What the second takes longer than the first to sample are samples alone."""

ROUNDS = 3

SCENES = {
    "iced_water": ("iced water, a cube moves", "Ice Cube 2"),
    "droplets": ("500 droplets on a pane, a droplet moves", "Droplet 5"),
    "gems": ("dispersive gems, one turns", "Diamond"),
}
"""What they are, and the object that moves."""

WAYS = {
    "osl": ("iced_water", "droplets", "gems"),
    "native": ("iced_water", "droplets"),
    "persistent": ("iced_water",),
    "prepared": ("iced_water",),
}
"""Scenes that are measured in each way: in OSL, in Cycles' own nodes; in OSL with Persistent Data, and from a file that is
prepared, without the extension. Own nodes do not split light as the gems want it.
"""

PICTURES = (256, 2048)
"""Pixels along a side of empty pictures, of which the larger takes longer to write."""

PARTS = (2, 8)
"""Ranges that are merged."""

PHASES = {
    "shaders": ("render kernels", "Updating Shaders"),
    "bvh": ("BVH",),
    "sample": ("Sample ",),
    "finish": ("Finished",),
}
"""What Cycles says while it compiles, builds the tree of boxes, samples and ends; before it says anything objects are evaluated
and cut, and the rest is export.
"""

Cost = tuple[float, float]
"""Seconds of all cores together, and of the clock on the wall."""


def now() -> Cost:
    return time.process_time(), time.perf_counter()


# One process --------------------------------------------------------------------------------------------------------


def build(name: str, file: str, prepared: bool) -> None:
    """Save a scene, set up as all are measured."""
    import bpy  # before numpy's users that live inside it
    from bench_scenes import SCENES as MADE
    from bench_worker import add_bodies, nested, set_sky
    from scenes import add_camera, new_scene

    import nested_dielectric as nd
    from nested_dielectric.demo import iced_water

    scene = new_scene(RESOLUTION)
    if name == "iced_water":
        empty, scene = scene, iced_water.build_scene()
        bpy.data.scenes.remove(empty)
    else:
        made = MADE[name]()
        scene = new_scene(RESOLUTION)
        set_sky(made.environment)
        add_camera(made.view.location, made.view.target, angle=made.view.angle_degrees)
        add_bodies(made.bodies, nested)
    scene.render.resolution_x = scene.render.resolution_y = RESOLUTION
    scene.render.resolution_percentage = 100
    scene.cycles.use_adaptive_sampling = False
    scene.render.image_settings.file_format = "OPEN_EXR"
    moving = bpy.data.objects[SCENES[name][1]]
    moving.rotation_mode = "XYZ"
    for frame in range(1, len(SAMPLES) + 1):
        moving.rotation_euler.z += 1e-3
        moving.keyframe_insert("rotation_euler", frame=frame)
    if prepared:
        nd.prepare(scene, cut=True, backend="OSL")
    bpy.ops.wm.save_as_mainfile(filepath=file)


def work(way: str, file: str, folder: str, began: str) -> None:
    """Render a file's frames as a task does, and print what each step took."""
    import bpy

    steps: dict[str, Cost] = {}
    if way != "prepared":
        import nested_dielectric as nd
        import nested_dielectric.cli
    bpy.utils.expose_bundled_modules()
    cpu, wall = now()
    steps["start"] = cpu, wall - float(began)
    last = now()
    bpy.ops.wm.open_mainfile(filepath=file)
    last = kept(steps, "load", last)
    scene = bpy.context.scene
    if way != "prepared":
        nd.prepare(scene, cut=True, backend="NATIVE" if way == "native" else "OSL")
    kept(steps, "prepare", last)
    scene.render.use_persistent_data = way == "persistent"
    frames = [frame_steps(scene, frame, Path(folder)) for frame in range(1, len(SAMPLES) + 1)]
    print("\n" + json.dumps({"steps": steps, "frames": frames, "said": now()}), flush=True)


def kept(steps: dict[str, Cost], step: str, last: Cost) -> Cost:
    """Write down what a step took since the last moment; returns the moment."""
    moment = now()
    steps[step] = added((0.0, 0.0), moment, last)
    return moment


def frame_steps(scene, frame: int, folder: Path) -> dict[str, Cost]:
    """Render a frame; what each step took, its time shared out between what Cycles said."""
    import bpy

    heard: list[tuple[str, Cost]] = [("", now())]

    def listen(stats: object, *_: object) -> None:
        heard.append((str(stats), now()))

    bpy.app.handlers.render_stats.append(listen)
    try:
        scene.frame_set(frame)
        scene.cycles.samples = SAMPLES[frame - 1]
        scene.render.filepath = str(folder / f"{frame}.exr")
        bpy.ops.render.render(write_still=True)
    finally:
        bpy.app.handlers.render_stats.remove(listen)
    heard.append(("end", now()))
    steps = dict.fromkeys(("evaluate", "export", *PHASES), (0.0, 0.0))
    for (said, moment), (_, following) in pairwise(heard):
        other = "export" if said else "evaluate"
        step = next((step for step, words in PHASES.items() if any(word in said for word in words)), other)
        steps[step] = added(steps[step], following, moment)
    return steps


def added(spent: Cost, end: Cost, begin: Cost) -> Cost:
    """Time spent, with that between two moments."""
    return spent[0] + end[0] - begin[0], spent[1] + end[1] - begin[1]


def pictures(folder: str) -> None:
    """Print what an empty picture takes, by pixels along its side."""
    import bpy
    from scenes import add_camera, new_scene

    scene = new_scene()
    add_camera((0, -5, 0), (0, 0, 0), angle=30)
    scene.cycles.shading_system = False
    scene.cycles.samples = 1
    found = {}
    for side in (PICTURES[0], *PICTURES):  # the first one loads what others find
        scene.render.resolution_x = scene.render.resolution_y = side
        scene.render.filepath = f"{folder}/empty.exr"
        start = now()
        bpy.ops.render.render(write_still=True)
        found[side] = now()[0] - start[0]
    print("\n" + json.dumps(found | {"blender": bpy.app.version_string}), flush=True)


def merges(folder: str) -> None:
    """Print what merging takes, by ranges, of pictures of the larger size."""
    import bpy
    from scenes import add_camera, new_scene

    scene = new_scene(PICTURES[1])
    add_camera((0, -5, 0), (0, 0, 0), angle=30)
    scene.cycles.shading_system = False
    scene.cycles.samples = 1
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    scene.render.filepath = f"{folder}/part.exr"
    bpy.ops.render.render(write_still=True)
    import _cycles

    found = {}
    for parts in PARTS:
        start = now()
        _cycles.merge(input=[f"{folder}/part.exr"] * parts, output=f"{folder}/merged.exr")
        found[parts] = now()[0] - start[0]
    print("\n" + json.dumps(found), flush=True)


TASKS: dict[str, Callable] = {"work": work, "pictures": pictures, "merges": merges}


# All processes ------------------------------------------------------------------------------------------------------


def called(*arguments: str) -> tuple[dict, float, float]:
    """What a task of this file printed, and the CPU seconds of its whole process and when it ended."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([sys.executable, __file__, *arguments], capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        raise SystemExit(done.stderr)
    spent = sum(getattr(after, clock) - getattr(before, clock) for clock in ("ru_utime", "ru_stime"))
    found = [line for line in done.stdout.splitlines() if line.startswith("{")]
    return json.loads(found[-1]) if found else {}, spent, time.perf_counter()


def measured(way: str, file: Path, folder: str) -> dict:
    """One process: its steps, and those of each of its frames; its end counts to its start."""
    found, spent, ended = called("work", way, str(file), folder, str(time.perf_counter()))
    cpu, wall = found.pop("said")
    start = found["steps"]["start"]
    found["steps"]["start"] = start[0] + spent - cpu, start[1] + ended - wall
    return found


def processor() -> str:
    """What the machine's processor is called; its kind where the system does not say."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except FileNotFoundError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def main() -> None:
    from farm_report import renew_page

    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else ROUNDS
    with tempfile.TemporaryDirectory() as folder:
        runs = measured_scenes(folder, rounds)
        empty = [called("pictures", folder)[0] for _ in range(rounds)]
        merged = [called("merges", folder)[0] for _ in range(rounds)]
    megapixels = PICTURES[1] ** 2 / 1e6
    larger = megapixels - PICTURES[0] ** 2 / 1e6
    few, many = (statistics.median(found[str(parts)] for found in merged) for parts in PARTS)
    part = (many - few) / (PARTS[1] - PARTS[0])
    result = {
        "machine": {"cores": os.process_cpu_count(), "name": processor(), "blender": empty[0]["blender"]},
        "resolution": RESOLUTION,
        "samples": list(SAMPLES),
        "rounds": rounds,
        "scenes": {name: {"title": SCENES[name][0], "ways": runs[name]} for name in SCENES},
        "write_per_megapixel": statistics.median((f[str(PICTURES[1])] - f[str(PICTURES[0])]) / larger for f in empty),
        "merge_part_per_megapixel": part / megapixels,
        "merge_per_megapixel": max(0.0, few - PARTS[0] * part) / megapixels,
    }
    renew_page(result)


def measured_scenes(folder: str, rounds: int) -> dict[str, dict[str, list[dict]]]:
    """All processes by scene and way, in rounds, so that what disturbs one disturbs others too."""
    files = {}
    for name in SCENES:
        for prepared in (False, True):
            if not prepared or name in WAYS["prepared"]:
                files[name, prepared] = Path(folder, f"{name}{'_prepared' * prepared}.blend")
                called("build", name, str(files[name, prepared]), "prepared" * prepared)
    runs: dict[str, dict[str, list[dict]]] = {name: {} for name in SCENES}
    for place in range(rounds):
        for way, names in WAYS.items():
            for name in names:
                runs[name].setdefault(way, []).append(measured(way, files[name, way == "prepared"], folder))
        print(f"{place + 1} of {rounds} rounds", flush=True)
    return runs


if __name__ == "__main__":
    if sys.argv[1:2] == ["build"]:
        build(sys.argv[2], sys.argv[3], sys.argv[4] == "prepared")
    elif sys.argv[1:] and sys.argv[1] in TASKS:
        TASKS[sys.argv[1]](*sys.argv[2:])
    else:
        main()
