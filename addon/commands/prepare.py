"""``prepare`` and ``update``: a file, saved with what it needs."""

from __future__ import annotations

import argparse

import bpy

from ..checking.listing import in_lines, is_refused
from ..model.files import require_place
from ..preparation.live import bake_cut
from ..preparation.prepare_scene import prepare
from ..preparation.versions import update_materials
from ..scene.output import save_blend
from .shared import FOUND, AddParser, add_backend, add_check, add_file, add_saved, open_file


def add_prepare(add_parser: AddParser) -> None:
    preparation = add_parser("prepare", help="set what a .blend needs, list problems, and save it")
    add_file(preparation)
    add_saved(preparation)
    preparation.add_argument(
        "--cut",
        action=argparse.BooleanOptionalAction,
        help="let renders of the file show surfaces cut where media cross, that of its frame kept in the file for farms; or "
        "not (default: as the file has it)",
    )
    add_backend(preparation)
    add_check(preparation)
    preparation.set_defaults(run=_prepare)


def _prepare(options: argparse.Namespace) -> int:
    """Prepare a file and save it; or with ``--check`` say what is wrong with it.

    :returns: 0, or :data:`FOUND` where nothing was saved because of that.
    """
    scene = open_file(options.file)
    output = options.output or bpy.data.filepath
    require_place(output)
    preparation = prepare(scene, options.cut, options.backend)
    if is_refused(preparation.findings, options.check):
        print("\n".join(in_lines(scene.name, preparation.findings)))
        print("nothing was written")
        return FOUND
    print(preparation)
    if options.cut:
        hindrance = bake_cut(scene)
        print(
            f"each frame is cut as it is rendered: {hindrance}"
            if hindrance
            else f"the cut of frame {scene.frame_current} is in the file"
        )
    print(f"wrote {save_blend(output)}")
    return 0


def add_update(add_parser: AddParser) -> None:
    update = add_parser("update", help="bring a .blend's materials to this version of the extension, and save it")
    add_file(update)
    add_saved(update)
    update.set_defaults(run=_update)


def _update(options: argparse.Namespace) -> None:
    """Bring a file's materials to this version and save it."""
    open_file(options.file)
    changes = update_materials()
    print("\n".join(changes) or "nothing to change")
    if changes or options.output:
        print(f"wrote {save_blend(options.output or bpy.data.filepath)}")
