"""Light at flat interfaces, against Snell, Fresnel and Beer-Lambert."""

import math

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from scenes import (
    add_box,
    add_camera,
    add_emission_port,
    add_mesh,
    add_plane,
    add_sun,
    diffuse,
    emission,
    fresnel,
    native,
    new_scene,
    render,
    set_half_world,
    set_world,
)
from significance import ROUNDING, assert_mean, standard_error
from slabs import AIM, DEPTH, TINT, aim_camera, beer_lambert, tinted

import nested_dielectric as nd

THICKNESS = 0.7


@pytest.mark.parametrize("degrees", [0, 45, 80])
def test_a_surface_reflects_what_fresnel_says(degrees):
    new_scene()
    set_half_world(2, +1)
    black_inside = nd.new_material("Ink", ior=1.5, transmittance=(0, 0, 0), transmittance_depth=0.01)
    add_box("Block", (-10, -10, -10), (10, 10, 0), black_inside)
    aim_camera(degrees)
    assert_mean(render(256), fresnel(degrees, 1.0, 1.5))


@pytest.mark.parametrize("n_outer, n_inner", [(1.33, 1.5), (1.5, 1.33), (1.5, 1.0), (0.8, 1.2)])
def test_where_two_media_meet_both_indices_count(n_outer, n_inner):
    """Camera inside one block, looking at the face of another that it overlaps."""
    new_scene()
    set_world((0, 0, 0))
    outer = nd.new_material("Outer", ior=n_outer)
    inner = nd.new_material("Inner", ior=n_inner, transmittance=(0, 0, 0), transmittance_depth=0.01)
    add_box("Outer", (-10, -10, -1), (10, 10, 30), outer, priority=2)
    add_box("Inner", (-60, -60, -70), (60, 60, 0), inner, priority=1)
    add_plane("Ceiling", 90, (0, 0, 20), (0, 0, -1), emission())
    aim_camera(40)
    assert_mean(render(256), fresnel(40, n_outer, n_inner))


def test_a_slab_displaces_a_ray_as_snell_says():
    """The plane behind the slab emits its own x coordinate, so the picture reads where the ray arrives."""
    new_scene(8)
    set_world((0, 0, 0))
    thickness, drop, degrees, ior = 1.0, 2.0, 45.0, 1.5
    glass = nd.new_material("Glass", ior=ior, internal_reflections=False)
    add_box("Slab", (0, -10, -thickness), (20, 10, 0), glass)
    ruler = emission()
    tree = ruler.node_tree
    position = tree.nodes.new("ShaderNodeNewGeometry")
    tree.links.new(position.outputs["Position"], tree.nodes["Emission"].inputs["Color"])
    add_plane("Ruler", 20, (10, 0, -drop), (0, 0, 1), ruler)
    slope = math.radians(degrees)
    add_camera((8 + 3 * math.sin(slope), 0.3, 3 * math.cos(slope)), (8, 0.3, 0), width=1e-3)
    inside = math.asin(math.sin(slope) / ior)
    arrives = 8 - thickness * math.tan(inside) - (drop - thickness) * math.tan(slope)
    through = (1 - fresnel(degrees, 1, ior)) * (1 - fresnel(math.degrees(inside), ior, 1))
    picture = render(1024)
    # Of the two lobes at the entrance one is black, so a pixel is `arrives` times the share of samples that went
    # through: divided by that share, which the ruler's constant green would give, position is left. Half a pixel is
    # 6e-5.
    assert np.abs(picture[..., 0].mean() / through - arrives) < 4 * standard_error(picture)[0] / through + 6e-5


def test_total_reflection_stays_when_internal_reflections_are_off():
    """A right-angled prism turns the ray by 90 degrees: two faces at normal incidence, total reflection between them."""
    new_scene(8)
    set_half_world(0, +1)
    glass = nd.new_material("Glass", ior=1.5, internal_reflections=False)

    def prism(bm):
        corners = [bm.verts.new((x, y, z)) for y in (-5, 5) for x, z in ((0, 0), (2, 0), (2, 2))]
        a, b, c, d, e, f = corners
        for face in ((a, b, c), (f, e, d), (a, d, e, b), (b, e, f, c), (c, f, d, a)):
            bm.faces.new(face)
        bmesh.ops.recalc_face_normals(bm, faces=bm.faces)

    add_mesh("Prism", prism, glass)
    # Upwards through the bottom face, off the hypotenuse, out through the face at x = 2.
    add_camera((1, 0.4, -3), (1, 0.4, 0), width=0.01)
    assert_mean(render(1024), (1 - fresnel(0, 1, 1.5)) ** 2)


@pytest.mark.parametrize("degrees", [0, 60])
def test_absorption_follows_beer_lambert(degrees):
    new_scene(16)
    set_half_world(2, -1)
    slab = tinted("Tinted", 1.5, internal_reflections=False)
    add_box("Slab", (-10, -10, -THICKNESS), (10, 10, 0), slab)
    aim_camera(degrees)
    inside = math.degrees(math.asin(math.sin(math.radians(degrees)) / 1.5))
    through = (1 - fresnel(degrees, 1, 1.5)) * (1 - fresnel(inside, 1.5, 1))
    assert_mean(render(256), through * beer_lambert(THICKNESS / math.cos(math.radians(inside))))


def test_light_that_crosses_ice_is_not_tinted_by_the_water_around_it():
    new_scene(16)
    set_half_world(2, -1)
    water = tinted("Water", 1.33, internal_reflections=False)
    ice = nd.new_material("Ice", ior=1.31, internal_reflections=False)
    add_box("Water", (-10, -10, -2.0), (10, 10, 0), water, priority=2)
    add_box("Ice", (-40, -40, -1.5), (40, 40, -0.5), ice, priority=1)
    aim_camera()
    through = (1 - fresnel(0, 1, 1.33)) ** 2 * (1 - fresnel(0, 1.33, 1.31)) ** 2
    assert_mean(render(256), through * beer_lambert(1.0))


@pytest.mark.parametrize("roughness", [0.0, 0.05])
def test_an_object_in_the_drink_is_seen_through_what_lies_before_it(roughness):
    new_scene(16)
    set_world((0, 0, 0))
    water = tinted(
        "Water",
        1.33,
        internal_reflections=False,
        roughness=roughness,
        distribution="GGX",
    )
    add_box("Water", (-10, -10, -20), (10, 10, 0), water)
    add_plane("Spoon", 30, (0, 0, -THICKNESS), (0, 0, 1), emission())
    aim_camera()
    # Alpha is 0.0025 for the rough surface: the spread of its path lengths changes the result by less than 1e-5.
    assert_mean(render(256), (1 - fresnel(0, 1, 1.33)) * beer_lambert(THICKNESS))


def test_an_object_in_the_drink_is_lit_through_what_lies_above_it():
    new_scene(16)
    set_world((0, 0, 0))
    water = tinted(
        "Water",
        1.33,
        internal_reflections=False,
        shadow_mode="TRANSMISSION",
    )
    add_box("Water", (-10, -10, -20), (10, 10, 0), water)
    add_plane("Spoon", 30, (0, 0, -THICKNESS), (0, 0, 1), diffuse())
    add_sun((0, 0, -1), irradiance=math.pi)  # a white Lambertian plane then has radiance 1
    bpy.context.scene.cycles.diffuse_bounces = 0  # what the water's surface sends back to the plane is another matter
    aim_camera()
    assert_mean(render(64), (1 - fresnel(0, 1, 1.33)) * beer_lambert(2 * THICKNESS))


def test_a_camera_in_the_drink_sees_what_the_way_leaves():
    """Straight at an object in the same medium, and out through the surface."""
    new_scene(16)
    set_half_world(2, -1)
    water = tinted("Water", 1.33, internal_reflections=False)
    add_box("Water", (-10, -10, -1.1), (10, 10, 10), water)
    x, y, _ = AIM
    add_camera((x, y, 0), (x, y, -1), width=0.01)
    assert_mean(render(256), (1 - fresnel(0, 1.33, 1)) * beer_lambert(1.1))
    add_plane("Card", 4, (0, 0, -THICKNESS), (0, 0, 1), emission())
    assert_mean(render(16), beer_lambert(THICKNESS))


def test_light_from_one_object_in_the_drink_to_another_is_absorbed_on_its_way():
    """A white floor under a glowing ceiling that is large, so every ray from the floor meets it; seen from just above
    the floor.
    """
    new_scene(16)
    set_world((0, 0, 0))
    height = 0.5
    water = tinted("Water", 1.33)
    add_box("Water", (-300, -300, -1), (300, 300, 2), water)
    add_plane("Floor", 400, (0, 0, 0), (0, 0, 1), diffuse())
    glow = emission()
    glow.cycles.emission_sampling = "NONE"
    add_plane("Ceiling", 400, (0, 0, height), (0, 0, -1), glow)
    bpy.context.scene.cycles.diffuse_bounces = 1
    x, y, _ = AIM
    add_camera((x, y, 0.001), (x, y, 0), width=0.0005)
    # Mean over the cosine lobe of T^(height / cos): the exponential integral 2 E3(sigma height).
    cosines = (np.arange(200000) + 0.5) / 200000
    sigma = -np.log(TINT) / DEPTH
    expected = [np.mean(2 * cosines * np.exp(-value * height / cosines)) for value in sigma]
    assert_mean(render(1024), np.array(expected) * beer_lambert(0.001))


SHADOW_ANGLE = 30.0


def shadow_factor(mode: str) -> np.ndarray:
    """What a straight ray keeps that goes up from the floor through a slab."""
    if mode == "BLACK":
        return np.zeros(3)
    factor = beer_lambert(THICKNESS / math.cos(math.radians(SHADOW_ANGLE)))
    if mode in ("OUTSIDE_FRESNEL", "ALL_FRESNEL"):
        factor = factor * (1 - fresnel(SHADOW_ANGLE, 1, 1.5))
    if mode == "ALL_FRESNEL":
        factor = factor * (1 - fresnel(SHADOW_ANGLE, 1.5, 1))
    return factor


def add_lit_floor() -> None:
    """A white floor under the sun, seen from between it and the slab."""
    set_world((0, 0, 0))
    add_plane("Floor", 20, (0, 0, 0), (0, 0, 1), diffuse())
    angle = math.radians(SHADOW_ANGLE)
    add_sun((math.sin(angle), 0, -math.cos(angle)), irradiance=math.pi / math.cos(angle))
    aim_camera(distance=0.9)
    # Light that the slab's underside sends back to the floor is not the shadow's.
    bpy.context.scene.cycles.max_bounces = 0


@pytest.mark.parametrize("mode", ["BLACK", "TRANSMISSION", "OUTSIDE_FRESNEL", "ALL_FRESNEL"])
def test_shadows_of_each_mode_have_the_closed_form(mode):
    new_scene(8)
    add_lit_floor()
    glass = tinted("Glass", 1.5, shadow_mode=mode)
    add_box("Slab", (-30, -30, 1), (30, 30, 1 + THICKNESS), glass)
    assert_mean(render(16), shadow_factor(mode))


def test_a_shadow_through_nested_media_takes_each_colour_over_its_own_way():
    new_scene(8)
    add_lit_floor()
    water = tinted("Water", 1.5, shadow_mode="TRANSMISSION")
    ice = nd.new_material("Ice", ior=1.31, shadow_mode="TRANSMISSION")
    add_box("Water", (-30, -30, 1), (30, 30, 2), water, priority=2)
    add_box("Ice", (-20, -20, 1.3), (20, 20, 1.6), ice, priority=1)
    assert_mean(render(16), beer_lambert(0.7 / math.cos(math.radians(SHADOW_ANGLE))))


@pytest.mark.parametrize(
    "socket, at_entrance, at_exit",
    [("Emission at Entrances", 1, 0), ("Emission at Exits", 0, 1), ("Emission at Interfaces", 1, 1)],
)
def test_each_emission_port_adds_its_shader_only_where_it_says(socket, at_entrance, at_exit):
    new_scene(8)
    set_world((0, 0, 0))
    glass = nd.new_material("Glass", ior=1.5, internal_reflections=False)
    add_emission_port(glass, socket, 2.0)
    add_box("Slab", (-30, -30, -1), (30, 30, 0), glass)
    aim_camera()
    assert_mean(render(256), 2.0 * (at_entrance + at_exit * (1 - fresnel(0, 1, 1.5))))


def test_emission_stays_away_from_surfaces_that_do_not_exist():
    """Water that reaches into glass: its hidden face is neither interface, entrance nor exit; its inner faces are
    interfaces only.
    """
    new_scene(8)
    set_world((0, 0, 0))
    water = nd.new_material("Water", ior=1.33, internal_reflections=False)
    for socket in ("Emission at Entrances", "Emission at Exits"):
        add_emission_port(water, socket, 1.0)
    glass = nd.new_material("Glass", ior=1.5, internal_reflections=False)
    add_box("Glass", (-30, -30, -3), (30, 30, 0), glass, priority=1)
    add_box("Water", (-20, -20, -2), (20, 20, -1), water, priority=2)
    aim_camera()
    assert render(16).max() == 0.0


def test_equal_indices_let_light_straight_through():
    new_scene(16)
    set_world()
    add_plane("Card", 1, (0.5, 0.5, -3), (0, 0, 1), native("Card", "ShaderNodeEmission", Color=(0.1, 0.5, 0.9, 1.0)))
    aim_camera(width=2.0)
    bare = render(4)
    air = nd.new_material("Air", ior=1.0)
    add_box("Air", (-0.9, -0.9, -2), (0.9, 0.9, 0), air, priority=1)
    assert np.abs(render(4) - bare).max() < ROUNDING


def test_refraction_and_specular_scales_scale_their_lobe():
    new_scene(16)
    set_world()
    glass = nd.new_material("Glass", ior=1.5, refraction_scale=0.0, specular_scale=0.5)
    add_box("Slab", (-30, -30, -1), (30, 30, 0), glass)
    aim_camera()
    assert_mean(render(64), 0.5 * fresnel(0, 1, 1.5))
