"""Script nodes have the sockets of their shaders."""

import re

import bpy
from scenes import add_point_light, add_sphere, new_scene

import nested_dielectric as nd
from nested_dielectric.model import contract, shader_source
from nested_dielectric.nodes import material_version, sockets

TYPES = {"int": "INT", "float": "VALUE", "color": "RGBA", "vector": "VECTOR", "closure color": "SHADER"}
VALUES = {"EXTERIOR_UNKNOWN": contract.Exterior.UNKNOWN, "NO_SOLE_PRIORITY": contract.NO_SOLE_PRIORITY}


def signature(source: str) -> tuple[dict[str, str], dict[str, str], dict[str, str]]:
    """Return a shader's inputs and outputs with their types, and the inputs' defaults."""
    code = shader_source.without_comments(source)
    text = re.search(r"^shader \w+\((.*?)\)\s*\{", code, re.MULTILINE | re.DOTALL)[1]
    found = re.findall(r"(output )?((?:closure )?\w+) (\w+) = ((?:[^,()]|\([^()]*\))+)", text)
    inputs = {name: TYPES[kind] for output, kind, name, _ in found if not output}
    outputs = {name: TYPES[kind] for output, kind, name, _ in found if output}
    return inputs, outputs, {name: default.strip() for output, _, name, default in found if not output}


def scripts() -> list[bpy.types.ShaderNodeScript]:
    """Return all Script nodes of a file with a medium and a light that the lobes carry."""
    scene = new_scene()
    add_sphere("Ball", 1.0, nd.new_material("Glass"), segments=8)
    add_point_light((0.0, 0.0, 3.0), 10.0)
    for obj in scene.objects:
        if obj.type == "LIGHT":
            obj.visible_transmission = False
    nd.prepare(scene)
    return [node for tree in bpy.data.node_groups for node in tree.nodes if node.type == "SCRIPT"]


def test_script_nodes_have_the_sockets_of_their_shaders():
    found = scripts()
    assert {node.script.name.split(".osl")[0] for node in found} == {
        "nested_dielectric",
        "spectral_coordinate",
        "volume_mask",
        "light",
    }
    for node in found:
        inputs, outputs, _ = signature(node.script.as_string())
        assert {socket.name: socket.type for socket in node.inputs} == inputs, node.name
        assert {socket.name: socket.type for socket in node.outputs} == outputs, node.name


def test_what_sockets_tell_by_default_is_what_inputs_do():
    *_, defaults = signature(shader_source.inlined_source("nested_dielectric.osl"))
    for osl_name, _, default, _ in sockets.ANALYSIS_SOCKETS.values():
        if not osl_name:
            continue
        text = defaults[osl_name]
        if isinstance(default, tuple):
            expected = f"vector{default}" if len(default) == 3 else "color(1.0)"
            assert contract_value(text) == expected
        else:
            assert float(VALUES.get(text, text)) == float(default), osl_name


def contract_value(text: str) -> str:
    """Return what a macro stands for."""
    return f"vector{contract.AIR_AROUND}" if text == "AIR_AROUND" else text


def test_outputs_for_artists_have_the_shaders_names():
    _, outputs, _ = signature(shader_source.inlined_source("nested_dielectric.osl"))
    new_scene()
    nd.new_material("Glass")
    assert material_version.find_group() is not None
    assert [name.replace(" ", "") for name in sockets.FACT_OUTPUTS] == list(outputs)[3:]
