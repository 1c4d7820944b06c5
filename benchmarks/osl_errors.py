"""How far the shader's functions are from the same in double precision, over all their inputs.

Run as ``.venv/bin/python benchmarks/osl_errors.py``; it renews its table in ``README.md``. The functions, their inputs and
references are those of ``tests/render/test_osl_values.py``. It takes half a minute.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "helpers"))

import bpy  # noqa: F401  before what lives inside it
from bench_report import markdown, renew
from osl_functions import FUNCTIONS
from osl_measure import ROUNDING, SQUARE, Function, measured


def row(function: Function) -> list[str]:
    """Measure a function; its line of the table."""
    errors = measured(function)
    name = f"`{function.name}`" + (f", {function.domain}" if function.domain else "")
    together = f" with {', '.join(f'`{other}`' for other in function.covers)}" if function.covers else ""
    return [
        f"{name}{together}",
        f"`{function.header}`",
        f"{errors.relative:.1e}" if errors.relative else "0",
        f"{errors.roundings:.2g}" if errors.roundings < 1e3 else "",
        function.because,
    ]


def table() -> str:
    """Measure all functions."""
    header = ["function", "file", "worst relative error", "in roundings", "what errs"]
    numbers = markdown(header, [row(function) for function in FUNCTIONS])
    return numbers.replace("| --- | ---: | ---: | ---: | ---: |", "| --- | --- | ---: | ---: | --- |")


if __name__ == "__main__":
    renew("osl", f"{SQUARE * SQUARE:,} inputs each; one rounding is {ROUNDING:.1e}.\n\n{table()}")
