"""Closed meshes as arrays, and what they enclose by brute force."""

import bpy  # noqa: F401  mathutils comes with it
import numpy as np

from nested_dielectric.geometry.solids import Body, Solid


def solid_angles(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Return the signed solid angles of triangles about the origin, positive where it lies on their inner side.

    Van Oosterom and Strackee 1983, The solid angle of a plane triangle. The sum over a closed mesh is 4 pi times its
    winding number (Jacobson, Kavan and Sorkine-Hornung 2013, Robust inside-outside segmentation).

    :param a: (n, 3) first corners; b, c: the others.
    :return: (n,) steradians.
    """
    la, lb, lc = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c))
    cosines = (np.einsum("ij,ij->i", u, v) for u, v in ((a, b), (b, c), (c, a)))
    ab, bc, ca = cosines
    return 2.0 * np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb)


def icosphere(subdivisions: int = 2, radius: float = 1.0, centre=(0.0, 0.0, 0.0)) -> Solid:
    phi = (1.0 + 5.0**0.5) / 2.0
    vertices = [(-1, phi, 0), (1, phi, 0), (-1, -phi, 0), (1, -phi, 0), (0, -1, phi), (0, 1, phi)]
    vertices += [(0, -1, -phi), (0, 1, -phi), (phi, 0, -1), (phi, 0, 1), (-phi, 0, -1), (-phi, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6)]
    faces += [(7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10)]
    faces += [(8, 6, 7), (9, 8, 1)]
    points, triangles = np.array(vertices, dtype=np.float64), np.array(faces)
    for _ in range(subdivisions):
        edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
        unique, index = np.unique(edges, axis=0, return_inverse=True)
        ab, bc, ca = len(points) + index.reshape(3, -1)
        points = np.concatenate([points, points[unique].mean(axis=1)])
        a, b, c = triangles.T
        triangles = np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    points *= radius / np.linalg.norm(points, axis=1, keepdims=True)
    return Solid(points + np.array(centre), triangles.astype(np.int32))


def grid_box(low, high, cells: int = 1) -> Solid:
    """A box whose sides are divided into cells * cells squares."""
    steps = np.arange(cells + 1)
    u, v = (t.ravel() for t in np.meshgrid(steps[:-1], steps[:-1], indexing="ij"))
    points, triangles = [], []
    for axis in range(3):
        for end in (0, cells):
            square = np.empty((len(u), 4, 3), dtype=np.int64)
            square[:, :, axis] = end
            square[:, :, (axis + 1) % 3] = np.stack([u, u + 1, u + 1, u], axis=1)
            square[:, :, (axis + 2) % 3] = np.stack([v, v, v + 1, v + 1], axis=1)
            if end == 0:
                square = square[:, ::-1]
            start = sum(len(p) for p in points)
            points.append(square.reshape(-1, 3))
            index = start + np.arange(4 * len(u)).reshape(-1, 4)
            triangles += [index[:, [0, 1, 2]], index[:, [0, 2, 3]]]
    unique, index = np.unique(np.concatenate(points), axis=0, return_inverse=True)
    low, high = np.array(low, dtype=np.float64), np.array(high, dtype=np.float64)
    return Solid(low + (high - low) * unique / cells, index[np.concatenate(triangles)].astype(np.int32))


def joined(*solids: Solid) -> Solid:
    offsets = np.cumsum([0] + [len(solid.vertices) for solid in solids])
    triangles = [solid.triangles + offset for solid, offset in zip(solids, offsets)]
    return Solid(np.concatenate([solid.vertices for solid in solids]), np.concatenate(triangles).astype(np.int32))


def inverted(solid: Solid) -> Solid:
    return Solid(solid.vertices, np.ascontiguousarray(solid.triangles[:, ::-1]))


def at(*place: float, scale=1.0) -> np.ndarray:
    matrix = np.diag(np.append(np.broadcast_to(scale, 3), 1.0).astype(np.float64))
    matrix[: len(place), 3] = place
    return matrix


def placed(body: Body) -> np.ndarray:
    """(m, 3, 3) triangles in the world, counterclockwise from outside."""
    points = body.solid.vertices @ body.matrix[:3, :3].T + body.matrix[:3, 3]
    triangles = body.solid.triangles
    return points[triangles[:, ::-1] if np.linalg.det(body.matrix[:3, :3]) < 0.0 else triangles]


def winding(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Winding numbers by solid angles of all triangles about all points."""
    result = []
    for some in np.array_split(points, max(1, len(points) * len(triangles) // 200_000)):
        corners = (triangles[None] - some[:, None, None]).reshape(-1, 3, 3).transpose(1, 0, 2)
        result.append(solid_angles(*corners).reshape(len(some), -1).sum(axis=1))
    return np.rint(np.concatenate(result) / (4.0 * np.pi)).astype(int)


def random_matrix(rng: np.random.Generator, spread: float) -> np.ndarray:
    linear = np.linalg.qr(rng.normal(size=(3, 3)))[0] @ np.diag(rng.uniform(0.3, 1.2, 3) * rng.choice([-1, 1], 3))
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, rng.uniform(-spread, spread, 3)
    return matrix


def torus(steps: int = 24, minor: float = 0.3, wobble: float = 0.0) -> Solid:
    u, v = (t.ravel() for t in np.meshgrid(np.arange(steps), np.arange(steps), indexing="ij"))
    s, t = 2 * np.pi * u / steps, 2 * np.pi * v / steps
    points = np.stack(
        [(1 + minor * np.cos(t)) * np.cos(s), (1 + minor * np.cos(t)) * np.sin(s), minor * np.sin(t)], axis=1
    )
    points += wobble * np.random.default_rng(0).normal(size=points.shape)
    a, b = u * steps + v, (u + 1) % steps * steps + v
    c, d = (u + 1) % steps * steps + (v + 1) % steps, u * steps + (v + 1) % steps
    return Solid(points, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32))


def same(one, other) -> bool:
    facts = (
        (
            each.code,
            each.surrounding_body,
            each.sole_priority,
            each.partners,
            each.overlaps_itself,
            repr(each.coincident),
        )
        for each in (one, other)
    )
    return next(facts) == next(facts)
