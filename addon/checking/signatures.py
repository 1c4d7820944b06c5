"""What neighbours read of media: the same for objects of one medium."""

from __future__ import annotations

import bpy

from ..model.parameters import NEIGHBOUR_PARAMETERS
from ..nodes.lookups import cached_by_nodes
from ..nodes.places import socket_value
from ..scene.materials import dielectric_node, medium_material


@cached_by_nodes
def neighbour_values(material: bpy.types.Material) -> tuple:
    """Return what neighbours read of a material, the values of its sockets."""
    node = dielectric_node(material)
    return tuple(socket_value(node.inputs[name]) for name in NEIGHBOUR_PARAMETERS)


def medium_signature(obj: bpy.types.Object) -> tuple:
    """Return what neighbours read of an object's medium, but its priority: the same for objects of one medium."""
    return neighbour_values(medium_material(obj))[1:]
