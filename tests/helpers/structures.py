"""Scenes whose media come into being in other ways than as a mesh of their own, and what they should look like."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from pathlib import Path

import bpy  # before bmesh and mathutils, which live inside it

import bmesh  # isort: skip
from mathutils import Matrix, Vector
from random_bodies import stage
from scenes import add, add_box, add_mesh, cycles_glass

import nested_dielectric as nd

WATER, GLASS = 1.33, 1.5
SPHERE = 2
"""Subdivisions of droplets."""


# 10^5 instances -----------------------------------------------------------------------------------------------------


def grid(side: int) -> list[Vector]:
    """Places of side^3 droplets in a cube, off all axes of the camera's."""
    step = 1.6 / side
    turn = Matrix.Rotation(0.37, 3, "Z") @ Matrix.Rotation(0.21, 3, "X")
    half = (side - 1) / 2.0
    return [
        turn @ (step * Vector((x - half, y - half, z - half))) for x, y, z in itertools.product(range(side), repeat=3)
    ]


def droplets(side: int, nested: bool, how: str) -> bpy.types.Scene:
    """Droplets of glass, instanced in a block of water, which they win over; or the same split by hand.

    :param how: "nodes", by Geometry Nodes; "vertices", as those of a mesh instance its child.
    """
    scene = stage()
    ratio = GLASS if nested else GLASS / WATER
    drop = nd.new_material("Droplet", ior=ratio, priority=0) if nested else cycles_glass(ratio)
    water = nd.new_material("Water", ior=WATER, priority=1) if nested else cycles_glass(WATER)
    turn = Matrix.Rotation(0.2, 4, "Z") @ Matrix.Rotation(0.1, 4, "X")
    add_box("Water", (-1.5, -1.5, -1.5), (1.5, 1.5, 1.5), water).matrix_world = turn
    radius = 0.3 * 1.6 / side
    source = add_mesh("Droplet", lambda bm: bmesh.ops.create_icosphere(bm, subdivisions=SPHERE, radius=radius), drop)
    points = bpy.data.meshes.new("Places")
    points.from_pydata(grid(side), [], [])
    host = add("Host", points)
    if how == "vertices":
        source.parent, host.instance_type = host, "VERTS"
    else:
        bpy.context.scene.collection.objects.unlink(source)
        host.modifiers.new("Droplets", "NODES").node_group = on_points(source)
    bpy.context.view_layer.update()
    return scene


def on_points(source: bpy.types.Object) -> bpy.types.NodeTree:
    """Return nodes that put an object at each point of a mesh."""
    tree = bpy.data.node_groups.new("Droplets", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    info, place = tree.nodes.new("GeometryNodeObjectInfo"), tree.nodes.new("GeometryNodeInstanceOnPoints")
    info.inputs["Object"].default_value = source
    info.inputs["As Instance"].default_value = True
    tree.links.new(start.outputs[0], place.inputs["Points"])
    tree.links.new(info.outputs["Geometry"], place.inputs["Instance"])
    tree.links.new(place.outputs["Instances"], end.inputs[0])
    return tree


# One body by another way ------------------------------------------------------------------------------------------


def egg(bm: bmesh.types.BMesh) -> None:
    """What all bodies below look like in the end."""
    bmesh.ops.create_icosphere(bm, subdivisions=3, radius=0.8)
    for vertex in bm.verts:
        vertex.co = shaped(vertex.co)


def shaped(point: Vector) -> Vector:
    """A place on the egg for one on the ball."""
    return Vector((point.x * (1.0 + 0.2 * point.z), point.y * 0.9, point.z + 0.2 * point.x))


def ball(bm: bmesh.types.BMesh) -> None:
    bmesh.ops.create_icosphere(bm, subdivisions=3, radius=0.8)


def by_mesh(material: bpy.types.Material, folder: Path) -> bpy.types.Object:
    return add_mesh("Egg", egg, material)


def by_shape_keys(material: bpy.types.Material, folder: Path) -> bpy.types.Object:
    obj = add_mesh("Egg", ball, material)
    obj.shape_key_add(name="Basis")
    for name, share in (("Half", 0.5), ("Other half", 0.5)):
        key = obj.shape_key_add(name=name, from_mix=False)
        for point in key.data:
            point.co = point.co.lerp(shaped(point.co), share)
        key.value = 1.0
    return obj


def by_armature(material: bpy.types.Material, folder: Path) -> bpy.types.Object:
    """A mesh that lies elsewhere, and a bone that brings it into place."""
    obj = add_mesh("Egg", egg, material)
    turn = Matrix.Rotation(0.6, 4, "Z") @ Matrix.Translation((0.3, -0.2, 0.1))
    obj.data.transform(turn.inverted())
    armature = add("Armature", bpy.data.armatures.new("Armature"))
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    bone = armature.data.edit_bones.new("Bone")
    bone.head, bone.tail = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)
    rest = bone.matrix.copy()
    bpy.ops.object.mode_set(mode="OBJECT")
    obj.vertex_groups.new(name="Bone").add(list(range(len(obj.data.vertices))), 1.0, "REPLACE")
    obj.modifiers.new("Armature", "ARMATURE").object = armature
    armature.pose.bones["Bone"].matrix = turn @ rest
    return obj


def by_library(material: bpy.types.Material, folder: Path) -> bpy.types.Object:
    """Linked from another file, with its material."""
    return _linked(material, folder, override=False)


def by_override(material: bpy.types.Material, folder: Path) -> bpy.types.Object:
    """Linked, and moved by a library override."""
    return _linked(material, folder, override=True)


def _linked(material: bpy.types.Material, folder: Path, override: bool) -> bpy.types.Object:
    obj = add_mesh("Egg", egg, material)
    away = Vector((0.4, 0.1, 0.2)) if override else Vector()
    obj.location = away
    bpy.context.view_layer.update()
    file = str(folder / "library.blend")
    bpy.data.libraries.write(file, {obj})
    bpy.data.objects.remove(obj)
    bpy.data.materials.remove(material)
    with bpy.data.libraries.load(file, link=True) as (_, wanted):
        wanted.objects = ["Egg"]
    (linked,) = wanted.objects
    bpy.context.scene.collection.objects.link(linked)
    if not override:
        return linked
    own = linked.override_create(remap_local_usages=True)
    own.location = (0.0, 0.0, 0.0)
    return own


BY: dict[str, Callable[[bpy.types.Material, Path], bpy.types.Object]] = {
    "shape keys": by_shape_keys,
    "armature": by_armature,
    "library": by_library,
    "override": by_override,
}


def beside_a_block(make: Callable[[bpy.types.Material, Path], bpy.types.Object], folder: Path) -> None:
    """The egg across a block that it wins over."""
    stage()
    make(nd.new_material("Egg", ior=GLASS, priority=0), folder)
    turn = Matrix.Rotation(0.2, 4, "Z") @ Matrix.Rotation(0.1, 4, "X")
    block = nd.new_material("Block", ior=WATER, priority=1)
    add_box("Block", (-1.0, -0.9, -1.0), (0.9, 1.0, 0.1), block).matrix_world = turn
    bpy.context.view_layer.update()
