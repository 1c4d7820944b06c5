"""Keyframes and drivers: all that may move a property of a data-block."""

from __future__ import annotations

from collections.abc import Iterator

import bpy


def curves(animation: bpy.types.AnimData | None) -> Iterator[bpy.types.FCurve]:
    """Yield the drivers and keyframes of one data-block, in its action and in strips."""
    if animation is None:
        return
    yield from animation.drivers
    actions = [(animation.action, animation.action_slot)]
    actions += [(strip.action, strip.action_slot) for track in animation.nla_tracks for strip in track.strips]
    for action, slot in actions:
        if action is None or slot is None:
            continue
        for strip in (strip for layer in action.layers for strip in layer.strips):
            bag = strip.channelbag(slot)
            if bag is not None:
                yield from bag.fcurves


def is_animated(owner: bpy.types.ID, struct: bpy.types.bpy_struct) -> bool:
    """Return whether a keyframe or a driver of a data-block moves a property of something in it, as a socket's value."""
    return any(_holder(owner, curve.data_path) == struct for curve in curves(owner.animation_data))


def _holder(owner: bpy.types.ID, path: str) -> bpy.types.bpy_struct | None:
    """Return the struct whose property is at the end of a path; None where the path leads nowhere."""
    try:
        return owner.path_resolve(path.rpartition(".")[0])
    except ValueError:
        return None
