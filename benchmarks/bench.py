"""Time, error and memory of nested media against hand-split Glass and others; `README.md` here says what is compared.

Run as ``.venv/bin/python benchmarks/bench.py [--quick] [--scene NAME ...] [--rounds N]``. A full run writes
``results/SCENE.json`` and ``results/SCENE.png`` and renews the tables in ``README.md``; a quick one writes its JSON and
plots to ``out/bench`` and prints the tables. Runs end in time whatever else the machine does: where time is short there
are fewer rounds and samples.
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import asdict
from pathlib import Path

from bench_measure import HERE, OUT, Plan, measure
from bench_report import plot, renew, tables
from bench_scenes import SCENES

RESULTS = HERE / "results"

PICTURE = """Error against time in iced water; dotted, the floor. The other scenes stand beside it in `results/`.

![Error against time in iced water](results/iced_water.png)"""
"""Of the page, below its tables."""

FULL = Plan(1620.0, 128, 16, 256, 2, 8, 1.0, 9, 4, peers=True)
QUICK = Plan(130.0, 64, 8, 16, 8, 4, 0.2, 3, 1, peers=False)


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
