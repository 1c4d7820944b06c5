"""Measure one scene: rounds of timing, pictures and errors, as the time allows."""

from __future__ import annotations

import hashlib
import os
import pickle
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, closing
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import bpy  # before numpy's users that live inside it
import numpy as np
from bench_arrays import BenchScene
from bench_errors import Reference
from bench_figures import curve, curve_pictures, halves, memory, preparation, timings
from bench_scenes import DISPERSING, SCENES
from bench_worker import NESTED, WAVELENGTHS, Built, Cost, Worker, save
from hand_split import Piece, Split, split
from scenes import BOUNCES

import nested_dielectric as nd

HERE = Path(__file__).resolve().parent

OUT = HERE.parent / "out" / "bench"

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
        rounds = []
        for place in rounds_in_time(plan.rounds, latest := begin + 0.45 * (deadline - begin)):
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
    return described(scene, parts, plan) | {
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


def rounds_in_time(count: int, latest: float) -> Iterator[int]:
    """Places of the rounds that there is time for, and of LEAST_ROUNDS."""
    for place in range(count):
        if place >= LEAST_ROUNDS and time.monotonic() >= latest:
            return
        yield place


def described(scene: BenchScene, parts: Split, plan: Plan) -> dict:
    """What is measured, and on what machine."""
    return {
        "scene": scene.name,
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


def usable_peers(scene: BenchScene, pieces: Sequence[Piece]) -> Peers | None:
    """The peers that are installed and can show a scene."""
    try:
        import peers
    except ImportError:
        return None
    wrong = {"mitsuba"} if scene.name in DISPERSING else set()
    kinds = [kind for kind in peers.available() if kind not in wrong and not peers.why_not(kind, scene, pieces)]
    return Peers(peers, kinds, scene, pieces) if kinds else None


def loaded(name: str) -> tuple[BenchScene, Split]:
    """A scene and its hand-split pieces, kept in ``out/bench`` for as long as what makes them stays the same."""
    names = ("bench_scenes", "bench_shapes", "bench_arrays", "hand_split")
    sources = [*(HERE / f"{each}.py" for each in names), Path(nd.__file__).parent / "demo" / "iced_water.py"]
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
