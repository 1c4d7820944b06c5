"""What this Blender and this scene's render settings can do, in words an artist can act on."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import addon_utils
import bpy

MINIMUM_VERSION = (5, 2, 0)
UNTESTED_VERSION = (5, 4, 0)
"""The first that no test has run on."""

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


def blender_problem(version: tuple[int, int, int] | None = None, with_osl: bool | None = None) -> str | None:
    """Return why this Blender cannot render nested dielectrics, or None if it can.

    ``version`` and ``with_osl`` stand for those of the running Blender unless given.
    """
    version = bpy.app.version if version is None else version
    with_osl = bpy.app.build_options.cycles_osl if with_osl is None else with_osl
    name = ".".join(map(str, version[:2]))
    if version < MINIMUM_VERSION:
        return (
            f"Blender {name} is too old for nested dielectrics: its shaders cannot read other objects' media; "
            "use Blender 5.2 LTS or 5.3"
        )
    if not with_osl:
        return "this Blender was built without Open Shading Language; use the build from blender.org or the bpy wheel"
    if takes_front_ior() != shows_front_ior():
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
    """Tell whether Cycles' closures take an index as it is met from the front, and turn it on back faces themselves; None
    if that cannot be found out.

    Cycles' own Glass shader tells: it asks for the side of the face if it has to turn the index.
    """
    for module in addon_utils.modules():
        if module.__name__ == "cycles":
            glass = Path(module.__file__).with_name("shader") / "node_glass_bsdf.oso"
            if glass.is_file():
                return not _TURNED_BY_SHADER.search(glass.read_text(encoding="utf-8"))
    return None


def shows_front_ior() -> bool:
    """Tell whether a material that is rendered by this Blender finds that closures take an index as met from the front."""
    return any(name in getattr(bpy.types, owner).bl_rna.properties for owner, name in FRONT_IOR_SIGNS.values())


def engine_name(engine: str) -> str:
    """Return the name that an artist knows a render engine by."""
    known = bpy.types.RenderSettings.bl_rna.properties["engine"].enum_items.get(engine)
    if known is not None:
        return known.name
    engines = bpy.types.RenderEngine.__subclasses__()
    return next((each.bl_label for each in engines if getattr(each, "bl_idname", "") == engine), engine)


def settings_problem(scene: bpy.types.Scene) -> str | None:
    """Return why a scene's render settings would not show nested dielectrics, or None if they would."""
    if scene.render.engine != "CYCLES":
        return f"scene {scene.name!r} renders with {engine_name(scene.render.engine)}; nested dielectrics need Cycles"
    if not scene.cycles.shading_system:
        return (
            f"scene {scene.name!r} renders without Open Shading Language; "
            "switch it on in Render properties, or press Prepare Scene"
        )
    if scene.cycles.device != "CPU":
        return (
            f"scene {scene.name!r} renders on the GPU, where shaders cannot trace rays; "
            "set Render properties > Device to CPU, or press Prepare Scene"
        )
    return None


def achromatic_reason(scene: bpy.types.Scene) -> str | None:
    """Return why dispersing media of a scene would render without their own colours, or None if they would not."""
    if not scene.render.use_motion_blur:
        instead = "show Cycles' own colours, not their spectrum's" if shows_front_ior() else "look as they do at 587.6 nm"
        return (
            f"scene {scene.name!r} renders without motion blur, whose random time carries the wavelength of a path; media "
            f"{instead}. Press Prepare Scene, which switches it on with a shutter of 0, so that nothing blurs"
        )
    if scene.render.motion_blur_shutter == 0.0 and not _even_shutter(scene):
        return (
            f"scene {scene.name!r} has a shutter of 0 with a shutter curve or a rolling shutter, which favour some "
            "wavelengths over others; press Prepare Scene"
        )
    return None


def _even_shutter(scene: bpy.types.Scene) -> bool:
    """Every moment is as likely as any other: the shutter curve is flat and nothing rolls."""
    (curve,) = scene.render.motion_blur_shutter_curve.curves
    return scene.cycles.rolling_shutter_type == "NONE" and len({point.location[1] for point in curve.points}) == 1


def require_blender() -> None:
    """Raise :class:`UnsupportedError` if this Blender cannot render nested dielectrics."""
    problem = blender_problem()
    if problem:
        raise UnsupportedError(problem)
