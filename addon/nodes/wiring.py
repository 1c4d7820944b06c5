"""The nodes within the group `Nested Dielectric`."""

from __future__ import annotations

import bpy

from ..model.contract import BY_VOLUME_SOCKET, CUT
from ..model.parameter import Parameter
from ..model.parameters import SOCKETS
from .absorption import absorption_coefficients, absorption_volume
from .closures import add_disperser, add_front_ior_test
from .debug_view import DebugPicture
from .layout import arrange
from .lights_group import EMITTER_OUTPUT, LIGHT_COUNT_OUTPUT, LIGHT_OUTPUTS, ensure_lights
from .names import (
    COORDINATE_NODE,
    CYCLES_OUTPUT,
    DEBUG_GROUP,
    DEBUG_THROUGH,
    DEBUG_VIEW,
    FACTS_SCENE,
    GIVES_BACK_SOCKET,
    LIGHTS_NAME,
    MASK_OUTPUT,
    MEANS_SOCKET,
    NATIVE_GROUP,
    NATIVE_SOCKET,
    PREVIEW_OUTPUT,
    ROW_OUTPUT,
    SCENE_SOCKET,
    SHADER_NODE,
    TABLE_SOCKET,
    VOLUME_OUTPUT,
)
from .native.body import NativeBody
from .numbers import Number
from .osl import COORDINATE_FILE, MASK_FILE, SHADER_FILE, Script, add_script
from .parts import Part
from .preview_nodes import Preview
from .requests import attribute_requests
from .shader_nodes import Socket, lazily, mix_shaders, mix_values, view_layer_attribute
from .sockets import ANALYSIS_SOCKETS, FACT_OUTPUTS
from .spectral_tables import add_table_image
from .validity import analysed_scene


def add_nodes(tree: bpy.types.NodeTree, scripts: dict[str, Script]) -> None:
    """Add all nodes of the group, whose sockets are there; `scripts` are the compiled shaders by their files."""
    wiring = _Wiring(tree, scripts)
    wiring.link_parameters()
    wiring.link_scene()
    wiring.link_tables()
    wiring.link_lights()
    wiring.link_closures()
    wiring.link_outputs()
    arrange(tree)


class _Wiring:
    """The group while it is wired: its ends, the Script node of the shader, and what several nodes need."""

    coefficients: Socket
    absorbs: Number
    by_volume: Number

    def __init__(self, tree: bpy.types.NodeTree, scripts: dict[str, Script]) -> None:
        self.tree = tree
        self.scripts = scripts
        self.inputs = tree.nodes.new("NodeGroupInput")
        self.outputs = tree.nodes.new("NodeGroupOutput")
        self.script = add_script(tree, SHADER_NODE, scripts[SHADER_FILE], _script_inputs(), _script_outputs())
        # What parts find by name.
        self.known: dict[str, Socket] = {name: socket for name, socket in self.inputs.outputs.items() if name}
        self.is_native = self.known[NATIVE_SOCKET]

    def value(self, name: str) -> Number:
        """Return the number of one of the group's inputs."""
        return Number(self.tree, self.inputs.outputs[name])

    def scene_value(self, path: str) -> Number:
        """Return a property of the scene that is rendered."""
        return Number(self.tree, view_layer_attribute(self.tree, path).outputs["Fac"])

    def feed(self, name: str, value: Number | Socket) -> None:
        """Link a value into an input of the shader."""
        self.tree.links.new(value.socket if isinstance(value, Number) else value, self.script.inputs[name])

    def link_output(self, name: str, socket: Socket) -> None:
        """Link a socket into an output of the group."""
        self.tree.links.new(socket, self.outputs.inputs[name])

    def unless_native(self, kind: str, by_shader: Socket | float, by_nodes: Socket) -> Socket:
        """Return what Cycles' own nodes make where they render the material, else what the shader makes."""
        return lazily(self.tree, kind, self.is_native, by_shader, by_nodes)

    def link_parameters(self) -> None:
        """Link the parameters, and what the analysis stores, into the shader."""
        for parameter in SOCKETS:
            if parameter.kind == "MENU":
                self.known[parameter.name] = _add_menu(self.tree, self.known[parameter.name], parameter)
            self.feed(parameter.osl_name, self.known[parameter.name])
        for name, (osl_name, *_) in ANALYSIS_SOCKETS.items():
            if osl_name:
                self.feed(osl_name, self.known[name])

    def link_scene(self) -> None:
        """Link what the scene that is rendered makes of the material into the shader."""
        spectral = self.scene_value("render.use_motion_blur")
        self.coefficients, self.absorbs = absorption_coefficients(self.tree, self.inputs)
        front_ior = add_front_ior_test(self.tree)
        curves_matter = spectral.math("MAXIMUM", self.value("Disperse") * front_ior)
        scene = analysed_scene(self.tree)
        self.feed("AnalysedScene", scene)
        analysis_holds = scene.equals(self.value(SCENE_SOCKET))
        self.feed("AnalysisHolds", analysis_holds)
        by_volume = scene.equals(self.value(BY_VOLUME_SOCKET))
        self.feed("ByVolume", by_volume)
        self.feed("GivesBack", self.value(GIVES_BACK_SOCKET) * analysis_holds)
        cut = self.scene_value(f'["{CUT}"]')
        self.feed("Cut", cut)
        requests = attribute_requests(self.tree, self.inputs, curves_matter, self.absorbs, analysis_holds, cut)
        self.feed("AttributeRequests", requests)
        self.feed("Spectral", spectral)
        self.feed("FrontIOR", front_ior)
        view = self.scene_value(f'["{DEBUG_VIEW}"]')
        self.feed("View", abs(view))
        told_scene = self.scene_value(f'["{FACTS_SCENE}"]')
        natives_by_volume = told_scene.equals(self.value(BY_VOLUME_SOCKET))
        self.by_volume = Number(self.tree, self.unless_native("FLOAT", by_volume.socket, natives_by_volume.socket))
        self.known |= {
            "Scene": told_scene.socket,
            "Holds": told_scene.equals(self.value(SCENE_SOCKET)).socket,
            "By Volume": self.by_volume.socket,
            "Cut": cut.socket,
            "Debug View": view.socket,
        }

    def link_tables(self) -> None:
        """Link the spectral tables into the shader."""
        tables = add_table_image(self.tree, self.known[TABLE_SOCKET], self.scripts[COORDINATE_FILE])
        self.feed("Table", self.tree.nodes[COORDINATE_NODE].outputs[ROW_OUTPUT])
        self.feed("TableMeans", self.known[MEANS_SOCKET])
        self.feed("Weight", tables.outputs["Color"])
        self.feed("Wavelength", tables.outputs["Alpha"])

    def link_lights(self) -> None:
        """Link the scene's lights that lobes carry into the shader."""
        lights = self.tree.nodes.new("ShaderNodeGroup")
        lights.node_tree = ensure_lights()
        lights.name = lights.label = LIGHTS_NAME
        for name in LIGHT_OUTPUTS:
            self.feed(f"Light{name}", lights.outputs[name])
        self.feed("Emitter", lights.outputs[EMITTER_OUTPUT])
        self.feed("Lights", lights.outputs[LIGHT_COUNT_OUTPUT])

    def link_closures(self) -> None:
        """Link closures that the shader weighs into it."""
        self.feed("CountsPortals", self.tree.nodes.new("ShaderNodeBsdfRayPortal").outputs[0])
        self.feed("Disperses", add_disperser(self.tree))

    def link_outputs(self) -> None:
        """Add the native body and the look in EEVEE, and link what each of the group's outputs shows."""
        body = NativeBody()
        native = self._add_part(NATIVE_GROUP, body)
        running = self.script.outputs["Running"]
        by_shader = mix_shaders(self.tree, running, native["Surface"], self.script.outputs["BSDF"])
        surface = self.unless_native("SHADER", by_shader, native["Surface"])
        number = mix_values(self.tree, "FLOAT", running, native["Debug Number"], self.script.outputs["DebugNumber"])
        self.known["Debug Number"] = self.unless_native("FLOAT", number, native["Debug Number"])
        self.known["Look Through"] = self.scene_value(f'["{DEBUG_THROUGH}"]').socket
        debug = self._add_part(DEBUG_GROUP, DebugPicture())
        self.link_output(CYCLES_OUTPUT, mix_shaders(self.tree, debug["Shows"], surface, debug["Surface"]))
        of_shadows = Number(self.tree, self.unless_native("FLOAT", 0.0, native["Shadow by Volume"]))
        absorbs = self.absorbs * (1.0 - (abs(Number(self.tree, self.known["Debug View"])) > 0.5))
        volume = absorption_volume(self.tree, self.coefficients, absorbs, self.by_volume, of_shadows)
        self.link_output(VOLUME_OUTPUT, volume)
        mask = add_script(self.tree, MASK_OUTPUT, self.scripts[MASK_FILE], {"Priority": "INT"}, {"Mask": "FLOAT"})
        self.tree.links.new(self.known["Priority"], mask.inputs["Priority"])
        self.link_output(MASK_OUTPUT, mask.outputs["Mask"])
        preview = self._add_part(PREVIEW_OUTPUT, Preview(body.surroundings, body.coefficients))
        self.link_output(PREVIEW_OUTPUT, preview[PREVIEW_OUTPUT])
        for name, (kind, _) in FACT_OUTPUTS.items():
            kind = "RGBA" if kind == "COLOR" else kind
            by_shader = mix_values(self.tree, kind, running, native[name], self.script.outputs[name.replace(" ", "")])
            self.link_output(name, self.unless_native(kind, by_shader, native[name]))

    def _add_part(self, name: str, part: Part) -> bpy.types.NodeOutputs:
        """Add a part, link what it needs into it, and return its outputs."""
        node = self.tree.nodes.new("ShaderNodeGroup")
        node.node_tree = part.tree
        node.name = node.label = name
        for needed in part.inputs:
            self.tree.links.new(self.known[needed], node.inputs[needed])
        return node.outputs


def _script_inputs() -> dict[str, str]:
    """Return the kinds of the shader's inputs, by their names in it."""
    kinds = {
        parameter.osl_name: "INT" if parameter.kind in ("MENU", "BOOL") else parameter.kind for parameter in SOCKETS
    }
    kinds |= {
        osl_name: "INT" if kind == "BOOL" else kind for osl_name, kind, *_ in ANALYSIS_SOCKETS.values() if osl_name
    }
    return kinds | {
        "AnalysedScene": "INT",
        "AnalysisHolds": "INT",
        "ByVolume": "INT",
        "Cut": "INT",
        "GivesBack": "INT",
        "AttributeRequests": "COLOR",
        "FrontIOR": "INT",
        "CountsPortals": "SHADER",
        "Disperses": "SHADER",
        "Emitter": "SHADER",
        "Lights": "INT",
        **{f"Light{name}": kind for name, kind in LIGHT_OUTPUTS.items()},
        "Spectral": "INT",
        "Table": "INT",
        "TableMeans": "VECTOR",
        "Weight": "COLOR",
        "Wavelength": "FLOAT",
        "View": "INT",
    }


def _script_outputs() -> dict[str, str]:
    """Return the kinds of the shader's outputs, by their names in it."""
    facts = {name.replace(" ", ""): kind for name, (kind, _) in FACT_OUTPUTS.items()}
    return {"BSDF": "SHADER", "Running": "FLOAT", "DebugNumber": "FLOAT"} | facts


def _add_menu(tree: bpy.types.NodeTree, source: Socket, parameter: Parameter) -> Socket:
    """Add a Menu Switch for a parameter, set its default, and return the place of the word that is chosen."""
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
