"""Which surfaces rest on a foreign one: share part of a plane with it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .coplanar import parallel_pairs, share_a_plane
from .hierarchy import BoxHierarchy, overlapping_leaves
from .numbering import NO_FACES, compact_numbers
from .solids import PlacedSolid, Solid, touch_tolerance
from .surfaces import FLOAT_ROUNDING, TOUCH_TOLERANCE, faces_in_box
from .triangles import with_normals


def resting_surfaces(places: Sequence[PlacedSolid], foreign: Solid) -> dict[int, np.ndarray]:
    """Find which surfaces share part of a plane with a foreign one, within the distance at which two bodies touch.

    :param places: of surfaces in the world, none need be closed; foreign: in the world's space.
    :return: by the place of each among them its triangles that do.
    """
    if len(foreign.triangles) == 0 or not places:
        return {}
    low, high = (np.array([place.box[end] for place in places]) for end in (0, 1))
    margin = TOUCH_TOLERANCE * np.linalg.norm(high - low, axis=1) + 2.0 * FLOAT_ROUNDING * np.abs([low, high]).max()
    low, high = low - margin[:, None], high + margin[:, None]
    foreign = _cropped(foreign, low.min(axis=0), high.max(axis=0))
    if len(foreign.triangles) == 0:
        return {}
    other = PlacedSolid(foreign, np.eye(4))
    found = {index: _resting(place, other, low[index], high[index]) for index, place in enumerate(places)}
    return {index: faces for index, faces in found.items() if len(faces)}


def _cropped(solid: Solid, low: np.ndarray, high: np.ndarray) -> Solid:
    """Keep the triangles whose boxes meet a box."""
    points = solid.vertices[solid.triangles]
    return Solid(
        solid.vertices,
        solid.triangles[((points.min(axis=1) <= high) & (points.max(axis=1) >= low)).all(axis=1)],
    )


def _resting(a: PlacedSolid, b: PlacedSolid, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return the triangles of a surface that share part of a plane with another's.

    :param low: (3,) lowest corner of the box of a with a margin; high: the highest.
    """
    faces_b = faces_in_box(b, low, high)
    if len(faces_b) == 0:
        return NO_FACES
    margin = (high - low - a.box[1] + a.box[0]) / 2.0
    points = b.points(faces_b)
    faces_a = faces_in_box(a, points.min(axis=(0, 1)) - margin, points.max(axis=(0, 1)) + margin)
    if len(faces_a) == 0:
        return NO_FACES
    tolerance = touch_tolerance(a, b)
    trees = (
        BoxHierarchy(place.bounds[:, faces], np.array([0, len(faces)])) for place, faces in ((a, faces_a), (b, faces_b))
    )
    first, second = overlapping_leaves(*trees, tolerance)
    index_a, index_b = (compact_numbers(first, len(faces_a)), compact_numbers(second, len(faces_b)))
    of_a, of_b = with_normals(a, faces_a[index_a[0]]), with_normals(b, faces_b[index_b[0]])
    i, j, _, tolerances = parallel_pairs(of_a, index_a[1], of_b, index_b[1], np.full(len(first), tolerance))
    return np.unique(a.solid.order[faces_a[index_a[0]]][i[share_a_plane(of_a, i, of_b, j, tolerances)]])
