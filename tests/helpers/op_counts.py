"""Render the cases of ``test_op_counts.py`` under ``OSL_OPTIONS=debug=1``, which prints what is left of shaders.

A line stands before each.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import bpy
from scenes import add_camera, add_sphere, new_scene, render, set_world

import nested_dielectric as nd

MARK = "CASE "


def build(crosses: bool) -> bpy.types.Scene:
    """Build a ball of glass, and with ``crosses`` a ball of water that reaches out of it."""
    scene = new_scene(32)
    set_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=28)
    add_sphere("Glass", 1.0, nd.new_material("Glass", ior=1.5), 2)
    if crosses:
        add_sphere("Water", 0.7, nd.new_material("Water", ior=1.33), 1, (0.5, -0.2, 0.1))
    nd.prepare(scene, cut=False, backend="OSL")
    return scene


def build_asking() -> None:
    """Build two media that cross and are told nothing."""
    nd.clear_analysis(build(crosses=True))


CASES: dict[str, Callable[[], object]] = {
    "alone": lambda: build(crosses=False),
    "told": lambda: build(crosses=True),
    "asking": build_asking,
}


def print_line(text: str) -> None:
    """Print after all that C++ has printed so far."""
    ctypes.CDLL(None).fflush(None)
    os.write(1, f"{text}\n".encode())


if __name__ == "__main__":
    for name, builder in CASES.items():
        builder()
        print_line(MARK + name)
        render(1)
