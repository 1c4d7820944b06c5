"""Where the surface of one mesh overlaps itself."""

from __future__ import annotations

import numpy as np
from mathutils.bvhtree import BVHTree

from .hierarchy import BoxHierarchy, overlapping_leaves
from .numbering import CHUNK, compact_numbers
from .surfaces import FLOAT_ROUNDING, TOUCH_TOLERANCE, Surfaces, normals_of
from .triangles import with_normals, without_separating_axis
from .vectors import dot, length
from .winding import ray_crossings, winding_numbers

# Height above the centre, in sizes of the island, from which a face certainly looks away from it.
LEAST_HEIGHT = 1e-6


def overlapping_triangle(surface: Surfaces) -> int | None:
    """Return a triangle where the surface of one mesh overlaps itself, None where it does nowhere.

    It crosses itself there, or the triangle is of an island that does not separate the inside from the outside. Islands that
    are star-shaped about their centre cannot cross themselves; the others are intersected.
    """
    faces, starts = surface.by_island
    for island in np.flatnonzero(~_are_star_shaped(surface)):
        found = _crossing_triangle(surface, faces[starts[island] : starts[island + 1]])
        if found is not None:
            return found
    if len(starts) == 2:
        return None
    found = _triangle_that_touches_an_island(surface)
    if found is not None:
        return found
    wrong = np.flatnonzero(_outer_winding_numbers(surface) != 0)
    return int(faces[starts[wrong[0]]]) if len(wrong) else None


def inward_islands(surface: Surfaces) -> np.ndarray:
    """Return the islands of one mesh whose normals point into them, and that are no cavities of others."""
    return np.flatnonzero(_outer_winding_numbers(surface) < 0)


def _are_star_shaped(surface: Surfaces) -> np.ndarray:
    """Return whether each island is certainly star-shaped about its centre, so that it cannot cross itself, (k,).

    Where all triangles look away from the centre and a ray from it meets but one, none lies behind another.
    """
    islands = surface.islands
    low, high = surface.island_boxes
    centre = (low + high) / 2.0
    size = np.linalg.norm(high - low, axis=0)
    normals = normals_of(surface)
    offset = [axis[surface.corners[0]] - c[islands] for axis, c in zip(surface.vertices, centre)]
    behind = dot(offset, normals) < LEAST_HEIGHT * size[islands] * length(normals)
    star = np.bincount(islands[behind], minlength=len(size)) == 0
    over = star[islands]
    for axis, c in zip(surface.vertices[:2], centre[:2]):
        beyond = [axis[corner] > c[islands] for corner in surface.corners]
        over &= (beyond[0] != beyond[1]) | (beyond[1] != beyond[2])
    faces = np.flatnonzero(over)
    return star & (ray_crossings(centre.T, surface, islands[faces], faces) == 1)


def _triangle_that_touches_an_island(surface: Surfaces) -> int | None:
    """Return a triangle that crosses or touches another island than its own; None where there is none."""
    size = length(np.subtract(*surface.island_boxes))
    tolerance = TOUCH_TOLERANCE * size + FLOAT_ROUNDING * float(np.abs(surface.boxes).max())
    faces, trees = surface.by_island[0], surface.island_trees
    first, second = near_islands(surface, tolerance)
    for start in range(0, len(first), CHUNK):
        chunk = slice(start, start + CHUNK)
        i, j = overlapping_leaves(trees, trees, float(tolerance.max()), first[chunk], second[chunk])
        for begin in range(0, len(i), CHUNK):
            some = [faces[each[begin : begin + CHUNK]] for each in (i, j)]
            least = np.minimum(*(tolerance[surface.islands[each]] for each in some))
            a, b = (with_normals(surface, each) for each in some)
            number = np.arange(len(least))
            touching = without_separating_axis(a, number, b, number, least)[0]
            if len(touching):
                return int(some[0][touching[0]])
    return None


def near_islands(surface: Surfaces, tolerance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Find the pairs of islands that may touch: those no farther apart than the tolerance of one of them.

    :param tolerance: (k,) of the islands.
    :return: two arrays of islands, the first with the lower number.
    """
    island, tree = surface.pieces
    grown = BoxHierarchy(tree.bounds - tolerance[island], tree.starts)
    first, second = (island[piece] for piece in overlapping_leaves(grown, grown, 0.0))
    once = first < second
    return np.divmod(np.unique(first[once] * len(tolerance) + second[once]), len(tolerance))


def aligning_frame(surface: Surfaces) -> np.ndarray:
    """Return the rotation that turns the axes along which islands extend the least and the most to x and z, (4, 4).

    The boxes of many islands that lie askew, but alike, are then apart.
    """
    axes, extent, _ = surface.island_axes
    long = (axes * extent.T[:, None]).transpose(1, 0, 2).reshape(3, -1)
    result = np.eye(4)
    result[:3, :3] = np.linalg.eigh(long @ long.T)[1].T
    result[0] *= np.linalg.det(result)
    return result


def _outer_winding_numbers(surface: Surfaces) -> np.ndarray:
    """Return the winding number of the mesh just outside one triangle of every island, (k,)."""
    islands = surface.islands
    up = normals_of(surface)[2]
    steep = np.lexsort([np.abs(up), islands])
    faces = steep[np.cumsum(np.bincount(islands)) - 1]
    # The ray upwards from just outside a triangle that looks down enters through it.
    return winding_numbers(surface.centroids(faces), surface, left_out=faces) - (up[faces] < 0.0)


def _crossing_triangle(surface: Surfaces, faces: np.ndarray) -> int | None:
    """Return a triangle of a mesh that crosses another, beyond vertices and edges that they share; None if there is none."""
    low, high = (end[:, 0] for end in surface.boxes)
    centre = (low + high) / 2.0
    size = float((high - low).max())
    used, corners = compact_numbers(surface.corners[:, faces], surface.vertices.shape[1])
    vertices = ((surface.vertices[:, used].T - centre) / max(size, 1e-300)).tolist()
    # Shared corners are known to the tree by their indices.
    tree = BVHTree.FromPolygons(vertices, corners.reshape(3, -1).T.tolist(), all_triangles=True, epsilon=1e-12)
    pairs = np.array(tree.overlap(tree), dtype=np.intp).reshape(-1, 2)
    if len(pairs) == 0:
        return None
    first, second = surface.points(faces[pairs[:, 0]]), surface.points(faces[pairs[:, 1]])
    found = np.flatnonzero(_pierces(first, second) | _pierces(second, first))
    return int(faces[pairs[found[0], 0]]) if len(found) else None


def _pierces(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return whether an edge of one triangle runs through the inside of another, by more than rounding, (k,).

    :param first: (k, 3 corners, 3 axes) triangles with the edges; second: those with the insides.
    """
    size = np.abs(second - second[:, :1]).max(axis=(1, 2)) + np.abs(first - second[:, :1]).max(axis=(1, 2))
    least = 1e-9 * size**3
    a, b, c = second.transpose(1, 0, 2)
    result = np.zeros(len(first), dtype=bool)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        start, end = first[:, i], first[:, j]
        through = _orientation(a, b, c, start), _orientation(a, b, c, end)
        sides = [_orientation(start, end, u, v) for u, v in ((a, b), (b, c), (c, a))]
        apart = (np.abs(through[0]) > least) & (np.abs(through[1]) > least) & (through[0] * through[1] < 0.0)
        inside = np.all([side > least for side in sides], axis=0) | np.all([side < -least for side in sides], axis=0)
        result |= apart & inside
    return result


def _orientation(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Return six times the signed volumes of tetrahedra, (k,)."""
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a)
