"""Nested dielectrics among materials: their nodes, and the values in them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import bpy
import numpy as np

from ..model.choice import Choice
from ..model.parameter import GROUP_NAME, Parameter
from ..model.parameters import SOCKETS
from ..nodes.animation import is_animated
from ..nodes.lookups import cached_by_nodes
from ..nodes.places import dielectric_places, shows_dielectric, shows_other_volume, value_socket

_SOCKET_KINDS = {"FLOAT": "VALUE", "BOOL": "BOOLEAN", "COLOR": "RGBA", "INDEX": "INT"}

_KINDS = {(parameter.name, _SOCKET_KINDS.get(parameter.kind, parameter.kind)) for parameter in SOCKETS}
"""Sockets by which a group node is known, with Blender's words for their kinds."""

LUMINANCE = (0.2126, 0.7152, 0.0722)
"""Of linear red, green and blue (ITU-R BT.709)."""


@cached_by_nodes
def dielectric_node(material: bpy.types.Material | None) -> bpy.types.ShaderNodeGroup | None:
    """Return the node that other media read ``material`` by, or None if it is no nested dielectric to them."""
    if material is None or material.node_tree is None:
        return None
    node = material.node_tree.nodes.get(GROUP_NAME)
    if node is None or node.type != "GROUP" or node.node_tree is None:
        return None
    return (
        node
        if {(socket.name, socket.type) for socket in node.inputs} >= _KINDS and shows_dielectric(material)
        else None
    )


@cached_by_nodes
def rendered_node(material: bpy.types.Material) -> bpy.types.ShaderNodeGroup | None:
    """Return the node that renders a nested dielectric: that of :func:`dielectric_node` unless it stands in a group."""
    places = dielectric_places(material)
    return places[0][-1] if places else dielectric_node(material)


def parameter_socket(material: bpy.types.Material, name: str) -> bpy.types.NodeSocket | None:
    """Return the socket that an artist sets a parameter of a nested dielectric in, or None if other nodes make its value."""
    places = dielectric_places(material)
    return value_socket(places[0], name) if places else None


def dielectrics(obj: bpy.types.Object) -> Iterator[tuple[int, bpy.types.Material]]:
    """Yield the slots of an object that hold nested dielectrics, with their materials."""
    for index, slot in enumerate(obj.material_slots):
        if dielectric_node(slot.material) is not None:
            yield index, slot.material


def medium_material(obj: bpy.types.Object) -> bpy.types.Material | None:
    """Return the first nested dielectric among an object's materials, or None if the object is no medium."""
    return next((material for _, material in dielectrics(obj)), None)


def get_parameter(node: bpy.types.ShaderNodeGroup, parameter: Parameter) -> Any:
    """Return the value of a parameter's socket as a keyword argument would have it."""
    value = node.inputs[parameter.name].default_value
    if parameter.kind == "INDEX":
        return parameter.choices[min(max(value, 0), len(parameter.choices) - 1)].keyword
    if parameter.kind == "MENU":
        return next((choice.keyword for choice in parameter.choices if choice.name == value), parameter.default)
    return tuple(value)[:3] if parameter.kind in ("COLOR", "VECTOR") else value


def set_parameter(node: bpy.types.ShaderNodeGroup, parameter: Parameter, value: Any) -> None:
    """Set the socket of a parameter to a checked value."""
    socket = node.inputs[parameter.name]
    if parameter.kind == "INDEX":
        socket.default_value = parameter.choices.index(value)
    elif isinstance(value, Choice):
        socket.default_value = value.name
    elif parameter.kind == "COLOR":
        socket.default_value = (*value, 1.0)
    else:
        socket.default_value = value


def may_disperse(material: bpy.types.Material) -> bool:
    """Return whether a nested dielectric splits light into colours, now or on some frame."""
    socket = dielectric_node(material).inputs["Disperse"]
    return socket.default_value or socket.is_linked or is_animated(material.node_tree, socket)


@cached_by_nodes
def has_own_volume(material: bpy.types.Material) -> bool:
    """Return whether more than the node's own volume goes into the output of a nested dielectric's material."""
    return shows_other_volume(material)


def absorption_coefficients(node: bpy.types.ShaderNodeGroup) -> tuple[float, float, float]:
    """Return what a nested dielectric's node absorbs of red, green and blue per scene unit, as its volume has it."""
    depth = node.inputs["Transmittance Depth"].default_value
    left = node.inputs["Transmittance"].default_value[:3]
    if depth <= 0.0:
        return 0.0, 0.0, 0.0
    return tuple(-math.log(min(max(channel, 1e-6), 1.0)) / depth for channel in left)


def half_distance(node: bpy.types.ShaderNodeGroup) -> float | None:
    """Return after how many scene units half of white light's luminance is left in a nested dielectric.

    None if it absorbs nothing, or leaves a part of the light alone that is more than half.
    """
    weights = np.array(LUMINANCE)
    coefficients = np.array(absorption_coefficients(node))
    if weights @ (coefficients <= 0.0) >= 0.5:
        return None
    low, high = 0.0, 1.0
    while weights @ np.exp(-coefficients * high) > 0.5:
        high *= 2.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if weights @ np.exp(-coefficients * middle) > 0.5 else (low, middle)
    return high
