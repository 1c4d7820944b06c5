"""Run a Blender application beside the bpy wheel: renders of files, and pictures of its window.

``python tests/helpers/real_blender.py render FILE.blend PICTURE.exr`` and the same with ``window FILE.blend FOLDER``.

ND_BLENDER holds the command that runs the application, such as ``/opt/blender/blender``; ND_BLENDER_WINDOW one that gives it a
screen, such as ``xvfb-run -a /opt/blender/blender``, the former one unless set. An application that sees the project's folder
elsewhere, in a container, has that place in ND_BLENDER_PROJECT. Whatever is exchanged with it lies in the folder ``out``.
"""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
EXCHANGE = PROJECT / "out" / "real"
PACKAGE = EXCHANGE / "package"
SHADINGS = ("SOLID", "MATERIAL", "RENDERED")
SECONDS = 600
"""Until an application is taken for hung up."""

COMMAND = shlex.split(os.environ.get("ND_BLENDER", ""))
WINDOW_COMMAND = shlex.split(os.environ.get("ND_BLENDER_WINDOW", "")) or COMMAND


def place(path: Path) -> str:
    """Return where the application sees a file of the project."""
    root = Path(os.environ.get("ND_BLENDER_PROJECT") or PROJECT)
    return str(root / path.resolve().relative_to(PROJECT))


def version() -> tuple[int, int]:
    """Return the application's version."""
    words = _run(COMMAND, "--version").split()
    major, minor, *_ = words[words.index("Blender") + 1].split(".")
    return int(major), int(minor)


def render(file: Path, picture: Path) -> None:
    """Render a file of the project's, as a farm does: without the extension."""
    frames = picture.with_name(f"{picture.stem}_####.exr")
    _run(COMMAND, "-b", "--factory-startup", place(file), "--render-output", place(frames), "--render-frame", "1")
    frames.with_name(f"{picture.stem}_0001.exr").replace(picture)


def photograph(file: Path, folder: Path) -> dict[str, Path]:
    """Save pictures of the window in which a file is open and the extension on, by the kind of shading of its viewport."""
    _link_package()
    folder.mkdir(parents=True, exist_ok=True)
    pictures = {shading: folder / f"{shading.lower()}.png" for shading in SHADINGS}
    for picture in pictures.values():
        picture.unlink(missing_ok=True)
    script = place(Path(__file__).with_name("real_window.py"))
    output = _run(
        WINDOW_COMMAND, "--factory-startup", "--window-geometry", "0", "0", "1000", "700", place(file), "--python", script,
        "--", place(PACKAGE), place(folder), *SHADINGS,
    )  # fmt: skip
    missing = [picture.name for picture in pictures.values() if not picture.is_file()]
    if missing:
        raise RuntimeError(f"no {', '.join(missing)}:\n{output[-3000:]}")
    return pictures


def _link_package() -> None:
    """Lay the extension out as a package of its name, by links that hold wherever the project is seen."""
    PACKAGE.mkdir(parents=True, exist_ok=True)
    up = Path(os.path.relpath(PROJECT, PACKAGE))
    links = {
        "nested_dielectric": "addon",
        "osl": "osl",
        "presets": "presets",
        "blender_manifest.toml": "blender_manifest.toml",
    }
    for name, target in links.items():
        link = PACKAGE / name
        link.unlink(missing_ok=True)
        link.symlink_to(up / target)


def _run(command: list[str], *arguments: str) -> str:
    if not command:
        raise RuntimeError("ND_BLENDER names no Blender application")
    done = subprocess.run(
        [*command, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        timeout=SECONDS,
    )
    if done.returncode:
        raise RuntimeError(f"{command[0]} failed:\n{done.stdout[-3000:]}")
    return done.stdout


if __name__ == "__main__":
    what, source, result = sys.argv[1:]
    {"render": render, "window": photograph}[what](Path(source), Path(result))
