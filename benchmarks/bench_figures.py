"""Figures of a scene: timings, curves of error, memory."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict

import numpy as np
from bench_errors import Reference, block_means, floor, relative_error
from bench_worker import Built, Cost, Worker

REFERENCE_SEED = 1000

LAST_SEEDS = (1, 2)
"""Pictures for the last point of a curve; the others take the first alone."""


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


PEERS = ("luxcore", "mitsuba")
