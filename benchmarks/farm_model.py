"""Time and price of many frames on many machines: closed forms, and a simulation that they are held to.

Run as ``.venv/bin/python benchmarks/farm_model.py --frames 10000 --machines 1000 --once 12 --frame 4 --samples 150`` with
seconds of your own; it needs no Blender. Times are seconds and failures are per hour of a machine, unless said otherwise.
"""

from __future__ import annotations

import argparse
import heapq
from collections import deque
from dataclasses import dataclass, replace
from itertools import count
from math import ceil, exp, expm1, sqrt

import numpy as np

HOUR = 3600.0


@dataclass(frozen=True)
class Job:
    """What a frame costs on one machine, in seconds.

    `once`: whatever every process repeats, from its start until its first frame, and what its first frame takes longer than
    the next; `frame`: a frame but for its samples; `samples`: all its samples; `merge_once` and `merge_part`: merging ranges
    of samples into a picture, in all and for each range.
    """

    once: float
    frame: float
    samples: float
    merge_once: float = 1.0
    merge_part: float = 0.1

    @property
    def whole_frame(self) -> float:
        """A frame with its samples."""
        return self.frame + self.samples

    @property
    def repeated(self) -> float:
        """What each range of samples of a frame repeats."""
        return self.once + self.frame

    def chunk_seconds(self, frames: int) -> float:
        """A task of some whole frames."""
        return self.once + frames * self.whole_frame

    def range_seconds(self, ranges: int) -> float:
        """A task that renders one of so many ranges of a frame's samples."""
        return self.repeated + self.samples / ranges

    def merge_seconds(self, ranges: int) -> float:
        """The task that merges a frame's ranges; none for one range."""
        return self.merge_once + ranges * self.merge_part if ranges > 1 else 0.0


@dataclass(frozen=True)
class Farm:
    """Machines.

    `failures` an hour of each machine while it works (Poisson); `away`: seconds until one that failed is back; `spread`:
    standard deviation of the logarithm of how long machines take for the same; `frame_spread`: the same of frames. Both
    have a mean of 1.
    """

    machines: int
    failures: float = 0.0
    away: float = 300.0
    spread: float = 0.0
    frame_spread: float = 0.0


# Closed forms -------------------------------------------------------------------------------------------------------


def rounds_seconds(job: Job, frames: int, chunk: int, machines: int) -> float:
    """Time of chunks of one length on equal machines that do not fail: as many rounds as are needed."""
    return ceil(ceil(frames / chunk) / machines) * job.chunk_seconds(chunk)


def retried_seconds(work: float, failures: float, away: float = 0.0) -> float:
    """Expected time of a task that begins again whenever its machine fails.

    With x failures a second, of which exp(x work) - 1 are expected before an attempt comes through, it is
    (exp(x work) - 1) (1 / x + away): Daly 2006, "A higher order estimate of the optimum checkpoint interval for restart
    dumps", of a run of one segment without a restart.
    """
    if failures == 0.0:
        return work
    rate = failures / HOUR
    return expm1(rate * work) * (1.0 / rate + away)


def kept_seconds(job: Job, frames: int, failures: float, away: float = 0.0) -> float:
    """Expected time of a chunk of which finished frames are kept when its machine fails.

    A frame is a segment and a process's start a restart, Daly's exp(x once) (exp(x frame) - 1) / x for each frame; the
    first one has its start before it in any case.
    """
    if failures == 0.0:
        return job.chunk_seconds(frames)
    rate = failures / HOUR
    first = expm1(rate * (job.once + job.whole_frame))
    next_one = exp(rate * job.once) * expm1(rate * job.whole_frame)
    return (first + (frames - 1) * next_one) * (1.0 / rate + away)


def chunk_for(job: Job, frames: int, machines: int, failures: float = 0.0, keeps: bool = True) -> int:
    """Frames of a task for the shortest time.

    N once / (c M) of all time goes into starts and, on an average, half a task's c frame into waiting for the last; their
    sum is least at the root of 2 N once / (M frame). Where a failure loses a whole chunk, none is longer than the root of
    2 once / x, Young's interval between checkpoints (1974, "A first order approximation to the optimum checkpoint interval").
    """
    chunk = sqrt(2.0 * frames * job.once / (machines * job.whole_frame))
    if failures and not keeps:
        chunk = min(chunk, sqrt(2.0 * job.once * HOUR / failures) / job.whole_frame)
    return int(np.clip(round(chunk), 1, max(1, ceil(frames / machines))))


LOST_LIFE = 0.2
"""Part of a machine's mean life that a frame may take before it is split for that alone: 11 % more is paid then."""


def ranges_for(job: Job, frames: int, machines: int, failures: float = 0.0) -> int:
    """Ranges of a frame's samples that are worth it: one where there are frames enough for all machines.

    No more than machines for each frame, nor than let a range's samples take as long as what it repeats: at that number,
    half of all time is repeated; nor than :func:`fastest_ranges`. Frames that machines hardly live to see finished are split
    in any case.
    """
    ranges = min(machines // frames, int(job.samples / job.repeated), fastest_ranges(job))
    if failures * job.whole_frame > LOST_LIFE * HOUR:
        ranges = max(ranges, ceil(job.samples / range_samples(job, failures)))
    return max(1, ranges)


def fastest_ranges(job: Job) -> int:
    """Ranges of one frame for its shortest time, however many machines that takes: more would merge longer than they save.

    samples / r + merge_part r is least at the root of samples / merge_part.
    """
    return max(1, round(sqrt(job.samples / job.merge_part)))


def range_samples(job: Job, failures: float) -> float:
    """Seconds of samples in a range that least is lost with where machines fail: Young's interval."""
    return sqrt(2.0 * job.repeated * HOUR / failures)


# Simulation ---------------------------------------------------------------------------------------------------------


@dataclass
class Task:
    """What one machine does in one go: `frames` of which each takes `each` seconds after `once`; a range or a merge is one.

    `kind` is "frames", "range" or "merge"; `keeps`: what was finished stays so when the machine fails.
    """

    kind: str
    frames: list[int]
    once: float
    each: list[float]
    keeps: bool


@dataclass
class Outcome:
    """What a run took: `seconds` on the wall, `busy` those of all machines together, `lost` those of work that was to be
    done again, starts included.

    `done`, for each frame, is how often a picture of it was finished.
    """

    seconds: float
    busy: float
    lost: float
    failures: int
    tasks: int
    done: np.ndarray

    @property
    def machine_hours(self) -> float:
        """Hours that are paid, machines without work being given back."""
        return self.busy / HOUR


def simulate(
    job: Job, frames: int, farm: Farm, chunk: int = 1, ranges: int = 1, keeps: bool = True, seed: int = 0
) -> Outcome:
    """Run a job event by event; a machine that has nothing to do takes the next task, one that was lost first."""
    random = np.random.default_rng(seed)
    pace = spread_around_one(random, farm.spread, farm.machines)
    tasks = deque(tasks_of(job, spread_around_one(random, farm.frame_spread, frames), chunk, ranges, keeps))
    left = np.full(frames, ranges)
    outcome = Outcome(0.0, 0.0, 0.0, 0, 0, np.zeros(frames, int))
    idle = list(range(farm.machines))[::-1]
    events: list[tuple[float, int, int, Task | None]] = []
    order = count()
    now = 0.0
    while tasks or events:
        while tasks and idle:
            machine, task = idle.pop(), tasks.popleft()
            work = pace[machine] * (task.once + sum(task.each))
            until = random.exponential(HOUR / farm.failures) if farm.failures else np.inf
            end = now + min(work, until)
            outcome.busy += end - now
            if until < work:
                outcome.failures += 1
                left_over = interrupted(task, until / pace[machine], outcome, pace[machine])
                heapq.heappush(events, (end, next(order), -1, left_over))
                heapq.heappush(events, (end + farm.away, next(order), machine, None))
            else:
                heapq.heappush(events, (end, next(order), machine, task))
        now, _, machine, task = heapq.heappop(events)
        if machine < 0:
            tasks.appendleft(task)
            continue
        idle.append(machine)
        if task is not None:
            outcome.tasks += 1
            outcome.seconds = now
            finish(job, task, ranges, left, tasks, outcome)
    return outcome


def spread_around_one(random: np.random.Generator, spread: float, size: int) -> np.ndarray:
    """Lognormal numbers of mean 1."""
    return random.lognormal(-0.5 * spread**2, spread, size)


def tasks_of(job: Job, lengths: np.ndarray, chunk: int, ranges: int, keeps: bool) -> list[Task]:
    """All tasks but those that merge, in order of frames, which take `lengths` times as long as the average."""
    if ranges > 1:
        parts = [(frame, job.frame + job.samples * length / ranges) for frame, length in enumerate(lengths)]
        return [Task("range", [frame], job.once, [each], False) for frame, each in parts for _ in range(ranges)]
    whole = (job.frame + job.samples * lengths).tolist()
    starts = range(0, len(whole), chunk)
    names = list(range(len(whole)))
    return [
        Task("frames", names[start : start + chunk], job.once, whole[start : start + chunk], keeps) for start in starts
    ]


def interrupted(task: Task, worked: float, outcome: Outcome, pace: float) -> Task:
    """What is left of a task whose machine failed after so many of its seconds."""
    done, kept = 0, 0.0
    if task.keeps:
        done = int(np.searchsorted(task.once + np.cumsum(task.each), worked, side="right"))
        kept = sum(task.each[:done])
    outcome.lost += (worked - kept) * pace
    outcome.done[task.frames[:done]] += 1
    return replace(task, frames=task.frames[done:], each=task.each[done:])


def finish(job: Job, task: Task, ranges: int, left: np.ndarray, tasks: deque[Task], outcome: Outcome) -> None:
    """Count a task's frames; after the last range of a frame its merging is next."""
    if task.kind == "range":
        (frame,) = task.frames
        left[frame] -= 1
        if left[frame] == 0:
            tasks.appendleft(Task("merge", [frame], job.merge_once, [ranges * job.merge_part], False))
    else:
        outcome.done[task.frames] += 1


# Answers ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Plan:
    """How a job is split up, and what came of it."""

    chunk: int
    ranges: int
    outcome: Outcome


def planned(job: Job, frames: int, farm: Farm, keeps: bool = True, seed: int = 0) -> Plan:
    """Split a job up by the rules and run it."""
    ranges = ranges_for(job, frames, farm.machines, farm.failures)
    chunk = 1 if ranges > 1 else chunk_for(job, frames, farm.machines, farm.failures, keeps)
    return Plan(chunk, ranges, simulate(job, frames, farm, chunk, ranges, keeps, seed))


def duration(seconds: float) -> str:
    """A time in words: seconds, minutes, hours or days, of two or three digits."""
    for limit, size, unit in ((100.0, 1.0, "s"), (6000.0, 60.0, "min"), (100.0 * HOUR, HOUR, "h")):
        if seconds < limit:
            return f"{digits(seconds / size)} {unit}"
    return f"{digits(seconds / (24.0 * HOUR))} days"


def digits(value: float) -> str:
    """A number with two digits, more of what is above 100."""
    return f"{value:,.0f}" if value >= 10.0 else f"{value:.1f}"


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--frames", type=int, required=True)
    parser.add_argument("--machines", type=int, required=True)
    for name, meaning in (
        ("once", "seconds that a process takes before its first frame"),
        ("frame", "seconds of a frame but for its samples"),
        ("samples", "seconds of a frame's samples"),
    ):
        parser.add_argument(f"--{name}", type=float, required=True, help=meaning)
    parser.add_argument("--merge", type=float, default=1.0, help="seconds of merging one range of a frame")
    parser.add_argument("--failures", type=float, default=0.0, help="per hour of a machine: 0.05 is one in 20 hours")
    parser.add_argument("--spread", type=float, default=0.1, help="of machines and frames: 0.1 is about 10 percent")
    parser.add_argument("--price", type=float, help="of a machine's hour")
    found = parser.parse_args()
    if min(found.frames, found.machines) < 1 or min(found.once, found.frame, found.samples, found.failures) < 0.0:
        parser.error("frames and machines are 1 at least, seconds and failures not below 0")
    return found


def main() -> None:
    given = arguments()
    job = Job(given.once, given.frame, given.samples, given.once, given.merge)
    farm = Farm(given.machines, given.failures, spread=given.spread, frame_spread=given.spread)
    plan = planned(job, given.frames, farm)
    found = plan.outcome
    split = f"{plan.ranges} ranges of samples a frame" if plan.ranges > 1 else f"{plan.chunk} frames a task"
    price = "" if given.price is None else f", price {given.price * found.machine_hours:,.2f}"
    print(f"{split}: {duration(found.seconds)}, {found.machine_hours:,.1f} machine hours{price}")
    if found.failures:
        print(f"{found.failures} failures, {found.lost / HOUR:,.1f} machine hours lost")


if __name__ == "__main__":
    main()
