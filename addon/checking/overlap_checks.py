"""Checks of media of equal priority that overlap."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np

from ..geometry.common_points import common_point
from ..model.parameter import MAX_PRIORITY
from .finding import Action, Finding, Fix, Place
from .inspection import Inspection, Medium
from .kinds import EQUAL_PRIORITIES
from .signatures import medium_signature


def overlap_findings(inspection: Inspection) -> Iterator[Finding]:
    """Yield objects of equal priority and different media that overlap.

    Objects of equal priority that overlap are one medium; that they should be two different ones cannot be meant.
    """
    media, contacts = inspection.media, inspection.contacts
    pairs = {tuple(sorted((index, other))) for index, contact in enumerate(contacts) for other in contact.partners}
    seen: set[frozenset[bpy.types.Object]] = set()
    for first, second in sorted(pairs):
        one, other = media[first], media[second]
        objects = frozenset((one.obj, other.obj))
        if one.body.priority != other.body.priority or objects in seen:
            continue
        if medium_signature(one.obj) == medium_signature(other.obj):
            continue
        point = common_point(one.place, other.place)
        if point is None:
            continue
        seen.add(objects)
        one, other = sorted((one, other), key=lambda medium: medium.obj.name)
        yield Finding(
            EQUAL_PRIORITIES,
            one.obj.name,
            f"overlaps {other.obj.name!r} with the same priority {one.body.priority} and another medium",
            "give the one that should win the lower priority",
            (other.obj.name,),
            Place(point=tuple(point.tolist())),
            _priority_fix(media, pairs, one, other),
        )


def _priority_fix(media: list[Medium], pairs: set[tuple[int, int]], one: Medium, other: Medium) -> Fix | None:
    """Return a priority with which the smaller of two wins and no order beside changes; None where there is no room for one.

    :param pairs: indices of media that touch.
    """
    small, large = sorted((one, other), key=lambda medium: float(np.prod(np.subtract(*medium.place.box[::-1]))))
    for medium, value in ((small, small.body.priority - 1), (large, large.body.priority + 1)):
        beside = {
            media[pair[1 - side]].body.priority
            for pair in pairs
            for side in (0, 1)
            if media[pair[side]].obj == medium.obj
        }
        if 0 <= value <= MAX_PRIORITY and value not in beside and medium.obj.is_editable:
            return Fix(Action.SET_PRIORITY, (medium.obj.name,), value, safe=False)
    return None
