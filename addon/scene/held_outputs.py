"""What the compositor's File Output nodes write, held back until all of it is whole."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import bpy

from ..model.files import WriteError, replacing_in, require_folder
from .meanwhile import set_meanwhile, set_path_meanwhile
from .output import check_picture
from .passes import file_outputs
from .render_error import RenderError

_OWN_NAME = "{node_name}"
"""What stands for a node's name in its folder. Paths of scenes, which tell what other words stand for, do not know it."""

_PLAIN_NAME = re.compile(r"\w[\w .-]*")
"""Names that folders bear as they are."""


@contextmanager
def file_outputs_held_back(scene: bpy.types.Scene, numbered: bool) -> Iterator[None]:
    """Let what the compositor's File Output nodes write take its place when all of it is whole.

    :param numbered: the files bear the frame's number, as Blender names those of animations.
    """
    with ExitStack() as undo:
        held = []
        for node in file_outputs(scene):
            for owner, name in _unnumbered(node) if numbered else ():
                undo.enter_context(set_meanwhile(owner, **{name: f"{getattr(owner, name)}####"}))
            folder = _folder(scene, node)
            if folder is not None:
                draft = undo.enter_context(replacing_in(folder))
                undo.enter_context(set_path_meanwhile(node, "directory", draft))
                held.append((node, folder, draft))
        yield
        for node, folder, draft in held:
            files = [path for path in draft.rglob("*") if path.is_file()]
            if not files:
                raise WriteError(f"{node.name!r} of the compositor wrote no file to {folder}; look at its File Name")
            for file in files:
                check_picture(file, folder / file.relative_to(draft))


def _unnumbered(node: bpy.types.CompositorNodeOutputFile) -> list[tuple[Any, str]]:
    """Return the owners and names of the properties that name a node's files without a number."""
    if "#" in node.file_name:
        return []
    if node.format.media_type == "MULTI_LAYER_IMAGE":
        return [(node, "file_name")]
    return [(item, "name") for item in node.file_output_items if "#" not in item.name]


def require_output_folders(scene: bpy.types.Scene) -> None:
    """Make sure that files can be written where File Output nodes will.

    :raises RenderError: for a folder that Blender cannot name.
    :raises WriteError: for one that no files can be written to.
    """
    for node in file_outputs(scene):
        folder = _folder(scene, node)
        if folder is not None:
            require_folder(folder)


def _folder(scene: bpy.types.Scene, node: bpy.types.CompositorNodeOutputFile) -> Path | None:
    """Return where a File Output node writes; None where its own name is part of that, which Blender would write otherwise."""
    directory = node.directory
    if _OWN_NAME in directory:
        if "{{" in directory or not _PLAIN_NAME.fullmatch(node.name):
            return None
        directory = directory.replace(_OWN_NAME, node.name)
    with set_meanwhile(scene.render, filepath=f"{directory}/x"):
        try:
            return Path(scene.render.frame_path(frame=scene.frame_current)).parent
        except RuntimeError as error:
            text = " ".join(str(error).split()).removeprefix("Error: ")
            raise RenderError(f"{node.name!r} of the compositor: {text}") from None
