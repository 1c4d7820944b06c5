"""Layers of media that are cut, of one priority and one material each."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ..model.contract import Exterior
from ..nodes.cutting.plan import HIDDEN, Layer
from ..scene.materials import medium_material
from ..scene.media import get_priority
from .medium_contents import needs_all_values
from .neighbours import Surroundings


def layer_key(obj: bpy.types.Object) -> tuple[int, bpy.types.Material]:
    """Return what all media of one layer have in common: priority and material."""
    return get_priority(obj), medium_material(obj)


def make_layers(
    objects: Sequence[bpy.types.Object], whole: set[bpy.types.Object], touching: dict, known: dict | None
) -> tuple[tuple[Layer, ...], frozenset[tuple[int, int]]]:
    """Return the layers of media that are cut, the strongest first, and the pairs of places of those that may cross.

    :param whole: media whose surfaces are needed inside winners, too.
    :param touching: the media that each may meet; known: what is known of each, None if something is not.
    """
    grouped: dict[tuple, list[bpy.types.Object]] = {}
    for obj in sorted(objects, key=lambda obj: (get_priority(obj), medium_material(obj).name_full, obj.name_full)):
        grouped.setdefault(layer_key(obj), []).append(obj)
    place = {obj: index for index, members in enumerate(grouped.values()) for obj in members}
    crossing = set(objects)
    if known is not None:
        odd = {obj for obj in objects if known[obj].may_cross}
        crossing = odd | {
            other for obj in odd for other in known[obj].partners if not _lies_within(other, known, grouped)
        }
    pairs = {
        tuple(sorted((place[obj], place[other])))
        for obj in crossing
        for other in touching[obj]
        if other in crossing and place[obj] != place[other]
    }
    layers = []
    for (priority, material), members in grouped.items():
        constant = tuple((obj, _outer_layer(obj, known, place)) for obj in members if obj not in crossing)
        layers.append(
            Layer(
                priority,
                material,
                tuple(obj for obj in members if obj in crossing),
                constant,
                overlapping=not set(members).isdisjoint(other for obj in members for other in touching[obj]),
                needs_all_values=needs_all_values(material),
                keeps_hidden_faces=not whole.isdisjoint(members),
            )
        )
    return tuple(layers), frozenset(pairs)


def _lies_within(obj: bpy.types.Object, known: dict[bpy.types.Object, Surroundings], layers: dict) -> bool:
    """Return whether another medium, in one piece without a hollow, holds all of a medium.

    What the other one leaves of weaker media then has no part in it.
    """
    around = known[obj].around
    if known[obj].code != Exterior.MEDIUM:
        return False
    return all(known[each].is_simple for each in layers[layer_key(around)])


def _outer_layer(obj: bpy.types.Object, known: dict, place: dict[bpy.types.Object, int]) -> int | None:
    """Return the place of the layer that lies outside a medium everywhere: None in air, HIDDEN inside winners."""
    if known[obj].code == Exterior.MEDIUM:
        return place[known[obj].around]
    return HIDDEN if known[obj].code == Exterior.WINNER else None
