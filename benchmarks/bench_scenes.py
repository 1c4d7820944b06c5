"""The scenes of the benchmark as plain arrays, so that every renderer gets the same ones.

``SCENES[name]()`` returns a :class:`BenchScene`: closed bodies that overlap as nested dielectrics want it, a camera and
a sky. Media are clear and smooth, shading is flat. World space, Z up; one unit is about 10 cm.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from itertools import pairwise
from math import cos, pi, sin, sqrt
from pathlib import Path

import bpy  # before bmesh and mathutils, which live inside it

import bmesh  # isort: skip
import numpy as np
from bench_arrays import BenchScene, Body, View, banded_sky
from bench_shapes import (
    ball,
    box,
    brilliant,
    built,
    mesh_arrays,
    mesh_of,
    moved,
    step_cut,
    taken_arrays,
    turned,
    turned_profile,
)
from mathutils import Euler, Vector

from nested_dielectric.demo import glassware, iced_water

AIR, WATER, ICE, GLASS = 1.0, 1.33, 1.31, 1.52
WINE = 1.345

BUBBLE_PRIORITY, GLASS_PRIORITY, ICE_PRIORITY, WINE_PRIORITY, WATER_PRIORITY = 5, 10, 20, 25, 30


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


BUCKET_OUTSIDE: tuple[glassware.Corner, ...] = (
    (0.0, 0.0, 0.0),
    (0.72, 0.0, 0.08),
    (1.0, 1.35, 0.028),
)
BUCKET_INSIDE: tuple[glassware.Corner, ...] = ((0.93, 1.35, 0.028), (0.655, 0.09, 0.1), (0.0, 0.09, 0.0))
BUCKET_WATER: tuple[glassware.Corner, ...] = (
    (0.0, 0.08, 0.0),
    (0.665, 0.08, 0.1),
    (0.8716, 1.03, 0.0),
    (0.0, 1.03, 0.0),
)
"""The bucket's inside grown by 0.01, up to the water's level."""

BOTTLE_FOOT = 0.2
BOTTLE: tuple[glassware.Corner, ...] = (
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

BOTTLE_WINE: tuple[glassware.Corner, ...] = ((0.0, 0.08, 0.0), (0.3, 0.06, 0.05), (0.3, 1.0, 0.0), (0.0, 1.0, 0.0))


def bucket_ice() -> list[Body]:
    """Seven cubes that float around the bottle and five that are held under water, apart from each other."""
    places = [(1.0, 0.6, 2.0 * pi * (step + 0.3) / 7, 0.99) for step in range(7)]
    places += [(0.8, 0.515, 2.0 * pi * (step + 0.1) / 5, 0.55) for step in range(5)]
    bodies = []
    for place, (size, distance, angle, height) in enumerate(places):
        tilt = Euler((0.2 * sin(2.1 * place), 0.2 * cos(1.7 * place), angle + 0.3 * sin(3.0 * place)))
        cube = turned(moved(taken_arrays(glassware.ice_mesh(place + 1)), (0.0, 0.0, 0.0), size), tilt)
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
FACETED_TUMBLER: tuple[glassware.Point, ...] = (
    (0.0, 0.0),
    (0.38, 0.0),
    (0.46, 1.0),
    (0.42, 1.0),
    (0.335, 0.15),
    (0.0, 0.15),
)
FACETED_WATER: tuple[glassware.Point, ...] = ((0.0, 0.142), (0.343, 0.142), (0.402, 0.74), (0.0, 0.74))
"""The tumbler's inside grown by 0.008, up to the water's level."""


def faceted(profile: Sequence[glassware.Point]) -> tuple[np.ndarray, np.ndarray]:
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
