"""Requests for the attributes that shaders read of other objects, so that Cycles exports them.

Cycles looks attributes up one by one in the order of these nodes, and what is not there takes longest: so the list is kept
short. What a material does not have, or has in no further slot, is multiplied by a constant 0, and Cycles drops it.
"""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ..model.contract import (
    BY_VOLUME_SOCKET,
    CUT_ATTRIBUTES,
    MATERIAL_SLOTS,
    SECOND_SLOT_PATH,
    DispersionModel,
    Exterior,
    socket_path,
)
from ..model.parameter import PRIORITY_PROPERTY
from ..model.parameters import NEIGHBOUR_PARAMETERS
from .names import EXTERIOR_SOCKET, OBJECT_PROPERTIES, SLOTS_SOCKET
from .numbers import Number
from .shader_nodes import Socket, attribute, vector_math

Request = tuple[str, str, Number | None]
"""An attribute's name, its kind, and the number that is 0 where nobody reads it; None where it is always read."""


def attribute_requests(
    tree: bpy.types.NodeTree,
    inputs: bpy.types.Node,
    curves_matter: Number,
    absorbs: Number,
    analysis_holds: Number,
    cut: Number,
) -> Socket:
    """Return one colour that depends on every attribute neighbours read of an object.

    The other numbers are 0 where no dispersion, no absorption, no analysis and no cut surface is to be read.
    """
    conditions = _conditions(tree, inputs, curves_matter, absorbs)
    by_object = Number(tree, inputs.outputs[EXTERIOR_SOCKET]).equals(Exterior.BY_OBJECT)
    one_slot = Number(tree, inputs.outputs[SLOTS_SOCKET]) < 1.5
    several = 1.0 - one_slot * analysis_holds
    requests = [
        *((name, "GEOMETRY", cut) for name in CUT_ATTRIBUTES),
        *((name, "OBJECT", by_object) for name in OBJECT_PROPERTIES),
        (PRIORITY_PROPERTY, "OBJECT", None),
        (SECOND_SLOT_PATH, "OBJECT", None),
        ("material_index", "GEOMETRY", several),
        *_slot_requests(conditions, several),
        # Only objects without further slots are left to volumes.
        (socket_path(0, BY_VOLUME_SOCKET), "OBJECT", absorbs),
    ]
    return _sum(tree, requests)


def _conditions(
    tree: bpy.types.NodeTree, inputs: bpy.types.Node, curves_matter: Number, absorbs: Number
) -> dict[str, Number]:
    """Return, by the names of sockets that neighbours read, what is 0 where these values do not matter."""
    model = Number(tree, inputs.outputs["Dispersion Model"])
    chosen = {choice: model.equals(choice) for choice in DispersionModel}
    sellmeier = chosen[DispersionModel.SELLMEIER] * curves_matter
    return {
        "Abbe": chosen[DispersionModel.ABBE] * curves_matter,
        "Sellmeier B": sellmeier,
        "Sellmeier C": sellmeier,
        # JF's also moves the index of white light.
        "Dispersion": chosen[DispersionModel.JF],
        "Dispersion Model": sellmeier.math("MAXIMUM", chosen[DispersionModel.JF]),
        "Disperse": Number(tree, inputs.outputs["Disperse"]),
        "Transmittance": absorbs,
        "Transmittance Depth": absorbs,
    }


def _slot_requests(conditions: dict[str, Number], several: Number) -> Iterator[Request]:
    """Yield the sockets that neighbours read in each slot; `several` is 0 where an object has one slot alone."""
    in_others = {name: several * condition for name, condition in conditions.items()}
    for slot in range(MATERIAL_SLOTS):
        for name in NEIGHBOUR_PARAMETERS:
            condition = in_others.get(name, several) if slot else conditions.get(name)
            yield socket_path(slot, name), "OBJECT", condition


def _sum(tree: bpy.types.NodeTree, requests: list[Request]) -> Socket:
    """Return the sum of all that is requested, each times its condition."""
    sums: dict[Number | None, Socket] = {}
    for name, kind, condition in requests:
        value = attribute(tree, kind, name).outputs["Color"]
        sums[condition] = vector_math(tree, "ADD", sums[condition], value) if condition in sums else value
    total = sums.pop(None)
    for condition, value in sums.items():
        total = vector_math(tree, "ADD", total, vector_math(tree, "MULTIPLY", value, condition.socket))
    return total
