"""Ray Visibility of objects as their artists have set it, also while a cut surface stands for them in viewports."""

from __future__ import annotations

import bpy

from ..nodes.animation import curves
from .media import HIDDEN_BY_CUT

RAY_KINDS = ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow")
"""Kinds of rays that an object may be hidden from."""

SETTINGS = tuple(
    f"visible_{kind}" for kind in (*RAY_KINDS, "raycast") if f"visible_{kind}" in bpy.types.Object.bl_rna.properties
)
"""Their names; to raycasts objects are visible from Blender 5.3 on."""


def is_seen(obj: bpy.types.Object, setting: str) -> bool:
    """Return whether an artist lets rays meet an object, by the name of a setting of Ray Visibility."""
    kept = _kept(obj)
    return getattr(obj, setting) if kept is None else setting in kept


def is_seen_by_all(obj: bpy.types.Object) -> bool:
    """Return whether an artist lets rays of all kinds meet an object."""
    return all(is_seen(obj, f"visible_{kind}") for kind in RAY_KINDS)


def may_hide(obj: bpy.types.Object) -> bool:
    """Return whether nothing animates by which rays an object is met."""
    return not any(curve.data_path in SETTINGS for curve in curves(obj.animation_data))


def is_hidden(obj: bpy.types.Object) -> bool:
    """Return whether no ray meets an object because a cut surface stands for it in viewports."""
    return _kept(obj) is not None


def hide(obj: bpy.types.Object) -> None:
    """Let no ray meet an object for which a cut surface stands, and keep with it what its artist has set."""
    seen = [setting for setting in SETTINGS if is_seen(obj, setting) or getattr(obj, setting)]
    _keep(obj, " ".join(seen))
    _set(obj, ())


def show(obj: bpy.types.Object) -> None:
    """Let those rays meet an object again that its artist lets."""
    kept = _kept(obj)
    if kept is not None:
        _keep(obj, True)
        _set(obj, kept)


def _kept(obj: bpy.types.Object) -> tuple[str, ...] | None:
    """Return by which rays an artist lets an object be met, as it was kept while none meets it; None while rays do.

    If others have damaged that, and no ray meets the object, it is to be met by all.
    """
    value = obj.get(HIDDEN_BY_CUT)
    if value is None or value is True:
        return None
    if isinstance(value, str) and all(word.startswith("visible_") for word in value.split()):
        return tuple(value.split())
    return None if any(getattr(obj, setting) for setting in SETTINGS) else SETTINGS


def _keep(obj: bpy.types.Object, value: str | bool) -> None:
    if obj.get(HIDDEN_BY_CUT) != value:
        obj.pop(HIDDEN_BY_CUT, None)  # or it may keep another type
        obj[HIDDEN_BY_CUT] = value


def _set(obj: bpy.types.Object, seen: tuple[str, ...]) -> None:
    for setting in SETTINGS:
        if getattr(obj, setting) != (setting in seen):
            setattr(obj, setting, setting in seen)
