"""What the stress suite measures is kept, so that each measurement is made once: `benchmarks/stress.py` makes tables of it."""

import json
import os
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[2] / "out" / "stress"


@pytest.fixture
def record(request):
    """Keep what a test measures, by the name of a table and of the row in it, where the whole suite runs."""

    def keep(table: str, row: str, **numbers) -> None:
        if not request.config.getoption("--stress"):
            return
        FOLDER.mkdir(parents=True, exist_ok=True)
        worker = os.environ.get("PYTEST_XDIST_WORKER", "main")
        with (FOLDER / f"{worker}.jsonl").open("a", encoding="utf-8") as file:
            print(json.dumps({"table": table, "row": row, **numbers}), file=file)

    return keep
