"""Checks of media that nearly touch, and of those that overlap too little for rays to tell."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np

from ..geometry.gaps import TELLABLE, Layer, find_layers, room_ahead
from ..geometry.solids import touch_tolerance
from .finding import Action, Finding, Fix, Kind, Place
from .inspection import Inspection, Medium, listed_faces
from .kinds import GAP, THIN_OVERLAP
from .own_mesh import before_changing, can_change

OVERLAP = 2e-3
"""How far a liquid is to reach into its wall, in diagonals of its box."""

MOST_OF_WALL = 0.5
"""The largest part of a wall's thickness that it may reach into it."""

SLACK = 1.05
"""How much more than a film's thickness at some points it may be elsewhere."""

LEAST_OVERLAP = 4.0
"""The least overlap that is worth making, in distances within which surfaces count as touching."""


def gap_findings(inspection: Inspection) -> Iterator[Finding]:
    """Yield films of air between media, and overlaps too thin to be told from none."""
    media, found = inspection.media, inspection.contacts
    gaps, thin = find_layers([medium.place for medium in media], [contact.partners for contact in found])
    seen: set[tuple[bpy.types.Object, bpy.types.Object, Kind]] = set()
    for kind, layers in ((GAP, gaps), (THIN_OVERLAP, thin)):
        for layer in layers:
            first, second = media[layer.first], media[layer.second]
            if (first.obj, second.obj, kind) in seen:
                continue
            seen.add((first.obj, second.obj, kind))
            beside = layer.second in found[layer.first].partners or layer.first in found[layer.second].partners
            yield _finding(kind, layer, first, second, beside)


def _finding(kind: Kind, layer: Layer, first: Medium, second: Medium, beside: bool) -> Finding:
    """Return what a layer between two media is, and by how much to push the first into the second."""
    name, other = first.obj.name, second.obj.name
    thin, thick = float(layer.thickness.min()), float(layer.thickness.max())
    tolerance = touch_tolerance(first.place, second.place)
    ahead = layer.thickness if kind is GAP else np.zeros_like(layer.thickness)
    wanted = OVERLAP * float(np.linalg.norm(np.subtract(*first.place.box))) + LEAST_OVERLAP * tolerance
    room = MOST_OF_WALL * room_ahead(layer, second.place, ahead, wanted / MOST_OF_WALL)
    slack = (SLACK - 1.0) * float(ahead.max())
    overlap = min(wanted, room - slack)
    distance = float(ahead.max()) + slack + overlap
    text = (
        f"has a film of air, {_range(thin, thick)} thick, between itself and {other!r}"
        if kind is GAP
        else f"overlaps {other!r} by {_range(thin, thick)}, of which rays there tell {TELLABLE * tolerance:.2g} and more"
    )
    fix = None
    if overlap >= LEAST_OVERLAP * tolerance:
        remedy = f"let it reach {overlap:.2g} into {other!r}: {_way_to_grow(first.obj)} by {distance:.2g} there"
        if can_change(first.obj):
            fix = Fix(Action.PUSH_INTO_WALL, (name, other), distance, safe=beside or not layer.one_sided)
    else:
        remedy = (
            f"make the wall of {other!r} thicker, and let {name!r} reach into it by more than {2.0 * tolerance:.2g}"
        )
    point = layer.points[:, 0] + 0.5 * (ahead[0] if kind is GAP else -layer.thickness[0]) * layer.normals[:, 0]
    place = Place(listed_faces(first.faces[layer.faces]), tuple(point.tolist()))
    return Finding(kind, name, text, remedy, (other,), place, fix)


def _range(low: float, high: float) -> str:
    """Return two lengths in words."""
    low, high = f"{low:.2g}", f"{high:.2g}"
    return low if low == high else f"{low} to {high}"


def _way_to_grow(obj: bpy.types.Object) -> str:
    """Return what makes an object larger, as a request."""
    if obj.type == "MESH" and can_change(obj):
        return "move its faces outwards (Edit Mode > Mesh > Transform > Shrink/Fatten)"
    return ", ".join(before_changing(obj) + ["move its faces outwards"])
