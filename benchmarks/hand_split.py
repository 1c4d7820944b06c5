"""Overlapping bodies split into interfaces, as one would by hand for a renderer that knows no priorities.

Every piece is a part of one body's surface, with its normals out of that body, and separates it from one other medium.
With Cycles' own Glass of the piece's ratio of indices, a path meets one surface wherever it passes from one medium to
another, and none elsewhere.

Bodies of one priority and one medium are split together as one surface of many components.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import bpy  # before mathutils, which lives inside it
import numpy as np
from bench_arrays import Body
from bench_scenes import AIR, SCENES
from bench_shapes import joined, mesh_arrays, mesh_of
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from nested_dielectric.geometry import meshes

OWN = "own"
"""Face attribute that tells a surface's own faces from those that cutters left."""


class Piece(NamedTuple):
    """One interface.

    `vertices` (n, 3) float64 in world space, `triangles` (m, 3) int, counter-clockwise seen from outside the body;
    `ior_ratio` is the body's index over the index of what lies outside.
    """

    name: str
    vertices: np.ndarray
    triangles: np.ndarray
    ior_ratio: float


class Split(NamedTuple):
    """All interfaces of some bodies, and the parts of their surfaces that lie inside a body that wins there."""

    pieces: list[Piece]
    hidden: list[Piece]


@dataclass(frozen=True, eq=False)
class Surface:
    """A closed surface, (n, 3) vertices and (m, 3) triangles, and which of its triangles are its own, (m,) bool."""

    vertices: np.ndarray
    triangles: np.ndarray
    own: np.ndarray

    @cached_property
    def tree(self) -> BVHTree:
        """For tests of overlap."""
        return BVHTree.FromPolygons(self.vertices.tolist(), self.triangles.tolist(), all_triangles=True)

    @cached_property
    def labels(self) -> np.ndarray:
        """Number of the connected component of every triangle, (m,), counted from 0."""
        a, b, c = self.triangles.T
        root = meshes.connected(len(self.vertices), np.concatenate([a, b]), np.concatenate([b, c]))
        return np.unique(root[a], return_inverse=True)[1]

    def kept(self, triangles: np.ndarray) -> Surface:
        """Some of the triangles."""
        return Surface(self.vertices, self.triangles[triangles], self.own[triangles])


@dataclass(frozen=True, eq=False)
class Medium:
    """All bodies of one priority and one medium."""

    name: str
    priority: int
    ior: float
    surface: Surface


def media(bodies: Iterable[Body]) -> list[Medium]:
    """The media that bodies are of, the one that wins over all others first."""
    groups: dict[tuple, list[Body]] = {}
    for body in bodies:
        groups.setdefault((body.priority, body.ior, body.abbe), []).append(body)
    found = []
    for (priority, ior, _), members in sorted(groups.items()):
        vertices, triangles = joined([(body.vertices, body.triangles) for body in members])
        name = members[0].name + (f" and {len(members) - 1} more" if len(members) > 1 else "")
        surface = Surface(vertices, triangles, np.ones(len(triangles), bool))
        found.append(Medium(name, priority, ior, surface))
    return found


def split(bodies: Sequence[Body]) -> Split:
    """Every interface between the media of some bodies, and between them and air."""
    order = media(bodies)
    pieces, hidden = [], []
    for place, medium in enumerate(order):
        rest = medium.surface
        for stronger in order[:place]:
            lost, rest = parted(rest, stronger)
            hidden.append(piece(medium, lost, stronger.name, stronger.ior))
        for weaker in order[place + 1 :]:
            inside, rest = parted(rest, weaker)
            pieces.append(piece(medium, inside, weaker.name, weaker.ior))
        pieces.append(piece(medium, rest, "air", AIR))
    return Split(*([part for part in parts if len(part.triangles)] for parts in (pieces, hidden)))


def piece(medium: Medium, surface: Surface, outside: str, ior: float) -> Piece:
    """What is a medium's own of a surface, without vertices that nothing uses."""
    used, triangles = np.unique(surface.triangles[surface.own], return_inverse=True)
    return Piece(f"{medium.name} to {outside}", surface.vertices[used], triangles.reshape(-1, 3), medium.ior / ior)


def parted(surface: Surface, cutter: Medium) -> tuple[Surface, Surface]:
    """The parts of a surface inside and outside a medium.

    Both are closed where the two cross; where they do not, both are made of whole components.
    """
    if not len(surface.triangles):
        return surface, surface
    if surface.tree.overlap(cutter.surface.tree):
        inside, outside = boolean(surface, cutter.surface)
        return with_own_faces(inside), with_own_faces(outside)
    first = np.unique(surface.labels, return_index=True)[1]
    points = surface.vertices[surface.triangles[first, 0]]
    inside = encloses(cutter.surface, points)[surface.labels]
    if not inside.any():
        return surface.kept(inside), surface  # which knows its tree already
    return surface.kept(inside), surface.kept(~inside)


def with_own_faces(surface: Surface) -> Surface:
    """The components that have faces of their own; the others bound nothing that is asked for."""
    if not len(surface.triangles):
        return surface
    return surface.kept((np.bincount(surface.labels, weights=surface.own) > 0)[surface.labels])


def boolean(surface: Surface, cutter: Surface) -> tuple[Surface, Surface]:
    """A surface's intersection with a closed cutter and what is left of it; faces of the cutter are nobody's own."""
    other = Surface(cutter.vertices, cutter.triangles, np.zeros(len(cutter.triangles), bool))
    objects = [placed(surface), placed(other)]
    modifier = objects[0].modifiers.new("Boolean", "BOOLEAN")
    modifier.object = objects[1]
    modifier.solver = "MANIFOLD"
    results = []
    for modifier.operation in ("INTERSECT", "DIFFERENCE"):
        evaluated = objects[0].evaluated_get(bpy.context.evaluated_depsgraph_get())
        results.append(surface_of(evaluated.data))
    for obj in objects:
        mesh = obj.data
        bpy.data.objects.remove(obj)
        bpy.data.meshes.remove(mesh)
    return results[0], results[1]


def placed(surface: Surface) -> bpy.types.Object:
    """An object of a surface in the current scene."""
    used, triangles = np.unique(surface.triangles, return_inverse=True)
    mesh = mesh_of("Surface", surface.vertices[used], triangles.reshape(-1, 3))
    mesh.attributes.new(OWN, "INT", "FACE").data.foreach_set("value", surface.own.astype(np.int32))
    obj = bpy.data.objects.new("Surface", mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def surface_of(mesh: bpy.types.Mesh) -> Surface:
    """The surface that a mesh of :func:`placed` has become."""
    if not len(mesh.polygons):
        return Surface(np.empty((0, 3)), np.empty((0, 3), np.int64), np.empty(0, bool))
    vertices, triangles = mesh_arrays(mesh)
    faces = np.empty(len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("polygon_index", faces)
    own = np.empty(len(mesh.polygons), np.int32)
    mesh.attributes[OWN].data.foreach_get("value", own)
    return Surface(vertices, triangles, own[faces].astype(bool))


DIRECTIONS = tuple(Vector(way).normalized() for way in ((0.38, 0.53, 0.77), (-0.62, 0.71, 0.33), (0.21, -0.44, -0.85)))
"""Of rays that ask what lies inside; that many so that one may meet an edge."""


def encloses(surface: Surface, points: np.ndarray) -> np.ndarray:
    """Whether a closed surface encloses each point, (k,) bool."""
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    within = np.all((low <= points) & (points <= high), axis=1)
    within[within] = [
        sum(winding_number(surface.tree, Vector(point), way) > 0 for way in DIRECTIONS) >= 2 for point in points[within]
    ]
    return within


def winding_number(tree: BVHTree, point: Vector, direction: Vector) -> int:
    """How many times a closed surface encloses a point: its faces that a ray leaves through less those it enters."""
    count = 0
    while True:
        place, normal, _, _ = tree.ray_cast(point, direction)
        if place is None:
            return count
        count += 1 if normal.dot(direction) > 0.0 else -1
        point = place + 1e-6 * direction


# Checks -------------------------------------------------------------------------------------------------------------


def area_vectors(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Normal of every triangle, as long as its area, (m, 3)."""
    a, b, c = (vertices[corner] for corner in triangles.T)
    return 0.5 * np.cross(b - a, c - a)


def wrong_points(bodies: Sequence[Body], pieces: Sequence[Piece], count: int = 40, step: float = 1e-4) -> list[str]:
    """Names of pieces, one for every point of `count` on each whose ratio of indices is not that of the bodies.

    Points are drawn by area; what lies inside and outside of each is asked `step` away from it.
    """
    random = np.random.default_rng(0)
    order = media(bodies)
    wrong = []
    for found in pieces:
        areas = area_vectors(found.vertices, found.triangles)
        sizes = np.linalg.norm(areas, axis=1)
        chosen = random.choice(len(sizes), count, p=sizes / sizes.sum())
        weights = random.dirichlet((1.0, 1.0, 1.0), count)
        points = np.einsum("ij,ijk->ik", weights, found.vertices[found.triangles[chosen]])
        normals = areas[chosen] / sizes[chosen, None]
        inside, outside = (winning_ior(points + side * step * normals, order) for side in (-1.0, 1.0))
        wrong += [found.name] * int(np.sum(np.abs(inside / outside - found.ior_ratio) > 1e-9))
    return wrong


def winning_ior(points: np.ndarray, order: Sequence[Medium]) -> np.ndarray:
    """Index of the medium that wins at each point, (k,)."""
    result = np.full(len(points), AIR)
    for medium in reversed(order):
        result[encloses(medium.surface, points)] = medium.ior
    return result


def openness(pieces: Sequence[Piece]) -> dict[str, float]:
    """How far the boundary of every medium's region is from closed: the sum of its area vectors over its area.

    The boundary is made of the medium's own pieces and, turned around, of those that others have towards it.
    """
    ends = [(piece, piece.name.split(" to ")) for piece in pieces]
    found = {}
    for name in {name for _, names in ends for name in names}:
        total, area = np.zeros(3), 0.0
        for piece, (inside, outside) in ends:
            if name in (inside, outside):
                vectors = area_vectors(piece.vertices, piece.triangles)
                total += vectors.sum(axis=0) * (1.0 if name == inside else -1.0)
                area += np.linalg.norm(vectors, axis=1).sum()
        found[name] = float(np.linalg.norm(total) / area)
    return found


def main() -> None:
    """Print every scene's pieces and what is wrong with them."""
    for name, make in SCENES.items():
        bpy.ops.wm.read_factory_settings(use_empty=True)
        scene = make()
        pieces, hidden = split(scene.bodies)
        print(f"{name}: {len(pieces)} pieces, {sum(len(piece.triangles) for piece in pieces)} triangles")
        for piece in pieces:
            print(f"  {piece.name}: {len(piece.triangles)} triangles, ratio {piece.ior_ratio:.4f}")
        print(f"  {sum(len(piece.triangles) for piece in hidden)} triangles are hidden")
        print(f"  points of another ratio: {wrong_points(scene.bodies, pieces) or 'none'}")
        print(f"  open by at most {max(openness(pieces).values()):.1e} of the area")


if __name__ == "__main__":
    main()
