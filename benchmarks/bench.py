"""Time, error and memory of nested media against hand-split Glass and others; `README.md` here says what is compared.

Run as ``.venv/bin/python benchmarks/bench.py [--quick] [--scene NAME ...] [--rounds N]``. A full run writes
``results/SCENE.json`` and ``results/SCENE.png`` and renews the tables in ``README.md``; a quick one writes its JSON and
plots to ``out/bench`` and prints the tables. Runs end in time whatever else the machine does: where time is short there
are fewer rounds and samples.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import pickle
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, closing
from dataclasses import asdict, dataclass
from pathlib import Path
from types import ModuleType

import bpy  # before numpy's users that live inside it
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench_errors import Reference, block_means, floor, relative_error
from bench_report import plot, renew, tables
from bench_scenes import DISPERSING, SCENES, BenchScene
from bench_worker import NESTED, WAVELENGTHS, Built, Cost, Worker, save
from hand_split import Piece, Split, split
from scenes import BOUNCES

import nested_dielectric as nd

HERE = Path(__file__).resolve().parent
RESULTS = HERE / "results"
OUT = HERE.parent / "out" / "bench"

PICTURE = """Error against time in iced water; dotted, the floor. The other scenes stand beside it in `results/`.

![Error against time in iced water](results/iced_water.png)"""
"""Of the page, below its tables."""

REFERENCE_SEED = 1000

LAST_SEEDS = (1, 2)
"""Pictures for the last point of a curve; the others take the first alone."""

PEER_ROUNDS = 3
"""A peer loads the scene anew for every picture."""

LEAST_ROUNDS = 2
PILOT_SAMPLES = 8


@dataclass(frozen=True)
class Plan:
    """How much a run does.

    `seconds` on the wall for all scenes; pixels along a side; least and most samples of a curve, powers of two, and the
    ratio from one point to the next; pictures of as many samples that the reference is the mean of; CPU seconds that a
    timed picture of hand-split Glass takes at least; rounds of timing; times that every scene is prepared; whether
    peers are compared, too.
    """

    seconds: float
    resolution: int
    least: int
    most: int
    step: int
    references: int
    timed: float
    rounds: int
    preparations: int
    peers: bool

    def counts(self, samples: int) -> list[int]:
        """Samples of the points of a curve that ends there."""
        return sorted({self.step**power for power in range(10) if self.step**power < samples} | {samples})


FULL = Plan(1620.0, 128, 16, 256, 2, 8, 1.0, 9, 4, peers=True)
QUICK = Plan(130.0, 64, 8, 16, 8, 4, 0.2, 3, 1, peers=False)


# Measuring ----------------------------------------------------------------------------------------------------------


def measure(name: str, plan: Plan, deadline: float) -> dict:
    """All figures of one scene, ready for JSON."""
    begin = time.monotonic()
    with ExitStack() as stack:
        disperses = name in DISPERSING
        workers = {way: stack.enter_context(closing(Worker(way))) for way in ways(disperses)}
        scene, parts = loaded(name)  # while the processes start
        if parts.hidden:
            workers["passed"] = stack.enter_context(closing(Worker("passed")))
        peers = usable_peers(scene, parts.pieces) if plan.peers else None
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        save(folder, scene, parts)

        def build(worker: Worker) -> Built:
            return worker.build(folder, plan.resolution)

        built = [at_once(workers, build)]
        clocked = {way: worker for way, worker in workers.items() if way != "brute"}
        timed = timed_samples(workers["split"], plan)
        rounds: list[dict[str, tuple[Cost, Cost]]] = []
        latest = begin + 0.45 * (deadline - begin)
        while len(rounds) < plan.rounds and (len(rounds) < LEAST_ROUNDS or time.monotonic() < latest):
            place = len(rounds)
            rounds.append(interleaved(clocked, lambda worker: worker.costs(timed), place))
            if peers is not None and place < PEER_ROUNDS:
                rounds[-1] |= peers.costs(plan.resolution, timed)
            if len(built) < plan.preparations and time.monotonic() < latest:
                built.append(interleaved(workers, build, place + 1))
        timing = timings(rounds, timed, plan.resolution)
        for way in ("passed", "plain"):  # the picture of hand-split Glass
            workers.pop(way, None)
        left = (deadline - time.monotonic()) * (0.6 if peers else 0.9)
        samples = affordable(costs_on_the_wall(workers, rounds, timed), plan, left)
        counts = plan.counts(samples)
        truth = "brute" if disperses else "split"
        pictures = at_once(workers, lambda worker: curve_pictures(worker.picture, counts))
        reference = Reference(*halves(workers[truth], samples, plan.references))
        errors = {way: curve(pictures[way], counts, reference) for way in workers}
    if peers is not None:
        errors |= peers.curves(plan.resolution, samples, reference, deadline)
    return {
        "scene": name,
        "title": scene.title,
        "surfaces_cross": scene.nested_media_cross,
        "bodies": len(scene.bodies),
        "triangles": {
            "bodies": sum(len(body.triangles) for body in scene.bodies),
            "pieces": sum(len(piece.triangles) for piece in parts.pieces),
        },
        "machine": {"cores": os.process_cpu_count(), "blender": bpy.app.version_string},
        "resolution": plan.resolution,
        "bounces": BOUNCES,
        "timing": timing,
        # The first time all ways do it at once.
        "preparation": {way: preparation([row[way] for row in built[1:] or built]) for way in built[0]},
        "memory": {way: memory(first) for way, first in built[0].items()},
        "reference": {
            "way": truth,
            "samples": plan.references * samples,
            "relmse": reference.noise,
            "block_relmse": reference.block_noise,
        },
        "errors": errors,
        "seconds": time.monotonic() - begin,
    }


def ways(disperses: bool) -> list[str]:
    """Ways that Cycles renders a scene in. Where media disperse none overlap: naive Glass is hand-split Glass."""
    return ["split", "plain", *NESTED, "brute"] if disperses else ["naive", "split", "plain", *NESTED]


def interleaved(workers: Mapping[str, Worker], ask: Callable[[Worker], object], place: int) -> dict:
    """The answer of every worker, one after another, another one first each time."""
    order = list(workers)
    order = order[place % len(order) :] + order[: place % len(order)]
    return {way: ask(workers[way]) for way in order}


def at_once(workers: Mapping[str, Worker], ask: Callable[[Worker], object]) -> dict:
    """The answer of every worker, for what is not timed: much of it uses one core."""
    with ThreadPoolExecutor(len(workers)) as pool:
        return dict(zip(workers, pool.map(ask, workers.values()), strict=True))


def timed_samples(worker: Worker, plan: Plan) -> int:
    """Samples that take hand-split Glass as long as planned."""
    pilot = worker.costs(PILOT_SAMPLES)[1].cpu / PILOT_SAMPLES
    return int(np.clip(np.ceil(plan.timed / max(pilot, 1e-6)), PILOT_SAMPLES, 1024))


def timings(rounds: Sequence[Mapping[str, tuple[Cost, Cost]]], samples: int, resolution: int) -> dict:
    """What `samples` samples cost in each round, and how that compares to hand-split Glass in the same round: CPU time,
    or for peers time on the wall. `again` is what a picture costs besides, the scene being loaded.
    """
    result = {"samples": samples, "ways": {}}
    for way in sorted({way for row in rounds for way in row}):
        rows = [row for row in rounds if way in row]
        clock = "wall" if way in PEERS else "cpu"
        ratios = [getattr(row[way][1], clock) / getattr(row["split"][1], clock) for row in rows]
        result["ways"][way] = {
            "ratio_of": clock,
            "ratios": ratios,
            "ratio": statistics.median(ratios),
            "wall_ratio": statistics.median(row[way][1].wall / row["split"][1].wall for row in rows),
            "wall": [row[way][1].wall for row in rows],
        }
        if way not in PEERS:
            result["ways"][way] |= {
                "cpu": [row[way][1].cpu for row in rows],
                "again_cpu": statistics.median(row[way][0].cpu for row in rows),
                "again_wall": statistics.median(row[way][0].wall for row in rows),
            }
    of_split = statistics.median(row["split"][1].cpu for row in rounds)
    result["cpu_microseconds_per_sample"] = 1e6 * of_split / samples / resolution**2
    return result


def costs_on_the_wall(workers: Mapping[str, Worker], rounds: Sequence[Mapping], timed: int) -> dict:
    """Seconds of a render without its samples, of a sample, and most renders of a picture, by way."""
    found = {}
    for way, worker in workers.items():
        per_sample = statistics.median(row["split" if way == "brute" else way][1].wall for row in rounds) / timed
        if way == "brute":
            start = time.monotonic()
            worker.picture(4, 0)
            found[way] = ((time.monotonic() - start) / 4, per_sample, WAVELENGTHS)
        else:
            found[way] = (statistics.median(row[way][0].wall for row in rounds), per_sample, 1)
    return found


def affordable(costs: Mapping[str, tuple[float, float, int]], plan: Plan, seconds: float) -> int:
    """Most samples of the curves that the time is enough for, a power of two."""
    truth = "brute" if "brute" in costs else "split"
    samples = plan.most
    while samples > plan.least:
        pictures = [(way, count) for way in costs for count in [*plan.counts(samples), samples]]
        pictures += [(truth, samples)] * plan.references
        if sum(picture_seconds(*costs[way], count) for way, count in pictures) < seconds:
            break
        samples //= 2
    return samples


def picture_seconds(render: float, sample: float, renders: int, samples: int) -> float:
    """Time of a picture from one of its :func:`costs_on_the_wall`."""
    return render * min(renders, samples) + sample * samples


def halves(worker: Worker, samples: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Two independent references, each the mean of half of that many pictures."""
    pictures = [worker.picture(samples, REFERENCE_SEED + place) for place in range(count)]
    return np.mean(pictures[: count // 2], axis=0), np.mean(pictures[count // 2 :], axis=0)


def curve_pictures(picture: Callable[[int, int], np.ndarray], counts: Sequence[int]) -> list[list[np.ndarray]]:
    """Pictures for every point of a curve."""
    seeds = [LAST_SEEDS if samples == counts[-1] else LAST_SEEDS[:1] for samples in counts]
    return [[picture(samples, seed) for seed in row] for samples, row in zip(counts, seeds, strict=True)]


def curve(pictures: Sequence[Sequence[np.ndarray]], counts: Sequence[int], reference: Reference) -> dict:
    """Errors by samples, less that of the reference, and what is left of them without noise at the last one."""
    last = pictures[-1]
    return {
        "points": [
            {"samples": samples} | errors_of(row, reference) for samples, row in zip(counts, pictures, strict=True)
        ],
        "floor": asdict(floor(*last, reference)),
        "block_floor": asdict(floor(*map(block_means, last), reference.blocks)),
        "mean": float(np.mean(last) / reference.mean.mean() - 1.0),
    }


def errors_of(pictures: Sequence[np.ndarray], reference: Reference) -> dict[str, float]:
    """Mean errors of pictures and of their blocks."""
    return {
        "relmse": float(np.mean([relative_error(p, reference.mean) for p in pictures])) - reference.noise,
        "block_relmse": float(np.mean([relative_error(block_means(p), reference.blocks.mean) for p in pictures]))
        - reference.block_noise,
    }


def preparation(rows: Sequence[Built]) -> dict:
    """Medians of CPU seconds and seconds on the wall before the first sample is done."""
    return {
        step: {
            clock: statistics.median(getattr(getattr(row, step), clock) for row in rows) for clock in ("cpu", "wall")
        }
        for step in ("prepare", "first_render")
    }


def memory(built: Built) -> dict[str, float]:
    """MB at most, and how much of that is the scene and its render."""
    return {"peak": built.megabytes, "scene": built.megabytes - built.megabytes_before}


# Peers --------------------------------------------------------------------------------------------------------------


@dataclass
class Peers:
    """The other renderers that can show a scene."""

    module: ModuleType
    kinds: Sequence[str]
    scene: BenchScene
    pieces: Sequence[Piece]

    def costs(self, resolution: int, samples: int) -> dict[str, tuple[Cost, Cost]]:
        """What the samples of each take on the wall: their own processes tell no more. NaN for the rest."""
        unknown = Cost(float("nan"), float("nan"))
        found = {}
        for kind in self.kinds:
            seconds = self.module.render(kind, self.scene, self.pieces, resolution, samples)[1]
            found[kind] = unknown, Cost(float("nan"), seconds)
        return found

    def curves(self, resolution: int, samples: int, reference: Reference, deadline: float) -> dict:
        """Errors at powers of 4 and at the last count, as far as the time left allows."""
        found = {}
        for place, kind in enumerate(self.kinds):

            def picture(count: int, seed: int, kind: str = kind) -> np.ndarray:
                return self.module.render(kind, self.scene, self.pieces, resolution, count, seed)[0]

            start = time.monotonic()
            seconds = (deadline - start) / (len(self.kinds) - place)
            _, rendering, megabytes = self.module.render(kind, self.scene, self.pieces, resolution, PILOT_SAMPLES)
            loading = time.monotonic() - start - rendering
            counts = sorted({4**power for power in range(8) if 4**power < samples} | {samples})
            while len(counts) > 2 and seconds < sum(
                loading + count * rendering / PILOT_SAMPLES for count in [*counts, counts[-1]]
            ):
                counts.pop()
            found[kind] = curve(curve_pictures(picture, counts), counts, reference) | {"megabytes": megabytes}
        return found


PEERS = ("luxcore", "mitsuba")


def usable_peers(scene: BenchScene, pieces: Sequence[Piece]) -> Peers | None:
    """The peers that are installed and can show a scene."""
    try:
        import peers
    except ImportError:
        return None
    wrong = {"mitsuba"} if scene.name in DISPERSING else set()
    kinds = [kind for kind in peers.available() if kind not in wrong and not peers.why_not(kind, scene, pieces)]
    return Peers(peers, kinds, scene, pieces) if kinds else None


# Running ------------------------------------------------------------------------------------------------------------


def loaded(name: str) -> tuple[BenchScene, Split]:
    """A scene and its hand-split pieces, kept in ``out/bench`` for as long as what makes them stays the same."""
    sources = [HERE / "bench_scenes.py", HERE / "hand_split.py", Path(nd.__file__).parent / "demo" / "iced_water.py"]
    digest = hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()[:16]
    path = OUT / f"{name}-{digest}.pickle"
    if path.exists():
        return pickle.loads(path.read_bytes())
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = SCENES[name]()
    made = scene, split(scene.bodies)
    OUT.mkdir(parents=True, exist_ok=True)
    for old in OUT.glob(f"{name}-*.pickle"):
        old.unlink()
    path.write_bytes(pickle.dumps(made))
    return made


def write_results(result: dict, folder: Path) -> None:
    """JSON and plot of one scene."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{result['scene']}.json"
    path.write_text(json.dumps(result, indent=1) + "\n")
    plot(result, path.with_suffix(".png"))


def read_results(folder: Path) -> list[dict]:
    """All results of a folder, in the order of the scenes."""
    paths = [folder / f"{name}.json" for name in SCENES]
    return [json.loads(path.read_text()) for path in paths if path.exists()]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="small pictures, few samples, fewer ways")
    parser.add_argument(
        "--scene", nargs="+", choices=SCENES, default=list(SCENES), metavar="NAME", help=", ".join(SCENES)
    )
    parser.add_argument("--rounds", type=int, help="of timing")
    arguments = parser.parse_args()
    plan = QUICK if arguments.quick else FULL
    if arguments.rounds:
        plan = Plan(**asdict(plan) | {"rounds": arguments.rounds})
    folder = OUT if arguments.quick else RESULTS
    start = time.monotonic()
    end = start + plan.seconds * len(arguments.scene) / len(SCENES)
    results = []
    for place, name in enumerate(arguments.scene):
        share = (end - time.monotonic()) / (len(arguments.scene) - place)
        results.append(measure(name, plan, time.monotonic() + max(share, 0.0)))
        write_results(results[-1], folder)
        print(f"{name}: {results[-1]['seconds']:.0f} s", flush=True)
    if arguments.quick:
        print(tables(results))
    else:
        renew("tables", f"{tables(read_results(RESULTS))}\n\n{PICTURE}")
    print(f"{time.monotonic() - start:.0f} s; {folder}")


if __name__ == "__main__":
    main()
