"""Scenes that own nodes or the shader render."""

import bpy
from scenes import add_box, add_sphere

import nested_dielectric as nd
from nested_dielectric.nodes.names import NATIVE_SOCKET
from nested_dielectric.scene.materials import dielectric_node

HERE = bpy.app.version


def ball(name="Ball", x=0.0, **keywords):
    material = nd.new_material(name, **{"ior": 1.5} | keywords)
    return add_sphere(name, 1.0, material, location=(x, 0, 0), segments=16)


def crossing():
    """A block of glass that a block of water reaches into."""
    add_box("Block", (-1, -1, -1), (0.1, 1, 1), nd.new_material("Glass", ior=1.5), 1)
    return add_box("Water", (-0.2, -0.7, -0.8), (1, 0.6, 0.9), nd.new_material("Water", ior=1.33), 2)


def sockets():
    """Whether Cycles' own nodes render each material, as its socket has it."""
    return {
        material.name: dielectric_node(material).inputs[NATIVE_SOCKET].default_value
        for material in bpy.data.materials
        if dielectric_node(material) is not None
    }
