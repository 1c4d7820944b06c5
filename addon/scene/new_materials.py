"""Making materials whose surface is a nested dielectric, or nodes of one in materials that are there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import bpy

from ..model.dispersion import LINE_D, sellmeier_ior
from ..model.parameter import GROUP_NAME, Parameter, ParameterError
from ..model.parameters import BY_KEYWORD, SETTINGS, check_keywords
from ..model.presets import Preset
from ..nodes.group import ensure_group
from ..nodes.mending import complete_nodes
from ..nodes.names import CYCLES_OUTPUT, PREVIEW_OUTPUT, VOLUME_OUTPUT
from ..nodes.sockets import NODE_WIDTH, hide_internal_sockets
from .material_spectra import baked_table, keep_table, refresh_spectrum
from .materials import set_parameter
from .preset_library import load_preset
from .preset_values import DEPTH, measured_depth, preset_values

PRESET_PROPERTY = "nd_preset"
"""Custom property of materials that presets made: what they are and where their numbers come from."""

KEY_PROPERTY = "nd_preset_key"
"""Custom property of materials that presets made: the preset's key."""


def new_material(name: str, preset: str | Preset | None = None, **keywords: Any) -> bpy.types.Material:
    """Make a material whose surface is a nested dielectric.

    :param name: name of the material; Blender numbers it if it is taken.
    :param preset: a preset, or a name of :func:`preset_names`, whose values are set first; its lengths, in metres,
        become those of the scene's units.
    :param keywords: socket names in snake_case, such as ``ior=1.33``; enumerations are upper-case words. With Sellmeier
        coefficients and no ``ior`` the index is that of the coefficients.
    :raises ParameterError: for an unknown preset or keyword, or a value outside its limits. Nothing has been made then.
    """
    loaded = load_preset(preset) if isinstance(preset, str) else preset
    values = {} if loaded is None else preset_values(loaded) | {DEPTH: measured_depth(loaded)}
    values.update(check_keywords(keywords))
    if keywords.keys() & {"sellmeier_b", "sellmeier_c"} and "ior" not in keywords:
        values[BY_KEYWORD["ior"]] = _sellmeier_index(values)
    settings = {parameter: values.pop(parameter, parameter.check(parameter.default)) for parameter in SETTINGS}
    table = baked_table(settings)
    group = ensure_group()

    material = bpy.data.materials.new(name)
    tree = material.node_tree
    tree.nodes.clear()
    node = _new_node(tree, group)
    for target, height, sockets in (
        ("CYCLES", 0.0, {"Surface": CYCLES_OUTPUT, "Volume": VOLUME_OUTPUT}),
        ("EEVEE", -160.0, {"Surface": PREVIEW_OUTPUT}),
    ):
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        output.target = target
        output.location = (340.0, height)
        for theirs, ours in sockets.items():
            tree.links.new(node.outputs[ours], output.inputs[theirs])
    for parameter, value in values.items():
        set_parameter(node, parameter, value)
    keep_table(material, node, settings, table)
    _set_surface(material)
    material.diffuse_color = viewport_colour(node.inputs["Transmittance"].default_value[:3])
    if loaded is not None:
        material[PRESET_PROPERTY] = f"{loaded.description} {loaded.source}"
        material[KEY_PROPERTY] = loaded.key
    return material


def _set_surface(material: bpy.types.Material) -> None:
    """Let light through surfaces that are not there, in the render and in EEVEE."""
    material.use_transparent_shadow = True
    show_colours_through(material)


def show_colours_through(material: bpy.types.Material) -> None:
    """Make EEVEE multiply the colours of surfaces that lie behind one another; Dithered ones have but grey clearness."""
    material.surface_render_method = "BLENDED"


def viewport_colour(transmittance: Sequence[float]) -> tuple[float, float, float, float]:
    """Return the colour and alpha of a medium in Solid view: the brighter and the denser the deeper its colour is."""
    brightest, darkest = max(transmittance), min(transmittance)
    gain = max(1.0, 0.5 / brightest) if brightest > 0.0 else 1.0
    return *(gain * channel for channel in transmittance), 0.3 + 0.6 * (1.0 - darkest)


def _new_node(tree: bpy.types.NodeTree, group: bpy.types.NodeTree) -> bpy.types.ShaderNodeGroup:
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    node.name = GROUP_NAME
    node.width = NODE_WIDTH
    hide_internal_sockets(node)
    return node


def add_node(material: bpy.types.Material, tree: bpy.types.NodeTree) -> tuple[bpy.types.ShaderNodeGroup, bool]:
    """Add a nested dielectric's node to a material's nodes, or to a group in them.

    It is plugged into the material's outputs where nothing but a bare Principled BSDF stands in its place.

    :return: the node, and whether it is plugged in.
    :raises UnsupportedError: when this Blender compiles no OSL; nothing has been added then.
    """
    node = _new_node(tree, ensure_group())
    if tree != material.node_tree:
        return node, False
    output = tree.get_output_node("CYCLES")
    if output is None:
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        output.location = node.location[0] + NODE_WIDTH + 80.0, node.location[1]
    sources = [link.from_node for link in output.inputs["Surface"].links]
    if any(not _is_bare_principled(source) for source in sources):
        return node, False
    tree.links.new(node.outputs[CYCLES_OUTPUT], output.inputs["Surface"])
    complete_nodes(material)
    refresh_spectrum(material)
    _set_surface(material)
    return node, True


def _is_bare_principled(node: bpy.types.Node) -> bool:
    """Return whether a node is the Principled BSDF of a new material: nothing is plugged in."""
    return node.type == "BSDF_PRINCIPLED" and not any(socket.is_linked for socket in node.inputs)


def _sellmeier_index(values: dict[Parameter, Any]) -> float:
    """Return the index of Sellmeier coefficients at the d line.

    :raises ParameterError: if they have none.
    """
    b, c = (values.get(BY_KEYWORD[word], BY_KEYWORD[word].default) for word in ("sellmeier_b", "sellmeier_c"))
    try:
        return BY_KEYWORD["ior"].check(sellmeier_ior(b, c, LINE_D))
    except ParameterError:
        raise ParameterError(
            f"sellmeier_b={b}, sellmeier_c={c}: these have no index of refraction at 587.56 nm; "
            "C is the square of a wavelength in square micrometres"
        ) from None
