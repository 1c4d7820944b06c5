"""What a scene's render settings would not show of its media, in words an artist can act on."""

from __future__ import annotations

import bpy

from . import compatibility
from .compatibility import NATIVE_DISPERSION_VERSION, shows_front_ior
from .render_with import OSL, get_backend, is_native, runs_osl


def engine_name(engine: str) -> str:
    """Return the name that an artist knows a render engine by."""
    known = bpy.types.RenderSettings.bl_rna.properties["engine"].enum_items.get(engine)
    if known is not None:
        return known.name
    engines = bpy.types.RenderEngine.__subclasses__()
    return next((each.bl_label for each in engines if getattr(each, "bl_idname", "") == engine), engine)


def settings_problem(scene: bpy.types.Scene) -> str | None:
    """Return in a sentence why a scene's render settings would not show nested dielectrics, or None if they would."""
    fault = settings_fault(scene)
    return None if fault is None else f"scene {scene.name!r} {fault[0]}; {fault[1]}"


def settings_fault(scene: bpy.types.Scene) -> tuple[str, str] | None:
    """Return what of a scene's render settings would not show nested dielectrics, after its name, and the remedy."""
    if scene.render.engine != "CYCLES":
        return f"renders with {engine_name(scene.render.engine)}", "nested dielectrics need Cycles"
    if get_backend(scene) != OSL or runs_osl(scene):
        return None
    if not compatibility.has_osl():
        return (
            "renders with Open Shading Language, which this Blender was built without",
            "set Render With to Automatic, or use the build from blender.org",
        )
    if not scene.cycles.shading_system:
        return (
            "renders without Open Shading Language",
            "switch it on in Render properties, press Prepare Scene, or set Render With to Automatic",
        )
    return (
        "renders on the GPU, where shaders cannot trace rays",
        "set Render properties > Device to CPU, press Prepare Scene, or set Render With to Automatic",
    )


def achromatic_reason(scene: bpy.types.Scene) -> str | None:
    """Return in sentences why dispersing media of a scene would render without their own colours, or None."""
    fault = achromatic_fault(scene)
    return None if fault is None else f"scene {scene.name!r} {fault[0]}. {fault[1][0].upper()}{fault[1][1:]}"


def achromatic_fault(scene: bpy.types.Scene) -> tuple[str, str] | None:
    """Return why dispersing media of a scene would render without their own colours, after its name, and the remedy."""
    if is_native(scene):
        if bpy.app.version >= NATIVE_DISPERSION_VERSION:
            return None
        return (
            "renders with Cycles' own nodes, which split no light before Blender 5.3; media look as they do at 587.6 nm",
            "set Render With to OSL and press Prepare Scene",
        )
    if not scene.render.use_motion_blur:
        instead = (
            "show Cycles' own colours, not their spectrum's" if shows_front_ior() else "look as they do at 587.6 nm"
        )
        return (
            f"renders without motion blur, whose random time carries the wavelength of a path; media {instead}",
            "press Prepare Scene, which switches it on with a shutter of 0, so that nothing blurs",
        )
    if scene.render.motion_blur_shutter == 0.0 and not _even_shutter(scene):
        return (
            "has a shutter of 0 with a shutter curve or a rolling shutter, which favour some wavelengths over others",
            "press Prepare Scene",
        )
    return None


def _even_shutter(scene: bpy.types.Scene) -> bool:
    """Every moment is as likely as any other: the shutter curve is flat and nothing rolls."""
    (curve,) = scene.render.motion_blur_shutter_curve.curves
    return scene.cycles.rolling_shutter_type == "NONE" and len({point.location[1] for point in curve.points}) == 1
