"""Which of the gamuts the open file renders in."""

from __future__ import annotations

import bpy

from ..model.colour_science import SpectrumError

_GAMUTS = {"Linear Rec.709": "REC709", "Linear Rec.2020": "REC2020", "ACEScg": "ACESCG"}


def working_gamut() -> str:
    """Return the word of :data:`~nested_dielectric.model.gamuts.GAMUTS` for the open file's working space.

    :raises SpectrumError: for a working space of a custom OpenColorIO configuration.
    """
    space = bpy.data.colorspace.working_space
    if space not in _GAMUTS:
        raise SpectrumError(
            f"working space {space!r} is none of {', '.join(_GAMUTS)}; choose the gamut that fits it instead of SCENE"
        )
    return _GAMUTS[space]
