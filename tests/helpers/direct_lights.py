"""Lamps behind and before media."""

import bpy
from scenes import add, add_box, add_camera, new_scene, set_world

import nested_dielectric as nd

SIZES = {
    "POINT": {"shadow_soft_size": 0.1},
    "SPOT": {"shadow_soft_size": 0.1, "spot_size": 1.0, "spot_blend": 0.6},
    "SUN": {"angle": 0.2},
    "AREA": {"shape": "RECTANGLE", "size": 0.8, "size_y": 0.4},
    "DISK": {"shape": "ELLIPSE", "size": 0.8, "size_y": 0.4, "spread": 2.0},
}


def add_light(kind="POINT", lobe=False):
    """A light behind the slab, which the lobe or rays carry."""
    light = bpy.data.lights.new("Lamp", "AREA" if kind == "DISK" else kind)
    light.energy = 3.0 if kind == "SUN" else 300.0
    light.color = (1.0, 0.6, 0.3)
    light.exposure = 0.5
    for name, value in SIZES[kind].items():
        setattr(light, name, value)
    light = add("Lamp", light, (0.2, 4.0, 0.5))
    light.rotation_euler = (-1.5, 0.1, 0.3)
    light.visible_transmission = not lobe
    return light


def slab(**keywords):
    """A slab of which both faces refract with a roughness of 0.4 and reflect nothing."""
    new_scene(32, with_group=True)
    set_world((0.0, 0.0, 0.0))
    add_camera((0.3, -4, 0.4), (0, 0, 0), angle=20)
    material = nd.new_material(
        "Glass",
        **{
            "ior": 1.5,
            "roughness": 0.4,
            "distribution": "GGX",
            "shadow_mode": "BLACK",
            "specular_scale": 0.0,
            "internal_reflections": False,
            "direct_roughness_offset": 0.0,
        }
        | keywords,
    )
    add_box("Slab", (-2, -0.3, -2), (2, 0.3, 2), material)
    return material
