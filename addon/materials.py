"""Nested dielectric materials: making them, finding them and giving them to objects."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import bpy
import numpy as np

from . import node_group
from .dispersion import LINE_D, sellmeier_ior
from .parameters import (
    BY_KEYWORD,
    GROUP_NAME,
    SETTINGS,
    SOCKETS,
    Choice,
    Parameter,
    ParameterError,
    check_keywords,
)
from .presets import load_preset
from .spectra import SpectrumError, spectral_table
from .spectral_images import read_rows
from .working_space import working_gamut


def new_material(name: str, preset: str | None = None, **keywords: Any) -> bpy.types.Material:
    """Make a material whose surface is a nested dielectric.

    :param name: name of the material; Blender numbers it if it is taken.
    :param preset: a name of :func:`preset_names` whose values are set first.
    :param keywords: socket names in snake_case, such as ``ior=1.33``; enumerations are upper-case words. With Sellmeier
        coefficients and no ``ior`` the index is that of the coefficients.
    :raises ParameterError: for an unknown preset or keyword, or a value outside its limits. Nothing has been made then.
    """
    values: dict[Parameter, Any] = {}
    description = ""
    if preset is not None:
        loaded = load_preset(preset)
        description = f"{loaded.description} {loaded.source}"
        values.update(check_keywords(loaded.parameters))
    values.update(check_keywords(keywords))
    if keywords.keys() & {"sellmeier_b", "sellmeier_c"} and "ior" not in keywords:
        values[BY_KEYWORD["ior"]] = _sellmeier_index(values)
    settings = {parameter: values.pop(parameter, parameter.check(parameter.default)) for parameter in SETTINGS}
    table = _table(settings)
    group = node_group.ensure_group()

    material = bpy.data.materials.new(name)
    tree = material.node_tree
    tree.nodes.clear()
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    node.name = GROUP_NAME
    node.width = 260.0
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
    material.use_transparent_shadow = True
    material.diffuse_color = (*node.inputs["Transmittance"].default_value[:3], 0.3)
    if description:
        material["nd_preset"] = description
    return material


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


def has_own_volume(material: bpy.types.Material) -> bool:
    """Tell whether more than the node's own volume goes into the output of a nested dielectric's material."""
    output = material.node_tree.get_output_node("CYCLES")
    link = next(iter(output.inputs["Volume"].links), None) if output is not None else None
    return link is not None and link.from_node != dielectric_node(material)


def get_parameter(node: bpy.types.ShaderNodeGroup, parameter: Parameter) -> Any:
    """Return the value of a parameter's socket as a keyword argument would have it."""
    value = node.inputs[parameter.name].default_value
    if parameter.kind == "INDEX":
        return parameter.choices[min(max(value, 0), len(parameter.choices) - 1)].keyword
    if parameter.kind == "MENU":
        return next(choice.keyword for choice in parameter.choices if choice.name == value)
    return tuple(value)[:3] if parameter.kind in ("COLOR", "VECTOR") else value


def spectrum_settings(material: bpy.types.Material) -> dict[str, Any]:
    """Return the keywords that a nested dielectric's spectral table is baked from."""
    return {parameter.keyword: material.get(parameter.keyword, parameter.default) for parameter in SETTINGS}


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
    _set_table(material, dielectric_node(material), settings, _table(settings))


def material_table(material: bpy.types.Material) -> np.ndarray | None:
    """Return the spectral table that a nested dielectric renders with, or None if the file has lost it."""
    node = dielectric_node(material)
    tables = node.node_tree.nodes.get(node_group.TABLES_NODE)
    image = None if tables is None else tables.image
    if image is None or not len(image.pixels):
        return None
    rows = read_rows(image)
    return rows[min(node.inputs[node_group.TABLE_SOCKET].default_value, len(rows) - 1)]


def refresh_spectrum(material: bpy.types.Material) -> bool:
    """Bake a material's spectral table again if its settings, a file it was read from or the file's working space have
    changed; tell whether they had. Raises :class:`ParameterError` as :func:`set_spectrum` does.
    """
    node = dielectric_node(material)
    table = _table(check_keywords(spectrum_settings(material)))
    stale = not node_group.uses_table(node, table)
    if stale:
        node_group.set_table(node, table)
    return stale


def may_disperse(material: bpy.types.Material) -> bool:
    """Whether a nested dielectric splits light into colours, now or on some frame."""
    socket = dielectric_node(material).inputs["Disperse"]
    animation = material.node_tree.animation_data
    return socket.default_value or socket.is_linked or animation is not None


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
        material[parameter.keyword] = value.keyword if isinstance(value, Choice) else value
    node_group.set_table(node, table)


def dielectric_node(material: bpy.types.Material | None) -> bpy.types.ShaderNodeGroup | None:
    """Return the group node that makes ``material`` a nested dielectric, or None."""
    if material is None or material.node_tree is None:
        return None
    node = material.node_tree.nodes.get(GROUP_NAME)
    if node is None or node.type != "GROUP" or node.node_tree is None:
        return None
    names = {socket.name for socket in node.inputs}
    return node if all(parameter.name in names for parameter in SOCKETS) else None


def dielectrics(obj: bpy.types.Object) -> Iterator[tuple[int, bpy.types.Material]]:
    """Yield the slots of an object that hold nested dielectrics, with their materials."""
    for index, slot in enumerate(obj.material_slots):
        if dielectric_node(slot.material) is not None:
            yield index, slot.material


def medium_material(obj: bpy.types.Object) -> bpy.types.Material | None:
    """Return the first nested dielectric among an object's materials, or None if the object is no medium."""
    return next((material for _, material in dielectrics(obj)), None)


def preset_material(preset: str) -> bpy.types.Material:
    """Return this file's material of a preset, made on first use."""
    loaded = load_preset(preset)
    found = bpy.data.materials.get(loaded.name)
    if found is not None and found.library is None and found.get("nd_preset") and dielectric_node(found) is not None:
        return found
    return new_material(loaded.name, preset=preset)
