"""Telling that nothing has changed since a scene was looked at, in far less time than to look again.

What is changed is tagged for the depsgraph, whose updates are counted here; what Python writes without a tag is compared.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy

from ..model.parameter import PRIORITY_PROPERTY
from ..nodes.names import OBJECT_PROPERTIES
from ..nodes.stored import plain

State = tuple[Any, ...]
"""Of a scene; two that are equal tell that nothing was changed between them."""

_UNTAGGED = (PRIORITY_PROPERTY, *OBJECT_PROPERTIES)
"""Custom properties of objects, which Python writes without a tag."""

_NO_CONCERN = (bpy.types.Scene, bpy.types.World, bpy.types.Camera)
"""What concerns no medium but by what :func:`state_of` compares."""

REPORT_PROPERTY = "nd_prepared"
"""Custom property of a scene that concerns no medium."""

_counted = 0
_counts = True


@contextmanager
def uncounted() -> Iterator[None]:
    """Let nothing that is written in the block count."""
    global _counts
    outer, _counts = _counts, False
    try:
        yield
    finally:
        _counts = outer


def count(depsgraph: bpy.types.Depsgraph) -> None:
    """Count what a depsgraph says that has changed."""
    global _counted
    if _counts and any(not isinstance(update.id, _NO_CONCERN) for update in depsgraph.updates):
        _counted += 1


def state_of(scene: bpy.types.Scene) -> State:
    """Return what tells whether a scene was changed; its first view layer is up to date."""
    render = scene.render
    layer = scene.view_layers[0]
    return (
        _counted,
        (scene.frame_current, scene.frame_subframe),
        (render.use_simplify, render.use_motion_blur, render.motion_blur_shutter > 0.0),
        (render.engine, scene.cycles.device, scene.cycles.shading_system),
        {key: plain(value) for key, value in scene.items() if key.startswith("nd_") and key != REPORT_PROPERTY},
        *(len(each) for each in (bpy.data.scenes, bpy.data.collections, bpy.data.materials, bpy.data.node_groups)),
        [(each.name, [obj.session_uid for obj in each.objects]) for each in scene.view_layers],
        [
            (
                obj.session_uid,
                obj.animation_data is None,
                *(plain(obj.get(name)) for name in _UNTAGGED),
                *(() if obj.visible_get(view_layer=layer) else _of_hidden(obj)),
            )
            for obj in bpy.data.objects
        ],
    )


def _of_hidden(obj: bpy.types.Object) -> State:
    """Return what matters of an object that is not evaluated."""
    materials = [slot.material.session_uid if slot.material else None for slot in obj.material_slots]
    return obj.hide_render, obj.hide_viewport, len(obj.modifiers), materials
