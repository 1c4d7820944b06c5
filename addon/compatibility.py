"""What this Blender and this scene's render settings can do, in words an artist can act on."""

from __future__ import annotations

import bpy

MINIMUM_VERSION = (5, 1, 0)
UNTESTED_VERSION = (5, 3, 0)
"""From here on Cycles' dielectric closure turns the index of back faces itself, and the shader's would be turned twice."""


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
            "use Blender 5.1 or 5.2"
        )
    if version >= UNTESTED_VERSION:
        return (
            f"Blender {name} is newer than this extension, and its Cycles may turn indices of refraction the other way; "
            "use Blender 5.2 LTS, or a newer version of the extension"
        )
    if not with_osl:
        return "this Blender was built without Open Shading Language; use the build from blender.org or the bpy wheel"
    return None


def settings_problem(scene: bpy.types.Scene) -> str | None:
    """Return why a scene's render settings would not show nested dielectrics, or None if they would."""
    if scene.render.engine != "CYCLES":
        return f"scene {scene.name!r} renders with {scene.render.engine}; nested dielectrics need Cycles"
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
    """Return why dispersing media of a scene would render without their colours, or None if they would not."""
    if not scene.render.use_motion_blur:
        return (
            f"scene {scene.name!r} renders without motion blur, whose random time carries the wavelength of a path; media "
            "look as they do at 587.6 nm. Press Prepare Scene, which switches it on with a shutter of 0, so that nothing blurs"
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
