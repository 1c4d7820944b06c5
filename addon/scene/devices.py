"""The devices of this machine that Cycles renders a scene on."""

from __future__ import annotations

import bpy

from .render_error import RenderError

CPU, GPU = "CPU", "GPU"
DEVICES = (CPU, GPU)

GPU_TYPES = ("OPTIX", "CUDA", "HIP", "METAL", "ONEAPI")
"""Ways of Cycles to run on GPUs, the fastest of each maker's first."""


def use_device(scene: bpy.types.Scene, device: str) -> tuple[str, ...]:
    """Let a scene be rendered on the CPU, or on the GPUs of this machine; return the names of the GPUs.

    Where Blender's preferences name GPUs that are there, these; else all that Cycles finds of the best kind, in this session.

    :param device: one of :data:`DEVICES`.
    :raises RenderError: if there is no GPU, on which Cycles would render on the CPU without a word.
    """
    gpus = _enable_gpus() if device == GPU else ()
    if device == GPU and not gpus:
        raise RenderError(
            "Cycles finds no GPU on this machine that it can render on; mend its driver, or render with --device CPU"
        )
    scene.cycles.device = device
    return gpus


def _enable_gpus() -> tuple[str, ...]:
    """Switch GPUs on in the preferences, where none is yet; return the names of those that are."""
    preferences = _preferences()
    if preferences is None:
        return ()
    chosen = preferences.compute_device_type
    if chosen in GPU_TYPES:
        used = tuple(device.name for device in _gpus(preferences, chosen) if device.use)
        if used:
            return used
    for kind in _built_types(preferences):
        gpus = _gpus(preferences, kind)
        if gpus:
            preferences.compute_device_type = kind
            for device in preferences.devices:
                device.use = device.type == kind
            return tuple(device.name for device in gpus)
    return ()


def _preferences() -> bpy.types.AddonPreferences | None:
    """Return Cycles' preferences; None where it is switched off."""
    addon = bpy.context.preferences.addons.get("cycles")
    return None if addon is None else addon.preferences


def _built_types(preferences: bpy.types.AddonPreferences) -> tuple[str, ...]:
    """Return the ways to run on GPUs that this Blender was built with, the fastest first."""
    built = {name for name, *_ in preferences.get_device_types(bpy.context)}
    return tuple(kind for kind in GPU_TYPES if kind in built)


def _gpus(preferences: bpy.types.AddonPreferences, kind: str) -> list[bpy.types.PropertyGroup]:
    """Return the GPUs of a kind that are there."""
    return [device for device in preferences.get_devices_for_type(kind) if device.type == kind]
