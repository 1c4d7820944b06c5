"""Media that are no meshes: balls that merge, texts and curves."""

import math

import bpy  # before bmesh, which lives inside it
from scenes import add

import nested_dielectric as nd


def metaball(material) -> bpy.types.Object:
    """Balls that merge, an element of one object each."""
    for name, x in (("Blob", -0.5), ("Blob.001", 0.5)):
        data = bpy.data.metaballs.new(name)
        data.resolution = data.render_resolution = 0.15
        data.elements.new().radius = 1.0
        nd.assign(add(name, data, (x, 0, 0)), material)
    return bpy.data.objects["Blob"]


def text(material, extrude: float = 0.2, bevel: float = 0.0) -> bpy.types.Object:
    data = bpy.data.curves.new("Text", "FONT")
    data.body, data.size, data.extrude, data.bevel_depth = "HI", 1.6, extrude, bevel
    obj = add("Text", data, (-0.9, 0, -0.5))
    obj.rotation_euler.x = math.pi / 2
    nd.assign(obj, material)
    return obj


def curve(material, capped: bool = True, cyclic: bool = False) -> bpy.types.Object:
    data = bpy.data.curves.new("Curve", "CURVE")
    data.dimensions, data.bevel_depth, data.bevel_resolution, data.use_fill_caps = "3D", 0.3, 3, capped
    spline = data.splines.new("POLY")
    spline.points.add(2)
    for point, place in zip(spline.points, ((-1, 0, -0.5), (0, 0, 0.4), (1, 0, -0.5))):
        point.co = (*place, 1)
    spline.use_cyclic_u = cyclic
    obj = add("Curve", data)
    nd.assign(obj, material)
    return obj
