"""Packing a file for machines that take one .blend and nothing else."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy

from ..analysis.validity import leave_scene_to_shader
from ..checking.finding import Finding, to_json
from ..checking.listing import in_lines, is_refused
from ..checking.version_checks import version_problems
from ..cutting.cut_scene import is_cut
from ..model.files import WriteError, absolute, require_place
from ..preparation import upkeep
from ..preparation.live import bake_cut
from ..preparation.prepare_scene import Preparation, prepare
from ..preparation.versions import update_materials
from ..scene.media import media
from ..scene.output import save_blend
from .needs import SceneNeeds, file_notes, needs_of, shader_needs
from .outside import Lack, find_lacks
from .whole_file import make_local, pack_files


@dataclass(frozen=True)
class Packed:
    """What :func:`pack` did.

    :param saved: the file that was written; None where it was refused.
    :param done: what was done to the file, in sentences.
    :param lacks: what the file needs and does not hold; findings: what is wrong with its media, by scenes.
    :param needs: what machines must have, scene by scene; notes: what else there is to know, in sentences.
    """

    saved: Path | None
    done: tuple[str, ...] = ()
    lacks: tuple[Lack, ...] = ()
    findings: dict[str, tuple[Finding, ...]] | None = None
    needs: tuple[SceneNeeds, ...] = ()
    notes: tuple[str, ...] = ()

    def as_json(self) -> dict[str, Any]:
        """Return it in JSON's types."""
        return {
            "saved": None if self.saved is None else str(self.saved),
            "done": list(self.done),
            "lacks": [vars(lack) for lack in self.lacks],
            "findings": {name: list(map(to_json, found)) for name, found in (self.findings or {}).items()},
            "needs": [each.as_json() for each in self.needs],
            "notes": list(self.notes),
        }

    def __str__(self) -> str:
        lines = [f"done: {each}" for each in self.done]
        lines += [f"lacks: {lack}" for lack in self.lacks]
        for name, found in (self.findings or {}).items():
            lines += in_lines(name, found)
        lines += [f"needs: {line}" for each in self.needs for line in str(each).splitlines()]
        lines += [f"needs: {note}" for note in self.notes]
        return "\n".join([*lines, f"wrote {self.saved}" if self.saved else "nothing was written"])


def pack(
    output: Path | str,
    cut: bool = True,
    backend: str | None = None,
    check: str | None = None,
    keep_outside: bool = False,
    relative: bool = True,
) -> Packed:
    """Save the open file so that it needs no other: for machines without the extension that take one .blend.

    What is linked becomes the file's own, pictures and other files are packed, materials brought to this version, all
    scenes with media prepared, and the cut of each one's present frame kept. Machines that do not run Open Shading
    Language, where only that is right, show the alarm. The file that was opened stays; the session holds what was packed.

    :param output: the .blend to write.
    :param cut: render surfaces cut where media cross.
    :param backend: what renders the media, as for :func:`~nested_dielectric.preparation.prepare_scene.prepare`.
    :param check: refuse what a check finds wrong: ``"wrong"``, or ``"strict"`` for what is slow, too.
    :param keep_outside: save the file though it lacks something.
    :param relative: let paths of what it lacks begin at the file, which goes along with it; else at the root.
    :raises WriteError: if the output is the file itself, or cannot be written.
    """
    if absolute(output) == absolute(bpy.data.filepath):
        raise WriteError(f"{output}: is the file itself, which stays as it is; name another")
    require_place(output)
    done = make_local() + pack_files()
    lacks = tuple(find_lacks())
    if lacks and not keep_outside:
        return Packed(None, tuple(done), lacks)
    done += update_materials()
    newer = tuple(version_problems())
    if newer:
        return Packed(None, tuple(done), lacks, {bpy.context.scene.name: newer})
    scenes = [scene for scene in bpy.data.scenes if media(scene)]
    preparations = {scene: prepare(scene, cut, backend) for scene in scenes}
    done += [f"{scene.name}: {each}" for scene, result in preparations.items() for each in _done(scene, result)]
    findings = {scene.name: result.findings for scene, result in preparations.items()}
    needs, notes = tuple(map(needs_of, bpy.data.scenes)), tuple(file_notes())
    saved = None
    if not any(is_refused(found, check) for found in findings.values()):
        if lacks:
            (bpy.ops.file.make_paths_relative if relative else bpy.ops.file.make_paths_absolute)()
        with _told_for_machines(scenes):
            saved = save_blend(output)
    return Packed(saved, tuple(done), lacks, findings, needs, notes)


def _done(scene: bpy.types.Scene, preparation: Preparation) -> Iterator[str]:
    """Keep the cut of a scene's frame, and yield what was done of it, in sentences."""
    yield from preparation.changes
    yield from str(preparation.chosen).splitlines()
    yield from str(preparation.cut).splitlines()
    if is_cut(scene) and preparation.cut.media:
        hindrance = bake_cut(scene)
        frame = f"the cut of frame {scene.frame_current} is in the file"
        yield f"each frame is cut as it is rendered: {hindrance}" if hindrance else frame


@contextmanager
def _told_for_machines(scenes: Sequence[bpy.types.Scene]) -> Iterator[None]:
    """Let what is saved meanwhile be rendered where nobody looks, whatever device that is.

    Where only the shader is right, Cycles' own nodes show the alarm. Where it is not needed at all, they render all media:
    a device that runs the shader without letting it trace rays would show the alarm in specks.
    """

    def tell(*_: object) -> None:
        left = [scene for scene in scenes if shader_needs(scene)]
        for scene in left:
            leave_scene_to_shader(scene)
        if not left and len(scenes) == 1:  # scenes may share materials, and need them otherwise
            upkeep.choose_bodies(scenes[0])

    bpy.app.handlers.save_pre.append(tell)  # after the extension's own
    try:
        yield
    finally:
        bpy.app.handlers.save_pre.remove(tell)
