"""The model of farms in `benchmarks/`, and jobs to try it on."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benchmarks"))

import farm_model

LIGHT = farm_model.Job(once=7.0, frame=3.0, samples=2.0)
"""A preview: processes take longer to start than frames to render."""

USUAL = farm_model.Job(once=7.0, frame=8.0, samples=160.0, merge_once=1.5, merge_part=0.1)

HEAVY = farm_model.Job(once=7.0, frame=40.0, samples=40_000.0, merge_once=4.0, merge_part=1.0)
"""A frame of eleven hours."""
