"""What :mod:`random_media` describes, built in Blender, of nested dielectrics or of Cycles' own Glass."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence

import bpy  # before bmesh and mathutils, which live inside it

import bmesh  # isort: skip
import numpy as np
from mathutils import Matrix
from random_media import Body, Medium, Place, RandomScene
from scenes import add, add_camera, add_mesh, cycles_glass, new_scene, set_world

import nested_dielectric as nd

RESOLUTION = 32
MOST_BOUNCES = 1024
BOUNCES_INSIDE = 128
"""Inside flat faces light is caught for ever. Where others lie hidden before them, each bounce takes several transparent ones.

Cycles has 1,024 of these.
"""


OUTSIDE = ((0.37, -7.9, 1.13), (0.02, 0.01, 0.03), 28.0)
INSIDE = ((0.11, 0.07, -0.05), (0.9, 0.7, 0.3), 60.0)
"""Location of the camera, what it looks at, its field of view in degrees."""


def stage(resolution: int = RESOLUTION, view=OUTSIDE) -> bpy.types.Scene:
    """Make an empty scene in which red is a white furnace, and green and blue tell directions.

    So one render says whether energy is kept and where light came from. The world is met by rays alone: lights that are
    drawn would only add noise.
    """
    scene = new_scene(resolution, with_group=True)
    for limit in ("max_bounces", "transmission_bounces", "glossy_bounces", "transparent_max_bounces"):
        setattr(scene.cycles, limit, MOST_BOUNCES)
    tree = set_world()
    scene.world.cycles.sampling_method = "NONE"
    coordinates, wave, split, join, grade = (
        tree.nodes.new(f"ShaderNode{kind}")
        for kind in ("TexCoord", "TexWave", "SeparateXYZ", "CombineColor", "MapRange")
    )
    wave.inputs["Scale"].default_value = 1.5
    grade.inputs["From Min"].default_value = -1.0
    join.inputs["Red"].default_value = 1.0
    for start, end in (
        (coordinates.outputs["Generated"], wave.inputs["Vector"]),
        (coordinates.outputs["Generated"], split.inputs[0]),
        (split.outputs["Z"], grade.inputs["Value"]),
        (wave.outputs["Fac"], join.inputs["Green"]),
        (grade.outputs[0], join.inputs["Blue"]),
        (join.outputs[0], tree.nodes["Background"].inputs["Color"]),
    ):
        tree.links.new(start, end)
    location, target, angle = view
    add_camera(location, target, angle=angle)
    return scene


def build(description: RandomScene, glass: bool = False) -> bpy.types.Scene:
    """Build a scene; of Cycles' own Glass on the same bodies if asked to."""
    scene = stage(view=INSIDE if description.camera_inside else OUTSIDE)
    if description.camera_inside:
        for limit in ("max_bounces", "transmission_bounces", "glossy_bounces"):
            setattr(scene.cycles, limit, BOUNCES_INSIDE)
    materials = [(own_glass if glass else nested)(index, medium) for index, medium in enumerate(description.media)]
    for index, body in enumerate(description.bodies):
        add_body(f"Body {index}", body, materials[body.medium])
    bpy.context.view_layer.update()
    return scene


def nested(index: int, medium: Medium) -> bpy.types.Material:
    """Make a nested dielectric whose priority is its number."""
    return nd.new_material(
        f"Medium {index}",
        ior=medium.ior,
        roughness=medium.roughness,
        abbe=medium.abbe,
        disperse=medium.abbe > 0.0,
        priority=index,
    )


def own_glass(index: int, medium: Medium) -> bpy.types.Material:
    """Make Cycles' own Glass of the medium's index."""
    return cycles_glass(medium.ior, medium.roughness)


def add_body(name: str, body: Body, material: bpy.types.Material) -> bpy.types.Object:
    """Add a body with its parent, if it has one."""
    obj = OTHERS[body.shape](name, body.smooth) if body.shape in OTHERS else add_mesh(name, SHAPES[body.shape])
    if obj.type == "MESH" and body.smooth:
        obj.data.polygons.foreach_set("use_smooth", [True] * len(obj.data.polygons))
    obj.data.materials.append(material)
    put(obj, body.place)
    if body.parent is not None:
        obj.parent = put(add(f"{name}'s frame", None), body.parent)
    return obj


def put(obj: bpy.types.Object, place: Place) -> bpy.types.Object:
    """Put an object into its place."""
    obj.location, obj.rotation_euler, obj.scale = place.location, place.rotation, place.scale
    return obj


# Meshes -------------------------------------------------------------------------------------------------------------


def lathe(profile: Sequence[tuple[float, float]], segments: int = 48) -> Callable[[bmesh.types.BMesh], None]:
    """Return a builder of the body that a profile makes, (radius, height) from one pole to the other, counterclockwise."""

    def make(bm: bmesh.types.BMesh) -> None:
        rings = []
        for radius, height in profile:
            turns = [0.0] if radius == 0.0 else [2.0 * math.pi * k / segments for k in range(segments)]
            rings.append([bm.verts.new((radius * math.cos(t), radius * math.sin(t), height)) for t in turns])
        for low, high in itertools.pairwise(rings):
            for k in range(segments):
                corners = [low[k % len(low)], low[(k + 1) % len(low)], high[(k + 1) % len(high)], high[k % len(high)]]
                bm.faces.new(dict.fromkeys(corners))

    return make


def build_shell(bm: bmesh.types.BMesh) -> None:
    """A ball with a cavity whose wall is turned inwards."""
    bmesh.ops.create_uvsphere(bm, u_segments=48, v_segments=24, radius=1.0)
    inner = bmesh.ops.create_uvsphere(bm, u_segments=48, v_segments=24, radius=0.7)
    bmesh.ops.reverse_faces(bm, faces=list({face for vertex in inner["verts"] for face in vertex.link_faces}))


def build_islands(bm: bmesh.types.BMesh) -> None:
    """Five parts of one mesh, apart from each other."""
    for radius, centre in ((0.35, (0.6, 0.1, 0)), (0.3, (-0.5, 0.5, 0.1)), (0.28, (-0.4, -0.5, 0.3))):
        bmesh.ops.create_icosphere(bm, subdivisions=3, radius=radius, matrix=Matrix.Translation(centre))
    for size, centre in ((0.5, (0.1, 0.0, 0.75)), (0.4, (0.0, 0.1, -0.7))):
        bmesh.ops.create_cube(bm, size=size, matrix=Matrix.Translation(centre))


def _arc(centre: tuple[float, float], radius: float, start: float, end: float, steps: int) -> list[tuple[float, float]]:
    """Points of an arc, (radius, height), its ends on the axis exact; angles in degrees from the horizontal."""
    points = []
    for angle in np.radians(np.linspace(start, end, steps)):
        r = centre[0] + radius * math.cos(angle)
        points.append((r if r > 1e-9 else 0.0, centre[1] + radius * math.sin(angle)))
    return points


CAPSULE = _arc((0.0, -0.6), 0.4, -90.0, 0.0, 9) + _arc((0.0, 0.6), 0.4, 0.0, 90.0, 9)

VESSEL = [(0.0, -0.9), (0.7, -0.9), (0.85, 0.9), (0.7, 0.9), (0.56, -0.7), (0.0, -0.7)]
"""A tumbler, from below its foot over the rim to the bottom inside."""

RING = [(0.7 + 0.3 * math.cos(a), 0.3 * math.sin(a)) for a in np.linspace(0.0, 2.0 * math.pi, 25)]


def build_ring(bm: bmesh.types.BMesh) -> None:
    """A torus: a lathe whose profile closes."""
    lathe(RING)(bm)
    bmesh.ops.remove_doubles(bm, verts=bm.verts, dist=1e-6)


SHAPES: dict[str, Callable[[bmesh.types.BMesh], None]] = {
    "ball": lambda bm: bmesh.ops.create_uvsphere(bm, u_segments=48, v_segments=24, radius=1.0),
    "geodesic": lambda bm: bmesh.ops.create_icosphere(bm, subdivisions=4, radius=1.0),
    "box": lambda bm: bmesh.ops.create_cube(bm, size=2.0),
    "cone": lambda bm: bmesh.ops.create_cone(bm, cap_ends=True, segments=20, radius1=0.9, radius2=0.3, depth=1.6),
    "ring": build_ring,
    "capsule": lathe(CAPSULE),
    "vessel": lathe(VESSEL),
    "shell": build_shell,
    "islands": build_islands,
}


# What is no mesh ----------------------------------------------------------------------------------------------------


def add_curve(name: str, smooth: bool) -> bpy.types.Object:
    """A bent rod with round section and capped ends."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions, data.bevel_depth, data.bevel_resolution, data.use_fill_caps = "3D", 0.25, 3, True
    spline = data.splines.new("POLY")
    spline.points.add(2)
    for point, place in zip(spline.points, ((-0.8, 0.0, -0.4), (0.0, 0.0, 0.3), (0.8, 0.0, -0.4))):
        point.co = (*place, 1.0)
    spline.use_smooth = smooth
    return add(name, data)


def add_text(name: str, smooth: bool) -> bpy.types.Object:
    """Two letters with thickness."""
    data = bpy.data.curves.new(name, "FONT")
    data.body, data.size, data.extrude = "HI", 1.5, 0.2
    data.align_x, data.align_y = "CENTER", "CENTER"
    return add(name, data)


def add_metaball(name: str, smooth: bool) -> bpy.types.Object:
    """Two balls that merge. Blender merges those of names that differ in numbers alone, so this one's is unlike others."""
    data = bpy.data.metaballs.new(name)
    data.resolution = data.render_resolution = 0.15
    for x in (-0.4, 0.4):
        element = data.elements.new()
        element.radius, element.co = 0.9, (x, 0.0, 0.0)
    return add(f"Blob of {name.replace(' ', '')}x", data)


OTHERS = {"curve": add_curve, "text": add_text, "metaball": add_metaball}
