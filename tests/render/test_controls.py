"""Every control of a medium's lobes, sampling, caustics and sky, against closed forms and one another."""

import math

import numpy as np
import pytest
from scenes import (
    add_box,
    add_camera,
    add_plane,
    add_sphere,
    diffuse,
    emission,
    fresnel,
    new_scene,
    render,
    set_half_world,
    set_striped_world,
    set_world,
)
from significance import assert_mean

import nested_dielectric as nd
from nested_dielectric.model import parameters, presets
from nested_dielectric.model.effects import has_effect

SF11 = presets.load_preset("sf11").parameters


def glass(**keywords):
    return nd.new_material("Glass", **{"ior": 1.5, "shadow_mode": "BLACK"} | keywords)


def link_vector(material, socket, value):
    """Give a vector socket a value, as a link that neighbours and limits do not touch."""
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeCombineXYZ")
    for axis, component in zip("XYZ", value):
        node.inputs[axis].default_value = component
    tree.links.new(node.outputs[0], tree.nodes["Nested Dielectric"].inputs[socket])


def ball(samples=16, **keywords):
    """A ball in front of stripes."""
    new_scene(32)
    set_striped_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=26)
    add_sphere("Ball", 1.0, glass(**keywords))
    return render(samples)


def other_value(parameter):
    """A value far from a parameter's default."""
    if parameter.kind in ("MENU", "INDEX"):
        return next(choice.keyword for choice in parameter.choices if choice.keyword != parameter.default)
    if parameter.kind == "BOOL":
        return not parameter.default
    far = 0.5 * (parameter.minimum + parameter.maximum)
    return far if far != parameter.default else parameter.maximum


@pytest.mark.parametrize(
    "keywords",
    [
        {},
        {"roughness": 0.3, "separate_reflection": True},
        {"internal_reflections": False, "transmittance": (0.5, 0.8, 0.9)},
    ],
)
def test_what_panels_grey_out_does_not_show_in_the_picture(keywords):
    numeric = [each for each in parameters.SOCKETS if each.kind not in ("SHADER", "VECTOR")]
    values = {each.keyword: keywords.get(each.keyword, each.default) for each in numeric} | {"lights_by_lobe": False}
    idle = {each.keyword: other_value(each) for each in numeric if not has_effect(each, values)}
    assert len(idle) > 15

    def lit_ball(**more):
        new_scene(24)
        set_striped_world()
        add_camera((0, -5, 2), (0, 0, -0.2), angle=36)
        add_sphere("Ball", 1.0, glass(shadow_mode="ALL_FRESNEL", **keywords, **more))
        add_plane("Floor", 8.0, (0, 0, -1.1), (0, 0, 1), diffuse())
        return render(16)

    # The same paths, but for the rounding of closures that are put together otherwise, which turns one path in many aside. What
    # shows changes the mean by a hundredth and more.
    assert np.abs(lit_ball(**idle) - lit_ball()).mean() < 1e-4


# Lobes


def test_separate_reflection_has_its_own_roughness_and_distribution():
    mirror = {"refraction_scale": 0.0, "internal_reflections": False}
    sharp = ball(**mirror)
    # The same paths, but for the rounding of another closure's weight.
    assert ball(roughness=0.5, separate_reflection=True, **mirror) == pytest.approx(sharp, rel=1e-4)
    own = {"separate_reflection": True, "reflection_roughness": 0.6}
    for distribution in ("GGX", "BECKMANN"):
        same = ball(roughness=0.6, distribution=distribution, **mirror)
        separate = ball(reflection_distribution=distribution, distribution="MULTI_GGX", **own, **mirror)
        assert separate == pytest.approx(same, rel=1e-4)
        assert not np.allclose(separate, sharp, atol=0.05)
    assert not np.allclose(separate, ball(reflection_distribution="GGX", **own, **mirror), atol=1e-3)


def test_separate_reflection_has_its_own_anisotropy():
    mirror = {"refraction_scale": 0.0, "internal_reflections": False, "distribution": "GGX"}
    joint = ball(roughness=0.5, anisotropy=0.7, **mirror)
    own = {"separate_reflection": True, "reflection_roughness": 0.5, "reflection_distribution": "GGX"}
    assert ball(reflection_anisotropy=0.7, **own, **mirror) == pytest.approx(joint, rel=1e-4)
    assert not np.allclose(ball(**own, **mirror), joint, atol=0.02)


def set_spread_world():
    """A world whose red and green are the distances of a direction from -Z along x and y."""
    tree = set_world()
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    absolute = tree.nodes.new("ShaderNodeVectorMath")
    absolute.operation = "ABSOLUTE"
    tree.links.new(coordinates.outputs["Generated"], absolute.inputs[0])
    tree.links.new(absolute.outputs[0], tree.nodes["Background"].inputs["Color"])


def refracted_spread(tangent=(1, 0, 0), samples=256, **keywords):
    """How far a slab's rough faces turn light that comes down: mean distances from the vertical along x and y."""
    new_scene(32)
    set_spread_world()
    material = glass(specular_scale=0.0, **keywords)
    link_vector(material, "Tangent", tangent)
    add_box("Slab", (-20, -20, -0.1), (20, 20, 0), material)
    add_camera((0.37, 0.11, 3), (0.37, 0.11, 0), width=1)
    return render(samples).mean(axis=(0, 1))[:2]


@pytest.mark.parametrize("distribution", ("BECKMANN", "GGX"))
def test_rough_refraction_is_as_anisotropic_as_asked(distribution):
    """Both faces turn light by (n - 1) times their slopes, so its spread goes with alpha along either axis."""
    wide, narrow = (
        refracted_spread(roughness=math.sqrt(alpha), distribution=distribution).mean() for alpha in (0.06, 0.015)
    )
    x, y = refracted_spread(roughness=math.sqrt(0.03), anisotropy=0.5, distribution=distribution)
    # 262,144 paths leave 0.2 %; GGX's tails, where small angles do not hold, 2 %.
    assert x == pytest.approx(narrow, rel=0.04)
    assert y == pytest.approx(wide, rel=0.04)
    turned = refracted_spread((0, 1, 0), roughness=math.sqrt(0.03), anisotropy=0.5, distribution=distribution)
    assert turned == pytest.approx((y, x), rel=0.02)


def slanted(tangent=None, **keywords):
    """How far a slab turns light out of the XZ plane, in which it is seen at 45 degrees."""
    new_scene(16)
    set_spread_world()
    material = glass(specular_scale=0.0, roughness=0.2, anisotropy=0.8, distribution="BECKMANN", **keywords)
    if tangent:
        link_vector(material, "Tangent", tangent)
    add_box("Slab", (-20, -20, -0.1), (20, 20, 0), material)
    add_camera((3.1, 0.2, 3), (0.1, 0.2, 0), width=1)
    return render(256).mean(axis=(0, 1))[1]


def test_tangents_from_refraction_lie_in_the_plane_of_incidence():
    derived, along, across = slanted(tangent_from="REFRACTION"), slanted((1, 0, 0)), slanted((0, 1, 0))
    assert along > 20.0 * across
    # Behind the first face the light has left the plane a little, and its tangents with it.
    assert derived == pytest.approx(along, rel=0.02)


def test_blurred_poles_are_round():
    lobe = {"roughness": 0.4, "distribution": "BECKMANN"}
    x, y = refracted_spread((0, 0, 1), anisotropy=0.5, blur_anisotropic_poles=0.5, **lobe)
    assert x == pytest.approx(y, rel=0.02)  # the tangents' axis is the normal
    x, y = refracted_spread((1, 0, 0), anisotropy=0.5, blur_anisotropic_poles=0.5, **lobe)
    assert y > 2.0 * x
    x, y = refracted_spread((1, 0, 0), anisotropy=0.5, blur_anisotropic_poles=1.0, **lobe)
    assert x == pytest.approx(y, rel=0.02)


# Polarizing filter


def polarised_reflectance(degrees, filter_degrees):
    """What a glass block reflects of a white world towards a camera whose vertical is in the plane of incidence."""
    new_scene(8)
    set_world()
    material = glass(refraction_scale=0.0, polarize=True, polarization_angle=math.radians(filter_degrees))
    add_box("Block", (-20, -20, -1), (20, 20, 0), material)
    angle = math.radians(degrees)
    camera = add_camera((0.07, 0.03 - 5 * math.sin(angle), 5 * math.cos(angle)), (0.07, 0.03, 0), width=0.1)
    assert abs(camera.rotation_euler.y) < 1e-3
    return render(256)


BREWSTER = math.degrees(math.atan(1.5))


@pytest.mark.parametrize("degrees", (BREWSTER, 40.0, 70.0))
@pytest.mark.parametrize("filter_degrees", (0.0, 90.0, 30.0))
def test_a_polarizing_filter_sees_fresnels_two_reflectances(degrees, filter_degrees):
    cos_i = math.cos(math.radians(degrees))
    cos_t = math.sqrt(1.0 - (math.sin(math.radians(degrees)) / 1.5) ** 2)
    across = ((cos_i - 1.5 * cos_t) / (cos_i + 1.5 * cos_t)) ** 2
    within = ((1.5 * cos_i - cos_t) / (1.5 * cos_i + cos_t)) ** 2
    share = math.cos(math.radians(filter_degrees)) ** 2
    assert_mean(polarised_reflectance(degrees, filter_degrees), share * within + (1.0 - share) * across)


def test_at_brewsters_angle_a_vertical_filter_takes_the_reflection_away():
    assert polarised_reflectance(BREWSTER, 0.0).max() < 1e-4


def test_a_polarizing_filter_keeps_a_white_world_white():
    new_scene(16)
    set_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=26)
    add_sphere("Ball", 1.0, glass(polarize=True, polarization_angle=0.6))
    assert_mean(render(64), 1.0)


# Sampling


def lit_slab(samples=256, **keywords):
    """A slab of high index before a world that is white below it: what comes through."""
    new_scene(8)
    set_half_world(2, -1)
    add_box("Slab", (-20, -20, -1), (20, 20, 0), glass(**{"ior": 2.5} | keywords))
    add_camera((0.07, 0.03, 3), (0.07, 0.03, 0), width=0.1)
    return render(samples)


R = fresnel(0, 1, 2.5)


@pytest.mark.parametrize(
    "keywords, expected",
    (
        ({}, (1 - R) / (1 + R)),
        ({"internal_reflections": False}, (1 - R) ** 2),
        ({"max_interior_reflections": 0}, (1 - R) ** 2),
        ({"max_interior_reflections": 2}, (1 - R) ** 2 * (1 + R * R)),
        ({"reflection_probability": 0.5}, (1 - R) / (1 + R)),
        ({"reflection_probability": 0.0}, (1 - R) / (1 + R)),
        ({"energy_cutoff_exponent": math.log10(R) + 0.01}, (1 - R) ** 2),
        ({"energy_cutoff_exponent": math.log10(R) - 0.01}, (1 - R) / (1 + R)),
    ),
    ids=str,
)
def test_interior_reflections_follow_their_series(keywords, expected):
    assert_mean(lit_slab(1024, **keywords), expected)


def test_a_reflection_probability_moves_the_noise():
    often, seldom = (lit_slab(reflection_probability=p) for p in (1.0, 0.2))
    assert seldom.std() > 1.2 * often.std()


def test_the_energy_cutoff_loses_less_at_a_surface_than_it_says():
    new_scene(16)
    set_world()
    add_camera((0, -5, 0.3), (0, 0, 0), width=1.6)
    add_sphere("Ball", 1.0, glass(energy_cutoff_exponent=-1.0))
    lost = 1.0 - render(256).mean()
    # Outside 4 % and more are given up, inside as much again for every pass; few paths meet more than 3 surfaces.
    assert 0.04 < lost < 3 * 0.1


# Caustics


def patch_below(shape, world, **keywords):
    """A diffuse patch that gets light through glass alone, as seen from beside it."""
    new_scene(8)
    world()
    add_plane("Patch", 0.4, (0, 0, 0), (0, 0, 1), diffuse(1.0))
    shape(glass(**keywords))
    add_camera((0.9, 0.0, 0.2), (0, 0, 0), width=0.05)
    return render(512).mean()


def slab_above(material):
    add_box("Slab", (-200, -200, 0.5), (200, 200, 0.8), material)


def cube_above(material):
    add_box("Cube", (-0.5, -0.5, 0.3), (0.5, 0.5, 1.3), material)


def above():
    set_half_world(2, +1)


def below():
    set_half_world(2, -1)


def test_caustic_refraction_lights_diffuse_surfaces():
    assert patch_below(slab_above, above) > 0.7
    assert patch_below(slab_above, above, caustic_refraction=False) == 0.0


def test_caustic_reflection_and_internal_reflections_light_diffuse_surfaces():
    both = patch_below(slab_above, below)
    outside = patch_below(slab_above, below, caustic_internal_reflections=False)
    inside = patch_below(slab_above, below, caustic_reflection=False)
    assert outside > 0.05 and inside > 0.03
    assert outside + inside == pytest.approx(both, rel=0.05)
    assert patch_below(slab_above, below, caustic_reflection=False, caustic_internal_reflections=False) == 0.0


def test_caustic_total_reflection_lights_diffuse_surfaces():
    """The sides of a cube reflect all light that entered through its bottom."""
    assert patch_below(cube_above, above, caustic_total_reflection=False) < 0.97 * patch_below(cube_above, above)


def test_caustic_dispersion_can_be_left_out():
    def patch(**keywords):
        scene = new_scene(8)
        scene.render.use_motion_blur = True
        scene.render.motion_blur_shutter = 0.0
        set_striped_world()
        add_plane("Patch", 0.4, (0, 0, 0), (0, 0, 1), diffuse(1.0))
        curve = {key: SF11[key] for key in ("ior", "dispersion_model", "sellmeier_b", "sellmeier_c")}
        cube_above(glass(**curve | keywords))
        add_camera((0.9, 0.0, 0.2), (0, 0, 0), width=0.05)
        return render(64)

    plain = patch(disperse=False)
    assert np.array_equal(patch(disperse=True, caustic_dispersion=False), plain)
    assert not np.allclose(patch(disperse=True), plain, atol=1e-3)


@pytest.mark.parametrize("distance", (1.0, 3.0))
def test_caustics_fall_off_linearly_with_the_distance_from_the_medium(distance):
    """Under a medium at height h with a most distance D, a patch gets (1 - h / D)^2 of a white world's light."""
    whole = patch_below(slab_above, above, ior=1.0)
    near = patch_below(slab_above, above, ior=1.0, caustic_max_distance=distance)
    assert near / whole == pytest.approx((1.0 - 0.5 / distance) ** 2, rel=0.02)


# Sky


def test_a_medium_that_does_not_refract_the_sky_shows_objects_alone():
    def picture(**keywords):
        new_scene(32)
        set_world()
        add_camera((0, -5, 0), (0, 0, 0), width=1.4)
        add_box("Slab", (-2, -0.2, -2), (2, 0.2, 2), glass(specular_scale=0.0, **keywords))
        add_plane("Wall", 0.7, (0, 2, 0), (0, -1, 0), emission(0.5))
        return render(32)

    seen, hidden = picture(), picture(refract_sky=False)
    assert hidden[0].max() == 0.0 < seen[0].min()
    assert hidden[14:18, 14:18] == pytest.approx(seen[14:18, 14:18], rel=0.2)


def test_a_medium_that_does_not_reflect_the_sky_reflects_objects_alone():
    mirror = {"refraction_scale": 0.0}
    assert ball(**mirror).mean() > 0.01
    new_scene(32)
    set_world()
    add_camera((0, -5, 0), (0, 0, 0), width=1.9)
    add_box("Block", (-2, 0, -2), (2, 1, 2), glass(reflect_sky=False, **mirror))
    add_plane("Wall", 0.7, (0, -6, 0), (0, 1, 0), diffuse(1.0)).visible_camera = False
    picture = render(32)
    assert picture[0].max() == 0.0
    assert picture[14:18, 14:18].mean() == pytest.approx(0.04, rel=0.2)
