"""The body of Cycles' own nodes: the same light as the shader's, and as closed forms and interfaces split by hand have it."""

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from scenes import (
    add_box,
    add_camera,
    add_emission_port,
    add_plane,
    add_sphere,
    add_sun,
    batches,
    cycles_glass,
    diffuse,
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
from nested_dielectric.scene.materials import dielectric_node

# Both bodies take the same decisions with the same random numbers; what is left is rounding, and now and then a path that it
# sends another way: at 64 samples such a one moves a pixel by a 64th of what lies there.
ONE_PATH = 0.03
MEAN = 1e-4

RED = (0.3, 0.6, 0.9)


def set_native(on: bool, osl: bool = True) -> None:
    bpy.context.scene.cycles.shading_system = osl
    for material in bpy.data.materials:
        node = dielectric_node(material)
        if node is not None:
            node.inputs["Native"].default_value = on


def by_both(samples: int = 64) -> tuple[np.ndarray, np.ndarray]:
    """Pictures of the scene by the shader, and by native nodes without OSL."""
    found = []
    for on in (False, True):
        set_native(on, osl=not on)
        found.append(render(samples))
    return tuple(found)


def assert_equal(shader: np.ndarray, nodes: np.ndarray, most: float = ONE_PATH) -> None:
    assert shader.std() > 0.01
    assert np.abs(nodes.mean(axis=(0, 1)) / shader.mean(axis=(0, 1)) - 1.0).max() < MEAN
    assert np.abs(nodes - shader).max() < most


def ball(**keywords) -> bpy.types.Material:
    """A ball that is lit by a sky and a sun, before and above diffuse things."""
    new_scene(24)
    set_world((0.4, 0.6, 0.9))
    add_camera((0, -5, 1.4), (0, 0, -0.2), angle=40)
    material = nd.new_material("Ball", **({"ior": 1.5} | keywords))
    add_sphere("Ball", 1.0, material, segments=32)
    add_sphere("Behind", 0.5, diffuse(0.6), location=(0.3, 1.8, 0.2), segments=16)
    add_plane("Floor", 12.0, (0, 0, -1.1), (0, 0, 1), diffuse(0.8))
    add_sun((0.3, 0.4, -1.0), 2.0)
    return material


def pool(water_tint=(1.0, 1.0, 1.0), ice_tint=(1.0, 1.0, 1.0), **keywords) -> None:
    """Water in a dish with ice in it, all boxes, cut where they cross."""
    scene = new_scene(24)
    set_world((0.4, 0.6, 0.9))
    add_camera((0.1, -5, 2.0), (0, 0, 0), angle=40)
    glass = nd.new_material("Glass", ior=1.5, priority=1)
    water = nd.new_material(
        "Water", ior=1.33, priority=2, transmittance=water_tint, transmittance_depth=0.6, **keywords
    )
    ice = nd.new_material("Ice", ior=1.2, priority=0, transmittance=ice_tint, transmittance_depth=0.4, **keywords)
    add_box("Dish", (-1, -1, -0.6), (1, 1, -0.2), glass)
    add_box("Water", (-0.8, -0.8, -0.3), (0.8, 0.8, 0.5), water)
    add_box("Ice", (-0.3, -0.4, 0.2), (0.3, 0.3, 0.8), ice)
    add_plane("Floor", 8.0, (0, 0, -0.7), (0, 0, 1), diffuse(0.8))
    add_sun((0.3, 0.2, -1.0), 3.0)
    nd.prepare(scene, cut=True)
    scene.render.use_motion_blur = False  # Cycles' own dispersion then, in both bodies
    nd.analyse(scene)


SAME = [
    {},
    {"ior": 0.8},
    {"roughness": 0.4},
    {"roughness": 0.4, "distribution": "BECKMANN"},
    {"roughness": 0.4, "distribution": "GGX"},
    {"transmittance": RED, "transmittance_depth": 1.0},
    {"thin_film_thickness": 400.0, "thin_film_ior": 1.8},
    {"internal_reflections": False},
    {"max_interior_reflections": 1},
    {"refract_sky": False},
    {"reflect_sky": False},
    {"specular_scale": 0.4},
    {"refraction_scale": 0.4},
    {"separate_reflection": True},
    {"polarize": True, "polarization_angle": 0.4},
    {"caustic_refraction": False},
    {"caustic_reflection": False},
    {"caustic_total_reflection": False},
    {"caustic_internal_reflections": False},
    {"caustic_max_distance": 1.0},
    {"dispersion_model": "JF", "dispersion": 0.2},
    *({"shadow_mode": mode} for mode in ("BLACK", "TRANSMISSION", "ALL_FRESNEL")),
]


@pytest.mark.parametrize("keywords", mostly_again(SAME, 3), ids=str)
def test_both_bodies_show_the_same_picture(keywords):
    ball(**keywords)
    nd.analyse(bpy.context.scene)
    # Where reflection and refraction are apart the lobes are other closures, which draw their random numbers otherwise.
    apart = keywords.keys() & {"specular_scale", "refraction_scale", "separate_reflection", "polarize", "reflect_sky"}
    shader, nodes = by_both(256 if apart else 64)
    if apart:
        assert np.abs(nodes.mean(axis=(0, 1)) / shader.mean(axis=(0, 1)) - 1.0).max() < 2e-3
        tiles = [picture.reshape(3, 8, 3, 8, 3).mean(axis=(1, 3)) for picture in (shader, nodes)]
        assert np.abs(tiles[0] - tiles[1]).max() < 0.02
    else:
        assert_equal(shader, nodes)


@pytest.mark.skipif(bpy.app.version < (5, 3, 0), reason="Glass is not anisotropic before Blender 5.3")
@pytest.mark.parametrize(
    "keywords", [{}, {"anisotropy": -0.6}, {"blur_anisotropic_poles": 0.5}, {"tangent_from": "REFRACTION"}], ids=str
)
def test_both_bodies_are_as_anisotropic(keywords):
    ball(**({"roughness": 0.4, "anisotropy": 0.6} | keywords))
    nd.analyse(bpy.context.scene)
    assert_equal(*by_both())


@pytest.mark.parametrize(
    "tints", mostly_again([(RED, (0.9, 0.5, 0.3)), ((1, 1, 1), (1, 1, 1)), (RED, (1, 1, 1))]), ids=str
)
@pytest.mark.parametrize("mode", mostly_again(["OUTSIDE_FRESNEL", "TRANSMISSION", "ALL_FRESNEL"]))
def test_both_bodies_of_media_that_are_cut_take_the_same_from_light_and_shadows(tints, mode):
    pool(*tints, shadow_mode=mode)
    if tints == ((1, 1, 1), (1, 1, 1)):
        assert_equal(*by_both())
        return
    # Native media that absorb keep their surfaces inside winners, which draw random numbers of their own.
    found = []
    for on in (False, True):
        set_native(on, osl=not on)
        found.append(batches(1024, 16))
    assert_same_picture(*found, size=8)


def test_both_bodies_are_bumped_alike():
    material = ball()
    tree = material.node_tree
    noise, bump = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexNoise", "Bump"))
    tree.links.new(noise.outputs[0], bump.inputs["Height"])
    tree.links.new(bump.outputs[0], dielectric_node(material).inputs["Normal"])
    nd.analyse(bpy.context.scene)
    assert_equal(*by_both())


@pytest.mark.parametrize(
    "place", mostly_again(["Emission at Interfaces", "Emission at Entrances", "Emission at Exits"])
)
def test_both_bodies_shine_where_they_are_asked_to(place):
    material = ball()
    add_emission_port(material, place, 0.3)
    material.cycles.emission_sampling = (
        "NONE"  # or Cycles takes one of them for a light that shines straight through the ball
    )
    nd.analyse(bpy.context.scene)
    assert_equal(*by_both())


FACTS = ("Surface Exists", "Is Entrance", "Is Exit", "Priority Inside", "Priority Outside", "Arriving Light")


@pytest.mark.parametrize("fact", mostly_again(FACTS))
def test_both_bodies_know_the_same_of_a_surface(fact):
    pool(RED)
    for name in ("Glass", "Water", "Ice"):
        bpy.data.materials[name].cycles.emission_sampling = "NONE"
        tree = bpy.data.materials[name].node_tree
        node = dielectric_node(bpy.data.materials[name])
        shine, add = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("Emission", "AddShader"))
        tree.links.new(node.outputs[fact], shine.inputs["Color"])
        output = next(
            each for each in tree.nodes if each.type == "OUTPUT_MATERIAL" and each.target in ("ALL", "CYCLES")
        )
        tree.links.new(output.inputs["Surface"].links[0].from_socket, add.inputs[0])
        tree.links.new(shine.outputs[0], add.inputs[1])
        tree.links.new(add.outputs[0], output.inputs["Surface"])
    nd.prepare(bpy.context.scene, cut=True)
    assert_equal(*by_both())


@pytest.mark.skipif(bpy.app.version < (5, 3, 0), reason="Cycles has no dispersion of its own before Blender 5.3")
@pytest.mark.parametrize(
    "keywords",
    [
        {"abbe": 20.0},
        {"abbe": 20.0, "roughness": 0.3},
        {"dispersion_model": "JF", "dispersion": 0.1},
        {"dispersion_model": "SELLMEIER"},
    ],
    ids=str,
)
def test_both_bodies_split_light_alike_by_cycles_own_dispersion(keywords):
    ball(ior=2.0, disperse=True, **keywords)
    set_striped_world()
    nd.analyse(bpy.context.scene)
    assert_equal(*by_both())


@pytest.mark.skipif(bpy.app.version < (5, 3, 0), reason="Cycles has no dispersion of its own before Blender 5.3")
@pytest.mark.parametrize(
    "keywords",
    [{"abbe": 15.0}, {"dispersion_model": "JF", "dispersion": 0.2}, {"dispersion_model": "SELLMEIER"}],
    ids=str,
)
def test_both_bodies_of_dispersing_media_that_are_cut_show_the_same_picture(keywords):
    pool(disperse=True, **keywords)
    found = []
    for on in (False, True):
        set_native(on, osl=not on)
        found.append(batches(1024, 16))
    assert_same_picture(*found, size=8)


@pytest.mark.parametrize("name", ["Internal Reflections", "Roughness", "Refraction Scale"])
def test_a_value_that_is_linked_counts_in_the_native_body(name):
    """What is left out is decided by unlinked sockets alone: a texture may be anything."""
    material = ball()
    tree = material.node_tree
    checker = tree.nodes.new("ShaderNodeTexChecker")
    tree.links.new(checker.outputs["Fac"], dielectric_node(material).inputs[name])
    nd.analyse(bpy.context.scene)
    shader, nodes = by_both(256)
    assert np.abs(nodes.mean(axis=(0, 1)) / shader.mean(axis=(0, 1)) - 1.0).max() < 2e-3
    assert np.abs(nodes - shader).mean() < 5e-3


def test_a_slab_absorbs_as_beer_says():
    """A colour of (0.8, 0.5, 0.2) after 0.5, seen through 0.7 behind Fresnel's two surfaces whose inner reflections are off."""
    new_scene(16)
    set_half_world(2, -1)
    material = nd.new_material(
        "Slab", ior=1.5, transmittance=(0.8, 0.5, 0.2), transmittance_depth=0.5, internal_reflections=False
    )
    add_box("Slab", (-4, -4, 0), (4, 4, 0.7), material)
    add_camera((0.37, 0.11, 3.0), (0.37, 0.11, 0.0), width=0.01)
    nd.analyse(bpy.context.scene)
    set_native(True, osl=False)
    assert_mean(render(64), 0.96**2 * np.power((0.8, 0.5, 0.2), 0.7 / 0.5))


def test_a_white_world_stays_white_through_media_that_are_cut():
    """What is reflected and what is let through add up to 1 at every interface, so 4 media in a white world cannot be seen."""
    pool()
    bpy.data.objects.remove(bpy.data.objects["Floor"])
    set_world()
    for light in list(bpy.data.lights):
        bpy.data.lights.remove(light)
    set_native(True, osl=False)
    assert np.abs(render(64) - 1.0).max() < 1e-4


def test_media_that_are_cut_look_as_interfaces_split_by_hand():
    """Two boxes that overlap, against Cycles' own Glass on their pieces: air to glass, air to water, and water to glass."""
    scene = new_scene(32)
    add_camera((0.2, -5, 1.5), (0, 0, 0), angle=40)
    set_striped_world()
    add_box("Glass", (-1, -1, -1), (1, 1, 0.1), nd.new_material("Glass", ior=1.5, priority=0))
    add_box("Water", (-0.7, -0.7, 0), (0.7, 0.7, 0.8), nd.new_material("Water", ior=1.33, priority=1))
    nd.prepare(scene, cut=True)
    set_native(True, osl=False)
    ours = batches(1024, 16)

    new_scene(32)
    add_camera((0.2, -5, 1.5), (0, 0, 0), angle=40)
    set_striped_world()
    scene = bpy.context.scene
    scene.cycles.shading_system = False
    glass, water, between = (cycles_glass(ior) for ior in (1.5, 1.33, 1.5 / 1.33))
    _open_box("Glass", (-1, -1, -1), (1, 1, 0.1), glass, hole=0.7, between=between)
    _open_box("Water", (-0.7, -0.7, 0.1), (0.7, 0.7, 0.8), water, open_below=True)
    assert_same_picture(ours, batches(1024, 16), size=8)


def _open_box(name, low, high, material, hole=None, between=None, open_below=False) -> None:
    """A box without its bottom, or with another material in the middle of its top."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    vertices = [(x, y, z) for z in (z0, z1) for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]
    sides = [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    faces = sides + ([] if open_below else [(3, 2, 1, 0)])
    if hole is None:
        faces.append((4, 5, 6, 7))
    else:
        vertices += [(x, y, z1) for x, y in ((-hole, -hole), (hole, -hole), (hole, hole), (-hole, hole))]
        faces += [(4 + i, 4 + (i + 1) % 4, 8 + (i + 1) % 4, 8 + i) for i in range(4)] + [(8, 9, 10, 11)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.materials.append(material)
    if between is not None:
        mesh.materials.append(between)
        mesh.polygons[-1].material_index = 1
    bpy.context.collection.objects.link(bpy.data.objects.new(name, mesh))


def test_without_osl_the_native_body_shows_whatever_was_chosen():
    ball()
    nd.analyse(bpy.context.scene)
    set_native(True, osl=False)
    chosen = render(16)
    set_native(False, osl=False)
    assert np.array_equal(render(16), chosen)


def test_a_surface_that_nobody_can_tell_anything_shows_the_alarm_without_osl():
    """And only then: of two balls that overlap one is open, so nothing can be cut; closed, both are by themselves."""
    scene = new_scene(16)
    set_world()
    add_camera((0, -5, 0), (0, 0, 0), angle=20)
    for name, place in (("A", -0.4), ("B", 0.4)):
        add_sphere(name, 1.0, nd.new_material(name, ior=1.5, priority=0 if name == "A" else 1), location=(place, 0, 0))
    scene.cycles.shading_system = False
    whole = bpy.data.objects["A"].data.copy()
    mesh = bmesh.new()
    mesh.from_mesh(bpy.data.objects["A"].data)
    bmesh.ops.delete(mesh, geom=list(mesh.faces)[:1], context="FACES")
    mesh.to_mesh(bpy.data.objects["A"].data)
    nd.analyse(scene)
    red, green, blue = render(16).reshape(-1, 3).mean(axis=0)
    assert green < 0.3 * red and blue == pytest.approx(red, rel=0.2)
    bpy.data.objects["A"].data = whole
    nd.analyse(scene)
    assert np.abs(render(16) - 1.0).max() < 0.01


def test_a_native_medium_told_of_the_one_around_it_bends_light_by_both_indices():
    """A ball of water's index in water cannot be seen."""
    scene = new_scene(16)
    set_striped_world()
    add_camera((0.1, -5, 0.2), (0, 0, 0), angle=10)
    water = nd.new_material("Water", ior=1.33, priority=1)
    add_box("Water", (-2, -2, -2), (2, 2, 2), water)
    nd.analyse(scene)
    set_native(True, osl=False)
    alone = render(64)
    add_sphere("Same", 0.3, nd.new_material("Same", ior=1.33, priority=0))
    nd.analyse(scene)
    set_native(True, osl=False)
    assert np.abs(render(64).mean(axis=(0, 1)) - alone.mean(axis=(0, 1))).max() < 2e-3
    dielectric_node(bpy.data.materials["Same"]).inputs["IOR"].default_value = 1.0
    nd.analyse(scene)
    assert_equal(*by_both())


def test_shadow_rays_are_charged_for_the_way_between_two_surfaces():
    """A tinted slab between a floor and a sun: the floor's light is what Beer leaves over the slanted way through it."""
    new_scene(16)
    set_world((0, 0, 0))
    material = nd.new_material(
        "Slab", ior=1.5, transmittance=(0.8, 0.5, 0.2), transmittance_depth=0.5, shadow_mode="TRANSMISSION"
    )
    add_box("Slab", (-4, -4, 0), (4, 4, 0.7), material)
    add_plane("Floor", 1.0, (0, 0, -1.0), (0, 0, 1), native("White", "ShaderNodeBsdfDiffuse", Color=(1, 1, 1, 1)))
    add_sun((1.0, 0.0, -2.0), np.pi)
    add_camera((0.1, -0.1, -0.2), (0.1, -0.1, -1.0), width=0.1)
    nd.analyse(bpy.context.scene)
    for name in ("max_bounces", "diffuse_bounces"):
        setattr(bpy.context.scene.cycles, name, 0)
    set_native(True, osl=False)
    slant = np.sqrt(5.0) / 2.0
    assert_mean(render(16), np.power((0.8, 0.5, 0.2), 0.7 * slant / 0.5) / slant)
