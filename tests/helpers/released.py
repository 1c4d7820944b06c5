"""Write a file as this release makes it, for the tests of the next: ``python tests/helpers/released.py FILE.blend``.

Everything that an update of its materials has to keep is in it: values, links, drivers, keyframes, tables, lights, priorities
and what an analysis found.
"""

from __future__ import annotations

import sys

import bpy
from scenes import add, add_box, add_camera, add_sphere, new_scene, set_striped_world

import nested_dielectric as nd

NODE = "Nested Dielectric"
TINT = {"transmittance": (0.9, 0.5, 0.3), "transmittance_depth": 0.8}
LAST_FRAME = 11
IORS = {1: 1.5, LAST_FRAME: 1.7}
"""Of the glass, by frame."""


def build_scene() -> bpy.types.Scene:
    """Glass whose index is keyframed, water in it whose roughness is driven, a bubble, a prism that disperses and a light that
    the lobe carries.
    """
    new_scene(48)
    set_striped_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=32)
    glass = nd.new_material("Glass", preset="glass", **TINT)
    water = nd.new_material("Water", preset="water")
    add_sphere("Glass", 1.0, glass, 2)
    ball = add_sphere("Water", 0.7, water, 1, (0.5, -0.2, 0.1))
    add_sphere("Bubble", 0.3, nd.new_material("Bubble", preset="air_bubble"), None, (0.2, -0.1, 0.0))
    prism = nd.new_material("Prism", preset="sf11", disperse=True, spectral_distribution="FL2", clamp_negative=False)
    add_box("Prism", (-1.4, -0.3, -0.3), (-1.1, 0.3, 0.3), prism)

    light = add("Lamp", bpy.data.lights.new("Lamp", "AREA"), (0.0, 3.0, 1.0))
    light.data.energy = 200.0
    light.rotation_euler = (-1.4, 0.0, 0.0)
    light.visible_transmission = False

    index = glass.node_tree.nodes[NODE].inputs["IOR"]
    for frame, ior in IORS.items():
        index.default_value = ior
        index.keyframe_insert("default_value", frame=frame)
    ball["roughness"] = 0.25
    _drive(water.node_tree.nodes[NODE].inputs["Roughness"], "default_value", ball, '["roughness"]')
    ball["follows"] = 0.0
    depth = glass.node_tree.nodes[NODE].inputs["Transmittance Depth"]
    _drive(ball, '["follows"]', glass, f"node_tree.{depth.path_from_id('default_value')}", "MATERIAL")
    emission = glass.node_tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Strength"].default_value = 0.125
    glass.node_tree.links.new(emission.outputs[0], glass.node_tree.nodes[NODE].inputs["Emission at Exits"])
    nd.prepare(bpy.context.scene)
    bpy.context.scene.frame_set(1)
    return bpy.context.scene


def _drive(owner, path: str, source: bpy.types.ID, source_path: str, kind: str = "OBJECT") -> None:
    driver = owner.driver_add(path).driver
    driver.type = "SUM"
    target = driver.variables.new().targets[0]
    target.id_type = kind
    target.id = source
    target.data_path = source_path


if __name__ == "__main__":
    build_scene().cycles.samples = 16
    bpy.ops.wm.save_as_mainfile(filepath=sys.argv[1], compress=True)
