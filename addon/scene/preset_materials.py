"""Materials of presets in a file: which may be used again, how deep their colour is, and presets made of materials."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import inf
from typing import Any

import bpy
import numpy as np

from ..model.parameters import SETTINGS, SOCKETS, ParameterError
from ..model.presets import Preset, key_of
from ..nodes.animation import is_animated
from .materials import (
    DEPTH,
    KEY_PROPERTY,
    TRANSMITTANCE,
    dielectric_node,
    get_parameter,
    is_preset,
    measured_depth,
    new_material,
    parameter_socket,
    rendered_node,
    usable_spectrum_settings,
    working_colour,
)
from .preset_library import load_preset
from .shapes import thickness

SAME_DEPTH = 2.0
"""How many times as deep a material's colour may be as an object's own for the object to share it: as far as red wine in
one glass may differ from that in another.
"""


def preset_material(
    preset: str, objects: Iterable[bpy.types.Object] = (), *, fit: bool = True, use_edited: bool = False
) -> bpy.types.Material:
    """Return a material of a preset for objects: one of this file that is as the preset has it, or else a new one.

    Where the preset has a colour, the thickest of the objects shows it: that thickness is the Transmittance Depth. Only a
    material whose depth is within a factor of :data:`SAME_DEPTH` of it is used again, or one that nothing else uses.

    :param fit: False takes the depth at which the preset was measured.
    :param use_edited: take what :func:`edited_material` finds first.
    :raises ParameterError: for an unknown preset.
    """
    loaded = load_preset(preset)
    edited = edited_material(loaded, objects) if use_edited else None
    if edited is not None:
        return edited
    unchanged = [material for material in _named(loaded) if is_preset(material, loaded)]
    if not loaded.has_colour:
        return unchanged[0] if unchanged else new_material(loaded.name, preset=preset)
    depth = _fitting_depth(loaded, objects if fit else ())
    near = [material for material in unchanged if _distance(material, depth) <= SAME_DEPTH]
    if near:
        return min(near, key=lambda material: _distance(material, depth))
    unused = next((material for material in unchanged if not _is_used(material, objects)), None)
    material = unused or new_material(loaded.name, preset=preset)
    rendered_node(material).inputs[DEPTH.name].default_value = depth
    return material


def edited_material(preset: Preset, objects: Iterable[bpy.types.Object] = ()) -> bpy.types.Material | None:
    """Return a material of this file that has the name of a preset and is not as that has it any more, or None; one of the
    objects' own if there are several.
    """
    theirs = {slot.material for obj in objects for slot in obj.material_slots}
    found = [
        material
        for material in _named(preset)
        if material.library is None and dielectric_node(material) is not None and not is_preset(material, preset)
    ]
    return min(found, key=lambda material: material not in theirs, default=None)


def fit_depth(material: bpy.types.Material, depth: float) -> None:
    """Set the Transmittance Depth of a nested dielectric where an artist would. Raises :class:`ParameterError` if it cannot
    be set to that, or other nodes, keyframes or drivers make it.
    """
    socket = parameter_socket(material, DEPTH.name)
    if socket is None or is_animated(socket.id_data, socket):
        raise ParameterError(f"{material.name!r}: other nodes, keyframes or a driver set {DEPTH.name}; change it there")
    socket.default_value = DEPTH.check(depth)


def preset_of(material: bpy.types.Material | None) -> Preset | None:
    """Return the preset that a material was made of, or None if it knows none that there still is."""
    key = None if material is None else material.get(KEY_PROPERTY)
    try:
        return load_preset(key) if isinstance(key, str) else None
    except ParameterError:
        return None


def preset_from(material: bpy.types.Material, name: str, group: str, tags: Iterable[str], description: str) -> Preset:
    """Make a preset of the values that a nested dielectric has now, its lengths in metres. Raises :class:`ParameterError`
    for a name that cannot be one.
    """
    node = rendered_node(material)
    values = {}
    for parameter in SOCKETS:
        if parameter.kind != "SHADER":
            value = _written(get_parameter(node, parameter))
            if parameter == TRANSMITTANCE and value != _written(parameter.default):
                value = _written(TRANSMITTANCE.bounded(working_colour(value, to_presets=True)))
            elif parameter == DEPTH:
                value = _written(value * bpy.context.scene.unit_settings.scale_length)
            if parameter.keyword == "ior" or value != _written(parameter.default):
                values[parameter.keyword] = value
    kept = usable_spectrum_settings(material)
    values |= {each.keyword: kept[each.keyword] for each in SETTINGS if kept[each.keyword] != each.default}
    words = tuple(dict.fromkeys(tag.strip() for tag in tags if tag.strip()))
    source = f"Saved from material {material.name!r}."
    return Preset(key_of(name), name.strip(), group, words, description, source, values)


def linked_parameters(material: bpy.types.Material) -> list[str]:
    """Return the names of a nested dielectric's parameters that other nodes make, so that no preset can hold them."""
    node = rendered_node(material)
    return [socket.name for socket in node.inputs if socket.is_linked]


def _named(preset: Preset) -> Iterator[bpy.types.Material]:
    for material in bpy.data.materials:
        if f"{material.name}.".startswith(f"{preset.name}."):
            yield material


def _fitting_depth(preset: Preset, objects: Iterable[bpy.types.Object]) -> float:
    """The thickness of the thickest, or where there is none the depth at which the preset was measured."""
    return DEPTH.bounded(max(map(thickness, objects), default=0.0) or measured_depth(preset))


def _distance(material: bpy.types.Material, depth: float) -> float:
    """How many times as deep a material's colour is, or the other way round."""
    found = rendered_node(material).inputs[DEPTH.name].default_value
    return max(found / depth, depth / found) if found > 0.0 else inf


def _is_used(material: bpy.types.Material, leaving: Iterable[bpy.types.Object]) -> bool:
    """Whether an object has a material but those that are to get another in its place, or somebody wants it kept; the mesh
    of a deleted object does not count.
    """
    left = set()
    for obj in leaving:
        slots = [slot for slot in obj.material_slots if slot.material == material]
        if len(slots) == 1 and obj.active_material == material:
            left.add(obj if slots[0].link == "OBJECT" else obj.data)
    owners = bpy.data.user_map(subset={material})[material]
    used = (owner.users > (owner in left) for owner in owners if not isinstance(owner, bpy.types.Object))
    linked = (owner not in left for owner in owners if isinstance(owner, bpy.types.Object))
    return material.use_fake_user or any(used) or any(linked)


def _written(value: Any) -> Any:
    """A socket's value as a file has it: numbers in as few digits as single precision needs."""
    if isinstance(value, float):
        return float(str(np.float32(value)))
    return list(map(_written, value)) if isinstance(value, (list, tuple)) else value
