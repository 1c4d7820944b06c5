"""The sockets of the node group `Nested Dielectric`."""

from __future__ import annotations

from functools import cache

import bpy

from ..model.contract import AIR_AROUND, BY_VOLUME_SOCKET, MATERIAL_SLOTS, NO_SOLE_PRIORITY, Exterior
from ..model.parameter import BASIC_KEYWORDS, BASICS, Parameter
from ..model.parameters import BY_KEYWORD, SOCKETS
from .identity import NO_SCENE
from .names import (
    ANALYSIS_PANEL,
    CYCLES_OUTPUT,
    EXTERIOR_MEDIUM_SOCKET,
    EXTERIOR_SOCKET,
    EXTERIOR_TRANSMITTANCE_SOCKET,
    FACTS_PANEL,
    FOREIGN_SOCKET,
    GIVES_BACK_SOCKET,
    MASK_OUTPUT,
    MEANS_SOCKET,
    NATIVE_SOCKET,
    OVERLAP_SOCKET,
    PREVIEW_OUTPUT,
    SCENE_SOCKET,
    SLOTS_SOCKET,
    SOLE_PRIORITY_SOCKET,
    TABLE_SOCKET,
    VOLUME_OUTPUT,
)
from .shader_nodes import SOCKET_TYPES

NODE_WIDTH = 320
"""Width of the group's node, which takes the longest name of a socket beside its value."""

FACT_OUTPUTS = {
    "Surface Exists": (
        "FLOAT",
        "1 where the surface parts two media, 0 inside one that wins: a mask for dirt and labels",
    ),
    "Is Entrance": ("FLOAT", "1 where light from the air meets the medium"),
    "Is Exit": ("FLOAT", "1 where light from the medium meets the air"),
    "Priority Inside": ("FLOAT", "Of the object itself"),
    "Priority Outside": ("FLOAT", "Of the medium that touches the object here; -1 in air, and where no surface exists"),
    "Arriving Light": (
        "COLOR",
        "What the medium that the ray crossed has left of its light: a factor on what is mixed in",
    ),
}
"""Outputs for nodes of the artist's own: kinds and descriptions. The shader's names are the same without spaces."""

CLEAR = (1.0, 1.0, 1.0, 1.0)

EXTERIOR_VALUES = ("IOR", "Transmittance", "Transmittance Depth")

ANALYSIS_SOCKETS = {
    SCENE_SOCKET: (
        "",
        "INT",
        NO_SCENE,
        "Number of the scene that was analysed; in any other the scene is asked",
    ),
    EXTERIOR_SOCKET: (
        "Exterior",
        "INT",
        Exterior.UNKNOWN,
        "What lies outside: 0 the scene is asked, 1 air, 2 the surroundings below, 3 a winner, 5 each object tells",
    ),
    SOLE_PRIORITY_SOCKET: (
        "ExteriorSolePriority",
        "FLOAT",
        NO_SOLE_PRIORITY,
        "The only priority around, whose nearest surface decides; below 0 there may be more",
    ),
    OVERLAP_SOCKET: ("OverlapsItself", "BOOL", False, "Objects that overlap themselves are one body"),
    FOREIGN_SOCKET: ("MayHoldObjects", "BOOL", True, "Objects that are no media may stand in the media"),
    EXTERIOR_MEDIUM_SOCKET: (
        "ExteriorMedium",
        "VECTOR",
        AIR_AROUND,
        "Priority, IOR and Transmittance Depth of the medium outside",
    ),
    EXTERIOR_TRANSMITTANCE_SOCKET: (
        "ExteriorTransmittance",
        "COLOR",
        CLEAR,
        "Transmittance of the medium outside",
    ),
    BY_VOLUME_SOCKET: (
        "",
        "INT",
        NO_SCENE,
        "The material's volume absorbs for all rays in the scene of this number",
    ),
    GIVES_BACK_SOCKET: (
        "",
        "BOOL",
        False,
        "Media that this one wins over absorb by their volumes; it gives back what they take inside it",
    ),
    SLOTS_SOCKET: (
        "",
        "INT",
        MATERIAL_SLOTS,
        "Slots of an object in which others may find the material: 1 where all of its objects have no more",
    ),
}
"""The shader's name (empty where it reads none), kind, default and description of what an analysis stores of all objects of a
material.
"""


@cache
def input_types() -> dict[str, str]:
    kinds = {parameter.name: parameter.kind for parameter in SOCKETS}
    kinds |= {name: kind for name, (_, kind, *_) in ANALYSIS_SOCKETS.items()}
    kinds |= {TABLE_SOCKET: "INT", MEANS_SOCKET: "VECTOR", NATIVE_SOCKET: "BOOL"}
    return {name: SOCKET_TYPES[kind] for name, kind in kinds.items()}


def has_analysis(node: bpy.types.ShaderNodeGroup) -> bool:
    """Return whether a material's group node can be told what surrounds it; those of older versions cannot."""
    return all(name in node.inputs for name in ANALYSIS_SOCKETS)


def hide_internal_sockets(node: bpy.types.ShaderNodeGroup) -> None:
    """Hide the sockets of a node that the extension sets; leave those that are an artist's."""
    for name in (*ANALYSIS_SOCKETS, TABLE_SOCKET, MEANS_SOCKET, NATIVE_SOCKET):
        node.inputs[name].hide = True


def add_sockets(tree: bpy.types.NodeTree) -> None:
    """Add the sockets of the group, in the order of their numbers (``Socket_5``), by which keyframes know them."""
    interface = tree.interface
    interface.new_socket(
        CYCLES_OUTPUT, in_out="OUTPUT", socket_type="NodeSocketShader", description="The dielectric, for Cycles"
    )
    interface.new_socket(
        VOLUME_OUTPUT,
        in_out="OUTPUT",
        socket_type="NodeSocketShader",
        description="Absorption; where others win over the medium that of light that comes straight from the camera or "
        "from an object inside",
    )
    interface.new_socket(
        PREVIEW_OUTPUT, in_out="OUTPUT", socket_type="NodeSocketShader", description="The dielectric, for EEVEE"
    )
    panels: dict[str, bpy.types.NodeTreeInterfacePanel] = {}
    for parameter in SOCKETS:
        if parameter.panel not in panels:
            panels[parameter.panel] = interface.new_panel(parameter.panel, default_closed=True)
        socket = interface.new_socket(
            parameter.name,
            in_out="INPUT",
            socket_type=SOCKET_TYPES[parameter.kind],
            parent=panels[parameter.panel],
            description=parameter.description,
        )
        _set_limits(socket, parameter)
    _add_analysis_sockets(interface)
    table = interface.new_socket(
        TABLE_SOCKET,
        in_out="INPUT",
        socket_type="NodeSocketInt",
        parent=panels["Dispersion"],
        description="Row of the material's spectral table among this file's; set by the Spectrum in the sidebar",
    )
    table.min_value = 0
    means = interface.new_socket(
        MEANS_SOCKET,
        in_out="INPUT",
        socket_type="NodeSocketVector",
        parent=panels["Dispersion"],
        description="Where red, green and blue of that table have their mean index of refraction; set with it",
    )
    table.hide_value = means.hide_value = True
    _add_fact_sockets(interface)
    _add_native_socket(interface)
    _put_basics_first(interface, panels[BASICS])


def _put_basics_first(interface: bpy.types.NodeTreeInterface, panel: bpy.types.NodeTreeInterfacePanel) -> None:
    """Move the basic sockets to the front, after all are made: keyframes know sockets by the order in which they are made."""
    for place, keyword in enumerate(BASIC_KEYWORDS):
        interface.move(interface.items_tree[BY_KEYWORD[keyword].name], place)
    interface.remove(panel, move_content_to_parent=True)


def _add_fact_sockets(interface: bpy.types.NodeTreeInterface) -> None:
    """Add outputs of facts last: an exchange of groups that number the other sockets otherwise loses their keyframes."""
    panel = interface.new_panel(
        FACTS_PANEL, default_closed=True, description="What the surface knows, for your own nodes; free unless used"
    )
    for name, (kind, description) in FACT_OUTPUTS.items():
        interface.new_socket(
            name, in_out="OUTPUT", socket_type=SOCKET_TYPES[kind], parent=panel, description=description
        )
    mask = interface.new_socket(
        MASK_OUTPUT,
        in_out="OUTPUT",
        socket_type="NodeSocketFloat",
        description="1 where the medium fills a point, 0 where another wins: for the density of a volume of your own",
    )
    interface.move(mask, len((CYCLES_OUTPUT, VOLUME_OUTPUT, PREVIEW_OUTPUT)))


def _add_native_socket(interface: bpy.types.NodeTreeInterface) -> None:
    """Add the socket of the native body after all others, whose numbers stay."""
    socket = interface.new_socket(
        NATIVE_SOCKET,
        in_out="INPUT",
        socket_type="NodeSocketBool",
        parent=interface.items_tree[ANALYSIS_PANEL],
        description="Cycles' own nodes render the material, rather than the shader; set by Render With",
    )
    socket.hide_value = True


def _add_analysis_sockets(interface: bpy.types.NodeTreeInterface) -> None:
    """Add sockets of what the analysis stores of all objects of a material; defaults say nothing, and hold everywhere."""
    panel = interface.new_panel(
        ANALYSIS_PANEL,
        default_closed=True,
        description="Which media the objects of this material touch; kept by the extension, spares rays",
    )
    for name, (_, kind, default, description) in ANALYSIS_SOCKETS.items():
        socket = interface.new_socket(
            name, in_out="INPUT", socket_type=SOCKET_TYPES[kind], parent=panel, description=description
        )
        socket.default_value = default
        socket.hide_value = True


def _set_limits(socket: bpy.types.NodeTreeInterfaceSocket, parameter: Parameter) -> None:
    """Give a socket the limits, the unit and the default of its parameter."""
    if parameter.kind in ("INT", "FLOAT"):
        socket.subtype = parameter.unit or "NONE"
        socket.min_value = parameter.minimum
        socket.max_value = parameter.maximum
        socket.default_value = parameter.default
    elif parameter.kind == "BOOL":
        socket.default_value = parameter.default
    elif parameter.kind == "COLOR":
        socket.default_value = (*parameter.default, 1.0)
    elif parameter.kind == "INDEX":
        words = [choice.keyword for choice in parameter.choices]
        socket.min_value, socket.max_value = 0, len(words) - 1
        socket.default_value = words.index(parameter.default)
    elif parameter.kind == "VECTOR" and parameter.unit == "DIRECTION":
        socket.subtype = parameter.unit
        socket.hide_value = True
    elif parameter.kind == "VECTOR":
        socket.min_value = parameter.minimum
        socket.max_value = parameter.maximum
        socket.default_value = parameter.default
