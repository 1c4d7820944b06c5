"""Scenes of media that split light."""

from scenes import new_scene, set_world

import nested_dielectric as nd
from nested_dielectric.model import dispersion, presets
from nested_dielectric.nodes import compatibility

SF11 = presets.load_preset("sf11").parameters
WATER = presets.load_preset("water").parameters


def index(medium, wavelength):
    """The published Sellmeier index of a preset."""
    return dispersion.sellmeier_ior(medium["sellmeier_b"], medium["sellmeier_c"], wavelength)


def dispersing_scene(resolution=48):
    """A scene in which paths have wavelengths."""
    scene = new_scene(resolution, with_group=True)
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = 0.0
    return scene


def material(medium, name="Glass", **keywords):
    """A nested dielectric of a preset's curve that lets no light pass straight."""
    curve = {key: medium[key] for key in ("ior", "dispersion_model", "sellmeier_b", "sellmeier_c")}
    return nd.new_material(name, **{"shadow_mode": "BLACK", "disperse": True} | curve | keywords)


def set_band_world():
    """Bright bands on black."""
    tree = set_world()
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    wave = tree.nodes.new("ShaderNodeTexWave")
    wave.inputs["Scale"].default_value = 3.0
    step = tree.nodes.new("ShaderNodeMath")
    step.operation = "GREATER_THAN"
    tree.links.new(coordinates.outputs["Generated"], wave.inputs["Vector"])
    tree.links.new(wave.outputs["Color"], step.inputs[0])
    tree.links.new(step.outputs[0], tree.nodes["Background"].inputs["Color"])


CLOSURES_DISPERSE = compatibility.shows_front_ior()
"""Whether Cycles' own closures may split light where paths carry no time."""
