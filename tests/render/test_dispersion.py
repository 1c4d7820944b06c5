"""Light that is split into its colours, against Snell's law, brute force and white."""

import inspect

import bpy
import colour
import numpy as np
import pytest
from dispersing import SF11, WATER, dispersing_scene, index, material, set_band_world
from references import reference_tiles
from scenes import (
    add_camera,
    add_plane,
    add_sphere,
    batches,
    cycles_glass,
    diffuse,
    native,
    new_scene,
    render,
    set_world,
)
from significance import assert_same_picture

import nested_dielectric as nd


def daylight(wavelengths, gamut):
    """RGB of daylight's power at some wavelengths in a gamut, from colour-science's own tables."""
    matching = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    power = colour.SDS_ILLUMINANTS["D65"]
    xyz = np.stack([np.interp(wavelengths, matching.wavelengths, values) for values in matching.values.T], axis=-1)
    xyz *= np.interp(wavelengths, power.wavelengths, power.values)[:, None]
    space = colour.RGB_COLOURSPACES[gamut]
    white = np.array([0.95047, 1.0, 1.08883])
    target = colour.xy_to_XYZ(space.whitepoint)
    adapt = colour.adaptation.matrix_chromatic_adaptation_VonKries(white, target, "Bradford")
    return xyz @ adapt.T @ np.linalg.inv(space.matrix_RGB_to_XYZ).T


def add_attribute_glass(name, radius):
    """A sphere of Cycles' own Glass whose index is the object's property "index"."""
    mat = cycles_glass(1.0)
    attribute = mat.node_tree.nodes.new("ShaderNodeAttribute")
    attribute.attribute_type = "OBJECT"
    attribute.attribute_name = "index"
    glass = next(node for node in mat.node_tree.nodes if node.type == "BSDF_GLASS")
    mat.node_tree.links.new(attribute.outputs["Fac"], glass.inputs["IOR"])
    return add_sphere(name, radius, mat)


def brute_force(shells, gamut, count, samples, wavelengths=48):
    """Batches of pictures put together from renders of one wavelength each, with interfaces split by hand.

    Every batch has its own wavelengths, evenly spaced; together they are count times as many.
    """
    scene = bpy.context.scene
    objects = [add_attribute_glass(f"Shell {place}", radius) for place, (radius, _) in enumerate(shells)]
    scene.render.use_persistent_data = True
    # Cycles sends its first sample through the middle of every pixel, which weighs too much where there are few.
    scene.cycles.use_sample_subset = True
    scene.cycles.sample_offset = 16
    scene.cycles.sample_subset_length = samples
    return reference_tiles(
        lambda: wavelength_batches(objects, shells, gamut, count, samples, wavelengths),
        *(shells, gamut, count, samples, wavelengths),
        *map(inspect.getsource, (wavelength_batches, daylight, index)),
    )


def wavelength_batches(objects, shells, gamut, count, samples, wavelengths):
    pictures = []
    for batch in range(count):
        nm = 380.0 + 400.0 * (np.arange(wavelengths) + (batch + 0.5) / count) / wavelengths
        weights = daylight(nm, gamut)
        weights /= weights.sum(axis=0)
        picture = 0.0
        for place, wavelength in enumerate(nm):
            outside = 1.0
            for obj, (_, medium) in zip(objects, shells):
                obj["index"] = index(medium, wavelength) / outside
                obj.update_tag()
                outside = index(medium, wavelength)
            picture = picture + render(16 + samples, seed=1000 * batch + place) * weights[place]
        pictures.append(picture)
    return np.stack(pictures)


SHELLS = {"sphere": ((1.0, SF11),), "water in a sphere": ((1.0, SF11), (0.7, WATER))}


def look_at_shells():
    set_band_world()
    add_camera((0, -5, 0.3), (0, 0, 0), width=2.1)


def split_light(name, gamut, samples):
    """Batches of a picture of shells in which the outermost starts dispersion, with negative colours."""
    dispersing_scene()
    look_at_shells()
    for place, (radius, medium) in enumerate(SHELLS[name]):
        mat = material(medium, spectral_gamut=gamut, clamp_negative=False, disperse=place == 0)
        add_sphere(f"Shell {place}", radius, mat, priority=9 - place)
    return batches(8 * samples, 8)


@pytest.fixture(scope="module")
def wide_sphere():
    return split_light("sphere", "REC2020", 256)


@pytest.mark.parametrize("name", SHELLS)
def test_colours_are_those_of_one_render_for_every_wavelength(name, request):
    ours = request.getfixturevalue("wide_sphere") if name == "sphere" else split_light(name, "REC2020", 192)
    new_scene(48)
    look_at_shells()
    reference = brute_force(SHELLS[name], "ITU-R BT.2020", count=4, samples=16)
    assert_same_colours(ours, reference)


def assert_same_colours(ours, reference):
    """Hold the tiles to noise, and each channel of the whole to 0.2 % beyond 2 standard errors."""
    assert_same_picture(ours, reference)
    a, b = ours.mean(axis=(1, 2)), reference.mean(axis=(1, 2))
    error = np.sqrt(a.var(axis=0, ddof=1) / len(a) + b.var(axis=0, ddof=1) / len(b))
    relative = np.abs(a.mean(axis=0) - b.mean(axis=0)) - 2.0 * error
    assert (relative / b.mean(axis=0)).max() < 2e-3, (a.mean(axis=0) / b.mean(axis=0) - 1.0, error)


@pytest.mark.again
def test_a_wide_gamut_render_is_the_narrow_one_converted_where_nothing_is_clamped(wide_sphere):
    narrow, wide = (colour.RGB_COLOURSPACES[name] for name in ("ITU-R BT.709", "ITU-R BT.2020"))
    convert = colour.matrix_RGB_to_RGB(narrow, wide, None)
    assert_same_colours(split_light("sphere", "REC709", 256) @ convert.T, wide_sphere)


@pytest.mark.parametrize("roughness", (0.0, 0.3))
def test_a_white_world_seen_through_a_dispersing_object_is_white(roughness):
    dispersing_scene()
    set_world()
    add_camera((0, -5, 0.3), (0, 0, 0), width=2.1)
    add_sphere("Sphere", 1.0, material(SF11, roughness=roughness, distribution="GGX"))
    add_sphere("Drop", 0.6, material(WATER), priority=1)
    mean = render(samples=256).mean(axis=(0, 1))
    # Single-scattering GGX loses energy on rough surfaces, in all colours alike.
    mean = mean / mean.mean() if roughness else mean
    assert mean == pytest.approx([1.0, 1.0, 1.0], abs=2e-3)


def test_light_that_a_translucent_sheet_scatters_into_a_dispersing_object_stays_white():
    scene = dispersing_scene(16)
    set_world()
    add_camera((0, -8, 0), (0, 0, 0), width=0.5)
    sheet = native("Sheet", "ShaderNodeBsdfTranslucent", Color=(1.0, 1.0, 1.0, 1.0))
    add_plane("Sheet", 2, (0, 0, 0), (0, -1, 0), sheet)
    add_sphere("Ball", 1.0, material(SF11), location=(0, 1.2, 0))
    scene.cycles.diffuse_bounces = 1
    mean = render(samples=256).mean(axis=(0, 1))
    # 65,536 paths, whose colours deviate by 1.5 around white, leave 0.6 %.
    assert mean == pytest.approx([1.0, 1.0, 1.0], rel=0.02)


def test_what_is_not_seen_through_a_dispersing_object_does_not_change_in_a_single_pixel():
    dispersing_scene(32)
    set_band_world()
    add_camera((0, -8, 0), (0, 0, 0), width=5)
    add_plane("Wall", 20, (0, 0, 0), (1, 0, 0), diffuse(0.0))
    add_sphere("Plain", 1.0, nd.new_material("Plain", ior=1.5, shadow_mode="BLACK"), location=(-1.25, 0, 0))
    add_sphere("Chalk", 0.4, diffuse(0.8), location=(-1.25, 0, 1.6))
    glass = material(SF11, disperse=False)
    add_sphere("Prism", 1.0, glass, location=(1.25, 0, 0))
    without = render(samples=16)
    glass.node_tree.nodes["Nested Dielectric"].inputs["Disperse"].default_value = True
    split = render(samples=16)
    assert np.array_equal(split[:, :15], without[:, :15])
    assert not np.array_equal(split[:, 17:], without[:, 17:])
