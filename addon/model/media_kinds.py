"""Kinds of media by which people know who gives way to whom: bubbles, solids, ice, liquids; and which liquid floats."""

from __future__ import annotations

from enum import IntEnum

from .presets import Preset


class Kind(IntEnum):
    """A kind of medium; its number is the priority that presets of the kind have.

    A bubble is cut out of whatever it is in. Solids keep their shape in ice, which grows around them, and in liquids. Ice
    keeps its shape in the liquid that it floats in.
    """

    GAS = 0
    SOLID = 10
    ICE = 20
    LIQUID = 30

    @property
    def noun(self) -> str:
        """Return its name for a sentence, with an article where there is one."""
        return {Kind.GAS: "a bubble", Kind.SOLID: "a solid", Kind.ICE: "ice", Kind.LIQUID: "a liquid"}[self]


_KINDS_OF_GROUPS = {
    "Glass": Kind.SOLID,
    "Laboratory Glass": Kind.SOLID,
    "Gems and Crystals": Kind.SOLID,
    "Plastics and Resins": Kind.SOLID,
    "Drinks": Kind.LIQUID,
    "Liquids": Kind.LIQUID,
}
"""Kinds of all presets of a group; the other groups hold several, which their indices tell apart."""

SAME_INDEX = 0.02
"""How far a material's index may be from that of its preset for it to be that medium: dyes, warmth and salt change less."""

_DENSITIES = {
    "water": 998.2,
    "pool_water": 998.2,
    "lake_water": 998.2,
    "pond_water": 998.2,
    "sea_water": 1024.8,
    "tropical_sea": 1024.8,
    "acetone": 784.5,
    "ethanol": 789.3,
    "methanol": 791.4,
    "isopropanol": 780.9,
    "glycerol": 1261.3,
    "olive_oil": 911.0,
    "sunflower_oil": 919.0,
}
"""Densities of liquids by preset, kg/m³, at 20 °C (acetone and isopropanol at 25 °C).

Haynes (2014), CRC Handbook of Chemistry and Physics, 95th edition; sea water of 35 g/kg by Millero and Poisson (1981), Deep-Sea
Research 28A; oils: the middle of what Codex Alimentarius Standards 33 and 210 allow (0.910 to 0.916 and 0.918 to 0.923 times
that of water). Other presets are mixtures whose sources give none.
"""


def kind_of_index(index: float, is_held: bool = False) -> Kind | None:
    """Guess the kind of a medium by its index at the d line; None where nothing is known.

    Ice Ih has 1.3097 (Warren and Brandt 2008), water 1.333. Of common solids fluorite has the lowest index, 1.434 (Malitson
    1963), and oils, glycerol and honey reach 1.49: between 1.40 and 1.50 the shape decides.

    :param is_held: it stands within the box of something that it touches, as a drink in its glass.
    """
    if not index >= 0.95:
        return None
    if index < 1.05:
        return Kind.GAS
    if 1.30 <= index <= 1.32:
        return Kind.ICE
    return Kind.LIQUID if index < 1.40 or (index < 1.50 and is_held) else Kind.SOLID


def kind_of(preset: Preset | None, index: float | None, is_held: bool = False) -> Kind | None:
    """Return the kind of a medium by the preset that it was made of, or else by its index.

    :param index: None if it is not known; then nothing is.
    """
    if index is None:
        return None
    kind = _KINDS_OF_GROUPS.get(preset.group) if _is_still(preset, index) else None
    return kind_of_index(index, is_held) if kind is None else kind


def density_of(preset: Preset | None, index: float | None) -> float | None:
    """Return the published density of a medium that was made of a preset, kg/m³; None if there is none."""
    return _DENSITIES.get(preset.key) if index is not None and _is_still(preset, index) else None


def _is_still(preset: Preset | None, index: float) -> bool:
    """Return whether a medium may be what its preset says."""
    return preset is not None and abs(preset.parameters.get("ior", index) - index) <= SAME_INDEX
