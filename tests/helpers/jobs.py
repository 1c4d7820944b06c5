"""Jobs of the Open Job Description, run by ``openjd`` with the bpy wheel in the place of a Blender application."""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

STUB = Path(__file__).with_name("blender_of_wheel.py")
OPENJD = (sys.executable, "-m", "openjd")


def openjd(*arguments: object) -> subprocess.CompletedProcess:
    """Run openjd and return what it did."""
    return subprocess.run([*OPENJD, *map(str, arguments)], capture_output=True, text=True, check=False)


def blender(folder: Path) -> Path:
    """Write a program that stands for Blender: a file for each of its processes, by number, is in a folder beside it."""
    (folder / "running").mkdir(exist_ok=True)
    program = folder / "blender"
    words = (sys.executable, STUB)
    program.write_text(
        f"#!/bin/sh\nunset PYTHONPATH\ntouch {shlex.quote(str(folder / 'running'))}/$$\n"
        f'exec {shlex.join(map(str, words))} "$@"\n'
    )
    program.chmod(0o755)
    return program


class Job:
    """A job in a folder, where its pictures go, and what else of its parameters is changed."""

    def __init__(self, folder: Path, output: Path, **parameters: str) -> None:
        self.template = folder / "template.json"
        self.output = output
        self.parameters = parameters
        output.parent.mkdir(parents=True, exist_ok=True)
        self.blender = blender(output.parent)

    def _arguments(self, *arguments: object) -> list[str]:
        parameters = {"Blender": str(self.blender), "OutputDir": str(self.output), **self.parameters}
        return [*OPENJD, "run", str(self.template), "-p", json.dumps(parameters), *map(str, arguments)]

    def run(self, step: str) -> subprocess.CompletedProcess:
        """Run a step and all before it."""
        command = self._arguments("--step", step, "--run-dependencies")
        return subprocess.run(command, capture_output=True, text=True, check=False)

    def start(self, step: str, *tasks: dict[str, str]) -> subprocess.Popen:
        """Start a worker with some tasks of a step."""
        command = self._arguments("--step", step, "--no-run-dependencies", "--tasks", json.dumps(tasks))
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def running(self) -> list[int]:
        """Return the processes that were started in the place of Blender."""
        return sorted(int(name) for name in os.listdir(self.blender.parent / "running"))
