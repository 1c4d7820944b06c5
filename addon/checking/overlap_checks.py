"""Checks of media that lie in the place of something else."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np

from ..analysis.findings import listed
from ..geometry.resting import resting_surfaces
from ..geometry.solids import Solid
from ..scene.media import SOLID_TYPES, get_priority, is_cut_surface
from .evaluated_shapes import Containment, Shape, evaluated_shape
from .finding import Problem
from .mesh_checks import medium_signature

NEAR = 1e-4
"""Distance by which to move what touches something else, in diagonals of its box."""


def foreign_contact_problems(
    shapes: list[Shape], objects: list[bpy.types.Object], depsgraph: bpy.types.Depsgraph
) -> list[Problem]:
    """Return media whose faces lie in the same place as those of what is no medium, of which a ray meets either."""
    shapes = [shape for shape in shapes if len(shape.triangles) and np.isfinite(shape.vertices).all()]
    if not shapes:
        return []
    low, high = (np.array([end(shape.vertices, axis=0) for shape in shapes]) for end in (np.min, np.max))
    size = np.linalg.norm(high - low, axis=1)
    margin = NEAR * size[:, None]
    among = set(objects)
    names: dict[int, dict[str, None]] = {}
    for instance in depsgraph.object_instances:
        obj = instance.object
        if obj.type not in SOLID_TYPES or obj.original in among or obj.original.hide_render or is_cut_surface(obj):
            continue
        matrix = np.array(instance.matrix_world)
        box = np.array([tuple(corner) for corner in obj.bound_box]) @ matrix[:3, :3].T + matrix[:3, 3]
        meets = (low - margin <= box.max(axis=0)) & (high + margin >= box.min(axis=0))
        near = np.flatnonzero(meets.all(axis=1))
        foreign = evaluated_shape(obj, matrix) if len(near) else None
        if foreign is None or not np.isfinite(foreign.vertices).all():
            continue
        solids = [Solid(shapes[index].vertices, shapes[index].triangles) for index in near]
        for index in resting_surfaces(solids, Solid(foreign.vertices, foreign.triangles)):
            names.setdefault(int(near[index]), {})[obj.name] = None
    return [
        Problem(
            shapes[index].obj.name,
            f"has faces in the same place as {listed(tuple(others))}, which is no medium",
            f"move them {NEAR * size[index]:.2g} apart, which leaves air between them, or let them overlap as much, "
            "which leaves none",
        )
        for index, others in sorted(names.items())
    ]


def overlap_problems(shapes: list[Shape]) -> list[Problem]:
    """Return objects of equal priority and different media that overlap.

    Objects of equal priority that overlap are one medium; that they should be two different ones cannot be meant.
    """
    by_priority: dict[int, list[Shape]] = {}
    for shape in shapes:
        if len(shape.triangles) and np.isfinite(shape.vertices).all():
            by_priority.setdefault(get_priority(shape.obj), []).append(shape)
    inside = Containment()
    return [
        Problem(
            one.obj.name,
            f"overlaps {other.obj.name!r} with the same priority {priority} and another medium",
            "give the one that should win the lower priority",
        )
        for priority, equals in by_priority.items()
        for one, other in _different_neighbours(equals)
        if inside.overlap(one, other)
    ]


def _different_neighbours(shapes: list[Shape]) -> Iterator[tuple[Shape, Shape]]:
    """Yield pairs of shapes of different media whose boxes meet."""
    numbers: dict[tuple, int] = {}
    kinds = np.array([numbers.setdefault(medium_signature(shape.obj), len(numbers)) for shape in shapes])
    if len(numbers) < 2:
        return
    low, high = (np.array([end(shape.vertices, axis=0) for shape in shapes]) for end in (np.min, np.max))
    for index, shape in enumerate(shapes):
        rest = slice(index + 1, None)
        meets = (low[rest] <= high[index]).all(axis=1) & (high[rest] >= low[index]).all(axis=1)
        for other in np.flatnonzero(meets & (kinds[rest] != kinds[index])):
            yield shape, shapes[index + 1 + other]
