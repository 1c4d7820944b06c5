"""What OSL leaves of the shader where much of it is constant: operations that are run for every surface that a ray meets."""

import os
import re
import subprocess
import sys
from pathlib import Path

import bpy
import pytest

HELPER = Path(__file__).parents[1] / "helpers" / "op_counts.py"

SHADER = re.compile(r"^After optimizing layer [^\n]*\nShader nested_dielectric\n(.*?)^-{8}", re.MULTILINE | re.DOTALL)
OPERATION = re.compile(r"^ +\d+: (\w+)", re.MULTILINE)

MARKS = {"nop", "end", "functioncall", "functioncall_nr", "useparam"}
"""Operations that stand for nothing that is computed."""

MOST = (
    {"alone": 808, "told": 1658, "asking": 1798}
    if bpy.app.version >= (5, 3, 0)
    else {"alone": 803, "told": 1315, "asking": 1455}
)
"""Operations of one material. Before Blender 5.3 closures split no light, so no curve is read."""


@pytest.fixture(scope="module")
def counts() -> dict[str, list[int]]:
    done = subprocess.run(
        [sys.executable, str(HELPER)],
        env=os.environ | {"OSL_OPTIONS": "debug=1"},
        capture_output=True,
        text=True,
        errors="replace",
        check=True,
    )
    cases = re.split(r"^CASE (\w+)\n", done.stdout, flags=re.MULTILINE)[1:]
    return {
        case: [sum(name not in MARKS for name in OPERATION.findall(code)) for code in SHADER.findall(output)]
        for case, output in zip(cases[::2], cases[1::2])
    }


@pytest.mark.parametrize("case, materials", [("alone", 1), ("told", 2), ("asking", 2)])
def test_a_surface_costs_no_more_operations_than_it_did(counts, case, materials):
    assert len(counts[case]) == materials
    assert min(counts[case]) > 0
    assert max(counts[case]) <= MOST[case], counts
