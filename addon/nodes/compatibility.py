"""What this Blender and this scene's render settings can do, in words an artist can act on; which body of the materials they
show.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import addon_utils
import bpy

from ..model.choice import Choice
from ..model.parameters import ParameterError

MINIMUM_VERSION = (5, 2, 0)
UNTESTED_VERSION = (5, 4, 0)
"""The first that no test has run on."""

NATIVE_DISPERSION_VERSION = (5, 3, 0)
"""The first whose own nodes split light."""

BACKEND_SETTING = "nd_backend"
"""Custom property of a scene: what its media are rendered with, a keyword of :data:`BACKENDS`; absent is the first."""

AUTO, OSL, NATIVE = "AUTO", "OSL", "NATIVE"

BACKENDS = (
    Choice(
        AUTO,
        "Automatic",
        "Cycles' own nodes on the GPU and without Open Shading Language. With it on the CPU, own nodes for all media that need "
        "nothing more, and the shader for the others, in one picture",
    ),
    Choice(OSL, "OSL", "The shader in Open Shading Language for all media: everything, on the CPU"),
    Choice(
        NATIVE,
        "Cycles' Nodes",
        "Cycles' own nodes for all media, on every device: surfaces are cut where media cross, and what only the shader does is "
        "left out",
    ),
)

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


def has_osl() -> bool:
    """Tell whether this Blender's Cycles runs Open Shading Language."""
    return bool(bpy.app.build_options.cycles_osl)


def runs_osl(scene: bpy.types.Scene) -> bool:
    """Tell whether a scene's renders run shaders in Open Shading Language that trace rays."""
    return has_osl() and scene.cycles.shading_system and scene.cycles.device == "CPU"


def get_backend(scene: bpy.types.Scene) -> str:
    """Return what a scene's media are to be rendered with: AUTO, OSL or NATIVE."""
    value = scene.get(BACKEND_SETTING)
    return next((choice.keyword for choice in BACKENDS if choice.keyword == value), AUTO)


def set_backend(scene: bpy.types.Scene, backend: str) -> None:
    """Render the media of a scene with Cycles' own nodes, the shader, or what fits best. Raises :class:`ParameterError` for
    another word.
    """
    words = [choice.keyword for choice in BACKENDS]
    if backend not in words:
        raise ParameterError(f"backend={backend!r}: one of {', '.join(words)} is needed")
    if backend == get_backend(scene):
        return
    if backend == AUTO:
        del scene[BACKEND_SETTING]
    else:
        scene[BACKEND_SETTING] = backend


def is_native(scene: bpy.types.Scene) -> bool:
    """Tell whether Cycles' own nodes render all media of a scene."""
    backend = get_backend(scene)
    return backend == NATIVE or (backend == AUTO and not runs_osl(scene))


def settings_problem(scene: bpy.types.Scene) -> str | None:
    """Return why a scene's render settings would not show nested dielectrics, or None if they would."""
    if scene.render.engine != "CYCLES":
        return f"scene {scene.name!r} renders with {engine_name(scene.render.engine)}; nested dielectrics need Cycles"
    if get_backend(scene) != OSL or runs_osl(scene):
        return None
    if not has_osl():
        return (
            f"scene {scene.name!r} renders with Open Shading Language, which this Blender was built without; "
            "set Render With to Automatic, or use the build from blender.org"
        )
    if not scene.cycles.shading_system:
        return (
            f"scene {scene.name!r} renders without Open Shading Language; "
            "switch it on in Render properties, press Prepare Scene, or set Render With to Automatic"
        )
    return (
        f"scene {scene.name!r} renders on the GPU, where shaders cannot trace rays; "
        "set Render properties > Device to CPU, press Prepare Scene, or set Render With to Automatic"
    )


def achromatic_reason(scene: bpy.types.Scene) -> str | None:
    """Return why dispersing media of a scene would render without their own colours, or None if they would not."""
    if is_native(scene):
        if bpy.app.version >= NATIVE_DISPERSION_VERSION:
            return None
        return (
            f"scene {scene.name!r} renders with Cycles' own nodes, which split no light before Blender 5.3; media look as they "
            "do at 587.6 nm. Set Render With to OSL and press Prepare Scene"
        )
    if not scene.render.use_motion_blur:
        instead = (
            "show Cycles' own colours, not their spectrum's" if shows_front_ior() else "look as they do at 587.6 nm"
        )
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
