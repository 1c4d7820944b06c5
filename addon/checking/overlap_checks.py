"""Checks of media that lie in the place of something else."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..analysis.findings import listed
from ..geometry.resting import resting_surfaces
from ..geometry.solids import Solid
from ..scene.media import get_priority
from .evaluated_shapes import Shape
from .finding import Finding
from .inspection import Inspection
from .kinds import EQUAL_PRIORITIES, FOREIGN_COINCIDENT
from .mesh_checks import medium_signature

NEAR = 1e-4
"""Distance by which to move what touches something else, in diagonals of its box."""


def foreign_contact_findings(inspection: Inspection) -> list[Finding]:
    """Return media whose faces lie in the same place as those of what is no medium, of which a ray meets either."""
    shapes = inspection.solids
    if not shapes:
        return []
    low, high = np.array([shape.box for shape in shapes]).swapaxes(0, 1)
    size = np.linalg.norm(high - low, axis=1)
    margin = NEAR * size[:, None]
    names: dict[int, dict[str, None]] = {}
    for foreign in inspection.foreign(low - margin, high + margin):
        meets = (low - margin <= foreign.box[1]) & (high + margin >= foreign.box[0])
        near = np.flatnonzero(meets.all(axis=1))
        solids = [Solid(shapes[index].vertices, shapes[index].triangles) for index in near]
        for index in resting_surfaces(solids, Solid(foreign.vertices, foreign.triangles)):
            names.setdefault(int(near[index]), {})[foreign.obj.name] = None
    return [
        Finding(
            FOREIGN_COINCIDENT,
            shapes[index].obj.name,
            f"has faces in the same place as {listed(tuple(others))}, which is no medium",
            f"move them {NEAR * size[index]:.2g} apart, which leaves air between them, or let them overlap as much, "
            "which leaves none",
        )
        for index, others in sorted(names.items())
    ]


def overlap_findings(inspection: Inspection) -> list[Finding]:
    """Return objects of equal priority and different media that overlap.

    Objects of equal priority that overlap are one medium; that they should be two different ones cannot be meant.
    """
    by_priority: dict[int, list[Shape]] = {}
    for shape in inspection.solids:
        by_priority.setdefault(get_priority(shape.obj), []).append(shape)
    return [
        Finding(
            EQUAL_PRIORITIES,
            one.obj.name,
            f"overlaps {other.obj.name!r} with the same priority {priority} and another medium",
            "give the one that should win the lower priority",
        )
        for priority, equals in by_priority.items()
        for one, other in _different_neighbours(equals)
        if inspection.inside.overlap(one, other)
    ]


def _different_neighbours(shapes: list[Shape]) -> Iterator[tuple[Shape, Shape]]:
    """Yield pairs of shapes of different media whose boxes meet."""
    numbers: dict[tuple, int] = {}
    kinds = np.array([numbers.setdefault(medium_signature(shape.obj), len(numbers)) for shape in shapes])
    if len(numbers) < 2:
        return
    low, high = np.array([shape.box for shape in shapes]).swapaxes(0, 1)
    for index, shape in enumerate(shapes):
        rest = slice(index + 1, None)
        meets = (low[rest] <= high[index]).all(axis=1) & (high[rest] >= low[index]).all(axis=1)
        for other in np.flatnonzero(meets & (kinds[rest] != kinds[index])):
            yield shape, shapes[index + 1 + other]
