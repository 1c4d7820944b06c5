"""Cycles' shadow caustics for media: one switch for the flags of media, of what they cast light on, and of lights."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ..model.parameters import BY_KEYWORD
from .lights import LOBE, light_carriers, scene_lights
from .materials import dielectric_node, dielectrics, get_parameter
from .media import SOLID_TYPES, media

_SURFACES = SOLID_TYPES | {"CURVES", "POINTCLOUD"}


def set_shadow_caustics(scene: bpy.types.Scene, enabled: bool = True) -> tuple[str, ...]:
    """Switch Cycles' shadow caustics on or off for the media of a scene.

    Media cast them, all other objects that render show them, and lights make them. What belongs to a library stays as it
    is. A second call changes nothing.

    :return: sentences: what was changed and, when they are switched on, what about the media does not go with them.
    """
    changes = []
    for owner, flag, label in _flags(scene):
        if owner.is_editable and getattr(owner.cycles, flag) != enabled:
            setattr(owner.cycles, flag, enabled)
            changes.append(f"{label} of {owner.name}: {'on' if enabled else 'off'}")
    if enabled:
        changes += _drawbacks(scene)
    return tuple(changes)


def _flags(scene: bpy.types.Scene) -> Iterator[tuple[bpy.types.Object | bpy.types.Light, str, str]]:
    """Yield what has a flag of shadow caustics, which one, and Blender's name for it."""
    casters = media(scene)
    for obj in casters:
        yield obj, "is_caustics_caster", "Cast Shadow Caustics"
    for obj in scene.objects:
        if obj.type in _SURFACES and not obj.hide_render and obj not in casters:
            yield obj, "is_caustics_receiver", "Receive Shadow Caustics"
    for data in dict.fromkeys(light.data for light in scene_lights(scene)):
        yield data, "is_caustics_light", "Shadow Caustics"


def _drawbacks(scene: bpy.types.Scene) -> list[str]:
    texts = []
    lobes = any(transport.refraction == LOBE for transport in light_carriers(scene))
    found = dict.fromkeys(material for obj in media(scene) for _, material in dielectrics(obj))
    for material in found:
        node = dielectric_node(material)
        if get_parameter(node, BY_KEYWORD["roughness"]) > 0.0:
            texts.append(f"{material.name!r} is rough, for which shadow caustics are approximate; set Roughness to 0")
        if get_parameter(node, BY_KEYWORD["shadow_mode"]) != "BLACK":
            texts.append(
                f"{material.name!r} also lets light straight through into its shadow, which counts it twice; "
                "set Shadow Mode to Black"
            )
        if lobes and get_parameter(node, BY_KEYWORD["caustic_direct_refraction"]):
            texts.append(
                f"{material.name!r} also casts light by its lobe, which counts it twice; "
                "switch Caustic Direct Refraction off"
            )
    return texts
