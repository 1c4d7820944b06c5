"""Render a job of the benchmark with Mitsuba or LuxCore, in their environment: ``peers.py`` runs it."""

from __future__ import annotations

import json
import math
import os
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

from peer_luxcore import import_luxcore, luxcore_picture
from peer_mitsuba import import_mitsuba, mitsuba_picture


def peak_megabytes() -> float:
    """Memory that this process has held at most; NaN where the system does not say.

    Not the one of getrusage, which starts from that of the process this one was forked from.
    """
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
    except FileNotFoundError:
        return math.nan
    return next(float(line.split()[1]) / 1024.0 for line in lines if line.startswith("VmHWM"))


def work(folder: Path) -> None:
    """Render the job in a folder; the picture and figures go there too."""
    job = json.loads((folder / "job.json").read_text())
    draw = mitsuba_picture if job["kind"] == "mitsuba" else luxcore_picture
    picture, seconds = draw(job, np.load(folder / "environment.npy"))
    np.save(folder / "picture.npy", np.ascontiguousarray(picture, np.float32))
    (folder / "result.json").write_text(json.dumps({"seconds": seconds, "megabytes": peak_megabytes()}))


def main(task: str, argument: str) -> None:
    if task == "worker":
        work(Path(argument))
    elif task == "import":
        import_mitsuba("scalar_rgb") if argument == "mitsuba" else import_luxcore()
    elif task == "try":
        mi = import_mitsuba(argument)
        np.array(mi.render(mi.load_dict(mi.cornell_box()), spp=1))
    sys.stdout.flush()
    os._exit(0)  # LuxCore crashes when the interpreter takes itself apart


if __name__ == "__main__":
    main(*sys.argv[1:])
