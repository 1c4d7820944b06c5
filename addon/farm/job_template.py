"""What a job of the Open Job Description says: its parameters, and its steps as commands of the command line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..checking.listing import STRICT, WRONG

SPECIFICATION = "jobtemplate-2023-09"
CHUNKING = "TASK_CHUNKING"
"""The extension of the specification by which services put several frames into a task."""

SCENE, PROGRAM, TASK = "scene.blend", "program", "task.py"
"""What lies beside the template; the last in the second."""

PARTS = "parts"
"""The folder, beside the pictures, of parts that are to be merged."""

NO_CHECK = "none"
CHECKS = (WRONG, STRICT, NO_CHECK)

_LONGEST_NAME, _LONGEST_VALUE = 128, 1024
"""Of a job, and of a parameter, in characters."""


class JobError(RuntimeError):
    """A job that the Open Job Description cannot say."""


@dataclass(frozen=True)
class Job:
    """A job.

    :param scene: what is rendered, which alone is checked; its file opens with it.
    :param frames: a list as the command line takes it; output: the name of the pictures, with ``#`` for the frame.
    :param chunk: frames a task.
    :param ranges: of the samples, each a task of its own; none for whole frames.
    :param denoised: whether what is merged of the ranges is denoised.
    :param check: one of :data:`CHECKS`; options: more of those that ``render`` has.
    """

    name: str
    frames: str
    output: str
    chunk: int
    ranges: tuple[range, ...] = ()
    denoised: bool = False
    check: str = WRONG
    options: tuple[str, ...] = ()
    scene: str = "Scene"


def template(job: Job) -> dict[str, Any]:
    """Return a job's template.

    :raises JobError: for what the specification cannot hold.
    """
    _require_sayable(job)
    steps = [_check(job)] if job.check != NO_CHECK else []
    steps += [_render_ranges(job), _merge(job)] if job.ranges else [_render_frames(job)]
    for step, earlier in zip(steps[1:], steps):
        step["dependencies"] = [{"dependsOn": earlier["name"]}]
    return {
        "specificationVersion": SPECIFICATION,
        **({} if job.ranges else {"extensions": [CHUNKING]}),
        "name": _plain(job.name),
        "parameterDefinitions": _parameters(job),
        "steps": steps,
    }


def parameter_values(job: Job) -> dict[str, Any]:
    """Return the values of a job's parameters but for its files, which lie beside the template, as bundles hold them."""
    values = [{"name": each["name"], "value": each["default"]} for each in _parameters(job) if each["type"] != "PATH"]
    return {"parameterValues": values}


def _require_sayable(job: Job) -> None:
    for text in (job.frames, job.output):
        if len(text) > _LONGEST_VALUE:
            raise JobError(
                f"{text[:40]}...: is longer than {_LONGEST_VALUE} characters; name ranges, or make several jobs"
            )
    for text in (job.output, *job.options):
        if any("\ud800" <= letter <= "\udfff" for letter in text):  # bytes of a path that are no text
            raise JobError(f"{text!r}: is no text that jobs can hold; name the pictures with --output")
    for text in (*job.options, *([] if job.check == NO_CHECK else [job.scene])):
        if "{{" in text or "}}" in text:
            raise JobError(f"{text!r}: has two braces in its name, by which jobs name parameters; rename it")


def _plain(name: str) -> str:
    """Return a name as jobs may have it."""
    text = "".join(letter if letter.isprintable() else " " for letter in name)
    text = text.replace("{{", "{ {").replace("}}", "} }")
    return text[:_LONGEST_NAME]


def _parameters(job: Job) -> list[dict[str, Any]]:
    """Return the definitions of a job's parameters."""
    found: list[dict[str, Any]] = [
        _parameter("Frames", "STRING", job.frames, "Frames to render, such as 1-100,120,200-240:2"),
        _parameter("OutputName", "STRING", job.output, "Name of the pictures; #### stands for the frame"),
        _parameter("OutputDir", "PATH", "output", "Folder of the pictures", objectType="DIRECTORY", dataFlow="OUT"),
        _parameter("SceneFile", "PATH", SCENE, "What is rendered", objectType="FILE", dataFlow="IN"),
        _parameter("Program", "PATH", PROGRAM, "Nested Dielectric", objectType="DIRECTORY", dataFlow="IN"),
        _parameter("Blender", "STRING", "blender", "How workers call Blender"),
    ]
    if job.ranges:
        text = "What becomes of the parts of a frame that is merged"
        found.append(_parameter("Parts", "STRING", "remove", text, allowedValues=["remove", "keep"]))
    else:
        found.append(_parameter("ChunkSize", "INT", job.chunk, "Frames a task", minValue=1))
    return found


def _parameter(name: str, kind: str, default: str | int, description: str, **more: Any) -> dict[str, Any]:
    return {"name": name, "type": kind, **more, "default": default, "description": description}


def _check(job: Job) -> dict[str, Any]:
    return {
        "name": "Check",
        "script": _run("check", f"--scene={job.scene}", *(["--strict"] if job.check == STRICT else [])),
    }


def _render_frames(job: Job) -> dict[str, Any]:
    chunks = {"defaultTaskCount": "{{Param.ChunkSize}}", "rangeConstraint": "NONCONTIGUOUS"}
    frames = {"name": "Frames", "type": "CHUNK[INT]", "range": "{{Param.Frames}}", "chunks": chunks}
    return {
        "name": "Render",
        "parameterSpace": {"taskParameterDefinitions": [frames]},
        "script": _run(*_rendering(job), "-o", _path(), "--frames={{Task.Param.Frames}}"),
    }


def _render_ranges(job: Job) -> dict[str, Any]:
    samples = {"name": "Samples", "type": "STRING", "range": [f"{each.start}:{each.stop}" for each in job.ranges]}
    names = [{"name": "Folder", "type": "STRING", "range": [_folder(each) for each in job.ranges]}]
    return {
        "name": "Render",
        "parameterSpace": {
            "taskParameterDefinitions": [_frame(), samples, *names],
            "combination": "Frame * (Samples, Folder)",
        },
        "script": _run(
            *_rendering(job),
            *("-o", _path(PARTS, "{{Task.Param.Folder}}")),
            "--frames={{Task.Param.Frame}}",
            *("--samples", "{{Task.Param.Samples}}"),
        ),
    }


def _merge(job: Job) -> dict[str, Any]:
    denoising = ["--denoise", "{{Param.SceneFile}}"] if job.denoised else []
    return {
        "name": "Merge",
        "parameterSpace": {"taskParameterDefinitions": [_frame()]},
        "script": _run(
            "merge",
            *(_path(PARTS, _folder(each)) for each in job.ranges),
            *("-o", _path()),
            "--frames={{Task.Param.Frame}}",
            "--skip-existing",
            *("--parts", "{{Param.Parts}}"),
            *denoising,
        ),
    }


def _frame() -> dict[str, Any]:
    return {"name": "Frame", "type": "INT", "range": "{{Param.Frames}}"}


def _folder(samples: range) -> str:
    """Return the name of the folder of a range's parts."""
    return f"{samples.start}-{samples.stop}"


def _path(*folders: str) -> str:
    """Return the path of the pictures, or of those in a folder beside them."""
    return "/".join(("{{Param.OutputDir}}", *folders, "{{Param.OutputName}}"))


def _rendering(job: Job) -> list[str]:
    return ["render", "--skip-existing", *job.options]


def _run(*command: str) -> dict[str, Any]:
    """Return what runs a command on the scene in a Blender as it comes, whatever a worker's own preferences are."""
    before = ["--factory-startup", "-b", "{{Param.SceneFile}}", "--python-exit-code", "1"]
    arguments = [*before, "--python", f"{{{{Param.Program}}}}/{TASK}", "--", *command]
    # Asked to end, a render removes what it has not finished.
    ending = {"mode": "NOTIFY_THEN_TERMINATE", "notifyPeriodInSeconds": 10}
    return {"actions": {"onRun": {"command": "{{Param.Blender}}", "args": arguments, "cancelation": ending}}}
