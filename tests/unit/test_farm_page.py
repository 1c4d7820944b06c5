"""What the manual says of farms follows from what was measured."""

import re
import shlex
import subprocess
import sys

import farm_plans
import farm_report
import pytest
from pytest import approx


@pytest.fixture(scope="module")
def measured():
    return farm_report.load()


@pytest.mark.parametrize("name", farm_report.CONTENTS)
def test_the_tables_of_the_page_are_of_the_numbers_that_were_measured(name, measured):
    page = farm_report.PAGE.read_text(encoding="utf-8")
    assert farm_report.renewed(page, name, farm_report.CONTENTS[name](measured)) == page, (
        "run benchmarks/farm_report.py"
    )


def test_a_job_adds_up_what_was_measured():
    steps = {"start": [1.0, 0.0], "load": [0.25, 0.0], "prepare": [2.0, 0.0]}
    parts = {
        "evaluate": [1.0, 0.0],
        "export": [0.5, 0.0],
        "shaders": [0.25, 0.0],
        "bvh": [0.125, 0.0],
        "finish": [0.0, 0.0],
    }
    frames = [
        {**parts, "shaders": [1.25, 0.0], "sample": [1.5, 0.0]},
        {**parts, "sample": [4.5, 0.0]},
    ]  # 0.5 + 0.125 each
    result = {
        "resolution": 100,
        "samples": [8, 32],
        "scenes": {"ball": {"title": "a ball", "ways": {"osl": [{"steps": steps, "frames": frames}]}}},
        "write_per_megapixel": 0.5,
        "merge_per_megapixel": 0.25,
        "merge_part_per_megapixel": 0.125,
    }
    job = farm_report.job_of(result, "ball", "osl", cores=4)
    pixels = 1920 * 1080
    assert job.once == approx(3.25 + 1.0)
    assert job.frame == approx(1.875 + 0.5 + 0.5 * pixels / 1e6)
    assert job.samples == approx(0.125 / 100**2 * pixels * 256 / 4)
    assert job.merge_once == approx(1.0 + 0.25 * pixels / 1e6)
    assert job.merge_part == approx(0.125 * pixels / 1e6)
    larger = farm_report.job_of(result, "ball", "osl", cores=4, larger=16)
    assert larger.samples == approx(256 * job.samples)
    assert larger.once == job.once


def test_the_command_of_the_page_says_how_long_it_takes_and_what_it_costs():
    (command,) = re.findall(
        r"^python (benchmarks/farm_model.py .*)$", farm_report.PAGE.read_text(encoding="utf-8"), re.M
    )
    root = farm_report.PAGE.parents[1]
    done = subprocess.run([sys.executable, *shlex.split(command)], cwd=root, capture_output=True, text=True, check=True)
    split, failures = done.stdout.splitlines()
    assert re.fullmatch(r"\d+ frames a task: \d+ min, [\d.]+ machine hours, price [\d.]+", split)
    assert re.fullmatch(r"\d+ failures, [\d.]+ machine hours lost", failures)


@pytest.mark.parametrize("wrong", ["--frames 0", "--machines 0", "--once -1", "--failures -0.1"])
def test_numbers_that_no_farm_has_are_refused(wrong, capsys, monkeypatch):
    given = "--frames 1 --machines 1 --once 1 --frame 1 --samples 1"
    monkeypatch.setattr(sys, "argv", ["farm_model.py", *given.split(), *wrong.split()])
    with pytest.raises(SystemExit) as stop:
        farm_plans.farm_model.main()
    assert stop.value.code == 2
    assert "are 1 at least" in capsys.readouterr().err
