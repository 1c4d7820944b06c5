"""Render settings that media need, and how each goes back to what it was when nothing needs it any more.

What a setting was and what it was set to stand together. Only what still has that value goes back: all else is the artist's.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import bpy

from ..nodes.render_settings import engine_name

AT_LEAST = {
    "cycles.max_bounces": 64,
    "cycles.transmission_bounces": 64,
    "cycles.glossy_bounces": 64,
    "cycles.transparent_max_bounces": 256,
}
"""Limits a path through nested media needs: an invalid surface costs a transparent bounce, an interface a transmission
or glossy one. In a white world the glass of iced water loses 4.7 % of its light at Blender's 12 bounces, 0.3 % at 64
and 0.08 % at 256.
"""

ENGINE = "render.engine"
DEVICE = "cycles.device"
OSL_SWITCH = "cycles.shading_system"
MOTION_BLUR = "render.use_motion_blur"
SHUTTER = "render.motion_blur_shutter"
SHUTTER_CURVE = "render.motion_blur_shutter_curve"
ROLLING_SHUTTER = "cycles.rolling_shutter_type"

RANDOM_TIME = (MOTION_BLUR, SHUTTER, SHUTTER_CURVE, ROLLING_SHUTTER)
"""What gives each path a time, which carries its wavelength."""

LABELS = {
    ENGINE: "Render Engine",
    OSL_SWITCH: "Open Shading Language",
    DEVICE: "Device",
    MOTION_BLUR: "Motion Blur",
    SHUTTER: "Shutter",
    SHUTTER_CURVE: "Shutter Curve",
    ROLLING_SHUTTER: "Rolling Shutter",
}
"""Settings by their paths from a scene; limits of bounces have Blender's names."""

Changed = dict[str, tuple[Any, Any]]
"""What settings were and what they were set to, by path. A curve is the heights of its points."""


def read(scene: bpy.types.Scene, path: str) -> Any:
    """Return the value of a setting."""
    value = scene.path_resolve(path)
    return [point.location[1] for point in value.curves[0].points] if path == SHUTTER_CURVE else value


def _write(scene: bpy.types.Scene, path: str, value: Any) -> None:
    if path == SHUTTER_CURVE:
        curve = scene.path_resolve(path)
        for point, height in zip(curve.curves[0].points, value):
            point.location[1] = height
        curve.update()
    else:
        owner, _, name = path.rpartition(".")
        setattr(scene.path_resolve(owner), name, value)


def label(scene: bpy.types.Scene, path: str) -> str:
    """Return what an artist knows a setting by."""
    owner, _, name = path.rpartition(".")
    return LABELS.get(path) or scene.path_resolve(owner).bl_rna.properties[name].name


def change(scene: bpy.types.Scene, changed: Changed, path: str, value: Any) -> list[str]:
    """Give a setting a value and write down what it was; return what was changed, in sentences."""
    before = read(scene, path)
    if before == value:
        return []
    _write(scene, path, value)
    known = changed.pop(path, None)
    first = known[0] if known is not None and known[1] == before else before
    if first != value:
        changed[path] = first, read(scene, path)
    return [_sentence(scene, path, before, value)]


def held(scene: bpy.types.Scene, changed: Changed, paths: Iterable[str] | None = None) -> Changed:
    """Return what of some settings, or all, still is as it was set, so that it may go back.

    With a shutter that is open somebody uses motion blur, whoever switched it on.
    """
    return {
        path: values
        for path, values in changed.items()
        if (paths is None or path in paths)
        and read(scene, path) == values[1]
        and (path != MOTION_BLUR or not values[1] or scene.render.motion_blur_shutter == 0.0)
    }


def go_back(scene: bpy.types.Scene, changed: Changed, paths: Iterable[str] | None = None) -> list[str]:
    """Let some settings, or all, be what they were, and forget that they were changed; return what was changed."""
    paths = tuple(changed if paths is None else paths)
    changes = []
    for path, (before, value) in held(scene, changed, paths).items():
        try:
            _write(scene, path, before)
        except TypeError:  # an engine that is not installed here
            continue
        changes.append(_sentence(scene, path, value, before))
    for path in paths:
        changed.pop(path, None)
    return changes


def sentences(scene: bpy.types.Scene, changed: Changed) -> list[str]:
    """Return what settings were and are, in sentences."""
    return [_sentence(scene, path, *values) for path, values in changed.items()]


def _sentence(scene: bpy.types.Scene, path: str, before: Any, value: Any) -> str:
    name = label(scene, path)
    if path == SHUTTER_CURVE:
        return f"{name}: {'flat' if len(set(value)) == 1 else 'as it was'}"
    return f"{name}: {_in_words(scene, path, before)} -> {_in_words(scene, path, value)}"


def _in_words(scene: bpy.types.Scene, path: str, value: Any) -> str:
    """Return a value as it stands in Blender's own panels."""
    if path == ENGINE:
        return engine_name(value)
    if isinstance(value, bool):
        return "on" if value else "off"
    owner, _, name = path.rpartition(".")
    kind = scene.path_resolve(owner).bl_rna.properties[name]
    item = kind.enum_items.get(value) if kind.type == "ENUM" else None
    return f"{value:.4g}" if isinstance(value, float) else str(value if item is None else item.name)
