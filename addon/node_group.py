"""The node group `Nested Dielectric`: sockets for artists, the OSL shader inside, and a look for EEVEE."""

from __future__ import annotations

import hashlib
import tempfile
from functools import partial
from math import e
from pathlib import Path

import bpy

from .compatibility import UnsupportedError
from .parameters import GROUP_NAME, NEIGHBOUR_PARAMETERS, PARAMETERS, PRIORITY_PROPERTY, Parameter
from .shader_source import inlined_source

SHADER_FILE = "nested_dielectric.osl"
MATERIAL_SLOTS = 8
"""As in osl/medium.h: slots of an object in which neighbours look for its dielectric."""

CYCLES_OUTPUT = "Surface"
VOLUME_OUTPUT = "Volume"
PREVIEW_OUTPUT = "Preview"
SOURCE_HASH = "nd_source"

LEAST_PREVIEW_IOR = 1.2
"""Keeps bubbles, whose index is that of air, in sight in EEVEE."""

_SOCKET_TYPES = {
    "INT": "NodeSocketInt",
    "FLOAT": "NodeSocketFloat",
    "BOOL": "NodeSocketBool",
    "COLOR": "NodeSocketColor",
    "VECTOR": "NodeSocketVector",
    "MENU": "NodeSocketMenu",
    "SHADER": "NodeSocketShader",
}


def ensure_group() -> bpy.types.NodeTree:
    """Return this file's group, made on first use.

    A group of the same name that was built from other shader source (an older file's) is left to the materials that
    use it. Raises :class:`~nested_dielectric.compatibility.UnsupportedError` when this Blender compiles no OSL; nothing
    has been made then.
    """
    source = inlined_source(SHADER_FILE)
    digest = hashlib.sha256(f"{source}{PARAMETERS}".encode()).hexdigest()
    for tree in bpy.data.node_groups:
        if tree.get(SOURCE_HASH) == digest and tree.library is None:
            return tree
    bytecode = compiled(source)
    tree = bpy.data.node_groups.new(GROUP_NAME, "ShaderNodeTree")
    tree[SOURCE_HASH] = digest
    tree.description = "A dielectric that knows the media it touches"
    _add_sockets(tree)
    _add_nodes(tree, _shader_text(source), bytecode)
    return tree


def _shader_text(source: str) -> bpy.types.Text:
    for text in bpy.data.texts:
        if text.name.startswith(SHADER_FILE) and text.as_string() == source:
            return text
    text = bpy.data.texts.new(SHADER_FILE)
    text.from_string(source)
    return text


def _add_sockets(tree: bpy.types.NodeTree) -> None:
    interface = tree.interface
    interface.new_socket(
        CYCLES_OUTPUT, in_out="OUTPUT", socket_type="NodeSocketShader", description="The dielectric, for Cycles"
    )
    interface.new_socket(
        VOLUME_OUTPUT,
        in_out="OUTPUT",
        socket_type="NodeSocketShader",
        description="Absorption of light that comes straight from the camera or from an object inside the medium",
    )
    interface.new_socket(
        PREVIEW_OUTPUT, in_out="OUTPUT", socket_type="NodeSocketShader", description="A stand-in for EEVEE"
    )
    panels: dict[str, bpy.types.NodeTreeInterfacePanel] = {}
    for parameter in PARAMETERS:
        if parameter.panel not in panels:
            panels[parameter.panel] = interface.new_panel(parameter.panel, default_closed=bool(panels))
        socket = interface.new_socket(
            parameter.name,
            in_out="INPUT",
            socket_type=_SOCKET_TYPES[parameter.kind],
            parent=panels[parameter.panel],
            description=parameter.description,
        )
        _set_limits(socket, parameter)


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
    elif parameter.kind == "VECTOR":
        socket.subtype = parameter.unit
        socket.hide_value = True


def _add_nodes(tree: bpy.types.NodeTree, text: bpy.types.Text, bytecode: str) -> None:
    nodes, links = tree.nodes, tree.links
    inputs = nodes.new("NodeGroupInput")
    outputs = nodes.new("NodeGroupOutput")
    script = nodes.new("ShaderNodeScript")
    script.name = script.label = "Nested Dielectric Shader"
    _load_script(script, text, bytecode)

    for parameter in PARAMETERS:
        source = inputs.outputs[parameter.name]
        if parameter.kind == "MENU":
            source = _menu(tree, source, parameter)
        links.new(source, script.inputs[parameter.osl_name])
    links.new(_requests(tree), script.inputs["Requests"])

    # Not an emitter: Cycles would take every glass for a lamp and spend light samples on it.
    alarm = nodes.new("ShaderNodeBsdfDiffuse")
    alarm.inputs["Color"].default_value = (1.0, 0.0, 1.0, 1.0)
    running = nodes.new("ShaderNodeMixShader")
    running.label = "Magenta where OSL or its ray tracing does not run"
    running.inputs[0].default_value = 0.0
    links.new(script.outputs["Running"], running.inputs[0])
    links.new(alarm.outputs[0], running.inputs[1])
    links.new(script.outputs["BSDF"], running.inputs[2])
    links.new(running.outputs[0], outputs.inputs[CYCLES_OUTPUT])

    links.new(_absorption(tree, inputs), outputs.inputs[VOLUME_OUTPUT])

    links.new(_preview(tree, inputs), outputs.inputs[PREVIEW_OUTPUT])
    _arrange(tree)


def _load_script(script: bpy.types.ShaderNodeScript, text: bpy.types.Text, bytecode: str) -> None:
    """Put the compiled shader into the node, where it stays with the file, and give the node its sockets.

    Cycles does both by itself when the scene's engine is Cycles and its own helper modules can be imported; under the
    wheel or another engine it does neither.
    """
    script.mode = "INTERNAL"
    script.script = text
    script.bytecode = bytecode
    script.bytecode_hash = hashlib.md5(bytecode.encode(), usedforsecurity=False).hexdigest()
    for parameter in PARAMETERS:
        kind = "INT" if parameter.kind in ("MENU", "BOOL") else parameter.kind
        _ensure_socket(script.inputs, kind, parameter.osl_name)
    _ensure_socket(script.inputs, "COLOR", "Requests")
    _ensure_socket(script.outputs, "SHADER", "BSDF")
    _ensure_socket(script.outputs, "FLOAT", "Running")


def _ensure_socket(sockets: bpy.types.NodeInputs, kind: str, name: str) -> None:
    if name not in sockets:
        sockets.new(type=_SOCKET_TYPES[kind], name=name, identifier=name)


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


def _math(tree: bpy.types.NodeTree, operation: str, *operands: bpy.types.NodeSocket | float) -> bpy.types.NodeSocket:
    """The result of a Math node on sockets and numbers."""
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = operation
    for socket, operand in zip(node.inputs, operands):
        if isinstance(operand, float):
            socket.default_value = operand
        else:
            tree.links.new(operand, socket)
    return node.outputs[0]


def _preview(tree: bpy.types.NodeTree, inputs: bpy.types.Node) -> bpy.types.NodeSocket:
    """A look for EEVEE: clear, with reflections towards the edges, so that what stands in a medium stays in sight.

    EEVEE's own refraction shows no second refracting object through the first. The reflectance is that of Schlick (1994),
    the same from inside as from outside: total reflection would hide what lies behind.
    """
    nodes, links = tree.nodes, tree.links
    math = partial(_math, tree)
    ior = math("MAXIMUM", inputs.outputs["IOR"], LEAST_PREVIEW_IOR)
    normal_reflectance = math("POWER", math("DIVIDE", math("SUBTRACT", ior, 1.0), math("ADD", ior, 1.0)), 2.0)
    edge = math("POWER", nodes.new("ShaderNodeLayerWeight").outputs["Facing"], 5.0)
    reflectance = math("MULTIPLY_ADD", edge, math("SUBTRACT", 1.0, normal_reflectance), normal_reflectance)
    clear = nodes.new("ShaderNodeBsdfTransparent")
    links.new(inputs.outputs["Transmittance"], clear.inputs["Color"])
    gloss = nodes.new("ShaderNodeBsdfAnisotropic")
    gloss.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    links.new(inputs.outputs["Roughness"], gloss.inputs["Roughness"])
    mix = nodes.new("ShaderNodeMixShader")
    links.new(reflectance, mix.inputs[0])
    links.new(clear.outputs[0], mix.inputs[1])
    links.new(gloss.outputs[0], mix.inputs[2])
    return mix.outputs[0]


def _absorption(tree: bpy.types.NodeTree, inputs: bpy.types.Node) -> bpy.types.NodeSocket:
    """Absorption of rays that start at the camera or at a foreign object, whose way may meet no surface of a medium.

    All other rays are charged by the shader, which knows who wins. Where nothing is absorbed the mix is folded away and
    Cycles sees no volume.
    """
    nodes, links = tree.nodes, tree.links

    math = partial(_math, tree)
    channels = nodes.new("ShaderNodeSeparateColor")
    links.new(inputs.outputs["Transmittance"], channels.inputs[0])
    depth = inputs.outputs["Transmittance Depth"]
    coefficients = nodes.new("ShaderNodeCombineXYZ")
    for channel, coefficient in zip(channels.outputs, coefficients.inputs):
        decay = math("MULTIPLY", math("LOGARITHM", math("MAXIMUM", channel, 1e-6), e), -1.0)
        links.new(math("DIVIDE", decay, depth), coefficient)

    path = nodes.new("ShaderNodeLightPath")
    charged = nodes.new("ShaderNodeVectorMath")
    charged.operation = "SCALE"
    links.new(coefficients.outputs[0], charged.inputs[0])
    links.new(math("ADD", path.outputs["Is Camera Ray"], path.outputs["Is Diffuse Ray"]), charged.inputs["Scale"])
    volume = nodes.new("ShaderNodeVolumeCoefficients")
    volume.inputs["Scatter Coefficients"].default_value = (0.0, 0.0, 0.0)
    links.new(charged.outputs[0], volume.inputs["Absorption Coefficients"])

    least = math("MINIMUM", math("MINIMUM", channels.outputs[0], channels.outputs[1]), channels.outputs[2])
    absorbs = nodes.new("ShaderNodeMixShader")
    links.new(math("MULTIPLY", math("LESS_THAN", least, 1.0), math("GREATER_THAN", depth, 0.0)), absorbs.inputs[0])
    links.new(volume.outputs[0], absorbs.inputs[2])
    return absorbs.outputs[0]


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


def _requests(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
    """One colour that depends on every attribute neighbours read of an object, so that Cycles exports them."""
    names = [
        (PRIORITY_PROPERTY, "OBJECT"),
        ("material_slots[1].material.pass_index", "OBJECT"),
        ("material_index", "GEOMETRY"),
    ]
    names += [
        (f'material_slots[{slot}].material.node_tree.nodes["{GROUP_NAME}"].inputs["{name}"].default_value', "OBJECT")
        for slot in range(MATERIAL_SLOTS)
        for name in NEIGHBOUR_PARAMETERS
    ]
    total = None
    for name, kind in names:
        attribute = tree.nodes.new("ShaderNodeAttribute")
        attribute.attribute_name = name
        attribute.attribute_type = kind
        if total is None:
            total = attribute.outputs["Color"]
            continue
        add = tree.nodes.new("ShaderNodeVectorMath")
        tree.links.new(total, add.inputs[0])
        tree.links.new(attribute.outputs["Color"], add.inputs[1])
        total = add.outputs[0]
    return total


def _arrange(tree: bpy.types.NodeTree) -> None:
    """Lay the nodes out in columns from left to right, so that whoever opens the group can read it."""
    columns = {
        "NodeGroupInput": 0,
        "ShaderNodeAttribute": -2,
        "ShaderNodeVectorMath": -1,
        "GeometryNodeMenuSwitch": 1,
        "ShaderNodeBsdfDiffuse": 2,
        "ShaderNodeLayerWeight": 1,
        "ShaderNodeBsdfTransparent": 2,
        "ShaderNodeBsdfAnisotropic": 2,
        "ShaderNodeScript": 2,
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
        column = columns[node.bl_idname]
        node.location = (column * 260.0, heights.get(column, 0.0))
        heights[column] = node.location.y - (60.0 if column < 0 else 380.0)
        node.hide = column < 0
