"""The simulation of farms agrees with what can be worked out, and the rules for splitting up are near the best."""

from dataclasses import replace
from math import ceil, exp

import numpy as np
import pytest
from farm_plans import HEAVY, LIGHT, USUAL, farm_model
from pytest import approx

simulate, Farm, HOUR = farm_model.simulate, farm_model.Farm, farm_model.HOUR

RUNS = 400

LIMIT = 4.5
"""Standard errors that a mean may be off: seven in a million are further, and seeds are fixed."""

JOBS = {"light": LIGHT, "usual": USUAL, "heavy": HEAVY}


def every_job(function):
    return pytest.mark.parametrize("job", JOBS.values(), ids=JOBS)(function)


def agrees(values, expected: float) -> bool:
    """Whether the mean of random values is what was expected."""
    values = np.asarray(values)
    return abs(values.mean() - expected) < LIMIT * values.std(ddof=1) / np.sqrt(len(values))


@every_job
def test_one_machine_takes_the_sum_of_all_tasks(job):
    found = simulate(job, 10, Farm(1), chunk=3)
    assert found.seconds == approx(4 * job.once + 10 * job.whole_frame)
    assert found.busy == approx(found.seconds)
    assert (found.tasks, found.lost, found.failures) == (4, 0.0, 0)


@pytest.mark.parametrize(("frames", "chunk", "machines"), [(1, 1, 1), (7, 1, 3), (60, 4, 5), (1000, 10, 100)])
def test_equal_tasks_on_equal_machines_take_whole_rounds(frames, chunk, machines):
    found = simulate(USUAL, frames, Farm(machines), chunk=chunk)
    expected = ceil(ceil(frames / chunk) / machines) * (USUAL.once + chunk * (USUAL.frame + USUAL.samples))
    assert found.seconds == approx(expected)
    assert farm_model.rounds_seconds(USUAL, frames, chunk, machines) == approx(expected)


def test_a_frame_in_ranges_takes_one_range_and_its_merging():
    found = simulate(USUAL, 1, Farm(8), ranges=8)
    assert found.seconds == approx(7.0 + 8.0 + 160.0 / 8 + 1.5 + 8 * 0.1)
    assert found.seconds == approx(USUAL.range_seconds(8) + USUAL.merge_seconds(8))
    assert found.busy == approx(8 * USUAL.range_seconds(8) + USUAL.merge_seconds(8))
    assert found.tasks == 9


def test_a_frame_that_is_not_split_needs_no_merging():
    assert USUAL.merge_seconds(1) == 0.0
    assert USUAL.range_seconds(1) == approx(USUAL.chunk_seconds(1))


@pytest.mark.parametrize("failures", [1.0, 10.0, 40.0])
def test_a_task_that_begins_again_takes_as_long_as_the_closed_form_says(failures):
    farm = Farm(1, failures, away=60.0)
    found = [simulate(USUAL, 1, farm, keeps=False, seed=seed).seconds for seed in range(RUNS)]
    rate = failures / 3600.0
    expected = (exp(rate * 175.0) - 1.0) * (1.0 / rate + 60.0)
    assert farm_model.retried_seconds(175.0, failures, 60.0) == approx(expected)
    assert agrees(found, expected)


@pytest.mark.parametrize("failures", [2.0, 10.0])
def test_a_chunk_whose_finished_frames_are_kept_takes_as_long_as_the_closed_form_says(failures):
    farm, job = Farm(1, failures, away=60.0), replace(USUAL, once=100.0)
    found = [simulate(job, 12, farm, chunk=12, seed=seed).seconds for seed in range(RUNS)]
    assert agrees(found, farm_model.kept_seconds(job, 12, failures, 60.0))
    assert not agrees(found, farm_model.retried_seconds(job.chunk_seconds(12), failures, 60.0))


@pytest.mark.parametrize(
    "form", [farm_model.retried_seconds, lambda work, rate: farm_model.kept_seconds(USUAL, 5, rate)]
)
def test_closed_forms_go_over_into_those_without_failures(form):
    work = USUAL.chunk_seconds(5)
    assert form(work, 0.0) == work
    assert form(work, 1e-6) == approx(work, rel=1e-6)


@pytest.mark.parametrize("keeps", [True, False], ids=["kept", "begun again"])
@pytest.mark.parametrize(("chunk", "ranges"), [(1, 1), (7, 1), (1, 5)])
def test_nothing_is_lost_or_finished_twice_however_machines_fail(chunk, ranges, keeps):
    farm = Farm(9, failures=6.0, away=30.0, spread=0.3, frame_spread=0.5)
    found = simulate(USUAL, 100, farm, chunk, ranges, keeps)
    assert found.failures > 20
    assert (found.done == 1).all()


@pytest.mark.parametrize("ranges", [1, 4])
def test_what_machines_worked_is_what_was_needed_and_what_was_lost(ranges):
    found = simulate(USUAL, 200, Farm(20, failures=2.0), ranges=ranges)
    one = ranges * USUAL.range_seconds(ranges) + USUAL.merge_seconds(ranges)
    assert found.lost > 0.0
    assert found.busy == approx(200 * one + found.lost)


def test_frames_that_are_kept_are_not_lost_but_their_start_is():
    kept, again = (simulate(USUAL, 200, Farm(20, failures=2.0), chunk=10, keeps=keeps) for keeps in (True, False))
    for found in (kept, again):
        assert found.busy == approx(20 * USUAL.chunk_seconds(10) + found.lost)
    assert kept.failures * USUAL.once < kept.lost < kept.failures * USUAL.chunk_seconds(1)
    assert again.lost > 2.0 * kept.lost


def test_no_farm_is_faster_than_its_work_nor_slower_than_the_bound_of_any_list():
    """Graham 1969: work / machines + the longest task, whatever the order."""
    farm = Farm(40, frame_spread=0.6)
    found = simulate(USUAL, 300, farm, chunk=2)
    assert found.busy / 40 <= found.seconds
    longest = simulate(USUAL, 300, replace(farm, machines=300), chunk=2).seconds
    assert found.seconds <= found.busy / 40 + longest


def test_machines_and_frames_that_vary_take_as_long_on_an_average():
    random = np.random.default_rng(1)
    assert agrees(farm_model.spread_around_one(random, 0.5, 20_000), 1.0)


@every_job
@pytest.mark.parametrize(("frames", "machines"), [(10_000, 1_000), (1_000, 100), (500, 50)])
def test_the_rule_for_frames_of_a_task_is_near_the_fastest(job, frames, machines):
    farm = Farm(machines, spread=0.1, frame_spread=0.1)
    rule = farm_model.chunk_for(job, frames, machines)

    def mean(chunk: int) -> float:
        return np.mean([simulate(job, frames, farm, chunk, seed=seed).seconds for seed in range(2)])

    best = min(map(mean, sorted({1, 2, 3, 4, 5, 6, 8, 10, rule})))
    assert mean(rule) < 1.15 * best  # the rule takes half a task for what the end takes, which hangs on the remainder


def test_where_a_failure_loses_a_whole_task_tasks_are_short():
    """Young's interval is where starts and losses are least together: the derivative of the closed form is nothing there."""
    failures, frames = 2.0, 100_000
    chunk = farm_model.chunk_for(LIGHT, frames, 1, failures, keeps=False)

    def lost_for_a_frame(each: int) -> float:
        return farm_model.retried_seconds(LIGHT.chunk_seconds(each), failures) / each

    assert lost_for_a_frame(chunk) < 1.001 * min(map(lost_for_a_frame, range(1, 400)))
    assert chunk < farm_model.chunk_for(LIGHT, frames, 1, failures, keeps=True)


def test_frames_are_split_only_where_machines_would_have_none():
    assert farm_model.ranges_for(USUAL, 1_000, 1_000) == 1
    assert farm_model.ranges_for(USUAL, 1_000, 100) == 1
    assert farm_model.ranges_for(USUAL, 100, 300) == 3
    assert farm_model.ranges_for(LIGHT, 1, 1_000) == 1  # its samples take no longer than what is repeated


def test_at_the_number_of_ranges_that_is_worth_it_half_of_all_time_is_samples():
    ranges = farm_model.ranges_for(USUAL, 1, 10_000)
    found = simulate(USUAL, 1, Farm(ranges), ranges=ranges)
    assert USUAL.samples / found.busy == approx(0.5, abs=0.03)  # merging, and the number is whole


def test_no_number_of_ranges_is_faster_than_the_fastest():
    found = {ranges: simulate(HEAVY, 1, Farm(ranges), ranges=ranges).seconds for ranges in range(100, 400, 5)}
    fastest = min(found, key=found.__getitem__)
    assert farm_model.fastest_ranges(HEAVY) == approx(fastest, abs=5)
    assert farm_model.ranges_for(HEAVY, 1, 10_000) == farm_model.fastest_ranges(HEAVY)


def test_frames_that_machines_hardly_live_to_finish_are_split_and_take_less():
    farm = Farm(20, failures=0.2)
    ranges = farm_model.ranges_for(HEAVY, 20, 20, 0.2)
    assert ranges > farm_model.ranges_for(HEAVY, 20, 20) == 1
    whole, split = (simulate(HEAVY, 20, farm, ranges=each) for each in (1, ranges))
    assert split.busy < 0.5 * whole.busy
    assert split.seconds < whole.seconds


def test_ten_thousand_frames_on_a_thousand_machines_that_fail():
    farm = Farm(1_000, failures=0.05, spread=0.1, frame_spread=0.1)
    found = farm_model.planned(USUAL, 10_000, farm).outcome
    assert (found.done == 1).all()
    assert found.busy > found.lost > 0.0
    assert found.seconds < 1.3 * found.busy / 1_000


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(3.21, "3.2 s"), (99.0, "99 s"), (100.0, "1.7 min"), (7200.0, "2.0 h"), (864_000.0, "10 days")],
)
def test_times_are_said_in_units_that_people_use(seconds, words):
    assert farm_model.duration(seconds) == words
