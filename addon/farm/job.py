"""Jobs of the Open Job Description: a folder with a template, its parameters and all that a machine with Blender needs."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import bpy

from ..model.files import new_folder
from ..model.folders import ROOT
from ..scene.devices import GPU
from .job_template import PROGRAM, SCENE, TASK, Job, JobError, parameter_values, template
from .packing import Packed, pack

_TASK = '''"""Run a command of Nested Dielectric in Blender: blender -b FILE.blend --python task.py -- COMMAND ..."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from nested_dielectric.cli import main

arguments = sys.argv[sys.argv.index("--") + 1 :]
if "-o" in arguments:
    name = arguments[arguments.index("-o") + 1].rsplit("/", 1)[-1]
    if "#" not in name:
        print(f"OutputName {name}: all frames would go to one file; put #### in it", file=sys.stderr)
        sys.exit(1)
sys.exit(main(arguments))
'''
"""Blender ends with the code that scripts exit with."""


class NotPacked(Exception):
    """A file that lacks something, which the report says."""

    def __init__(self, report: Packed) -> None:
        super().__init__(str(report))
        self.report = report


def write_job(folder: Path, job: Job, cut: bool, backend: str | None, keep_outside: bool) -> Packed:
    """Write a job that renders the open file, and return what packing that has to report.

    :param folder: a new one, or an empty one. It is there whole, or not at all.
    :param cut, backend, keep_outside: as for :func:`~nested_dielectric.farm.packing.pack`.
    :raises NotPacked: if the file cannot be packed.
    :raises JobError: for a device that does not show what is meant.
    :raises WriteError: if the folder cannot be written.
    """
    with new_folder(folder) as draft:
        packed = pack(draft / SCENE, cut, backend, keep_outside=keep_outside, relative=False)
        if packed.saved is None:
            raise NotPacked(packed)
        job = replace(job, scene=bpy.context.scene.name)  # as it is called in the packed file
        _require_device(job, packed)
        _copy_program(draft / PROGRAM)
        for name, content in (("template", template(job)), ("parameter_values", parameter_values(job))):
            text = json.dumps(content, indent=2, ensure_ascii=False)
            (draft / f"{name}.json").write_text(f"{text}\n", encoding="utf-8")
    return replace(packed, saved=folder / SCENE)


def _require_device(job: Job, packed: Packed) -> None:
    """Refuse a GPU for a scene of which it would show the alarm."""
    reasons = [reason for needs in packed.needs if needs.scene == job.scene for reason in needs.osl]
    if reasons and f"--device={GPU}" in job.options:
        raise JobError(
            f"scene {job.scene!r}: needs Open Shading Language on the CPU ({reasons[0]}); leave out --device gpu, or choose "
            "--backend native"
        )


def _copy_program(folder: Path) -> None:
    """Copy what the command line needs, as it is laid out where the extension is installed, and the script that runs it."""
    without = shutil.ignore_patterns("__pycache__")
    shutil.copytree(Path(__file__).resolve().parents[1], folder / "nested_dielectric", ignore=without)
    shutil.copytree(ROOT / "osl", folder / "osl", ignore=without)
    (folder / "presets").mkdir()
    for file in (ROOT / "presets").glob("*.toml"):
        shutil.copyfile(file, folder / "presets" / file.name)
    for name in ("blender_manifest.toml", "LICENSE"):
        shutil.copyfile(ROOT / name, folder / name)
    (folder / TASK).write_text(_TASK, encoding="utf-8")
