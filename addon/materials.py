"""Nested dielectric materials: making them, finding them and giving them to objects."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

from . import node_group
from .parameters import GROUP_NAME, PARAMETERS, Choice, Parameter, check_keywords
from .presets import load_preset


def new_material(name: str, preset: str | None = None, **keywords: Any) -> bpy.types.Material:
    """Make a material whose surface is a nested dielectric.

    :param name: name of the material; Blender numbers it if it is taken.
    :param preset: a name of :func:`preset_names` whose values are set first.
    :param keywords: socket names in snake_case, such as ``ior=1.33``; enumerations are upper-case words.
    :raises ParameterError: for an unknown preset or keyword, or a value outside its limits. Nothing has been made then.
    """
    values: dict[Parameter, Any] = {}
    description = ""
    if preset is not None:
        loaded = load_preset(preset)
        description = f"{loaded.description} {loaded.source}"
        values.update(check_keywords(loaded.parameters))
    values.update(check_keywords(keywords))
    group = node_group.ensure_group()

    material = bpy.data.materials.new(name)
    tree = material.node_tree
    tree.nodes.clear()
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    node.name = GROUP_NAME
    node.width = 260.0
    for target, height, sockets in (
        ("CYCLES", 0.0, {"Surface": node_group.CYCLES_OUTPUT, "Volume": node_group.VOLUME_OUTPUT}),
        ("EEVEE", -160.0, {"Surface": node_group.PREVIEW_OUTPUT}),
    ):
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        output.target = target
        output.location = (340.0, height)
        for theirs, ours in sockets.items():
            tree.links.new(node.outputs[ours], output.inputs[theirs])
    for parameter, value in values.items():
        set_parameter(node, parameter, value)
    material.use_transparent_shadow = True
    material.diffuse_color = (*node.inputs["Transmittance"].default_value[:3], 0.3)
    if description:
        material["nd_preset"] = description
    return material


def set_parameter(node: bpy.types.ShaderNodeGroup, parameter: Parameter, value: Any) -> None:
    """Set the socket of a parameter to a checked value."""
    socket = node.inputs[parameter.name]
    if isinstance(value, Choice):
        socket.default_value = value.name
    elif parameter.kind == "COLOR":
        socket.default_value = (*value, 1.0)
    else:
        socket.default_value = value


def dielectric_node(material: bpy.types.Material | None) -> bpy.types.ShaderNodeGroup | None:
    """Return the group node that makes ``material`` a nested dielectric, or None."""
    if material is None or material.node_tree is None:
        return None
    node = material.node_tree.nodes.get(GROUP_NAME)
    if node is None or node.type != "GROUP" or node.node_tree is None:
        return None
    names = {socket.name for socket in node.inputs}
    return node if all(parameter.name in names for parameter in PARAMETERS) else None


def dielectrics(obj: bpy.types.Object) -> Iterator[tuple[int, bpy.types.Material]]:
    """Yield the slots of an object that hold nested dielectrics, with their materials."""
    for index, slot in enumerate(obj.material_slots):
        if dielectric_node(slot.material) is not None:
            yield index, slot.material


def medium_material(obj: bpy.types.Object) -> bpy.types.Material | None:
    """Return the first nested dielectric among an object's materials, or None if the object is no medium."""
    return next((material for _, material in dielectrics(obj)), None)


def preset_material(preset: str) -> bpy.types.Material:
    """Return this file's material of a preset, made on first use."""
    loaded = load_preset(preset)
    found = bpy.data.materials.get(loaded.name)
    if found is not None and found.library is None and found.get("nd_preset") and dielectric_node(found) is not None:
        return found
    return new_material(loaded.name, preset=preset)
