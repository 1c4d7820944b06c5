"""Points spread evenly over triangles, and what straight ways from them meet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .hierarchy import leaves_in_boxes
from .numbering import CHUNK
from .surfaces import Surfaces
from .vectors import cross, dot, length

SAMPLES = 512
"""Points by which a surface is looked at."""

STEPS = np.array([[0.8191725133961645], [0.6710436067037893], [0.5497004779019703]])
"""Steps from one point to the next along all triangles and across each of them, which fill them evenly however few are taken
(Roberts 2018, The unreasonable effectiveness of quasirandom sequences): steps in the order of a mesh would fall into its beat.
"""


@dataclass(frozen=True, eq=False)
class Samples:
    """SAMPLES points spread evenly over triangles, and so are the first few of them.

    :param faces: (k,) the triangle of each; corners: (3 axes, 3, k) its corners; areas: (k,) its area.
    :param shares: (3, k) of the corners in the point.
    """

    faces: np.ndarray
    corners: np.ndarray
    areas: np.ndarray
    shares: np.ndarray


def spread_samples(vertices: np.ndarray, triangles: np.ndarray) -> Samples:
    """Spread points evenly over triangles.

    :param vertices: (n, 3); triangles: (m, 3) their indices.
    """
    a, b, c = (vertices.T[:, corner] for corner in triangles.T)
    areas = 0.5 * length(cross(b - a, c - a))
    total = np.cumsum(areas)
    along, u, v = (0.5 + np.arange(1, SAMPLES + 1) * STEPS) % 1.0
    faces = np.minimum(np.searchsorted(total, along * total[-1]), len(areas) - 1)
    u, v = np.where(u + v > 1.0, 1.0 - u, u), np.where(u + v > 1.0, 1.0 - v, v)
    corners = vertices[triangles[faces]].transpose(2, 1, 0)
    return Samples(faces, np.ascontiguousarray(corners), areas[faces], np.array([1.0 - u - v, u, v]))


def meet(
    surfaces: Surfaces, trees: np.ndarray, points: np.ndarray, ways: np.ndarray, before: np.ndarray, behind: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Find the triangles that straight ways meet.

    :param trees: (n,) the body of the surfaces that each looks for; points: (3, n) where they start; ways: (3, n) unit
        vectors; before, behind: (n,) how far they reach ahead and back.
    :return: for each meeting the way, the triangle, how far ahead, and the product of the way with the normal.
    """
    found = [(np.empty(0, dtype=np.intp),) * 2 + (np.empty(0),) * 2]
    for start in range(0, len(trees), 4 * CHUNK):
        some = slice(start, start + 4 * CHUNK)
        ends = points[:, some] + ways[:, some] * before[some], points[:, some] - ways[:, some] * behind[some]
        way, face = leaves_in_boxes(surfaces.hierarchy, trees[some], np.minimum(*ends), np.maximum(*ends))
        way += start
        p, direction = points[:, way], ways[:, way]
        a, b, c = (surfaces.vertices[:, corner[face]] - p for corner in surfaces.corners)
        sides = np.array([dot(direction, cross(u, v)) for u, v in ((b, c), (c, a), (a, b))])
        normal = cross(b - a, c - a)
        along = dot(normal, direction)
        with np.errstate(divide="ignore", invalid="ignore"):
            distance, cosine = dot(normal, a) / along, along / length(normal)
            reached = (distance <= before[way]) & (distance >= -behind[way])
        inside = (sides >= 0.0).all(axis=0) | (sides <= 0.0).all(axis=0)
        kept = np.flatnonzero(inside & reached)
        found.append((way[kept], face[kept], distance[kept], cosine[kept]))
    return tuple(np.concatenate(parts) for parts in zip(*found))
