"""Scenes of media that split light."""

import numpy as np
from scenes import add_mesh, new_scene, set_world

import nested_dielectric as nd
from nested_dielectric.model import dispersion, presets
from nested_dielectric.nodes import compatibility

SF11 = presets.load_preset("sf11").parameters
WATER = presets.load_preset("water").parameters

CLEAR = {"specular_scale": 0.0, "internal_reflections": False}
"""Keywords of a material that reflects nothing."""

APEX = 30.0
"""Angle between two faces of :func:`prism`, in degrees."""


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


def prism(mat, priority=None):
    """A prism whose first face looks at a camera on the negative Y axis and whose second slopes by the apex angle."""
    width = 2.0 * np.tan(np.radians(APEX))

    def build(bm):
        outline = ((-1.0, 0.0), (1.0, 0.0), (-1.0, width))
        low, high = ([bm.verts.new((x, y, z)) for x, y in outline] for z in (-1.0, 1.0))
        bm.faces.new(low[::-1])
        bm.faces.new(high)
        for i in range(3):
            j = (i + 1) % 3
            bm.faces.new((low[i], low[j], high[j], high[i]))

    return add_mesh("Prism", build, mat, priority)


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
