"""A preset's numbers in the open file: colours in its working space, lengths in its units."""

from __future__ import annotations

from typing import Any

import bpy

from ..model.colour_science import SpectrumError
from ..model.gamuts import converted
from ..model.parameter import Parameter
from ..model.parameters import BY_KEYWORD, check_keywords
from ..model.presets import Preset
from ..nodes.working_space import working_gamut

DEPTH = BY_KEYWORD["transmittance_depth"]

TRANSMITTANCE = BY_KEYWORD["transmittance"]


def preset_values(preset: Preset) -> dict[Parameter, Any]:
    """Return a preset's checked values, its colour in the open file's working space."""
    values = check_keywords(preset.parameters)
    if preset.has_colour:
        values[TRANSMITTANCE] = TRANSMITTANCE.bounded(working_colour(values[TRANSMITTANCE]))
    return values


def working_colour(rgb: tuple[float, ...], to_presets: bool = False) -> tuple[float, ...]:
    """Convert a colour of preset files, which is in linear Rec.709, to the open file's working space, or back.

    In a working space that nobody knows it stays as it is.
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
