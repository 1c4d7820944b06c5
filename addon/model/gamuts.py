"""Gamuts: spaces of colours that tables and presets may be in, and the way from one to another.

Source: Lam (1985), Metamerism and colour constancy, University of Bradford: the Bradford adaptation.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from .choice import Choice
from .colour_science import colour_science

GAMUTS = (
    Choice("SCENE", "Scene", "The file's own working space"),
    Choice("REC709", "Rec.709", "ITU-R BT.709, the primaries of sRGB"),
    Choice("ADOBE_RGB", "Adobe RGB", "Adobe RGB (1998)"),
    Choice("WIDE_GAMUT", "Wide Gamut RGB", "Adobe Wide Gamut RGB"),
    Choice("PROPHOTO", "ProPhoto RGB", "ProPhoto RGB (ROMM)"),
    Choice("ACES_AP0", "ACES AP0", "ACES2065-1, which holds every colour"),
    Choice("ACESCG", "ACEScg", "ACEScg, the primaries AP1"),
    Choice("REC2020", "Rec.2020", "ITU-R BT.2020"),
)

COLOURSPACES = {
    "REC709": "ITU-R BT.709",
    "ADOBE_RGB": "Adobe RGB (1998)",
    "WIDE_GAMUT": "Adobe Wide Gamut RGB",
    "PROPHOTO": "ProPhoto RGB",
    "ACES_AP0": "ACES2065-1",
    "ACESCG": "ACEScg",
    "REC2020": "ITU-R BT.2020",
}
"""Names that colour-science has for the gamuts that need no file."""


@cache
def white_and_primaries(keyword: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the white's XYZ (Y = 1) and the (3, 3) matrix from RGB to XYZ of a gamut.

    The matrix is derived from the primaries: published ones are rounded, and their white is not quite white.
    """
    colour = colour_science()
    space = colour.RGB_COLOURSPACES[COLOURSPACES[keyword]]
    return colour.xy_to_XYZ(space.whitepoint), colour.normalised_primary_matrix(space.primaries, space.whitepoint)


def adaptation_matrix(white: np.ndarray, other_white: np.ndarray) -> np.ndarray:
    """Return the (3, 3) matrix that adapts XYZ from one white to another (Lam, 1985: Bradford)."""
    return colour_science().adaptation.matrix_chromatic_adaptation_VonKries(white, other_white, transform="Bradford")


def converted(rgb: Sequence[float], source: str, target: str) -> tuple[float, float, float]:
    """Convert a scene-linear colour from one gamut to another, white to white (Bradford's adaptation).

    :raises SpectrumError: without colour-science, if they differ.
    """
    if source == target:
        return tuple(rgb)
    (white, to_xyz), (other_white, other_to_xyz) = white_and_primaries(source), white_and_primaries(target)
    adaptation = adaptation_matrix(white, other_white)
    return tuple((np.linalg.inv(other_to_xyz) @ adaptation @ to_xyz @ np.array(rgb)).tolist())
