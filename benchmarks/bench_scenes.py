"""The scenes of the benchmark as plain arrays, so that every renderer gets the same ones.

``SCENES[name]()`` returns a :class:`BenchScene`: closed bodies that overlap as nested dielectrics want it, a camera and
a sky. Media are clear and smooth, shading is flat. World space, Z up; one unit is about 10 cm.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import cos, pi, radians, sin, sqrt
from pathlib import Path

import bpy  # before bmesh and mathutils, which live inside it

import bmesh  # isort: skip
import numpy as np
from mathutils import Euler, Matrix, Vector

from nested_dielectric.demo import iced_water
from nested_dielectric.scene.shapes import triangles_of

AIR, WATER, ICE, GLASS = 1.0, 1.33, 1.31, 1.52
WINE = 1.345

BUBBLE_PRIORITY, GLASS_PRIORITY, ICE_PRIORITY, WINE_PRIORITY, WATER_PRIORITY = 5, 10, 20, 25, 30


@dataclass(frozen=True, eq=False)
class Body:
    """A closed surface and what is in it.

    `vertices` (n, 3) float64 in world space; `triangles` (m, 3) int, counter-clockwise seen from outside. The lowest
    `priority` wins where bodies overlap; bodies of one priority do not overlap. `ior` is the index at 587.56 nm, `abbe`
    the Abbe number of a medium that disperses, 0 of one that does not. Bodies that share one shape share one array
    `triangles`.
    """

    name: str
    vertices: np.ndarray
    triangles: np.ndarray
    priority: int
    ior: float
    smooth: bool = False
    abbe: float = 0.0


@dataclass(frozen=True)
class View:
    """A pinhole camera for square pictures, Z up; `angle_degrees` is the whole field of view."""

    location: tuple[float, float, float]
    target: tuple[float, float, float]
    angle_degrees: float


@dataclass(frozen=True, eq=False)
class BenchScene:
    """What is rendered.

    `environment` (h, w, 3) float32, linear: radiance by direction as in :func:`directions`.
    `nested_media_cross` is whether surfaces of bodies cross; where not, they are apart or one wholly inside another.
    """

    name: str
    title: str
    bodies: tuple[Body, ...]
    view: View
    environment: np.ndarray
    nested_media_cross: bool


# Sky ----------------------------------------------------------------------------------------------------------------


def directions(height: int, width: int) -> np.ndarray:
    """Unit vectors that the pixels of an equirectangular picture stand for, (height, width, 3).

    As in Blender: the first row is up (+Z), the middle column is +X, and columns to the left of it turn towards +Y.
    """
    azimuth = pi - 2.0 * pi * (np.arange(width) + 0.5) / width
    polar = pi * (np.arange(height) + 0.5) / height
    x = np.sin(polar)[:, None] * np.cos(azimuth)
    y = np.sin(polar)[:, None] * np.sin(azimuth)
    z = np.broadcast_to(np.cos(polar)[:, None], x.shape)
    return np.stack([x, y, z], axis=-1)


def banded_sky(frequency: float = 9.0, height: int = 512) -> np.ndarray:
    """Soft tilted bands, from a warm ground to a blue zenith; (height, 2 height, 3) float32 between 0.1 and 1.3.

    `frequency` is that of the bands, in radians over a unit of direction.
    """
    ways = directions(height, 2 * height)
    up = 0.5 + 0.5 * ways[..., 2:]
    blend = up * up * (3.0 - 2.0 * up)
    ground, zenith = np.array([1.3, 0.85, 0.45]), np.array([0.35, 0.75, 1.3])
    tilted = np.array([0.48, -0.2, 0.85])
    bands = 0.5 + 0.5 * np.sin(frequency * ways @ (tilted / np.linalg.norm(tilted)) + 0.7)
    return ((ground + (zenith - ground) * blend) * (0.3 + 0.7 * bands[..., None])).astype(np.float32)


# Shapes -------------------------------------------------------------------------------------------------------------


def mesh_arrays(mesh: bpy.types.Mesh, matrix: Matrix | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a mesh, placed by a matrix."""
    vertices, triangles = triangles_of(mesh)
    vertices = vertices.astype(np.float64)
    if matrix is not None:
        placed = np.array(matrix, np.float64)
        vertices = vertices @ placed[:3, :3].T + placed[:3, 3]
    return vertices, triangles.astype(np.int64)


def mesh_of(name: str, vertices: np.ndarray, triangles: np.ndarray, smooth: bool = False) -> bpy.types.Mesh:
    """A mesh of vertices and triangles; much faster than from_pydata."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(vertices, np.float32).ravel())
    mesh.loops.add(triangles.size)
    mesh.loops.foreach_set("vertex_index", np.ascontiguousarray(triangles, np.int32).ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", np.arange(0, triangles.size, 3, dtype=np.int32))
    if not smooth:
        sharp = mesh.attributes.new("sharp_face", "BOOLEAN", "FACE")
        sharp.data.foreach_set("value", np.ones(len(triangles), bool))
    mesh.update()
    return mesh


def taken_arrays(mesh: bpy.types.Mesh, matrix: Matrix | None = None) -> tuple[np.ndarray, np.ndarray]:
    """:func:`mesh_arrays` of a mesh that nothing else needs."""
    arrays = mesh_arrays(mesh, matrix)
    bpy.data.meshes.remove(mesh)
    return arrays


def built(build: Callable[[bmesh.types.BMesh], None]) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of what `build(bm)` makes."""
    shape = bmesh.new()
    build(shape)
    bmesh.ops.recalc_face_normals(shape, faces=shape.faces)
    mesh = bpy.data.meshes.new("Shape")
    shape.to_mesh(mesh)
    shape.free()
    return taken_arrays(mesh)


def ball(subdivisions: int) -> tuple[np.ndarray, np.ndarray]:
    """A unit icosphere of 20 * 4 ** (subdivisions - 1) triangles."""
    return built(lambda bm: bmesh.ops.create_icosphere(bm, subdivisions=subdivisions, radius=1.0))


def box(low: Sequence[float], high: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """A box between two corners."""
    low, high = Vector(low), Vector(high)
    matrix = Matrix.Translation((low + high) / 2.0) @ Matrix.Diagonal((*(high - low), 1.0))
    return built(lambda bm: bmesh.ops.create_cube(bm, size=1.0, matrix=matrix))


def moved(shape: tuple[np.ndarray, np.ndarray], offset: Sequence[float], size: float | Sequence[float] = 1.0):
    """A shape scaled, then moved. The triangles stay the same array."""
    vertices, triangles = shape
    return vertices * np.asarray(size) + np.asarray(offset), triangles


def turned(shape: tuple[np.ndarray, np.ndarray], rotation: Euler):
    """A shape turned around the origin."""
    vertices, triangles = shape
    return vertices @ np.array(rotation.to_matrix(), np.float64).T, triangles


def joined(shapes: Sequence[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """One shape of many."""
    starts = np.cumsum([0] + [len(vertices) for vertices, _ in shapes[:-1]])
    triangles = [triangles + start for (_, triangles), start in zip(shapes, starts, strict=True)]
    return np.concatenate([vertices for vertices, _ in shapes]), np.concatenate(triangles)


def turned_profile(corners: Sequence[iced_water.Corner]) -> tuple[np.ndarray, np.ndarray]:
    """The body that a rounded profile makes turned around Z."""
    return taken_arrays(iced_water.lathe(without_straight_points(iced_water.rounded(corners))))


def without_straight_points(profile: Sequence[iced_water.Point]) -> list[iced_water.Point]:
    """A profile without the points on straight lines between others, which flat shading does not need."""
    points = np.array(profile)
    points = points[np.concatenate([[True], np.any(np.abs(np.diff(points, axis=0)) > 1e-9, axis=1)])]
    before, after = np.diff(points[:-1], axis=0), np.diff(points[1:], axis=0)
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    bent = np.abs(turn) > 1e-3 * np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    return [tuple(point) for point in points[np.concatenate([[True], bent, [True]])]]


# Scenes -------------------------------------------------------------------------------------------------------------


def sphere() -> BenchScene:
    """One glass sphere."""
    body = Body("Sphere", *ball(7), GLASS_PRIORITY, 1.5)
    view = View((0.0, -5.0, 0.8), (0.013, 0.0, 0.007), 26.0)
    return BenchScene("sphere", "one glass sphere", (body,), view, banded_sky(), False)


def iced_water_scene() -> BenchScene:
    """The flagship's media: tumbler, water, three ice cubes, bubbles in both."""
    before = {kind: set(getattr(bpy.data, kind)) for kind in ("meshes", "materials", "worlds", "cameras", "lights")}
    scene = iced_water.build_scene()
    media = {
        "Tumbler": (GLASS_PRIORITY, GLASS),
        "Water": (WATER_PRIORITY, WATER),
        "Ice Cube 1": (ICE_PRIORITY, ICE),
        "Ice Cube 2": (ICE_PRIORITY, ICE),
        "Ice Cube 3": (ICE_PRIORITY, ICE),
        "Bubbles in Water": (BUBBLE_PRIORITY, AIR),
        "Bubbles in Ice": (BUBBLE_PRIORITY, AIR),
    }
    objects = {obj.name: obj for obj in scene.objects}
    bodies = tuple(
        Body(name, *mesh_arrays(objects[name].data, objects[name].matrix_world), *medium)
        for name, medium in media.items()
    )
    for obj in objects.values():
        bpy.data.objects.remove(obj)
    bpy.data.scenes.remove(scene)
    for kind, known in before.items():
        bpy.data.batch_remove(set(getattr(bpy.data, kind)) - known)
    view = View((0.0, -4.3, 1.75), (0.012, 0.0, 0.49), 17.0)
    return BenchScene("iced_water", "iced water", bodies, view, banded_sky(), True)


DROPLETS = 500
PANE = 2.0
"""Width and height of the pane."""


def droplet_places(random: np.random.Generator, count: int) -> list[tuple[float, float, float]]:
    """X, Z and radius of each droplet on the pane, apart from each other; large ones first. More of them are smaller."""
    radii = np.sort(0.018 + 0.042 * random.random(count) ** 3)[::-1] * min(1.0, sqrt(DROPLETS / count))
    places: list[tuple[float, float, float]] = []
    for radius in radii:
        while True:
            x, z = (random.random(2) - 0.5) * (PANE - 0.14)
            if all((x - a) ** 2 + (z - b) ** 2 > (1.1 * (radius + r)) ** 2 for a, b, r in places):
                break
        places.append((x, z, radius))
    return places


def droplets(count: int = DROPLETS) -> BenchScene:
    """Flattened drops on the front of an upright pane, reaching a little into it. All are one shape."""
    half, depth = PANE / 2.0, 0.08
    pane = Body("Pane", *box((-half, 0.0, -half), (half, depth, half)), GLASS_PRIORITY, GLASS)
    shape = moved(ball(3), (0.0, 0.0, 0.0), (1.0, 0.55, 1.0))
    drops = tuple(
        Body(f"Droplet {place}", *moved(shape, (x, -0.2 * radius, z), radius), WATER_PRIORITY, WATER)
        for place, (x, z, radius) in enumerate(droplet_places(np.random.default_rng(1), count))
    )
    view = View((0.5, -3.6, 0.4), (0.012, 0.0, 0.003), 36.0)
    return BenchScene("droplets", f"{count:,} droplets on a pane", (pane, *drops), view, banded_sky(), True)


SHELLS = 12


def shells() -> BenchScene:
    """Concentric balls of glass and water in turn; the inner one wins."""
    bodies = tuple(
        Body(f"Shell {place}", *moved(ball(6), (0, 0, 0), 1.0 - 0.07 * place), SHELLS - place, (1.5, 1.33)[place % 2])
        for place in range(SHELLS)
    )
    view = View((0.0, -5.0, 0.8), (0.013, 0.0, 0.007), 26.0)
    return BenchScene("shells", "12 nested shells", bodies, view, banded_sky(), False)


BUCKET_OUTSIDE: tuple[iced_water.Corner, ...] = (
    (0.0, 0.0, 0.0),
    (0.72, 0.0, 0.08),
    (1.0, 1.35, 0.028),
)
BUCKET_INSIDE: tuple[iced_water.Corner, ...] = ((0.93, 1.35, 0.028), (0.655, 0.09, 0.1), (0.0, 0.09, 0.0))
BUCKET_WATER: tuple[iced_water.Corner, ...] = (
    (0.0, 0.08, 0.0),
    (0.665, 0.08, 0.1),
    (0.8716, 1.03, 0.0),
    (0.0, 1.03, 0.0),
)
"""The bucket's inside grown by 0.01, up to the water's level."""

BOTTLE_FOOT = 0.2
BOTTLE: tuple[iced_water.Corner, ...] = (
    (0.0, 0.0, 0.0),
    (0.33, 0.0, 0.05),
    (0.33, 1.25, 0.22),
    (0.12, 1.62, 0.2),
    (0.12, 2.2, 0.025),
    (0.075, 2.2, 0.02),
    (0.075, 1.61, 0.2),
    (0.29, 1.21, 0.2),
    (0.29, 0.07, 0.05),
    (0.0, 0.09, 0.0),
)
"""Outside, around the mouth, inside; above its foot."""

BOTTLE_WINE: tuple[iced_water.Corner, ...] = ((0.0, 0.08, 0.0), (0.3, 0.06, 0.05), (0.3, 1.0, 0.0), (0.0, 1.0, 0.0))


def bucket_ice() -> list[Body]:
    """Seven cubes that float around the bottle and five that are held under water, apart from each other."""
    places = [(1.0, 0.6, 2.0 * pi * (step + 0.3) / 7, 0.99) for step in range(7)]
    places += [(0.8, 0.515, 2.0 * pi * (step + 0.1) / 5, 0.55) for step in range(5)]
    bodies = []
    for place, (size, distance, angle, height) in enumerate(places):
        tilt = Euler((0.2 * sin(2.1 * place), 0.2 * cos(1.7 * place), angle + 0.3 * sin(3.0 * place)))
        cube = turned(moved(taken_arrays(iced_water.ice_mesh(place + 1)), (0.0, 0.0, 0.0), size), tilt)
        offset = (distance * cos(angle), distance * sin(angle), height)
        bodies.append(Body(f"Ice {place}", *moved(cube, offset), ICE_PRIORITY, ICE))
    return bodies


def bucket() -> BenchScene:
    """A bottle of wine in a glass bucket of ice and water."""
    foot = (0.0, 0.0, BOTTLE_FOOT)
    bodies = (
        Body("Bucket", *turned_profile(BUCKET_OUTSIDE + BUCKET_INSIDE), GLASS_PRIORITY, GLASS),
        Body("Bottle", *moved(turned_profile(BOTTLE), foot), GLASS_PRIORITY, GLASS),
        *bucket_ice(),
        Body("Wine", *moved(turned_profile(BOTTLE_WINE), foot), WINE_PRIORITY, WINE),
        Body("Water", *turned_profile(BUCKET_WATER), WATER_PRIORITY, WATER),
    )
    view = View((0.0, -6.2, 2.6), (0.012, 0.0, 1.12), 25.0)
    return BenchScene("bucket", "a bottle in a bucket of ice and water", bodies, view, banded_sky(), True)


FACETED_SEGMENTS = 48
FACETED_TUMBLER: tuple[iced_water.Point, ...] = (
    (0.0, 0.0),
    (0.38, 0.0),
    (0.46, 1.0),
    (0.42, 1.0),
    (0.335, 0.15),
    (0.0, 0.15),
)
FACETED_WATER: tuple[iced_water.Point, ...] = ((0.0, 0.142), (0.343, 0.142), (0.402, 0.74), (0.0, 0.74))
"""The tumbler's inside grown by 0.008, up to the water's level."""


def faceted(profile: Sequence[iced_water.Point]) -> tuple[np.ndarray, np.ndarray]:
    """A profile from axis to axis turned around Z in few steps, each of its lines a single strip of faces."""

    def build(bm):
        vertices = [bm.verts.new((r, 0.0, z)) for r, z in profile]
        edges = [bm.edges.new(pair) for pair in pairwise(vertices)]
        bmesh.ops.spin(
            bm,
            geom=vertices + edges,
            cent=(0.0, 0.0, 0.0),
            axis=(0.0, 0.0, 1.0),
            angle=2.0 * pi,
            steps=FACETED_SEGMENTS,
            use_merge=True,
        )
        bmesh.ops.remove_doubles(bm, verts=bm.verts, dist=1e-6)

    return built(build)


def faceted_scene() -> BenchScene:
    """Water and three blocks of ice in a tumbler of few, large faces: all of them that touch a medium are crossed by
    another, as the walls are single strips from foot to rim, and one block stands on the middle of the floor.
    """
    blocks = (
        ((0.27, 0.27, 0.36), (0.02, 0.01, 0.325), Euler((0.0, 0.0, 0.37))),
        ((0.23, 0.21, 0.19), (-0.185, -0.06, 0.655), Euler((0.09, -0.07, 0.25))),
        ((0.21, 0.23, 0.19), (0.18, 0.05, 0.66), Euler((-0.06, 0.1, -0.4))),
    )
    ice = tuple(
        Body(
            f"Ice {place}",
            *moved(turned(box(-Vector(size) / 2.0, Vector(size) / 2.0), turn), centre),
            ICE_PRIORITY,
            ICE,
        )
        for place, (size, centre, turn) in enumerate(blocks)
    )
    bodies = (
        Body("Tumbler", *faceted(FACETED_TUMBLER), GLASS_PRIORITY, GLASS),
        *ice,
        Body("Water", *faceted(FACETED_WATER), WATER_PRIORITY, WATER),
    )
    view = View((0.0, -4.3, 1.75), (0.012, 0.0, 0.49), 17.0)
    return BenchScene("faceted", "a tumbler of few, large faces with ice and water", bodies, view, banded_sky(), True)


Facet = tuple[float, float, float]
"""Angle from the horizontal, negative below the girdle; azimuth, both in degrees; distance of its plane."""


def cut(facets: Sequence[Facet], girdle: int) -> tuple[np.ndarray, np.ndarray]:
    """A stone of radius 1 cut along planes from a prism with that many sides."""

    def build(bm):
        bmesh.ops.create_cone(
            bm, cap_ends=True, segments=girdle, radius1=1.0, radius2=1.0, depth=4.0, matrix=Matrix.Identity(4)
        )
        for slope, azimuth, distance in facets:
            a, b = radians(abs(slope)), radians(azimuth)
            normal = Vector((sin(a) * cos(b), sin(a) * sin(b), cos(a) if slope >= 0.0 else -cos(a)))
            geometry = bm.verts[:] + bm.edges[:] + bm.faces[:]
            bmesh.ops.bisect_plane(
                bm, geom=geometry, dist=1e-5, plane_co=normal * distance, plane_no=normal, clear_outer=True
            )
            bmesh.ops.holes_fill(bm, edges=bm.edges, sides=0)

    return built(build)


def ring(slope: float, count: int, turn: float, radius: float, height: float) -> list[Facet]:
    """Facets around a stone, every one through the point at that radius and height; `turn` in steps."""
    a = radians(abs(slope))
    distance = radius * sin(a) + (height if slope >= 0.0 else -height) * cos(a)
    return [(slope, 360.0 * (step + turn) / count, distance) for step in range(count)]


HALF_GIRDLE = 0.025


def brilliant() -> tuple[np.ndarray, np.ndarray]:
    """The round brilliant: table, 8 stars, 8 bezels, 16 upper and 16 lower halves, 8 pavilion mains."""
    facets = [(0.0, 0.0, 0.33)]
    facets += ring(34.5, 8, 0.0, 1.0, HALF_GIRDLE)
    facets += ring(22.0, 8, 0.5, 0.775, 0.205)
    facets += ring(40.5, 16, 0.5, 1.0, HALF_GIRDLE)
    facets += ring(-40.8, 8, 0.0, 1.0, -HALF_GIRDLE)
    facets += ring(-42.2, 16, 0.5, 1.0, -HALF_GIRDLE)
    return cut(facets, 64)


def step_cut() -> tuple[np.ndarray, np.ndarray]:
    """An octagon of steps, three above and three below the girdle."""
    facets = [(0.0, 0.0, 0.3)]
    for slope, radius, height in ((48.0, 1.0, HALF_GIRDLE), (38.0, 0.85, 0.19), (27.0, 0.75, 0.255)):
        facets += ring(slope, 8, 0.5, radius * cos(pi / 8), height)
    for slope, radius, height in ((-58.0, 1.0, -HALF_GIRDLE), (-48.0, 0.85, -0.25), (-40.0, 0.6, -0.51)):
        facets += ring(slope, 8, 0.5, radius * cos(pi / 8), height)
    return cut(facets, 8)


def gems() -> BenchScene:
    """Three cut stones that split light: diamond, zirconia and sapphire."""
    bodies = (
        Body("Diamond", *turned(brilliant(), Euler((0.42, 0.0, 0.21))), 1, 2.417, abbe=55.3),
        Body(
            "Zirconia", *moved(turned(brilliant(), Euler((0.5, -0.5, 0.1))), (1.74, 0.66, 0.1), 0.8), 2, 2.16, abbe=33.5
        ),
        Body(
            "Sapphire",
            *moved(turned(step_cut(), Euler((0.55, 0.45, 0.1))), (-1.74, 0.62, 0.1), 0.8),
            3,
            1.768,
            abbe=72.2,
        ),
    )
    view = View((0.0, -3.6, 5.6), (0.012, 0.2, -0.1), 43.5)
    return BenchScene("gems", "dispersive gems", bodies, view, banded_sky(24.0), False)


def through_a_file(shape: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """A shape as Blender's importer reads it from the PLY that Blender's exporter wrote."""
    mesh = mesh_of("Exported", *shape)
    obj = bpy.data.objects.new("Exported", mesh)
    bpy.context.scene.collection.objects.link(obj)
    known = set(bpy.data.objects)
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder, "mesh.ply"))
        bpy.ops.object.select_all(action="DESELECT")
        obj.select_set(True)
        bpy.ops.wm.ply_export(filepath=path, export_selected_objects=True)
        bpy.ops.wm.ply_import(filepath=path)
    (imported,) = set(bpy.data.objects) - known
    arrays = mesh_arrays(imported.data, imported.matrix_world)
    for done in (imported, obj):
        data = done.data
        bpy.data.objects.remove(done)
        bpy.data.meshes.remove(data)
    return arrays


def suzanne(voxel: float = 0.02) -> tuple[np.ndarray, np.ndarray]:
    """The monkey's head as a remesher makes it closed: as irregular as a scan."""
    shape = bmesh.new()
    bmesh.ops.create_monkey(shape)
    mesh = bpy.data.meshes.new("Suzanne")
    shape.to_mesh(mesh)
    shape.free()
    obj = bpy.data.objects.new("Suzanne", mesh)
    bpy.context.scene.collection.objects.link(obj)
    smooth = obj.modifiers.new("Smooth", "SUBSURF")
    smooth.levels = smooth.render_levels = 2
    remesh = obj.modifiers.new("Remesh", "REMESH")
    remesh.mode = "VOXEL"
    remesh.voxel_size = voxel
    even = obj.modifiers.new("Even", "SMOOTH")
    even.iterations = 6
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    arrays = mesh_arrays(evaluated.data)
    bpy.data.objects.remove(obj)
    bpy.data.meshes.remove(mesh)
    return arrays


def filling() -> tuple[np.ndarray, np.ndarray]:
    """A ball of liquid with a level surface."""

    def build(bm):
        bmesh.ops.create_icosphere(bm, subdivisions=6, radius=0.42)
        bmesh.ops.bisect_plane(
            bm,
            geom=bm.verts[:] + bm.edges[:] + bm.faces[:],
            dist=1e-6,
            plane_co=(0.0, 0.0, 0.17),
            plane_no=(0.0, 0.0, 1.0),
            clear_outer=True,
        )
        bmesh.ops.holes_fill(bm, edges=bm.edges, sides=0)

    return built(build)


def imported_mesh() -> BenchScene:
    """A head of glass from a file, filled with a liquid under a bubble of air that reaches into it."""
    head = through_a_file(suzanne())
    bodies = (
        Body("Bubble", *moved(ball(6), (0.05, 0.02, 0.3), (0.3, 0.3, 0.16)), BUBBLE_PRIORITY, AIR),
        Body("Liquid", *moved(filling(), (0.0, 0.05, 0.07)), GLASS_PRIORITY, WATER),
        Body("Head", *head, ICE_PRIORITY, GLASS),
    )
    view = View((1.6, -5.0, 1.0), (0.04, 0.0, -0.02), 30.0)
    return BenchScene("import", "an imported mesh", bodies, view, banded_sky(), True)


SCENES: dict[str, Callable[[], BenchScene]] = {
    "sphere": sphere,
    "iced_water": iced_water_scene,
    "droplets": droplets,
    "shells": shells,
    "bucket": bucket,
    "faceted": faceted_scene,
    "gems": gems,
    "import": imported_mesh,
}

DISPERSING = ("gems",)
"""Scenes whose media split light into colours."""
