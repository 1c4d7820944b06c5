"""Nested dielectric materials: making them, finding them and giving them to objects."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import bpy
import numpy as np

from ..model.dispersion import LINE_D, sellmeier_ior
from ..model.parameters import (
    BY_KEYWORD,
    GROUP_NAME,
    SETTINGS,
    SOCKETS,
    Choice,
    Parameter,
    ParameterError,
    check_keywords,
)
from ..model.presets import Preset
from ..model.spectra import SpectrumError, converted, spectral_table
from ..nodes import node_group
from ..nodes.animation import curves, is_animated
from ..nodes.lookups import looked_up_once
from ..nodes.trees import complete_nodes, dielectric_places, shows_dielectric, shows_other_volume, value_socket
from ..nodes.working_space import working_gamut
from .preset_library import load_preset

_SOCKET_KINDS = {"FLOAT": "VALUE", "BOOL": "BOOLEAN", "COLOR": "RGBA", "INDEX": "INT"}
_KINDS = {(parameter.name, _SOCKET_KINDS.get(parameter.kind, parameter.kind)) for parameter in SOCKETS}
"""Sockets by which a group node is known, with Blender's words for their kinds."""

PRESET_PROPERTY = "nd_preset"
"""Custom property of materials that presets made: what they are and where their numbers come from."""

KEY_PROPERTY = "nd_preset_key"
"""Custom property of materials that presets made: the preset's key."""

DEPTH = BY_KEYWORD["transmittance_depth"]
TRANSMITTANCE = BY_KEYWORD["transmittance"]

LUMINANCE = (0.2126, 0.7152, 0.0722)
"""Of linear red, green and blue (ITU-R BT.709)."""


def new_material(name: str, preset: str | None = None, **keywords: Any) -> bpy.types.Material:
    """Make a material whose surface is a nested dielectric.

    :param name: name of the material; Blender numbers it if it is taken.
    :param preset: a name of :func:`preset_names` whose values are set first; its lengths, in metres, become those of the
        scene's units.
    :param keywords: socket names in snake_case, such as ``ior=1.33``; enumerations are upper-case words. With Sellmeier
        coefficients and no ``ior`` the index is that of the coefficients.
    :raises ParameterError: for an unknown preset or keyword, or a value outside its limits. Nothing has been made then.
    """
    loaded = None if preset is None else load_preset(preset)
    values = {} if loaded is None else _preset_values(loaded) | {DEPTH: measured_depth(loaded)}
    values.update(check_keywords(keywords))
    if keywords.keys() & {"sellmeier_b", "sellmeier_c"} and "ior" not in keywords:
        values[BY_KEYWORD["ior"]] = _sellmeier_index(values)
    settings = {parameter: values.pop(parameter, parameter.check(parameter.default)) for parameter in SETTINGS}
    table = _table(settings)
    group = node_group.ensure_group()

    material = bpy.data.materials.new(name)
    tree = material.node_tree
    tree.nodes.clear()
    node = _new_node(tree, group)
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
    _set_table(material, node, settings, table)
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


def _preset_values(preset: Preset) -> dict[Parameter, Any]:
    """A preset's checked values, its colour in the file's working space."""
    values = check_keywords(preset.parameters)
    if preset.has_colour:
        values[TRANSMITTANCE] = TRANSMITTANCE.bounded(working_colour(values[TRANSMITTANCE]))
    return values


def working_colour(rgb: tuple[float, ...], to_presets: bool = False) -> tuple[float, ...]:
    """Convert a colour of preset files, which is in linear Rec.709, to the open file's working space, or back. In a working
    space of nobody's knowledge it stays as it is.
    """
    try:
        gamuts = ("REC709", working_gamut())
        return converted(rgb, *(gamuts[::-1] if to_presets else gamuts))
    except SpectrumError:
        return rgb


def measured_depth(preset: Preset) -> float:
    """Return the Transmittance Depth of a preset in units of the scene that is open; of a clear one as it has it."""
    if not preset.has_colour:
        return preset.depth
    return DEPTH.bounded(preset.depth / bpy.context.scene.unit_settings.scale_length)


def _new_node(tree: bpy.types.NodeTree, group: bpy.types.NodeTree) -> bpy.types.ShaderNodeGroup:
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    node.name = GROUP_NAME
    node.width = node_group.NODE_WIDTH
    node_group.hide_internals(node)
    return node


def add_node(material: bpy.types.Material, tree: bpy.types.NodeTree) -> tuple[bpy.types.ShaderNodeGroup, bool]:
    """Add a nested dielectric's node to a material's nodes, or to a group in them, and plug it into the material's outputs
    where nothing but a bare Principled BSDF stands in its place; return it, and whether it is plugged in.

    Raises :class:`~nested_dielectric.compatibility.UnsupportedError` when this Blender compiles no OSL; nothing has been
    added then.
    """
    node = _new_node(tree, node_group.ensure_group())
    if tree != material.node_tree:
        return node, False
    output = tree.get_output_node("CYCLES")
    if output is None:
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        output.location = node.location[0] + node_group.NODE_WIDTH + 80.0, node.location[1]
    sources = [link.from_node for link in output.inputs["Surface"].links]
    if any(not _is_bare_principled(source) for source in sources):
        return node, False
    tree.links.new(node.outputs[node_group.CYCLES_OUTPUT], output.inputs["Surface"])
    complete_nodes(material)
    refresh_spectrum(material)
    _set_surface(material)
    return node, True


def _is_bare_principled(node: bpy.types.Node) -> bool:
    """Whether a node is as a new material has it: nothing is plugged in."""
    return node.type == "BSDF_PRINCIPLED" and not any(socket.is_linked for socket in node.inputs)


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


def _sellmeier_index(values: dict[Parameter, Any]) -> float:
    """Index of Sellmeier coefficients at the d line. Raises :class:`ParameterError` if they have none."""
    b, c = (values.get(BY_KEYWORD[word], BY_KEYWORD[word].default) for word in ("sellmeier_b", "sellmeier_c"))
    try:
        return BY_KEYWORD["ior"].check(sellmeier_ior(b, c, LINE_D))
    except ParameterError:
        raise ParameterError(
            f"sellmeier_b={b}, sellmeier_c={c}: these have no index of refraction at 587.56 nm; "
            "C is the square of a wavelength in square micrometres"
        ) from None


def absorption_coefficients(node: bpy.types.ShaderNodeGroup) -> tuple[float, float, float]:
    """Return what a nested dielectric's node absorbs of red, green and blue per scene unit, as its volume has it."""
    depth = node.inputs["Transmittance Depth"].default_value
    left = node.inputs["Transmittance"].default_value[:3]
    if depth <= 0.0:
        return 0.0, 0.0, 0.0
    return tuple(-math.log(min(max(channel, 1e-6), 1.0)) / depth for channel in left)


def half_distance(node: bpy.types.ShaderNodeGroup) -> float | None:
    """Return after how many scene units half of white light's luminance is left in a nested dielectric; None if it absorbs
    nothing, or leaves a part of the light alone that is more than half.
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


@looked_up_once
def has_own_volume(material: bpy.types.Material) -> bool:
    """Tell whether more than the node's own volume goes into the output of a nested dielectric's material."""
    return shows_other_volume(material)


def get_parameter(node: bpy.types.ShaderNodeGroup, parameter: Parameter) -> Any:
    """Return the value of a parameter's socket as a keyword argument would have it."""
    value = node.inputs[parameter.name].default_value
    if parameter.kind == "INDEX":
        return parameter.choices[min(max(value, 0), len(parameter.choices) - 1)].keyword
    if parameter.kind == "MENU":
        return next((choice.keyword for choice in parameter.choices if choice.name == value), parameter.default)
    return tuple(value)[:3] if parameter.kind in ("COLOR", "VECTOR") else value


def spectrum_settings(material: bpy.types.Material) -> dict[str, Any]:
    """Return the keywords that a nested dielectric's spectral table is baked from, as the material keeps them: a custom
    property may hold anything.
    """
    return {parameter.keyword: material.get(parameter.keyword, parameter.default) for parameter in SETTINGS}


def usable_spectrum_settings(material: bpy.types.Material) -> dict[str, Any]:
    """Return the same with the default in place of what a setting cannot be."""
    return {parameter.keyword: _usable(parameter, material.get(parameter.keyword)) for parameter in SETTINGS}


def _usable(parameter: Parameter, value: Any) -> Any:
    try:
        parameter.check(value)
    except ParameterError:
        return parameter.default
    return value


def set_spectrum(material: bpy.types.Material, **keywords: Any) -> None:
    """Bake a spectral table for a nested dielectric from ``spectral_distribution``, ``spectral_gamut``,
    ``spectral_saturation`` and ``clamp_negative``; what is not given stays.

    The material's custom properties keep them, and the file keeps the table. Raises :class:`ParameterError` for a wrong
    value or a file that cannot be read; nothing has changed then.
    """
    settings = check_keywords(spectrum_settings(material) | keywords)
    unknown = settings.keys() - set(SETTINGS)
    if unknown:
        raise ParameterError(f"{unknown.pop().keyword} is a socket; set it in the node {GROUP_NAME!r}")
    _set_table(material, rendered_node(material), settings, _table(settings))


def material_table(material: bpy.types.Material) -> np.ndarray | None:
    """Return the spectral table that a nested dielectric renders with, or None if the file has lost it."""
    return node_group.table_of(rendered_node(material))


def refresh_spectrum(material: bpy.types.Material) -> bool:
    """Bake a material's spectral table again if its settings, a file it was read from or the file's working space have
    changed; tell whether they had. Raises :class:`ParameterError` as :func:`set_spectrum` does.
    """
    node = rendered_node(material)
    table = _table(check_keywords(spectrum_settings(material)))
    stale = not node_group.uses_table(node, table)
    if stale and not (material.is_editable and node.node_tree.is_editable):
        raise ParameterError("it belongs to a library, where it is to be prepared")
    if stale:
        node_group.set_table(node, table)
    return stale


def may_disperse(material: bpy.types.Material) -> bool:
    """Whether a nested dielectric splits light into colours, now or on some frame."""
    socket = dielectric_node(material).inputs["Disperse"]
    return socket.default_value or socket.is_linked or is_animated(material.node_tree, socket)


def _table(settings: dict[Parameter, Any]) -> np.ndarray:
    """The spectral table of checked settings."""
    distribution, gamut, saturation, clamped = (settings[parameter] for parameter in SETTINGS)
    try:
        resolved = working_gamut() if gamut.keyword == "SCENE" else gamut.keyword
        return spectral_table(_absolute(distribution), resolved, saturation, clamped)
    except SpectrumError as error:
        raise ParameterError(f"spectral_distribution={distribution!r}: {error}") from None


def _absolute(distribution: str) -> str:
    return bpy.path.abspath(distribution) if distribution.startswith("//") else distribution


def _set_table(
    material: bpy.types.Material,
    node: bpy.types.ShaderNodeGroup,
    settings: dict[Parameter, Any],
    table: np.ndarray,
) -> None:
    for parameter, value in settings.items():
        material[parameter.keyword] = _plain(value)
    node_group.set_table(node, table)


@looked_up_once
def dielectric_node(material: bpy.types.Material | None) -> bpy.types.ShaderNodeGroup | None:
    """Return the node that other media read ``material`` by, or None if it is no nested dielectric to them."""
    if material is None or material.node_tree is None:
        return None
    node = material.node_tree.nodes.get(GROUP_NAME)
    if node is None or node.type != "GROUP" or node.node_tree is None:
        return None
    return (
        node
        if _KINDS <= {(socket.name, socket.type) for socket in node.inputs} and shows_dielectric(material)
        else None
    )


@looked_up_once
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


def is_preset(material: bpy.types.Material, preset: Preset) -> bool:
    """Tell whether a material of this file is what :func:`new_material` makes of a preset, whatever its name and
    Transmittance Depth.
    """
    node = dielectric_node(material)
    if node is None or material.library is not None or len(material.node_tree.nodes) > 3:
        return False
    values = _preset_values(preset)
    settings = {parameter.keyword: _plain(values.get(parameter, parameter.default)) for parameter in SETTINGS}
    return (
        not any(socket.is_linked for socket in node.inputs)
        and not any(curves(material.node_tree.animation_data))
        and all(
            _holds(node, parameter, values.get(parameter, parameter.default))
            for parameter in SOCKETS
            if parameter != DEPTH
        )
        and spectrum_settings(material) == settings
    )


def _holds(node: bpy.types.ShaderNodeGroup, parameter: Parameter, value: Any) -> bool:
    if parameter.kind == "SHADER":
        return True
    found = get_parameter(node, parameter)
    if isinstance(found, str):
        return found == _plain(value)
    return np.allclose(found, value, rtol=1e-5, atol=1e-9)


def _plain(value: Any) -> Any:
    return value.keyword if isinstance(value, Choice) else value
