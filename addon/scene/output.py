"""Pictures and .blend files as Blender writes them: read back before they take the place of what was there.

Blender says that a file is written which a full disk has cut off.
"""

from __future__ import annotations

import os
import shutil
from itertools import pairwise
from pathlib import Path
from types import ModuleType

import bpy

from ..model.files import WriteError, absolute, replacing
from ..nodes.compatibility import UnsupportedError

_PNG_END = b"IEND\xaeB`\x82"


def picture_files() -> ModuleType:
    """Return OpenImageIO, Blender's own copy of it.

    :raises UnsupportedError: for a Blender that was built without.
    """
    bpy.utils.expose_bundled_modules()
    try:
        import OpenImageIO
    except ImportError:
        raise UnsupportedError(
            "this Blender has no OpenImageIO for Python, which reads pictures back; use the build from blender.org"
        ) from None
    return OpenImageIO


def check_picture(file: Path, path: Path | str, size: tuple[int, int] | None = None, channels: int = 1) -> None:
    """Make sure that a file holds a whole picture.

    :param path: what the file is to be called.
    :param size: the width and height in pixels that it must have.
    :param channels: how many channels it must have at least.
    :raises WriteError: if it does not.
    """
    oiio = picture_files()
    picture = oiio.ImageInput.open(os.fsencode(file))
    if picture is None:
        raise WriteError(f"{path}: was not written whole ({reason(oiio.geterror(), file, path)}); is the disk full?")
    try:
        layer = 0
        while picture.seek_subimage(layer, 0):
            spec = picture.spec()
            pixels = picture.read_image(layer, 0, 0, spec.nchannels, oiio.UNKNOWN)
            if pixels is None or picture.has_error:
                text = reason(picture.geterror(), file, path)
                raise WriteError(f"{path}: was not written whole ({text}); is the disk full?")
            found = spec.width, spec.height
            if size is not None and found != size:
                raise WriteError(f"{path}: was written with {found} pixels instead of {size}")
            if spec.nchannels < channels:
                raise WriteError(f"{path}: was written with {spec.nchannels} channels instead of {channels}")
            layer += 1
    finally:
        picture.close()
    # OpenImageIO does without the last block of a PNG.
    if file.suffix == ".png" and not file.read_bytes().endswith(_PNG_END):
        raise WriteError(f"{path}: was not written whole; is the disk full?")


def save_blend(path: Path | str) -> Path:
    """Save the open file under a path and return where that is; the open file stays what it is.

    What was there is kept beside it as Blender keeps it, as .blend1, in as many versions as the preferences say.

    :raises WriteError: if it cannot be written, or not whole.
    """
    target = absolute(path)
    if os.sep == "/" and "\\" in str(target.parent):
        raise WriteError(f"{target.parent}: has a backslash, which Blender reads as a slash; name another folder")
    with replacing(path) as draft:
        try:
            bpy.ops.wm.save_as_mainfile(filepath=str(draft), copy=True)
            with bpy.data.libraries.load(str(draft)) as (held, _):
                whole = set(held.scenes) == {scene.name for scene in bpy.data.scenes if scene.library is None}
        except (OSError, RuntimeError) as error:
            text = reason(error, draft, path)
            raise WriteError(f"{path}: was not written whole ({text}); is the disk full?") from error
        if not whole:
            raise WriteError(f"{path}: was not written whole; is the disk full?")
        try:
            _keep_versions(target, bpy.context.preferences.filepaths.save_version)
        except OSError as error:
            raise WriteError(f"{path}: its old version cannot be kept ({error.strerror})") from error
    return target


def _keep_versions(target: Path, count: int) -> None:
    """Keep what was there under numbers, the newest as 1; it stays in its place, too."""
    names = [target.with_name(f"{target.name}{number or ''}") for number in range(count + 1)]
    for older, newer in pairwise(reversed(names)):
        if newer == target and os.path.exists(target):
            older.unlink(missing_ok=True)
            try:
                os.link(target, older)
            except OSError:
                shutil.copy2(target, older)
        elif os.path.exists(newer):
            os.replace(newer, older)


def reason(error: object, file: Path, path: Path | str) -> str:
    """Return in one line what Blender or OpenImageIO say of a temporary file, as said of the path that it is for."""
    text = " ".join(str(error).split()).removeprefix("Error: ") or "it cannot be read"
    return text.replace(str(file), Path(path).name).replace(file.name, Path(path).name)
