"""Each path keeps its wavelength, whatever it meets."""

import bpy
import numpy as np
import pytest
from dispersing import (
    APEX,
    CLEAR,
    CLOSURES_DISPERSE,
    SF11,
    WATER,
    dispersing_scene,
    index,
    material,
    prism,
    set_band_world,
)
from scenes import (
    add_box,
    add_camera,
    add_plane,
    add_sphere,
    cycles_glass,
    diffuse,
    emission,
    fresnel,
    new_scene,
    render,
    set_half_world,
    set_world,
)

import nested_dielectric as nd
from nested_dielectric.model import dispersion
from nested_dielectric.scene.material_spectra import material_table


def line(tmp_path, *wavelengths):
    """A distribution of lines of equal power, 0.02 nm wide."""
    path = tmp_path / f"{'-'.join(map(str, wavelengths))}.csv"
    rows = [f"{nm + step},{power}" for nm in wavelengths for step, power in ((-0.01, 0.0), (0.0, 1.0), (0.01, 0.0))]
    path.write_text("\n".join(rows))
    return str(path)


def set_direction_world():
    """A world that shows the direction of a ray as colours from 0 to 1."""
    tree = set_world()
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    scale = tree.nodes.new("ShaderNodeVectorMath")
    scale.operation = "MULTIPLY_ADD"
    scale.inputs[1].default_value = scale.inputs[2].default_value = (0.5, 0.5, 0.5)
    tree.links.new(coordinates.outputs["Generated"], scale.inputs[0])
    tree.links.new(scale.outputs[0], tree.nodes["Background"].inputs["Color"])


def deviation():
    """Degrees by which light from the camera is turned on its way to the world, in the XY plane.

    The world shows (x, y, z) as colours times what the faces let through; z is 0, so green over red and blue tells
    the direction.
    """
    picture = render(samples=16)
    red, green, blue = picture.reshape(-1, 3).mean(axis=0)
    return np.degrees(np.arctan2(1.0 - red / blue, green / blue - 1.0))


def prism_scene():
    dispersing_scene(8)
    set_direction_world()
    add_camera((0.03, -4.0, 0.02), (0.03, 0.0, 0.02), width=0.5)


@pytest.mark.parametrize("wavelength", (440.0, 550.0, 660.0))
def test_a_prism_turns_each_wavelength_as_snell_has_it(tmp_path, wavelength):
    expected = np.degrees(np.arcsin(index(SF11, wavelength) * np.sin(np.radians(APEX)))) - APEX
    prism_scene()
    prism(material(SF11, spectral_distribution=line(tmp_path, wavelength), **CLEAR))
    assert deviation() == pytest.approx(expected, abs=0.01)


NEIGHBOURS = {
    "Sellmeier": WATER | {"dispersion_model": "SELLMEIER"},
    "Abbe": {"ior": 1.4, "dispersion_model": "ABBE", "abbe": 20.0},
    "JF": {"ior": 1.4, "dispersion_model": "JF", "dispersion": 0.1},
}


@pytest.mark.parametrize("name", NEIGHBOURS)
def test_a_medium_that_splits_no_light_bends_split_light_by_its_own_curve(tmp_path, name):
    keywords = {key: value for key, value in NEIGHBOURS[name].items() if key != "priority"}
    n1, n2 = index(SF11, 440.0), dispersion.material_ior(keywords, 440.0)
    assert abs(n2 - dispersion.material_ior(keywords, dispersion.LINE_D)) > 5e-3
    in_bath = np.arcsin(n1 / n2 * np.sin(np.radians(APEX))) - np.radians(APEX)
    prism_scene()
    prism(material(SF11, spectral_distribution=line(tmp_path, 440.0), **CLEAR), priority=1)
    bath = nd.new_material("Bath", shadow_mode="BLACK", **keywords, **CLEAR)
    add_box("Bath", (-3, -0.5, -2), (3, 3, 2), bath, priority=2)
    # 1e-5 of the index is 0.002 degrees here; single precision and the 0.02 nm of the line stay below it.
    assert deviation() == pytest.approx(np.degrees(np.arcsin(n2 * np.sin(in_bath))), abs=0.01)


def test_a_table_of_another_material_keeps_its_wavelengths_in_every_medium(tmp_path):
    n1, n2 = index(SF11, 445.0), index(WATER, 445.0)
    in_bath = np.arcsin(n1 / n2 * np.sin(np.radians(APEX))) - np.radians(APEX)
    prism_scene()
    bath = material(WATER, disperse=False, **CLEAR)
    for place, wavelength in enumerate((500.0, 600.0, 445.0)):
        glass = material(SF11, spectral_distribution=line(tmp_path, wavelength), **CLEAR)
        assert glass.node_tree.nodes["Nested Dielectric"].inputs["Spectral Table"].default_value == place + 1
    prism(glass, priority=1)
    add_box("Bath", (-3, -0.5, -2), (3, 3, 2), bath, priority=2)
    assert deviation() == pytest.approx(np.degrees(np.arcsin(n2 * np.sin(in_bath))), abs=0.01)


def test_motion_blur_is_followed_from_render_to_render_where_shaders_are_kept():
    scene = dispersing_scene(32)
    scene.render.use_persistent_data = True
    set_band_world()
    add_camera((0, -5, 0.3), (0, 0, 0), width=2.1)
    add_sphere("Sphere", 1.0, material(SF11))
    pictures = []
    for blurred in (False, True, False):
        scene.render.use_motion_blur = blurred
        pictures.append(render(samples=64))
    scene.render.use_persistent_data = False
    colourfulness = [np.ptp(picture, axis=2).mean() / picture.mean() for picture in pictures]
    assert colourfulness[1] > 0.05
    assert CLOSURES_DISPERSE or colourfulness[0] < 1e-6
    assert np.array_equal(pictures[0], pictures[2]) and not np.array_equal(pictures[0], pictures[1])


def test_one_wavelength_is_reflected_totally_where_another_leaves(tmp_path):
    angle = np.radians(33.7)
    blue, red = index(SF11, 440.0), index(SF11, 660.0)
    assert blue * np.sin(angle) > 1.0 > red * np.sin(angle)
    dispersing_scene(8).cycles.max_bounces = 4  # blue light, which never leaves, is given up early
    set_half_world(2, 1)
    direction = np.array([np.sin(angle), 0.0, np.cos(angle)])
    add_camera(tuple(-0.5 * direction), tuple(0.5 * direction), width=0.1)
    glass = material(SF11, spectral_distribution=line(tmp_path, 440.0, 660.0), internal_reflections=False)
    add_box("Block", (-20, -20, -1), (20, 20, 1), glass)
    table = material_table(glass)
    share = table[table[:, 3] > 550.0, :3].sum(axis=0) / len(table)
    picture = render(samples=4096).mean(axis=(0, 1))
    # The share of red light among 64 pixels of 4096 well distributed wavelengths is off by less than 1 in 4096.
    assert picture == pytest.approx(share * (1.0 - fresnel(33.7, red, 1.0)), abs=2e-3)


def test_negative_colours_reach_the_image_unless_they_are_clamped():
    lowest = {}
    for clamped in (True, False):
        dispersing_scene()
        set_band_world()
        add_camera((0, -5, 0.3), (0, 0, 0), width=2.1)
        add_sphere("Sphere", 1.0, material(SF11, clamp_negative=clamped))
        lowest[clamped] = render(samples=256).min()
    assert lowest[True] >= 0.0 > -0.01 > lowest[False]


def test_motion_and_colour_do_not_correlate():
    scene = dispersing_scene(32)
    scene.render.motion_blur_shutter = 1.0
    set_world((0.0, 0.0, 0.0))
    add_camera((0, -5, 0), (0, 0, 0), width=2)
    add_box("Pane", (-2, -1, -2), (2, -0.8, 2), material(SF11))
    stripe = add_plane("Stripe", 0.4, (0, 0, 0), (0, -1, 0), emission())
    for frame, x in ((0, -1.0), (2, 1.0)):
        stripe.location.x = x
        stripe.keyframe_insert("location", frame=frame)
    scene.frame_set(1)
    picture = render(samples=1024)
    # Light that meets the pane straight on is not parted in space, so the stripe's trail is white along its whole
    # length. A pixel sees it for a fifth of the time, which leaves 1.2 / sqrt(1024 / 5) = 0.08 of noise in a channel,
    # and a column of the stripe's 6 pixels 0.03.
    trail = picture[13:19].mean(axis=0)
    trail = trail[trail.mean(axis=1) > 0.1]
    assert len(trail) > 12
    assert np.abs(trail / trail.mean(axis=1, keepdims=True) - 1.0).max() < 0.15


def caustic(mat, walks, samples):
    """What a ball throws on a floor out of a point light: the tile around the focus."""
    scene = bpy.context.scene
    set_world((0.0, 0.0, 0.0))
    add_camera((0.9, 0, 6), (0.9, 0, 0), width=1.6)
    floor = add_plane("Floor", 6, (0, 0, -1.2), (0, 0, 1), diffuse(0.8))
    ball = add_sphere("Ball", 0.5, mat, location=(0, 0, -0.4))
    light = bpy.data.lights.new("Light", "POINT")
    light.energy = 100
    light.shadow_soft_size = 0.02
    bulb = bpy.data.objects.new("Light", light)
    bulb.location = (-4, 0, 2.2)
    scene.collection.objects.link(bulb)
    if walks:
        ball.cycles.is_caustics_caster = floor.cycles.is_caustics_receiver = light.cycles.is_caustics_light = True
    return render(samples)[16:32, 16:32].mean(axis=(0, 1))


def test_shadow_caustics_are_split_into_the_colours_of_one_caustic_for_every_wavelength():
    dispersing_scene()
    ours = caustic(material(SF11), True, 64)
    table = material_table(material(SF11))
    reference = np.zeros(3)
    for part in np.array_split(table.astype(float), 12):
        new_scene(48)
        wavelength = part[:, 3].mean()
        reference += caustic(cycles_glass(index(SF11, wavelength)), True, 16) * part[:, :3].sum(axis=0) / len(table)
    assert reference.max() / reference.min() > 1.04
    # 12 wavelengths and 4,096 paths a render leave less than 0.5 %.
    assert ours == pytest.approx(reference, rel=1e-2)
    dispersing_scene()
    assert caustic(material(SF11), False, 64).max() < 0.5 * ours.min()
