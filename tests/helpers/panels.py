"""Panels that list media."""

import bpy
from scenes import add_box

import nested_dielectric as nd
from nested_dielectric.ui.panels import scene_panels

CUBE = (0, 0, 0), (1, 1, 1)
PANELS = (scene_panels.SidebarPanel, scene_panels.ObjectPanel)


def add_media(**numbers):
    """Cubes of a material each, with its number; where it stands in a list, of the material before with one of their own."""
    material = None
    for name, number in numbers.items():
        own = number[0] if isinstance(number, list) else None
        material = material if own is not None else nd.new_material(name, priority=number)
        add_box(f"{name} Cube", *CUBE, material, own)
    bpy.context.view_layer.update()


def activate(name):
    bpy.context.view_layer.objects.active = bpy.data.objects[name]


def exclude(name):
    """Take an object out of the view layer."""
    collection = bpy.data.collections.new("Excluded")
    bpy.context.scene.collection.children.link(collection)
    bpy.context.scene.collection.objects.unlink(bpy.data.objects[name])
    collection.objects.link(bpy.data.objects[name])
    bpy.context.view_layer.layer_collection.children["Excluded"].exclude = True
