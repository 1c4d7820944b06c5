"""Rough, filmed, bumped and anisotropic surfaces, and light found through them, against Cycles' own Glass."""

import math

import bpy
import numpy as np
import pytest
from references import reference_batches
from scenes import (
    add_box,
    add_camera,
    add_plane,
    add_point_light,
    add_sphere,
    batches,
    cycles_glass,
    diffuse,
    emission,
    fresnel,
    mostly_again,
    native,
    new_scene,
    render,
    set_half_world,
    set_striped_world,
    set_world,
)
from significance import assert_mean, assert_same_picture

import nested_dielectric as nd
from nested_dielectric.nodes import compatibility

SAMPLES = 256
BATCHES = 16


def ball(material, look=batches) -> np.ndarray:
    new_scene(48)
    set_striped_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=26)
    add_sphere("Ball", 1.0, material())
    return look(SAMPLES, BATCHES)


@pytest.mark.parametrize("distribution", ["GGX", "MULTI_GGX", "BECKMANN"])
def test_a_rough_ball_matches_cycles_own_glass(distribution):
    def reference():
        material = cycles_glass(1.5, 0.4)
        material.node_tree.nodes["Glass BSDF"].distribution = distribution
        return material

    ours = ball(
        lambda: nd.new_material("Glass", ior=1.5, roughness=0.4, distribution=distribution, shadow_mode="BLACK")
    )
    assert_same_picture(ours, ball(reference, reference_batches))


@pytest.mark.skipif(not compatibility.shows_front_ior(), reason="Cycles refracts isotropically")
@pytest.mark.parametrize("anisotropy", [0.6, -0.6])
def test_an_anisotropic_ball_matches_cycles_own_glass(anisotropy):
    def reference():
        material = cycles_glass(1.5, 0.4)
        glass = material.node_tree.nodes["Glass BSDF"]
        glass.distribution = "GGX"
        glass.inputs["Anisotropy"].default_value = anisotropy
        tangent = material.node_tree.nodes.new("ShaderNodeTangent")
        tangent.direction_type, tangent.axis = "RADIAL", "Z"
        material.node_tree.links.new(tangent.outputs[0], glass.inputs["Tangent"])
        return material

    rough = {"ior": 1.5, "roughness": 0.4, "distribution": "GGX", "anisotropy": anisotropy, "shadow_mode": "BLACK"}
    ours = ball(lambda: nd.new_material("Glass", **rough))
    assert_same_picture(ours, ball(reference, reference_batches))


def test_a_thin_film_matches_cycles_own_glass():
    film = {"Thin Film Thickness": 350.0, "Thin Film IOR": 1.8}

    def reference():
        material = cycles_glass(1.5)
        for name, value in film.items():
            material.node_tree.nodes["Glass BSDF"].inputs[name].default_value = value
        return material

    ours = ball(
        lambda: nd.new_material("Glass", ior=1.5, thin_film_thickness=350.0, thin_film_ior=1.8, shadow_mode="BLACK")
    )
    assert_same_picture(ours, ball(reference, reference_batches))
    assert np.ptp(ours.mean(axis=0), axis=2).max() > 0.05  # interference is coloured


def test_a_normal_input_turns_the_surface():
    """Seen at 45 degrees with its normal turned 20 degrees towards the eye, a surface reflects as at 25."""
    new_scene(16)
    set_half_world(2, +1)
    material = nd.new_material("Ink", ior=1.5, transmittance=(0, 0, 0), transmittance_depth=0.01)
    tree = material.node_tree
    turned = tree.nodes.new("ShaderNodeCombineXYZ")
    angle = math.radians(20)
    turned.inputs["X"].default_value, turned.inputs["Z"].default_value = math.sin(angle), math.cos(angle)
    tree.links.new(turned.outputs[0], tree.nodes["Nested Dielectric"].inputs["Normal"])
    add_box("Block", (-10, -10, -10), (10, 10, 0), material)
    slope = math.radians(45)
    add_camera((0.37 + 3 * math.sin(slope), 0.11, 3 * math.cos(slope)), (0.37, 0.11, 0), width=0.01)
    assert_mean(render(1024), fresnel(25, 1.0, 1.5))


def reflected_glow(anisotropy: float, tangent: tuple[float, float, float]) -> np.ndarray:
    """The picture of a small light in a rough block that only reflects."""
    new_scene(32)
    set_world((0, 0, 0))
    material = nd.new_material(
        "Block", ior=1.5, roughness=0.5, anisotropy=anisotropy, refraction_scale=0.0, distribution="GGX"
    )
    tree = material.node_tree
    direction = tree.nodes.new("ShaderNodeCombineXYZ")
    for axis, value in zip("XYZ", tangent):
        direction.inputs[axis].default_value = value
    tree.links.new(direction.outputs[0], tree.nodes["Nested Dielectric"].inputs["Tangent"])
    add_box("Block", (-10, -10, -1), (10, 10, 0), material)
    add_sphere("Lamp", 0.2, emission(10), location=(0, 0, 2))
    add_camera((0, 0, 5), (0, 0, 0), width=4)
    bpy.data.objects["Lamp"].visible_camera = False
    return render(1024)


def test_anisotropy_stretches_reflections_across_the_tangent():
    across = reflected_glow(0.8, (1, 0, 0))
    profile = across.mean(axis=2)
    x = np.arange(32) - 15.5
    width = (profile.sum(axis=0) * x**2).sum() / profile.sum()
    height = (profile.sum(axis=1) * x**2).sum() / profile.sum()
    assert height > 1.5 * width
    # The tangent turned by 90 degrees with the sign reversed is the same lobe.
    same = reflected_glow(-0.8, (0, 1, 0))
    assert abs(same.mean() / across.mean() - 1) < 0.01
    difference = np.abs(same - across).reshape(4, 8, 4, 8, 3).mean(axis=(1, 3))
    assert difference.max() < 0.05 * across.max()


BARELY_ROUGH = 1e-5
"""A roughness that Cycles takes for none, but that has the closure of rough surfaces."""


def smooth_ball(material, **settings) -> np.ndarray:
    """A ball of few faces, whose normals would often reflect light into them, on a diffuse floor."""
    scene = new_scene(32)
    set_striped_world()
    add_camera((0, -5, 0.6), (0, 0, -0.2), angle=32)
    add_sphere("Ball", 1.0, material(), segments=8)
    add_plane("Floor", 8.0, (0, 0, -1.1), (0, 0, 1), diffuse(0.8))
    for name, value in settings.items():
        setattr(scene.cycles, name, value)
    return render(64)


@pytest.mark.parametrize(
    "situation",
    mostly_again(
        [
            ({}, {}),
            ({"distribution": "BECKMANN", "specular_scale": 0.5}, {"blur_glossy": 1.0}),
            ({}, {"caustics_reflective": False}),
            ({}, {"caustics_refractive": False}),
            ({}, {"caustics_reflective": False, "caustics_refractive": False}),
            ({"max_interior_reflections": 2}, {"glossy_bounces": 3, "transmission_bounces": 3}),
            ({}, {"use_denoising": True}),
        ],
        first=3,
    ),
)
def test_a_smooth_surface_looks_like_one_that_is_barely_rough(situation):
    keywords, settings = situation
    smooth, rough = (
        smooth_ball(lambda each=roughness: nd.new_material("Glass", ior=1.5, roughness=each, **keywords), **settings)
        for roughness in (0.0, BARELY_ROUGH)
    )
    # The same paths, but for rounding, which turns one in many aside. Closures that Cycles treats otherwise move a
    # thousandth of the light and more.
    assert np.abs(smooth - rough).mean() < 1e-4 * rough.mean()


def test_roughness_may_be_none_in_places():
    """A ball that is smooth on the left and rough on the right reflects there what whole balls do."""

    def picture(roughness: float, left_smooth: bool = False) -> np.ndarray:
        new_scene(32)
        set_striped_world()
        add_camera((0, -5, 0.3), (0, 0, 0), angle=26)
        material = nd.new_material("Mirror", ior=1.5, roughness=roughness, refraction_scale=0.0)
        if left_smooth:
            tree = material.node_tree
            geometry, axes, right = (
                tree.nodes.new(f"ShaderNode{kind}") for kind in ("NewGeometry", "SeparateXYZ", "Math")
            )
            right.operation, right.inputs[1].default_value = "GREATER_THAN", 0.0
            tree.links.new(geometry.outputs["Position"], axes.inputs[0])
            tree.links.new(axes.outputs["X"], right.inputs[0])
            tree.links.new(right.outputs[0], tree.nodes["Nested Dielectric"].inputs["Roughness"])
        add_sphere("Ball", 1.0, material)
        return render(16)

    both, smooth, rough = picture(1.0, left_smooth=True), picture(0.0), picture(1.0)
    # The same paths; pixels in the middle show both.
    np.testing.assert_allclose(both[:, :15], smooth[:, :15], atol=1e-5)
    np.testing.assert_allclose(both[:, 17:], rough[:, 17:], atol=1e-5)
    assert np.abs(smooth - rough).max() > 0.01


def caustic(material, look=batches) -> np.ndarray:
    """A floor lit through a ball by manifold next-event estimation alone."""
    new_scene(48)
    set_world((0, 0, 0))
    bpy.context.scene.cycles.caustics_refractive = bpy.context.scene.cycles.caustics_reflective = False
    caster = add_sphere("Ball", 0.5, material(), location=(0, 0, 1.2))
    caster.cycles.is_caustics_caster = True
    floor = add_plane("Floor", 6, (0, 0, 0), (0, 0, 1), diffuse())
    floor.cycles.is_caustics_receiver = True
    add_point_light((0, 0, 3), 100)
    add_camera((0, -2.5, 0.6), (0, 0, 0), angle=30)
    return look(SAMPLES, BATCHES)


def test_shadow_caustics_match_those_of_cycles_own_glass():
    ours = caustic(lambda: nd.new_material("Glass", ior=1.5, shadow_mode="BLACK"))
    reference = caustic(lambda: cycles_glass(1.5), reference_batches)
    assert ours.max() > 5 * np.median(ours)  # there is a caustic
    assert_same_picture(ours, reference)


def test_a_light_inside_a_medium_needs_no_setting():
    def picture(material, look=batches) -> np.ndarray:
        new_scene(48)
        set_world((0, 0, 0))
        add_sphere("Ball", 1.0, material())
        add_sphere("Lamp", 0.2, emission(3.0), location=(0.2, 0.1, 0.0))
        add_camera((0, -5, 0.3), (0, 0, 0), angle=26)
        return look(SAMPLES, BATCHES)

    ours = picture(lambda: nd.new_material("Glass", ior=1.5, shadow_mode="BLACK"))
    assert_same_picture(ours, picture(lambda: cycles_glass(1.5), reference_batches))


def test_equal_priorities_are_one_medium():
    """Two overlapping slabs: no surface between them, absorption over their common thickness."""
    new_scene(16)
    set_half_world(2, -1)
    tinted = nd.new_material(
        "Tinted", ior=1.5, transmittance=(0.8, 0.5, 0.2), transmittance_depth=0.5, internal_reflections=False
    )
    add_box("Upper", (-10, -10, -0.6), (10, 10, 0), tinted, 1)
    add_box("Lower", (-10.1, -10.1, -1.0), (10.1, 10.1, -0.4), tinted, 1)
    add_camera((0.37, 0.11, 3), (0.37, 0.11, 0), width=0.01)
    expected = (1 - fresnel(0, 1, 1.5)) ** 2 * np.power((0.8, 0.5, 0.2), 1.0 / 0.5)
    assert_mean(render(1024), expected)


def test_a_material_that_is_not_ours_stays_foreign():
    """Cycles' own glass in our water does not take part in priorities: both of its surfaces are there."""
    new_scene(16)
    set_world()
    add_sphere("Ours", 1.0, nd.new_material("Water", preset="water"))
    add_sphere("Theirs", 0.5, native("Emitter", "ShaderNodeEmission", Color=(0.0, 0.0, 0.0, 1.0)))
    add_camera((0, -5, 0), (0, 0, 0), width=0.1)
    picture = render(64)
    assert picture.mean() < fresnel(0, 1, 1.3334) * 1.5
