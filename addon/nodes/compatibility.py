"""What this Blender can do, in words an artist can act on."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import addon_utils
import bpy

MINIMUM_VERSION = (5, 2, 0)
UNTESTED_VERSION = (5, 4, 0)
"""The first that no test has run on."""

NATIVE_DISPERSION_VERSION = (5, 3, 0)
"""The first whose own nodes split light."""

FRONT_IOR_SIGNS = {
    "render.use_compositor_frames_cache": ("RenderSettings", "use_compositor_frames_cache"),
    "wrap_timeline_navigation": ("Scene", "wrap_timeline_navigation"),
}
"""What came with Blender 5.3, as did Cycles' closures that take an index as met from the front: paths from a scene, with
type and property. A material that is rendered without the extension knows Cycles' way by them.
"""

_TURNED_BY_SHADER = re.compile(r"^\s*backfacing\b", re.MULTILINE)


class UnsupportedError(RuntimeError):
    """This Blender cannot render nested dielectrics. The text says what to use instead."""


def blender_problem(version: tuple[int, int, int] | None = None) -> str | None:
    """Return why this Blender cannot render nested dielectrics, or None if it can.

    ``version`` stands for that of the running Blender unless given.
    """
    version = bpy.app.version if version is None else version
    name = ".".join(map(str, version[:2]))
    if version < MINIMUM_VERSION:
        return (
            f"Blender {name} is too old for nested dielectrics: its shaders cannot read other objects' media; "
            "use Blender 5.2 LTS or 5.3"
        )
    if has_osl() and takes_front_ior() != shows_front_ior():
        return (
            f"Blender {name} takes indices of refraction in a way that files cannot tell, so pictures would be wrong; "
            "use Blender 5.2 LTS or 5.3, or a newer version of the extension"
        )
    return None


def blender_note(version: tuple[int, int, int] | None = None) -> str | None:
    """Return what there is to know of a Blender that can render nested dielectrics, or None."""
    version = bpy.app.version if version is None else version
    if version < UNTESTED_VERSION:
        return None
    return (
        f"Blender {'.'.join(map(str, version[:2]))} is newer than this extension was tested with; its Cycles takes indices "
        "of refraction in a way that the extension knows"
    )


@cache
def takes_front_ior() -> bool | None:
    """Return whether Cycles' closures take an index as it is met from the front, and turn it on back faces themselves.

    Return None if that cannot be found out.

    Cycles' own Glass shader tells: it asks for the side of the face if it has to turn the index.
    """
    for module in addon_utils.modules():
        if module.__name__ == "cycles":
            glass = Path(module.__file__).with_name("shader") / "node_glass_bsdf.oso"
            if glass.is_file():
                return not _TURNED_BY_SHADER.search(glass.read_text(encoding="utf-8"))
    return None


def shows_front_ior() -> bool:
    """Return whether a material that is rendered by this Blender finds that closures take an index as met from the front."""
    return any(name in getattr(bpy.types, owner).bl_rna.properties for owner, name in FRONT_IOR_SIGNS.values())


def has_osl() -> bool:
    """Return whether this Blender's Cycles runs Open Shading Language."""
    return bool(bpy.app.build_options.cycles_osl)


def require_blender() -> None:
    """Raise :class:`UnsupportedError` if this Blender cannot render nested dielectrics."""
    problem = blender_problem()
    if problem:
        raise UnsupportedError(problem)
