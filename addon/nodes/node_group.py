"""The node group `Nested Dielectric`: sockets for artists, the OSL shader inside, and a look for EEVEE."""

from __future__ import annotations

import hashlib
import tempfile
from dataclasses import dataclass
from functools import cache, partial
from math import e
from pathlib import Path

import bpy
import numpy as np

from ..geometry.contacts import BY_OBJECT, PROBE
from ..model.dispersion import mean_cauchy_distances
from ..model.parameters import (
    BASIC_KEYWORDS,
    BASICS,
    BY_KEYWORD,
    GROUP_NAME,
    NEIGHBOUR_PARAMETERS,
    PRIORITY_PROPERTY,
    SOCKETS,
    Parameter,
)
from ..model.shader_source import inlined_source
from .compatibility import FRONT_IOR_SIGNS, UnsupportedError
from .identity import NO_SCENE, SCENE_PROPERTY
from .lookups import looked_up_once
from .native_nodes import NATIVE_GROUP, NativeBody
from .preview_nodes import Preview
from .shader_nodes import (
    SOCKET_TYPES,
    Part,
    bounded,
    lazily,
    math_node,
    mix_shaders,
    mix_values,
    vector_math,
    view_layer_attribute,
)
from .spectral_images import ensure_row, holds, read_rows

SHADER_FILE = "nested_dielectric.osl"
COORDINATE_FILE = "spectral_coordinate.osl"
LIGHT_FILE = "light.osl"
MASK_FILE = "volume_mask.osl"
MATERIAL_SLOTS = 8
"""As in osl/medium.h: slots of an object in which neighbours look for its dielectric."""

NODE_WIDTH = 320
"""Of the group's node: the longest name of a socket beside its value."""

CYCLES_OUTPUT = "Surface"
VOLUME_OUTPUT = "Volume"
PREVIEW_OUTPUT = "Preview"
FACTS_PANEL = "Facts"

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
MASK_OUTPUT = "Volume Mask"

MATERIAL_VERSION = 3
"""Of the group and of all that stands in a file with it. A release that changes any of it counts on."""

FRONT_IOR_VERSION = 2
"""The first whose shader knows both ways in which Cycles' closures take an index."""

DAMAGED = 0
"""Version of a group that nobody can tell by its number, its nodes or its sockets any more."""

VERSION_PROPERTY = "nd_version"
SOURCE_HASH = "nd_source"
"""What groups of version 1 carry instead of a number."""

LIGHTS_NAME = "Nested Dielectric Lights"
LIGHTS_VERSION_PROPERTY = "nd_lights_version"
LAMP_OUTPUTS = {"Kind": "FLOAT", "Total": "FLOAT"} | dict.fromkeys(
    ("Centre", "Axis", "EdgeX", "EdgeY", "Shape", "Strength", "Carried"), "VECTOR"
)
EMITTER_OUTPUT = "Emitter"
LAMPS_OUTPUT = "Lamps"
"""Outputs of the group of the scene's lamps: one that was drawn, as osl/light.osl has it, a weak emission, and how
many lamps there are.
"""

_LIGHTS_OUTPUTS = LAMP_OUTPUTS | {EMITTER_OUTPUT: "SHADER", LAMPS_OUTPUT: "INT"}

ANALYSED = "nd_analysed"
"""Custom property of a scene whose media are kept analysed: what holds of its analysis, :class:`Validity`."""

TOLD_SCENE = "nd_told"
"""Another: its number, where what media were told holds on every frame as far as anybody knows. Cycles' own nodes go by it: they
cannot ask where it does not.
"""

CUT = "nd_cut"
"""Custom property of a scene that shows surfaces which are cut where media cross, and attribute of the faces of those."""

CUT_PRIORITY, CUT_TINT, CUT_DEPTH, CUT_BY_VOLUME, CUT_CURVE, CUT_SELLMEIER_B, CUT_SELLMEIER_C = (
    f"nd_cut_{name}" for name in ("priority", "tint", "depth", "by_volume", "curve", "sellmeier_b", "sellmeier_c")
)
CUT_ATTRIBUTES = (CUT, CUT_PRIORITY, CUT_TINT, CUT_DEPTH, CUT_BY_VOLUME, CUT_CURVE, CUT_SELLMEIER_B, CUT_SELLMEIER_C)
"""Of faces that are cut: what lies outside them, as in osl/cut.h."""

ANALYSIS_PANEL = "Scene Analysis"
SCENE_SOCKET = "Analysed Scene"
OUTSIDE_SOCKET = "Outside"
LEVEL_SOCKET = "Outside Priority"
OVERLAP_SOCKET = "Overlaps Itself"
FOREIGN_SOCKET = "Foreign Objects"
BY_VOLUME_SOCKET = "Absorbs by Volume"
GIVES_BACK_SOCKET = "Gives Back"
SURROUNDINGS_SOCKET = "Surroundings"
SURROUNDINGS_COLOR_SOCKET = "Surroundings Transmittance"
SLOTS_SOCKET = "Material Slots"
NATIVE_SOCKET = "Native"
"""Input of the group: Cycles' own nodes render the material, not the shader."""

AIR_AROUND = (0.0, 1.0, 0.0)
"""Priority, IOR and Transmittance Depth of surroundings that are told to nobody."""

CLEAR = (1.0, 1.0, 1.0, 1.0)
OFFSET_GROUP = "Nested Dielectric Offset"
OFFSET_ATTRIBUTE = "nd_offset"
"""Of a mesh's points: by how much the modifier with that group moves them, in the object's own space. Objects that share the
mesh and are moved by something else have one of the same name and a number.
"""

ATTRIBUTE_SOCKET = "Attribute"
"""Input of that modifier: the name of the attribute; empty stands for OFFSET_ATTRIBUTE."""

NEIGHBOUR_VALUES = ("IOR", "Transmittance", "Transmittance Depth")
OBJECT_PROPERTIES = ("nd_outside", "nd_outside_transmittance")
"""Where objects keep what a scene's analysis tells of them, four floats to a property."""

TABLE_SOCKET = "Spectral Table"
MEANS_SOCKET = "Spectral Table Means"
SHADER_NODE = "Nested Dielectric Shader"
TABLES_NODE = "Spectral Tables"
COORDINATE_NODE = "Spectral Coordinate"
ROW_OUTPUT = "Row"
FRAME_NODE = "Frame"
FRAME_PATH, TIMED_FRAME_PATH = "frame_float", "frame_current"
"""Both are the number of the frame; by the other one the depsgraph knows that a material depends on it."""

DISPERSER_NODE = "Cycles Dispersion"

_ANALYSIS_SOCKETS = {
    SCENE_SOCKET: (
        "",
        "INT",
        NO_SCENE,
        "Number of the scene that was analysed; in any other the scene is asked",
    ),
    OUTSIDE_SOCKET: (
        "Around",
        "INT",
        PROBE,
        "What lies outside: 0 the scene is asked, 1 air, 2 the surroundings below, 3 a winner, 5 each object tells",
    ),
    LEVEL_SOCKET: (
        "AroundLevel",
        "FLOAT",
        -1.0,
        "The only priority around, whose nearest surface decides; below 0 there may be more",
    ),
    OVERLAP_SOCKET: ("OverlapsItself", "BOOL", False, "Objects that overlap themselves are one body"),
    FOREIGN_SOCKET: ("ForeignNear", "BOOL", True, "Objects that are no media may stand in the media"),
    SURROUNDINGS_SOCKET: (
        "AroundMedium",
        "VECTOR",
        AIR_AROUND,
        "Priority, IOR and Transmittance Depth of the medium outside",
    ),
    SURROUNDINGS_COLOR_SOCKET: (
        "AroundTransmittance",
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
"""The shader's name (empty where it reads none), kind, default and description of what an analysis tells all objects of a
material.
"""


def ensure_group() -> bpy.types.NodeTree:
    """Return this file's group of this version, made on first use.

    A group of another version is left to the materials that use it. Raises
    :class:`~nested_dielectric.compatibility.UnsupportedError` when this Blender compiles no OSL; nothing has been made
    then.
    """
    found = find_group()
    if found is not None:
        return found
    scripts = {name: make_script(name, inlined_source(name)) for name in (SHADER_FILE, COORDINATE_FILE, MASK_FILE)}
    tree = bpy.data.node_groups.new(GROUP_NAME, "ShaderNodeTree")
    tree[VERSION_PROPERTY] = MATERIAL_VERSION
    tree.description = "A dielectric that knows the media it touches"
    tree.default_group_node_width = NODE_WIDTH
    _add_sockets(tree)
    _add_nodes(tree, scripts)
    return tree


def find_group() -> bpy.types.NodeTree | None:
    """Return this file's group of this version, or None if there is none yet."""
    groups = (tree for tree in bpy.data.node_groups if tree.library is None)
    return next((tree for tree in groups if group_version(tree) == MATERIAL_VERSION), None)


@looked_up_once
def group_version(tree: bpy.types.NodeTree | None) -> int | None:
    """Return which version of the material a group is, :data:`DAMAGED` if others have taken from it what it needs, or
    None if it is another group.
    """
    if tree is None or tree.bl_idname != "ShaderNodeTree":
        return None
    version = tree.get(VERSION_PROPERTY, 1 if SOURCE_HASH in tree else None)
    if version == MATERIAL_VERSION:
        return version if _is_whole(tree) else DAMAGED
    if isinstance(version, int) and version > DAMAGED:
        return version
    return None if version is None and SHADER_NODE not in tree.nodes else DAMAGED


def _is_whole(tree: bpy.types.NodeTree) -> bool:
    """Whether a group has the nodes and sockets that Python looks for in it, and its shaders."""
    kinds = {
        SHADER_NODE: "SCRIPT",
        COORDINATE_NODE: "SCRIPT",
        TABLES_NODE: "TEX_IMAGE",
        LIGHTS_NAME: "GROUP",
        DISPERSER_NODE: "BSDF_PRINCIPLED",
        NATIVE_GROUP: "GROUP",
    }
    for name, kind in kinds.items():
        node = tree.nodes.get(name)
        if node is None or node.type != kind:
            return False
        if kind == "SCRIPT" and (node.mode != "INTERNAL" or not node.bytecode_hash):
            return False
    if tree.nodes[LIGHTS_NAME].node_tree is None or tree.nodes[NATIVE_GROUP].node_tree is None:
        return False
    sockets = {
        item.name: item.socket_type
        for item in tree.interface.items_tree
        if item.item_type == "SOCKET" and item.in_out == "INPUT"
    }
    return all(sockets.get(name) == kind for name, kind in _input_types().items())


@cache
def _input_types() -> dict[str, str]:
    kinds = {parameter.name: parameter.kind for parameter in SOCKETS}
    kinds |= {name: kind for name, (_, kind, *_) in _ANALYSIS_SOCKETS.items()}
    kinds |= {TABLE_SOCKET: "INT", MEANS_SOCKET: "VECTOR", NATIVE_SOCKET: "BOOL"}
    return {name: SOCKET_TYPES[kind] for name, kind in kinds.items()}


@dataclass(frozen=True)
class Script:
    """A shader's file name, source and bytecode."""

    name: str
    source: str
    bytecode: str

    def text(self) -> bpy.types.Text:
        """The source as a text of this file, made on first use."""
        for text in bpy.data.texts:
            if text.name.startswith(self.name) and text.as_string() == self.source:
                return text
        text = bpy.data.texts.new(self.name)
        text.from_string(self.source)
        return text


def make_script(name: str, source: str) -> Script:
    """Compile a shader; raises as :func:`compiled` does."""
    return Script(name, source, compiled(source))


def hide_internals(node: bpy.types.ShaderNodeGroup) -> None:
    """Leave the sockets on a node that are an artist's, not those that the extension sets."""
    for name in (*_ANALYSIS_SOCKETS, TABLE_SOCKET, MEANS_SOCKET, NATIVE_SOCKET):
        node.inputs[name].hide = True


def has_analysis(node: bpy.types.ShaderNodeGroup) -> bool:
    """Whether a material's group node can be told what surrounds it; those of older versions cannot."""
    return all(name in node.inputs for name in _ANALYSIS_SOCKETS)


def is_offset_group(tree: bpy.types.NodeTree | None) -> bool:
    """Tell whether a group does nothing but move points by an attribute that its modifier names, or in files of older
    versions by :data:`OFFSET_ATTRIBUTE`, whatever its name.
    """
    if tree is None or tree.bl_idname != "GeometryNodeTree":
        return False
    nodes = {node.bl_idname: node for node in tree.nodes if not node.mute}
    attribute = nodes.get("GeometryNodeInputNamedAttribute")
    if len(nodes) != len(tree.nodes) or attribute is None or attribute.data_type != "FLOAT_VECTOR":
        return False
    ways = {(link.from_node.bl_idname, link.to_node.bl_idname, link.to_socket.name) for link in tree.links}
    if attribute.inputs["Name"].is_linked:
        return ways == _OFFSET_WAYS | _NAME_WAYS
    return ways == _OFFSET_WAYS and attribute.inputs["Name"].default_value == OFFSET_ATTRIBUTE


_OFFSET_WAYS = {
    ("NodeGroupInput", "GeometryNodeSetPosition", "Geometry"),
    ("GeometryNodeInputNamedAttribute", "GeometryNodeSetPosition", "Offset"),
    ("GeometryNodeSetPosition", "NodeGroupOutput", "Geometry"),
}
_NAME_WAYS = {
    ("NodeGroupInput", "FunctionNodeCompare", "A"),
    ("FunctionNodeCompare", "GeometryNodeSwitch", "Switch"),
    ("NodeGroupInput", "GeometryNodeSwitch", "False"),
    ("GeometryNodeSwitch", "GeometryNodeInputNamedAttribute", "Name"),
}
"""Links of the group: nodes, and the socket that each leads into."""


def find_lights() -> bpy.types.NodeTree | None:
    """Return this file's group of the scene's lamps, or None if there is none yet."""
    found = [tree for tree in bpy.data.node_groups if tree.library is None and _lists_lamps(tree)]
    return next((tree for tree in found if tree.name == LIGHTS_NAME), found[0] if found else None)


def _lists_lamps(tree: bpy.types.NodeTree) -> bool:
    """Whether a group is one of the scene's lamps, whatever its name."""
    return tree.bl_idname == "ShaderNodeTree" and all(
        getattr(tree.interface.items_tree.get(name), "socket_type", "") == SOCKET_TYPES[kind]
        for name, kind in _LIGHTS_OUTPUTS.items()
    )


def ensure_lights() -> bpy.types.NodeTree:
    """Return this file's group of the scene's lamps, made empty on first use."""
    tree = find_lights()
    if tree is None:
        tree = bpy.data.node_groups.new(LIGHTS_NAME, "ShaderNodeTree")
        tree[LIGHTS_VERSION_PROPERTY] = MATERIAL_VERSION
        tree.description = "Lights that direct refraction and direct reflection carry; made by Prepare"
        for name, kind in _LIGHTS_OUTPUTS.items():
            tree.interface.new_socket(name, in_out="OUTPUT", socket_type=SOCKET_TYPES[kind])
        tree.nodes.new("NodeGroupOutput")
    return tree


def table_row(tree: bpy.types.NodeTree, table: np.ndarray) -> int:
    """Return the row of a spectral table in the group's image, where it is put on first use."""
    node = tree.nodes[TABLES_NODE]
    node.image, row = ensure_row(node.image, table)
    tree.nodes[COORDINATE_NODE].inputs["Tables"].default_value = node.image.size[1]
    return row


def uses_table(node: bpy.types.ShaderNodeGroup, table: np.ndarray) -> bool:
    """Whether a material's group node uses this very spectral table."""
    image = node.node_tree.nodes[TABLES_NODE].image
    row = node.inputs[TABLE_SOCKET].default_value
    count = node.node_tree.nodes[COORDINATE_NODE].inputs["Tables"].default_value
    means = np.float32(mean_cauchy_distances(table))
    return (
        holds(image, row, table)
        and count == image.size[1]
        and np.array_equal(np.float32(node.inputs[MEANS_SOCKET].default_value), means)
    )


def table_of(node: bpy.types.ShaderNodeGroup) -> np.ndarray | None:
    """Return the spectral table that a material's group node uses, or None if its file has lost it."""
    holder = node.node_tree.nodes.get(TABLES_NODE)
    rows = read_rows(getattr(holder, "image", None))
    if rows is None or TABLE_SOCKET not in node.inputs:
        return None
    return rows[min(max(node.inputs[TABLE_SOCKET].default_value, 0), len(rows) - 1)]


def set_table(node: bpy.types.ShaderNodeGroup, table: np.ndarray) -> None:
    """Make a material's group node use a spectral table."""
    node.inputs[TABLE_SOCKET].default_value = table_row(node.node_tree, table)
    node.inputs[MEANS_SOCKET].default_value = mean_cauchy_distances(table)


def _add_sockets(tree: bpy.types.NodeTree) -> None:
    interface = tree.interface
    interface.new_socket(
        CYCLES_OUTPUT, in_out="OUTPUT", socket_type="NodeSocketShader", description="The dielectric, for Cycles"
    )
    interface.new_socket(
        VOLUME_OUTPUT,
        in_out="OUTPUT",
        socket_type="NodeSocketShader",
        description="Absorption; where others win over the medium that of light that comes straight from the camera or from an object inside",
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
    """Moved after all have been made: what keyframes know sockets by is the order in which they are made."""
    for place, keyword in enumerate(BASIC_KEYWORDS):
        interface.move(interface.items_tree[BY_KEYWORD[keyword].name], place)
    interface.remove(panel, move_content_to_parent=True)


def _add_fact_sockets(interface: bpy.types.NodeTreeInterface) -> None:
    """Made last: keyframes of the other sockets are lost in an exchange of groups that number these otherwise."""
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
    """Made after all others, whose numbers stay."""
    socket = interface.new_socket(
        NATIVE_SOCKET,
        in_out="INPUT",
        socket_type="NodeSocketBool",
        parent=interface.items_tree[ANALYSIS_PANEL],
        description="Cycles' own nodes render the material, rather than the shader; set by Render With",
    )
    socket.hide_value = True


def _add_analysis_sockets(interface: bpy.types.NodeTreeInterface) -> None:
    """What the analysis of the scene tells of all objects of a material; defaults tell nothing, and hold everywhere."""
    panel = interface.new_panel(
        ANALYSIS_PANEL,
        default_closed=True,
        description="Which media the objects of this material touch; kept by the extension, spares rays",
    )
    for name, (_, kind, default, description) in _ANALYSIS_SOCKETS.items():
        socket = interface.new_socket(
            name, in_out="INPUT", socket_type=SOCKET_TYPES[kind], parent=panel, description=description
        )
        socket.default_value = default
        socket.hide_value = True


def _set_limits(socket: bpy.types.NodeTreeInterfaceSocket, parameter: Parameter) -> None:
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


def _add_nodes(tree: bpy.types.NodeTree, scripts: dict[str, Script]) -> None:
    nodes, links = tree.nodes, tree.links
    inputs = nodes.new("NodeGroupInput")
    outputs = nodes.new("NodeGroupOutput")
    kinds = {
        parameter.osl_name: "INT" if parameter.kind in ("MENU", "BOOL") else parameter.kind for parameter in SOCKETS
    }
    told = {osl_name: (name, kind) for name, (osl_name, kind, *_) in _ANALYSIS_SOCKETS.items() if osl_name}
    kinds |= {osl_name: "INT" if kind == "BOOL" else kind for osl_name, (_, kind) in told.items()}
    kinds |= {
        "AnalysedScene": "INT",
        "AnalysisHolds": "INT",
        "ByVolume": "INT",
        "Cut": "INT",
        "GivesBack": "INT",
        "Requests": "COLOR",
        "FrontIOR": "INT",
        "CountsPortals": "SHADER",
        "Disperses": "SHADER",
        "Emitter": "SHADER",
        "Lamps": "INT",
        **{f"Lamp{name}": kind for name, kind in LAMP_OUTPUTS.items()},
        "Spectral": "INT",
        "Table": "INT",
        "TableMeans": "VECTOR",
        "Weight": "COLOR",
        "Wavelength": "FLOAT",
    }
    script = add_script(
        tree,
        SHADER_NODE,
        scripts[SHADER_FILE],
        kinds,
        {"BSDF": "SHADER", "Running": "FLOAT"}
        | {name.replace(" ", ""): kind for name, (kind, _) in FACT_OUTPUTS.items()},
    )

    menus = {}
    for parameter in SOCKETS:
        source = inputs.outputs[parameter.name]
        if parameter.kind == "MENU":
            source = menus[parameter.name] = _menu(tree, source, parameter)
        links.new(source, script.inputs[parameter.osl_name])
    for osl_name, (name, _) in told.items():
        links.new(inputs.outputs[name], script.inputs[osl_name])
    spectral = view_layer_attribute(tree, "render.use_motion_blur").outputs["Fac"]
    coefficients, absorbs = _absorption_coefficients(tree, inputs)
    front_ior = _takes_front_ior(tree)
    split_by_closures = math_node(tree, "MULTIPLY", inputs.outputs["Disperse"], front_ior)
    curves_matter = math_node(tree, "MAXIMUM", spectral, split_by_closures)
    scene = _analysed_scene(tree)
    links.new(scene, script.inputs["AnalysedScene"])
    analysis_holds = math_node(tree, "COMPARE", scene, inputs.outputs[SCENE_SOCKET], 0.5)
    links.new(analysis_holds, script.inputs["AnalysisHolds"])
    by_volume = math_node(tree, "COMPARE", scene, inputs.outputs[BY_VOLUME_SOCKET], 0.5)
    links.new(by_volume, script.inputs["ByVolume"])
    chosen = inputs.outputs[NATIVE_SOCKET]
    told_scene = view_layer_attribute(tree, f'["{TOLD_SCENE}"]').outputs["Fac"]
    natives_by_volume = math_node(tree, "COMPARE", told_scene, inputs.outputs[BY_VOLUME_SOCKET], 0.5)
    by_volume = lazily(tree, "FLOAT", chosen, by_volume, natives_by_volume)
    gives_back = math_node(tree, "MULTIPLY", inputs.outputs[GIVES_BACK_SOCKET], analysis_holds)
    links.new(gives_back, script.inputs["GivesBack"])
    cut = view_layer_attribute(tree, f'["{CUT}"]').outputs["Fac"]
    links.new(cut, script.inputs["Cut"])
    links.new(_requests(tree, inputs, curves_matter, absorbs, analysis_holds, cut), script.inputs["Requests"])
    links.new(spectral, script.inputs["Spectral"])
    links.new(front_ior, script.inputs["FrontIOR"])
    table = inputs.outputs[TABLE_SOCKET]
    tables = _spectral_tables(tree, table, scripts[COORDINATE_FILE])
    links.new(tree.nodes[COORDINATE_NODE].outputs[ROW_OUTPUT], script.inputs["Table"])
    links.new(inputs.outputs[MEANS_SOCKET], script.inputs["TableMeans"])
    links.new(tables.outputs["Color"], script.inputs["Weight"])
    links.new(tables.outputs["Alpha"], script.inputs["Wavelength"])

    lights = nodes.new("ShaderNodeGroup")
    lights.node_tree = ensure_lights()
    lights.name = lights.label = LIGHTS_NAME
    for name in LAMP_OUTPUTS:
        links.new(lights.outputs[name], script.inputs[f"Lamp{name}"])
    for name in (EMITTER_OUTPUT, LAMPS_OUTPUT):
        links.new(lights.outputs[name], script.inputs[name])

    links.new(nodes.new("ShaderNodeBsdfRayPortal").outputs[0], script.inputs["CountsPortals"])
    links.new(_disperser(tree, inputs), script.inputs["Disperses"])
    known = (
        {name: inputs.outputs[name] for name in inputs.outputs.keys() if name}
        | menus
        | {
            "Scene": told_scene,
            "Holds": math_node(tree, "COMPARE", told_scene, inputs.outputs[SCENE_SOCKET], 0.5),
            "By Volume": by_volume,
            "Cut": cut,
        }
    )
    body = NativeBody()
    native = _add_part(tree, NATIVE_GROUP, body, known)
    by_shader = mix_shaders(tree, script.outputs["Running"], native["Surface"], script.outputs["BSDF"])
    links.new(lazily(tree, "SHADER", chosen, by_shader, native["Surface"]), outputs.inputs[CYCLES_OUTPUT])

    of_shadows = lazily(tree, "FLOAT", chosen, 0.0, native["Shadow by Volume"])
    links.new(_absorption(tree, coefficients, absorbs, by_volume, of_shadows), outputs.inputs[VOLUME_OUTPUT])

    mask = add_script(tree, "Volume Mask", scripts[MASK_FILE], {"Priority": "INT"}, {"Mask": "FLOAT"})
    links.new(inputs.outputs["Priority"], mask.inputs["Priority"])
    links.new(mask.outputs["Mask"], outputs.inputs[MASK_OUTPUT])

    preview = _add_part(tree, PREVIEW_OUTPUT, Preview(body.surroundings, body.coefficients), known)
    links.new(preview[PREVIEW_OUTPUT], outputs.inputs[PREVIEW_OUTPUT])
    for name, (kind, _) in FACT_OUTPUTS.items():
        kind = "RGBA" if kind == "COLOR" else kind
        by_shader = mix_values(
            tree, kind, script.outputs["Running"], native[name], script.outputs[name.replace(" ", "")]
        )
        links.new(lazily(tree, kind, chosen, by_shader, native[name]), outputs.inputs[name])
    _arrange(tree)


def _add_part(
    tree: bpy.types.NodeTree, name: str, part: Part, known: dict[str, bpy.types.NodeSocket]
) -> bpy.types.NodeOutputs:
    """The outputs of a part, which finds what it asks for by name."""
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = part.tree
    node.name = node.label = name
    for asked in part.asked:
        tree.links.new(known[asked], node.inputs[asked])
    return node.outputs


def add_script(
    tree: bpy.types.NodeTree, name: str, script: Script, inputs: dict[str, str], outputs: dict[str, str]
) -> bpy.types.ShaderNodeScript:
    """A Script node with the compiled shader in it, where it stays with the file, and with its sockets.

    Cycles adds both by itself when the scene's engine is Cycles and its own helper modules can be imported; under the
    wheel or another engine it does neither.
    """
    node = tree.nodes.new("ShaderNodeScript")
    node.name = node.label = name
    node.mode = "INTERNAL"
    node.script = script.text()
    node.bytecode = script.bytecode
    node.bytecode_hash = hashlib.md5(script.bytecode.encode(), usedforsecurity=False).hexdigest()
    for sockets, kinds in ((node.inputs, inputs), (node.outputs, outputs)):
        for socket, kind in kinds.items():
            _ensure_socket(sockets, kind, socket)
    return node


def _spectral_tables(
    tree: bpy.types.NodeTree, table: bpy.types.NodeSocket, script: Script
) -> bpy.types.ShaderNodeTexImage:
    """The image of spectral tables, read where the path's wavelength stands in it.

    Linear interpolation makes the spectrum continuous and keeps every table's mean, because the edges are extended.
    """
    nodes, links = tree.nodes, tree.links
    shutter = view_layer_attribute(tree, "render.motion_blur_shutter")
    coordinate = add_script(
        tree,
        COORDINATE_NODE,
        script,
        {"Table": "INT", "Tables": "INT", "Shutter": "COLOR"},
        {"Coordinate": "VECTOR", ROW_OUTPUT: "INT"},
    )
    links.new(table, coordinate.inputs["Table"])
    links.new(shutter.outputs["Color"], coordinate.inputs["Shutter"])
    image = nodes.new("ShaderNodeTexImage")
    image.name = image.label = TABLES_NODE
    image.interpolation = "Linear"
    image.extension = "EXTEND"
    links.new(coordinate.outputs["Coordinate"], image.inputs["Vector"])
    return image


def _analysed_scene(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
    """The number of the scene that is rendered if what its materials keep of an analysis holds on this frame, else below 0.

    Scripts may change a scene on every frame, and while the shutter is open: then it holds on the frame that was looked at,
    if nothing blurs. Simplify may change every shape.
    """
    math = partial(math_node, tree)
    number = view_layer_attribute(tree, f'["{SCENE_PROPERTY}"]').outputs["Fac"]
    validity = tree.nodes.new("ShaderNodeSeparateColor")
    tree.links.new(view_layer_attribute(tree, f'["{ANALYSED}"]').outputs["Color"], validity.inputs[0])
    analysed, frame, every_frame = validity.outputs
    frame_now, blurs, shutter, simplified = (
        view_layer_attribute(tree, path)
        for path in (FRAME_PATH, "render.use_motion_blur", "render.motion_blur_shutter", "render.use_simplify")
    )
    frame_now.name = FRAME_NODE
    frame_now, blurs, shutter, simplified = (node.outputs["Fac"] for node in (frame_now, blurs, shutter, simplified))
    this_frame = math("COMPARE", frame_now, frame, 0.5)
    still = math("LESS_THAN", math("MULTIPLY", blurs, shutter), 1e-6)
    moment = math("MAXIMUM", every_frame, math("MULTIPLY", this_frame, still))
    shapes = math("SUBTRACT", analysed, simplified)
    holds = math("GREATER_THAN", math("MULTIPLY", moment, shapes), 0.5)
    return math("SUBTRACT", math("MULTIPLY", holds, math("ADD", number, 1.0)), 1.0)


def follow_frames(follow: bool) -> None:
    """Let materials be evaluated anew on each frame, with all objects that have them, because what they are told may not hold
    there; or not.
    """
    path = TIMED_FRAME_PATH if follow else FRAME_PATH
    for tree in bpy.data.node_groups:
        if tree.get(VERSION_PROPERTY) == MATERIAL_VERSION and tree.is_editable and (node := tree.nodes.get(FRAME_NODE)):
            if node.attribute_name in (FRAME_PATH, TIMED_FRAME_PATH) and node.attribute_name != path:
                node.attribute_name = path


def _takes_front_ior(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
    """1 where Cycles' closures take an index as it is met from the front, and turn it on back faces themselves.

    A file that is rendered without the extension can only tell by what else came with that Blender: an attribute that is
    not there has an alpha of 0.
    """
    alphas = (view_layer_attribute(tree, path).outputs["Alpha"] for path in FRONT_IOR_SIGNS)
    return math_node(tree, "MAXIMUM", *alphas)


def _disperser(tree: bpy.types.NodeTree, inputs: bpy.types.Node) -> bpy.types.NodeSocket:
    """What makes Cycles split light in closures that ask for it, folded away where the medium does not disperse."""
    disperser = tree.nodes.new("ShaderNodeBsdfPrincipled")
    disperser.name = disperser.label = DISPERSER_NODE
    arm_dispersion(tree)
    return disperser.outputs[0]


def arm_dispersion(tree: bpy.types.NodeTree) -> None:
    """Let Cycles' closures split light, which Blender 5.2 and files from it do not know of."""
    socket = tree.nodes[DISPERSER_NODE].inputs.get("Transmission Dispersion Scale")
    if socket is not None and socket.default_value != 1.0:
        socket.default_value = 1.0
        tree.nodes[DISPERSER_NODE].inputs["Transmission Weight"].default_value = 1.0


def _ensure_socket(sockets: bpy.types.NodeInputs, kind: str, name: str) -> None:
    if name not in sockets:
        sockets.new(type=SOCKET_TYPES[kind], name=name, identifier=name)


def compiled(source: str) -> str:
    """Return the bytecode of an OSL shader.

    Raises :class:`~nested_dielectric.compatibility.UnsupportedError` when this Blender compiles no OSL.
    """
    import _cycles

    with tempfile.TemporaryDirectory() as folder:
        source_path, bytecode_path = Path(folder, "shader.osl"), Path(folder, "shader.oso")
        source_path.write_text(source, encoding="utf-8")
        if not (_cycles.with_osl and _cycles.osl_compile(str(source_path), str(bytecode_path))):
            raise UnsupportedError("this Blender compiles no OSL; use the build from blender.org or the bpy wheel")
        return bytecode_path.read_text(encoding="utf-8")


def _absorption_coefficients(
    tree: bpy.types.NodeTree, inputs: bpy.types.Node
) -> tuple[bpy.types.NodeSocket, bpy.types.NodeSocket]:
    """What the medium absorbs per length, and whether it absorbs at all (0 or 1)."""
    math = partial(math_node, tree)
    separate = tree.nodes.new("ShaderNodeSeparateColor")
    tree.links.new(inputs.outputs["Transmittance"], separate.inputs[0])
    total = math("ADD", math("ADD", separate.outputs[0], separate.outputs[1]), separate.outputs[2])
    low, high, default = BY_KEYWORD["transmittance"].limits
    channels = [bounded(tree, channel, total, (low, high, own)) for channel, own in zip(separate.outputs, default)]
    depth = inputs.outputs["Transmittance Depth"]
    depth = bounded(tree, depth, depth, BY_KEYWORD["transmittance_depth"].limits)
    coefficients = tree.nodes.new("ShaderNodeCombineXYZ")
    for channel, coefficient in zip(channels, coefficients.inputs):
        decay = math("MULTIPLY", math("LOGARITHM", math("MAXIMUM", channel, 1e-6), e), -1.0)
        tree.links.new(math("DIVIDE", decay, depth), coefficient)
    least = math("MINIMUM", math("MINIMUM", channels[0], channels[1]), channels[2])
    absorbs = math("MULTIPLY", math("LESS_THAN", least, 1.0), math("GREATER_THAN", depth, 0.0))
    return coefficients.outputs[0], absorbs


def _absorption(
    tree: bpy.types.NodeTree,
    coefficients: bpy.types.NodeSocket,
    absorbs: bpy.types.NodeSocket,
    by_volume: bpy.types.NodeSocket,
    of_shadows: bpy.types.NodeSocket,
) -> bpy.types.NodeSocket:
    """Absorption by Cycles' own volume: of all rays where the analysis says so (see :mod:`charging`); elsewhere of those that
    start at the camera or at a foreign object, whose way may meet no surface of a medium, and of shadow rays where the native
    body cannot.

    All other rays are charged by the surface, which knows who wins. Where nothing is absorbed the mix is folded away and
    Cycles sees no volume.
    """
    math = partial(math_node, tree)
    nodes, links = tree.nodes, tree.links
    path = nodes.new("ShaderNodeLightPath")
    charged = nodes.new("ShaderNodeVectorMath")
    charged.operation = "SCALE"
    links.new(coefficients, charged.inputs[0])
    # Folds to 1, and no light path is asked, where the volume absorbs for all rays.
    straight = math_node(tree, "ADD", path.outputs["Is Camera Ray"], path.outputs["Is Diffuse Ray"])
    shadow = math_node(tree, "MULTIPLY", path.outputs["Is Shadow Ray"], of_shadows)
    straight = math_node(tree, "MAXIMUM", straight, shadow)
    elsewhere = math_node(tree, "MULTIPLY", straight, math_node(tree, "SUBTRACT", 1.0, by_volume))
    links.new(math_node(tree, "ADD", elsewhere, by_volume), charged.inputs["Scale"])
    volume = nodes.new("ShaderNodeVolumeCoefficients")
    volume.inputs["Scatter Coefficients"].default_value = (0.0, 0.0, 0.0)
    links.new(charged.outputs[0], volume.inputs["Absorption Coefficients"])
    mix = nodes.new("ShaderNodeMixShader")
    links.new(absorbs, mix.inputs[0])
    links.new(volume.outputs[0], mix.inputs[2])
    return mix.outputs[0]


def _menu(tree: bpy.types.NodeTree, source: bpy.types.NodeSocket, parameter: Parameter) -> bpy.types.NodeSocket:
    switch = tree.nodes.new("GeometryNodeMenuSwitch")
    switch.label = parameter.name
    switch.data_type = "INT"
    items = switch.enum_definition.enum_items
    items.clear()
    for choice in parameter.choices:
        items.new(choice.name).description = choice.description
    for index, choice in enumerate(parameter.choices):
        switch.inputs[choice.name].default_value = index
    tree.links.new(source, switch.inputs[0])
    default = next(choice.name for choice in parameter.choices if choice.keyword == parameter.default)
    next(item for item in tree.interface.items_tree if item.name == parameter.name).default_value = default
    return switch.outputs[0]


def _requests(
    tree: bpy.types.NodeTree,
    inputs: bpy.types.Node,
    curves_matter: bpy.types.NodeSocket,
    absorbs: bpy.types.NodeSocket,
    analysis_holds: bpy.types.NodeSocket,
    cut: bpy.types.NodeSocket,
) -> bpy.types.NodeSocket:
    """One colour that depends on every attribute neighbours read of an object, so that Cycles exports them.

    Cycles looks attributes up one by one in the order of these nodes, and what is not there takes longest: so the
    list is kept short. What a material does not have, or has in no further slot, is multiplied by a constant 0, and Cycles
    drops it.
    """
    math = partial(math_node, tree)
    model = inputs.outputs["Dispersion Model"]
    curve = {
        name: math("MULTIPLY", math("COMPARE", model, float(index), 0.5), curves_matter)
        for index, name in enumerate(("Abbe", "Sellmeier B"))
    }
    # JF's also moves the index of white light.
    curve["Dispersion"] = math("COMPARE", model, 2.0, 0.5)
    curve["Sellmeier C"] = curve["Sellmeier B"]
    by_object = math("COMPARE", inputs.outputs[OUTSIDE_SOCKET], float(BY_OBJECT), 0.5)
    conditions = curve | {
        "Transmittance": absorbs,
        "Transmittance Depth": absorbs,
        "Disperse": inputs.outputs["Disperse"],
        "Dispersion Model": math("MAXIMUM", curve["Sellmeier B"], curve["Dispersion"]),
    }
    names = [
        *((name, "GEOMETRY", cut) for name in CUT_ATTRIBUTES),
        *((name, "OBJECT", by_object) for name in OBJECT_PROPERTIES),
        (PRIORITY_PROPERTY, "OBJECT", None),
        ("material_slots[1].material.pass_index", "OBJECT", None),
    ]
    one_slot = math("LESS_THAN", inputs.outputs[SLOTS_SOCKET], 1.5)
    several = math("SUBTRACT", 1.0, math("MULTIPLY", one_slot, analysis_holds))
    names.append(("material_index", "GEOMETRY", several))
    in_others = {name: math("MULTIPLY", several, condition) for name, condition in conditions.items()}
    names += [
        (
            socket_path(slot, name),
            "OBJECT",
            in_others.get(name, several) if slot else conditions.get(name),
        )
        for slot in range(MATERIAL_SLOTS)
        for name in NEIGHBOUR_PARAMETERS
    ]
    # Only objects without further slots are left to volumes.
    names.append((socket_path(0, BY_VOLUME_SOCKET), "OBJECT", absorbs))
    sums: dict[bpy.types.NodeSocket | None, bpy.types.NodeSocket] = {}
    for name, kind, condition in names:
        attribute = tree.nodes.new("ShaderNodeAttribute")
        attribute.attribute_name = name
        attribute.attribute_type = kind
        value = attribute.outputs["Color"]
        sums[condition] = vector_math(tree, "ADD", sums[condition], value) if condition in sums else value
    total = sums.pop(None)
    for condition, value in sums.items():
        total = vector_math(tree, "ADD", total, vector_math(tree, "MULTIPLY", value, condition))
    return total


def socket_path(slot: int, name: str) -> str:
    """The path of a dielectric's socket from the object whose slot it is in."""
    return f'material_slots[{slot}].material.node_tree.nodes["{GROUP_NAME}"].inputs["{name}"].default_value'


def _arrange(tree: bpy.types.NodeTree) -> None:
    """Lay the nodes out in columns from left to right, so that whoever opens the group can read it."""
    columns = {
        "NodeGroupInput": 0,
        "ShaderNodeAttribute": -2,
        "ShaderNodeVectorMath": -1,
        "GeometryNodeMenuSwitch": 1,
        "ShaderNodeBsdfDiffuse": 2,
        "ShaderNodeBsdfTransparent": 2,
        "ShaderNodeBsdfPrincipled": 2,
        "ShaderNodeBsdfRayPortal": 2,
        "ShaderNodeScript": 2,
        "ShaderNodeTexImage": 1,
        "ShaderNodeGroup": 1,
        "ShaderNodeSeparateColor": 1,
        "ShaderNodeLightPath": 1,
        "ShaderNodeMath": 2,
        "ShaderNodeCombineXYZ": 3,
        "ShaderNodeVolumeCoefficients": 3,
        "ShaderNodeMixShader": 3,
        "NodeGroupOutput": 4,
    }
    heights: dict[int, float] = {}
    for node in tree.nodes:
        column = columns.get(node.bl_idname, 2)
        node.location = (column * 260.0, heights.get(column, 0.0))
        heights[column] = node.location.y - (60.0 if column < 0 else 380.0)
        node.hide = column < 0
