"""Tables and plots of what a farm takes: of what was measured, and of what the model makes of it.

All of them stand in ``docs/farm.md``, between marks, and follow from ``results/farm.json`` alone.
"""

from __future__ import annotations

import json
import statistics
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

from bench_report import markdown, renewed
from farm_model import (
    HOUR,
    Farm,
    Job,
    Plan,
    chunk_for,
    duration,
    fastest_ranges,
    planned,
    ranges_for,
    simulate,
)
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

HERE = Path(__file__).resolve().parent
RESULTS = HERE / "results" / "farm.json"
PICTURE = HERE / "results" / "farm.png"
PAGE = HERE.parent / "docs" / "farm.md"

WAYS = {
    "osl": "OSL",
    "native": "Cycles' nodes",
    "persistent": "OSL, *Persistent Data*",
    "prepared": "OSL, prepared file, no extension",
}

ONCE = {"start": "start", "load": "file", "prepare": "prepare"}
EACH = {"evaluate": "evaluate, cut", "export": "export", "shaders": "compile", "bvh": "BVH"}

SCENE, WAY = "iced_water", "osl"
"""What the tables of the model are of."""

MEGAPIXELS, SAMPLES, CORES = 1920 * 1080 / 1e6, 256, 16
HEAVY = 16
"""Times as many pixels, and samples, of the frame that takes hours: 7680 x 4320."""

FRAMES, MACHINES = (1, 10, 100, 1_000, 10_000), (1, 10, 100, 1_000)

SPREAD = {"spread": 0.1, "frame_spread": 0.1}

FAILURES = (0.0, 0.01, 0.05, 0.2)

RUNS = 4
"""Of each case with failures, of which the table has the mean."""


def load() -> dict:
    """What was measured last."""
    return json.loads(RESULTS.read_text(encoding="utf-8"))


# What was measured --------------------------------------------------------------------------------------------------


def step(runs: Sequence[dict], name: str) -> float:
    """CPU seconds of a step of each process, its median."""
    return statistics.median(run["steps"][name][0] for run in runs)


def part(runs: Sequence[dict], frame: int, name: str) -> float:
    """CPU seconds of a part of a frame, the median."""
    return statistics.median(run["frames"][frame][name][0] for run in runs)


def sample_costs(run: dict, samples: Sequence[int]) -> tuple[float, float]:
    """CPU seconds of one process's sample of a whole picture, and of what else stands between its first and last."""
    few, many = (frame["sample"][0] for frame in run["frames"])
    each = (many - few) / (samples[1] - samples[0])
    return each, few - samples[0] * each


def microseconds(result: dict, runs: Sequence[dict]) -> list[float]:
    """CPU microseconds that a sample of a pixel takes, in every process."""
    return [1e6 * sample_costs(run, result["samples"])[0] / result["resolution"] ** 2 for run in runs]


def once(run: dict) -> float:
    """CPU seconds that a process takes before its first frame."""
    return sum(run["steps"][name][0] for name in ONCE)


def frame_costs(result: dict, run: dict) -> tuple[float, float]:
    """CPU seconds of a process's first frame and of its second, but for their samples."""
    ending = sample_costs(run, result["samples"])[1]
    first, second = (
        sum(spent[0] for name, spent in frame.items() if name != "sample") + ending for frame in run["frames"]
    )
    return first, second


def job_of(result: dict, scene: str, way: str, cores: int = CORES, larger: int = 1) -> Job:
    """What a frame of a scene costs on a machine of so many cores: samples use all, the rest one.

    `larger`: times as many pixels, and as many samples.
    """
    runs = result["scenes"][scene]["ways"][way]
    first, second = (statistics.median(costs) for costs in zip(*(frame_costs(result, run) for run in runs)))
    pixels = MEGAPIXELS * larger
    per_sample = statistics.median(microseconds(result, runs)) * pixels
    return Job(
        once=statistics.median(map(once, runs)) + max(0.0, first - second),
        frame=second + result["write_per_megapixel"] * pixels,
        samples=per_sample * SAMPLES * larger / cores,
        merge_once=step(runs, "start") + result["merge_per_megapixel"] * pixels,
        merge_part=result["merge_part_per_megapixel"] * pixels,
    )


def rows_of(result: dict) -> list[tuple[str, str]]:
    """All scenes with the ways that they were measured in."""
    return [(scene, way) for scene, found in result["scenes"].items() for way in WAYS if way in found["ways"]]


def measured_table(result: dict) -> str:
    """Medians, of sums with the least and the most."""
    header = ["CPU s", *ONCE.values(), *(f"first frame: {words}" for words in EACH.values()), "all of it"]
    rows = []
    for scene, way in rows_of(result):
        runs = result["scenes"][scene]["ways"][way]
        costs = [frame_costs(result, run) for run in runs]
        rows.append(
            [
                f"{result['scenes'][scene]['title']}: {WAYS[way]}",
                *(f"{step(runs, name):.2f}" for name in ONCE),
                *(f"{part(runs, 0, name):.2f}" for name in EACH),
                *(spread_cell([cost[place] for cost in costs], 1) for place in range(2)),
                spread_cell(microseconds(result, runs), 1),
            ]
        )
    machine = result["machine"]
    return (
        markdown([*header, "next frame", "µs a sample of a pixel"], rows)
        + f"\n\nBesides, writing takes {result['write_per_megapixel']:.2f} s a megapixel; merging "
        f"{result['merge_part_per_megapixel']:.2f} s a megapixel of every range and {result['merge_per_megapixel']:.2f} once.\n"
        f"\nMedians of {result['rounds']} processes, of sums with the least and the most; {machine['cores']} cores of "
        f"{machine['name']}, Blender {machine['blender']}{busy(result)}."
    )


def busy(result: dict) -> str:
    """Say where starts, each of one thread, took longer on the wall: other work had the cores, which lengthens CPU seconds."""
    starts = [
        run["steps"]["start"] for found in result["scenes"].values() for runs in found["ways"].values() for run in runs
    ]
    waited = statistics.fmean(wall / cpu for cpu, wall in starts)
    return "" if waited < 1.1 else f". Other work ran meanwhile: on the wall starts took {waited:.1f} times as long"


def spread_cell(values: Sequence[float], places: int) -> str:
    """A median with the least and the most."""
    return f"{statistics.median(values):.{places}f} ({min(values):.{places}f}–{max(values):.{places}f})"


# What follows from it -----------------------------------------------------------------------------------------------


def model_table(result: dict) -> str:
    """What the model takes from the measurements, for a picture on a machine."""
    header = [f"s on a machine of {CORES} cores", "once, *a*", "a frame but samples, *g*", "its samples, *V*"]
    header += ["samples' part of a frame alone", "of 10 in a task"]
    rows = []
    for scene, way in rows_of(result):
        job = job_of(result, scene, way)
        parts = [frames * job.samples / job.chunk_seconds(frames) for frames in (1, 10)]
        cells = [f"{value:.1f}" for value in (job.once, job.frame, job.samples)]
        rows.append([f"{result['scenes'][scene]['title']}: {WAYS[way]}", *cells, *(f"{each:.0%}" for each in parts)])
    small, large = (job_of(result, SCENE, WAY, cores) for cores in (4, 64))
    return markdown(header, rows) + (
        f"\n\nThe first of them on 4 cores: {small.samples / small.chunk_seconds(1):.0%} are samples; on 64, "
        f"{large.samples / large.chunk_seconds(1):.0%}."
    )


def hours(seconds: float) -> str:
    """A time in hours, of three digits or more."""
    return f"{seconds / HOUR:,.0f} h" if seconds >= 100.0 * HOUR else f"{seconds / HOUR:.3g} h"


@cache
def grid(job: Job) -> dict[tuple[int, int], Plan]:
    """The model's job split up by the rules, for all numbers of frames and machines."""
    return {
        (frames, machines): planned(job, frames, Farm(machines, **SPREAD)) for frames in FRAMES for machines in MACHINES
    }


def times_table(result: dict) -> str:
    """Time and machine hours of frames on machines, how they are split up, and a worked price."""
    found = grid(job_of(result, SCENE, WAY))

    def table(cell: Callable[[Plan], str]) -> str:
        header = ["frames", *(f"{machines:,} machine{'s' * (machines > 1)}" for machines in MACHINES)]
        rows = [[f"{frames:,}", *(cell(found[frames, machines]) for machines in MACHINES)] for frames in FRAMES]
        return markdown(header, rows)

    times = table(lambda plan: f"{duration(plan.outcome.seconds)} ({hours(plan.outcome.busy)})")
    splits = table(lambda plan: f"{plan.ranges} ranges" if plan.ranges > 1 else f"{plan.chunk} a task")
    many, one = (found[FRAMES[-1], machines].outcome for machines in (MACHINES[-1], 1))
    return "\n\n".join(
        (
            times,
            "Split up by the rules below, into ranges of samples of each frame or so many frames a task:",
            splits,
            f"At 1.00 for a machine's hour, {FRAMES[-1]:,} frames on {MACHINES[-1]:,} machines cost {many.machine_hours:,.0f} "
            f"and take {duration(many.seconds)}; on one machine {one.machine_hours:,.0f} and {duration(one.seconds)}.",
        )
    )


def ranges_table(result: dict) -> str:
    """One frame in ranges of its samples, on as many machines."""
    tables = []
    for larger, counts in ((1, (1, 2, 4, 8, 16, 32, 64)), (HEAVY, (1, 4, 16, 64, 256, 1024))):
        job = job_of(result, SCENE, WAY, larger=larger)
        rows = []
        for ranges in counts:
            found = simulate(job, 1, Farm(ranges), ranges=ranges)
            rows.append([f"{ranges:,}", duration(found.seconds), hours(found.busy), f"{job.samples / found.busy:.0%}"])
        header = [f"{picture_words(larger)}: ranges", "time", "of all machines", "of that samples"]
        tables.append(
            f"{markdown(header, rows)}\n\nWorth it: up to {ranges_for(job, 1, 10**6):,} ranges; "
            f"shortest with {fastest_ranges(job):,}."
        )
    return "\n\n".join(tables)


def picture_words(larger: int = 1) -> str:
    """What picture the numbers are of."""
    width, height = (side * round(larger**0.5) for side in (1920, 1080))
    return f"{width} x {height}, {SAMPLES * larger:,} samples"


def failures_table(result: dict) -> str:
    """Time, machine hours and those of them that were lost, by how often machines fail."""
    job, heavy = (job_of(result, SCENE, WAY, larger=larger) for larger in (1, HEAVY))
    ranges = {rate: ranges_for(heavy, 100, 100, rate) for rate in FAILURES}
    most = max(ranges.values())
    cases: dict[str, Callable[[float], tuple]] = {
        "10,000 frames on 1,000 machines, 1 a task": lambda rate: (job, 10_000, 1_000, rate, 1, 1, True),
        "10 a task, finished frames kept": lambda rate: (job, 10_000, 1_000, rate, 10, 1, True),
        "10 a task, begun again": lambda rate: (job, 10_000, 1_000, rate, 10, 1, False),
        f"100 frames of {picture_words(HEAVY)} on 100 machines": lambda rate: (heavy, 100, 100, rate, 1, 1, True),
        f"the same, {most} ranges a frame": lambda rate: (heavy, 100, 100, rate, 1, most, True),
    }
    rows = [[words, *(failing_cell(*case(rate)) for rate in FAILURES)] for words, case in cases.items()]
    return markdown(
        [f"machines that fail in an hour; means of {RUNS} runs", *(f"{rate:.0%}" for rate in FAILURES)], rows
    )


@cache
def failing_cell(job: Job, frames: int, machines: int, rate: float, chunk: int, ranges: int, keeps: bool) -> str:
    """What came of it, the mean of some runs."""
    farm = Farm(machines, rate, **SPREAD)
    runs = [simulate(job, frames, farm, chunk, ranges, keeps, seed) for seed in range(RUNS)]
    seconds, busy, lost = (statistics.fmean(getattr(run, name) for run in runs) for name in ("seconds", "busy", "lost"))
    return f"{duration(seconds)} ({hours(busy)}{f', {hours(lost)} lost' if lost else ''})"


CONTENTS: dict[str, Callable[[dict], str]] = {
    "measured": measured_table,
    "model": model_table,
    "times": times_table,
    "ranges": ranges_table,
    "failures": failures_table,
}
"""What stands between the marks of the page."""


def plot(result: dict, path: Path) -> None:
    """Time against frames of a task, and of one frame against ranges, to a PNG."""
    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    whole = job_of(result, SCENE, WAY)
    for samples in (1, 16, 256):
        job = Job(whole.once, whole.frame, whole.samples * samples / SAMPLES)
        chunks = [1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20]
        times = [simulate(job, 10_000, Farm(1_000, **SPREAD), chunk).seconds / 60.0 for chunk in chunks]
        (line,) = left.plot(chunks, times, marker=".", label=f"{samples} sample{'s' * (samples > 1)} a pixel")
        rule = chunk_for(job, 10_000, 1_000)
        left.plot(rule, times[chunks.index(rule)], "o", color=line.get_color(), markersize=9.0)
    left.set_title("10,000 frames on 1,000 machines")
    left.set_xlabel("frames a task")
    for scene, found in result["scenes"].items():
        job = job_of(result, scene, WAY)
        counts = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128]
        rule = ranges_for(job, 1, counts[-1])
        *times, worth = (simulate(job, 1, Farm(ranges), ranges=ranges).seconds for ranges in (*counts, rule))
        (line,) = right.plot(counts, times, label=found["title"].partition(",")[0])
        right.plot(rule, worth, "o", color=line.get_color(), markersize=9.0)
    right.set_title("one frame, a machine for each range")
    right.set_xlabel("ranges of its samples")
    for axis in (left, right):
        axis.set_xscale("log")
        axis.set_yscale("log")
        for side in (axis.xaxis, axis.yaxis):
            side.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            side.set_major_formatter(StrMethodFormatter("{x:g}"))
            side.set_minor_formatter(NullFormatter())
        axis.grid(alpha=0.3)
        axis.legend()
    left.set_ylabel("minutes")
    right.set_ylabel("seconds")
    figure.savefig(path, dpi=100)


def renew_page(result: dict) -> None:
    """Keep what was measured, and write all that follows from it anew."""
    RESULTS.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    plot(result, PICTURE)
    page = PAGE.read_text(encoding="utf-8")
    for name, content in CONTENTS.items():
        page = renewed(page, name, content(result))
    PAGE.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    renew_page(load())
