"""What the compositor's File Output nodes write, held back until all of it is whole."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import bpy

from ..model.files import WriteError, replacing_in
from .meanwhile import set_meanwhile, set_path_meanwhile
from .output import check_picture
from .passes import file_outputs
from .render_error import RenderError


@contextmanager
def file_outputs_held_back(scene: bpy.types.Scene) -> Iterator[None]:
    """Let what the compositor's File Output nodes write take its place when all of it is whole."""
    with ExitStack() as undo:
        held = []
        for node in file_outputs(scene):
            folder = output_folder(scene, node)
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


def output_folder(scene: bpy.types.Scene, node: bpy.types.CompositorNodeOutputFile) -> Path | None:
    """Return where a File Output node writes; None where its own name is part of that, which scenes cannot tell."""
    if "{node_name}" in node.directory:
        return None
    with set_meanwhile(scene.render, filepath=f"{node.directory}/x"):
        try:
            return Path(scene.render.frame_path(frame=scene.frame_current)).parent
        except RuntimeError as error:
            text = " ".join(str(error).split()).removeprefix("Error: ")
            raise RenderError(f"{node.name!r} of the compositor: {text}") from None
