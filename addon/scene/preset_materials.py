"""Materials of presets in a file: which may be used again, how deep their colour is, and presets made of materials."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import inf
from typing import Any

import bpy
import numpy as np

from ..model.choice import keyword_of
from ..model.parameter import Parameter, ParameterError
from ..model.parameters import SETTINGS, SOCKETS
from ..model.presets import Preset, key_of
from ..nodes.animation import curves, is_animated
from .material_spectra import spectrum_settings, usable_spectrum_settings
from .materials import dielectric_node, get_parameter, parameter_socket, rendered_node
from .new_materials import KEY_PROPERTY, new_material
from .preset_library import load_preset
from .preset_values import DEPTH, TRANSMITTANCE, measured_depth, preset_values, working_colour
from .shapes import thickness

SAME_DEPTH = 2.0
"""How many times as deep a material's colour may be as an object's own for the object to share it.

So far red wine in one glass may differ from that in another.
"""


def preset_material(
    preset: str | Preset, objects: Iterable[bpy.types.Object] = (), *, fit: bool = True, use_edited: bool = False
) -> bpy.types.Material:
    """Return a material of a preset for objects: one of this file that is as the preset has it, or else a new one.

    Where the preset has a colour, the thickest of the objects shows it: that thickness is the Transmittance Depth. Only a
    material whose depth is within a factor of :data:`SAME_DEPTH` of it is used again, or one that nothing else uses.

    :param preset: a preset, or its key.
    :param fit: False takes the depth at which the preset was measured.
    :param use_edited: take what :func:`edited_material` finds first.
    :raises ParameterError: for an unknown preset.
    """
    loaded = load_preset(preset) if isinstance(preset, str) else preset
    edited = edited_material(loaded, objects) if use_edited else None
    if edited is not None:
        return edited
    unchanged = [material for material in _named(loaded) if is_preset(material, loaded)]
    if not loaded.has_colour:
        return unchanged[0] if unchanged else new_material(loaded.name, preset=loaded)
    depth = _fitting_depth(loaded, objects if fit else ())
    near = [material for material in unchanged if _distance(material, depth) <= SAME_DEPTH]
    if near:
        return min(near, key=lambda material: _distance(material, depth))
    unused = next((material for material in unchanged if not _is_used(material, objects)), None)
    material = unused or new_material(loaded.name, preset=loaded)
    rendered_node(material).inputs[DEPTH.name].default_value = depth
    return material


def is_preset(material: bpy.types.Material, preset: Preset) -> bool:
    """Return whether a material of this file is what :func:`new_material` makes of a preset.

    Its name and its Transmittance Depth may be others.
    """
    node = dielectric_node(material)
    if node is None or material.library is not None or len(material.node_tree.nodes) > 3:
        return False
    values = preset_values(preset)
    settings = {parameter.keyword: keyword_of(values.get(parameter, parameter.default)) for parameter in SETTINGS}
    return (
        not any(socket.is_linked for socket in node.inputs)
        and not any(curves(material.node_tree.animation_data))
        and all(
            _holds(node, parameter, values.get(parameter, parameter.default))
            for parameter in SOCKETS
            if parameter != DEPTH
        )
        and spectrum_settings(material) == settings
    )


def _holds(node: bpy.types.ShaderNodeGroup, parameter: Parameter, value: Any) -> bool:
    if parameter.kind == "SHADER":
        return True
    found = get_parameter(node, parameter)
    if isinstance(found, str):
        return found == keyword_of(value)
    return np.allclose(found, value, rtol=1e-5, atol=1e-9)


def edited_material(preset: Preset, objects: Iterable[bpy.types.Object] = ()) -> bpy.types.Material | None:
    """Return a material of this file that has the name of a preset and was edited since, or None.

    If there are several, it is one of the objects' own.
    """
    theirs = {slot.material for obj in objects for slot in obj.material_slots}
    found = [
        material
        for material in _named(preset)
        if material.library is None and dielectric_node(material) is not None and not is_preset(material, preset)
    ]
    return min(found, key=lambda material: material not in theirs, default=None)


def fit_depth(material: bpy.types.Material, depth: float) -> None:
    """Set the Transmittance Depth of a nested dielectric, in scene units, where an artist would.

    :raises ParameterError: if it cannot be set to that, or other nodes, keyframes or drivers make it.
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
    """Make a preset of the values that a nested dielectric has now, its lengths in metres.

    :raises ParameterError: for a name that cannot be one.
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
    """Return the thickness of the thickest object; without objects, the depth at which the preset was measured."""
    return DEPTH.bounded(max(map(thickness, objects), default=0.0) or measured_depth(preset))


def _distance(material: bpy.types.Material, depth: float) -> float:
    """Return how many times as deep a material's colour is, or the other way round; 1 or more."""
    found = rendered_node(material).inputs[DEPTH.name].default_value
    return max(found / depth, depth / found) if found > 0.0 else inf


def _is_used(material: bpy.types.Material, leaving: Iterable[bpy.types.Object]) -> bool:
    """Return whether a material is used by others than the objects that are to get another in its place.

    One that somebody wants kept is used, too; the mesh of a deleted object does not count.
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
    """Return a socket's value as a file has it: numbers in as few digits as single precision needs."""
    if isinstance(value, float):
        return float(str(np.float32(value)))
    return list(map(_written, value)) if isinstance(value, (list, tuple)) else value
