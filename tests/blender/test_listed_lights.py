"""Lamps that the lobes carry are listed, each by what carries it."""

import bpy
from direct_lights import add_light, slab

import nested_dielectric as nd
from nested_dielectric.scene import lights


def test_lights_are_told_by_what_carries_them():
    slab()
    light = add_light()
    scene = bpy.context.scene
    assert lights.light_carriers(scene) == (lights.LightTransport("Lamp", "RAYS", "RAYS"),)
    light.visible_transmission = False
    assert lights.light_carriers(scene) == (lights.LightTransport("Lamp", "LOBE", "RAYS"),)
    light.data.normalize = False
    (carrier,) = lights.light_carriers(scene)
    assert carrier.refraction == "NOTHING" and "normalized" in carrier.reason
    assert any(problem.name == "Lamp" and carrier.reason in problem.text for problem in nd.prepare(scene).problems)


def test_prepare_lists_the_lights_of_the_lobe_once():
    slab()
    light = add_light(lobe=True)
    scene = bpy.context.scene
    assert any("Lights" in change for change in nd.prepare(scene).changes)
    assert not any("Lights" in change for change in nd.prepare(scene).changes)
    light.visible_transmission = True
    assert any("Lights" in change for change in nd.prepare(scene).changes)
    assert lights.listed_lights(bpy.context.scene) == []
