"""A block of glass that a block of water reaches into."""

import bpy
from scenes import add_box

import nested_dielectric as nd


def add_crossing(open_one=False):
    """A block of glass that a block of water reaches into; or with a face of the water missing."""
    add_box("Block", (-1, -1, -1), (0.1, 1, 1), nd.new_material("Glass", ior=1.5), 1)
    water = add_box("Water", (-0.2, -0.7, -0.8), (1, 0.6, 0.9), nd.new_material("Water", ior=1.33), 2)
    if open_one:
        faces = [tuple(polygon.vertices) for polygon in water.data.polygons][1:]
        points = [tuple(vertex.co) for vertex in water.data.vertices]
        water.data.clear_geometry()
        water.data.from_pydata(points, [], faces)
    bpy.context.view_layer.update()
