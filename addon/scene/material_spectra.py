"""Spectra of materials: the settings that a material keeps, and the table that is baked from them."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from ..model.choice import keyword_of
from ..model.colour_science import SpectrumError
from ..model.parameter import GROUP_NAME, Parameter, ParameterError
from ..model.parameters import SETTINGS, check_keywords
from ..model.spectral_tables import spectral_table
from ..nodes.spectral_tables import set_table, table_of, uses_table
from ..nodes.working_space import working_gamut
from .materials import rendered_node


def spectrum_settings(material: bpy.types.Material) -> dict[str, Any]:
    """Return the keywords that a nested dielectric's spectral table is baked from, as the material keeps them.

    A custom property may hold anything.
    """
    return {parameter.keyword: material.get(parameter.keyword, parameter.default) for parameter in SETTINGS}


def usable_spectrum_settings(material: bpy.types.Material) -> dict[str, Any]:
    """Return the keywords of :func:`spectrum_settings`, with the default in place of what a setting cannot be."""
    return {parameter.keyword: _usable(parameter, material.get(parameter.keyword)) for parameter in SETTINGS}


def _usable(parameter: Parameter, value: Any) -> Any:
    try:
        parameter.check(value)
    except ParameterError:
        return parameter.default
    return value


def set_spectrum(material: bpy.types.Material, **keywords: Any) -> None:
    """Bake a spectral table for a nested dielectric.

    The material's custom properties keep the settings, and the file keeps the table.

    :param keywords: ``spectral_distribution``, ``spectral_gamut``, ``spectral_saturation`` and ``clamp_negative``; what is
        not given stays.
    :raises ParameterError: for a wrong value or a file that cannot be read; nothing has changed then.
    """
    settings = check_keywords(spectrum_settings(material) | keywords)
    unknown = settings.keys() - set(SETTINGS)
    if unknown:
        raise ParameterError(f"{unknown.pop().keyword} is a socket; set it in the node {GROUP_NAME!r}")
    keep_table(material, rendered_node(material), settings, baked_table(settings))


def material_table(material: bpy.types.Material) -> np.ndarray | None:
    """Return the spectral table that a nested dielectric renders with, or None if the file has lost it."""
    return table_of(rendered_node(material))


def refresh_spectrum(material: bpy.types.Material) -> bool:
    """Bake a material's spectral table again if what it was baked from has changed; tell whether it had.

    That is its settings, a file that it was read from, and the working space of the open file.

    :raises ParameterError: as :func:`set_spectrum` does, and for a material of a library.
    """
    node = rendered_node(material)
    table = baked_table(check_keywords(spectrum_settings(material)))
    stale = not uses_table(node, table)
    if stale and not (material.is_editable and node.node_tree.is_editable):
        raise ParameterError("it belongs to a library, where it is to be prepared")
    if stale:
        set_table(node, table)
    return stale


def baked_table(settings: dict[Parameter, Any]) -> np.ndarray:
    """Return the spectral table of checked settings, (entries, 4) float32.

    :raises ParameterError: for light that no table can be made of.
    """
    distribution, gamut, saturation, clamped = (settings[parameter] for parameter in SETTINGS)
    try:
        resolved = working_gamut() if gamut.keyword == "SCENE" else gamut.keyword
        return spectral_table(_absolute(distribution), resolved, saturation, clamped)
    except SpectrumError as error:
        raise ParameterError(f"spectral_distribution={distribution!r}: {error}") from None


def _absolute(distribution: str) -> str:
    return bpy.path.abspath(distribution) if distribution.startswith("//") else distribution


def keep_table(
    material: bpy.types.Material,
    node: bpy.types.ShaderNodeGroup,
    settings: dict[Parameter, Any],
    table: np.ndarray,
) -> None:
    """Keep checked settings in a material's custom properties, and their table with its node."""
    for parameter, value in settings.items():
        material[parameter.keyword] = keyword_of(value)
    set_table(node, table)
