"""What is cut: media in layers, the strongest first."""

from __future__ import annotations

from dataclasses import dataclass, field

import bpy

from ...model.contract import BY_VOLUME_SOCKET

VALUES = {
    "IOR": "NodeSocketFloat",
    "Transmittance": "NodeSocketColor",
    "Transmittance Depth": "NodeSocketFloat",
    "Disperse": "NodeSocketBool",
    "Dispersion Model": "NodeSocketInt",
    "Abbe": "NodeSocketFloat",
    "Dispersion": "NodeSocketFloat",
    "Sellmeier B": "NodeSocketVector",
    "Sellmeier C": "NodeSocketVector",
    BY_VOLUME_SOCKET: "NodeSocketInt",
}
"""Sockets of a material whose values are stored in the faces that lie in it, and the types of inputs that bring them."""


@dataclass(frozen=True)
class Layer:
    """Media of one priority and one material.

    :param crossing: those whose surfaces may cross others'.
    :param constant: media whose whole surface lies in one layer (its place), in air (None) or inside winners (HIDDEN).
    :param overlapping: media of the layer may overlap each other.
    :param needs_all_values: its colour or dispersion, beside its index, matters to what lies in it.
    :param keeps_hidden_faces: its surfaces inside winners stay, passed by light, for volumes and labels.
    """

    priority: int
    material: bpy.types.Material
    crossing: tuple[bpy.types.Object, ...]
    constant: tuple[tuple[bpy.types.Object, int | None], ...] = ()
    overlapping: bool = False
    needs_all_values: bool = False
    keeps_hidden_faces: bool = False

    @property
    def bodies(self) -> tuple[bpy.types.Object, ...]:
        """Return all media of the layer, in the order of their numbers."""
        return self.crossing + tuple(obj for obj, _ in self.constant)


HIDDEN = -1
"""In place of a layer: inside winners."""


@dataclass(frozen=True)
class Plan:
    """What is cut, and where.

    :param layers: the strongest first.
    :param pairs: places of layers that may cross, the stronger one's first.
    :param may_part: which of them cross has to be looked at in every frame.
    :param attributes: those of media that are not of corners and that materials read.
    """

    layers: tuple[Layer, ...] = ()
    pairs: frozenset[tuple[int, int]] = frozenset()
    may_part: bool = False
    attributes: dict[bpy.types.Object, tuple[str, ...]] = field(default_factory=dict)

    def numbers(self) -> dict[bpy.types.Object, int]:
        """Return the number of every medium."""
        return {obj: number for number, obj in enumerate(obj for layer in self.layers for obj in layer.bodies)}


def value_name(name: str, place: int) -> str:
    """Return the name of the input that brings a layer's value."""
    return f"{name} {place}"


def enclosing_layers(plan: Plan) -> set[int]:
    """Return the places of the layers that something may lie in."""
    return {weaker for _, weaker in plan.pairs} | {
        around for layer in plan.layers for _, around in layer.constant if around not in (None, HIDDEN)
    }


def values_of(layer: Layer) -> tuple[str, ...]:
    """Return the names of the values that are stored in a face in a layer."""
    return tuple(VALUES) if layer.needs_all_values else ("IOR",)
