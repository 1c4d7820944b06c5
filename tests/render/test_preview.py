"""EEVEE's look knows what lies on both sides of a surface. Cycles shows it here, whose pixels have closed forms."""

import bpy
import numpy as np
import pytest
from scenes import (
    add_box,
    add_camera,
    add_plane,
    add_sphere,
    fresnel,
    mostly_again,
    new_scene,
    render,
    set_half_world,
    set_world,
)

import nested_dielectric as nd
from nested_dielectric.nodes.preview_nodes import LEAST_CONTRAST, WATER
from nested_dielectric.scene.materials import dielectric_node

HIDDEN = 1e6
SAMPLES = 64


@pytest.fixture(autouse=True)
def scene():
    return new_scene(16)


def previewed(name: str = "Medium", **values) -> bpy.types.Material:
    """A material that shows Cycles what others show EEVEE."""
    return show_preview(nd.new_material(name, **values))


def show_preview(material: bpy.types.Material) -> bpy.types.Material:
    links, node, output = (
        material.node_tree.links,
        dielectric_node(material),
        material.node_tree.get_output_node("CYCLES"),
    )
    links.new(node.outputs["Preview"], output.inputs["Surface"])
    links.remove(output.inputs["Volume"].links[0])
    return material


def tell(obj: bpy.types.Object, index: float, tint=None, depth: float = 0.0) -> None:
    """Let all faces of an object tell what lies outside."""
    faces = len(obj.data.polygons)
    obj.data.attributes.new("nd_cut", "FLOAT", "FACE").data.foreach_set("value", [index] * faces)
    if tint is not None:
        obj.data.attributes.new("nd_cut_tint", "FLOAT_COLOR", "FACE").data.foreach_set("color", [*tint, 1.0] * faces)
        obj.data.attributes.new("nd_cut_depth", "FLOAT", "FACE").data.foreach_set("value", [depth] * faces)


def show() -> np.ndarray:
    return render(SAMPLES).mean(axis=(0, 1))


def near(expected) -> pytest.approx:
    """Each ray takes one of two ways: within five standard errors."""
    expected = np.asarray(expected)
    rays = 16 * 16 * SAMPLES
    return pytest.approx(expected, abs=float(np.max(5.0 * np.sqrt(expected * (1.0 - expected) / rays)) + 1e-5))


def reflected(ior: float, outside: float | None, degrees: float = 0.0, back: bool = False) -> float:
    """What a surface reflects of light that comes to it from where it is seen."""
    angle = np.radians(degrees)
    eye = np.array((0.0, np.sin(angle), np.cos(angle)))
    plane = add_plane("Plane", 1.0, (0.0, 0.0, 0.0), (0.0, 0.0, -1.0 if back else 1.0), previewed(ior=ior))
    if outside is not None:
        tell(plane, outside)
    set_half_world(2, 1.0)
    add_camera(tuple(5.0 * eye), (0.0, 0.0, 0.0), width=0.2)
    return show()[1]


@pytest.mark.parametrize("back", mostly_again([False, True]))
@pytest.mark.parametrize(
    ("ior", "outside", "contrast"),
    [
        (1.5, None, 1.5),
        (1.0, None, WATER),
        (1.5, 1.0, 1.5),
        (2.4, 1.333, 2.4 / 1.333),
        (1.0, 1.333, 1.333),
        (1.31, 1.333, LEAST_CONTRAST),
    ],
)
def test_reflectance_is_that_of_both_indices_but_never_too_little_to_be_seen(ior, outside, contrast, back):
    assert reflected(ior, outside, back=back) == near(fresnel(0.0, 1.0, contrast))


@pytest.mark.parametrize("told", mostly_again([1.333, None]))
def test_a_bubble_in_water_is_silvery_towards_its_edges_told_or_not(told):
    assert reflected(1.0, told, 60.0) == near(1.0)


def test_air_in_air_is_hardly_seen():
    assert reflected(1.0, 1.0) == near(fresnel(0.0, 1.0, LEAST_CONTRAST))


def test_what_leaves_for_thinner_media_is_not_totally_reflected_so_that_things_behind_stay_in_sight():
    assert reflected(1.5, 1.0, 60.0, back=True) == near(fresnel(60.0, 1.0, 1.5))


def test_a_surface_inside_a_winner_does_not_show():
    plane = add_plane("Plane", 1.0, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), previewed(ior=1.5, transmittance=(0.5, 0.2, 0.1)))
    tell(plane, HIDDEN)
    set_world()
    add_camera((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), width=0.2)
    assert show() == pytest.approx(1.0, abs=1e-6)


def seen_through(*objects: bpy.types.Object) -> np.ndarray:
    """What is left of light from behind that comes straight through the faces of objects."""
    set_half_world(2, -1.0)
    add_camera((0.05, 0.03, 9.0), (0.05, 0.03, 0.0), width=0.02)
    return show() / (1.0 - fresnel(0.0, 1.0, LEAST_CONTRAST)) ** (2 * len(objects))


LEFT = np.array((0.9, 0.5, 0.2))
JUICE = {"ior": 1.0, "transmittance": LEFT, "transmittance_depth": 1.0}


@pytest.mark.parametrize("low", [-0.5, 3.0])
def test_a_colour_is_that_of_the_whole_way_wherever_the_object_has_its_origin(low):
    box = add_box("Box", (-0.5, -0.5, low), (0.5, 0.5, low + 1.5), previewed(**JUICE))
    tell(box, 1.0)
    # Two faces show each other, of which each reflects 0.2 %.
    assert seen_through(box) == pytest.approx(LEFT**1.5, rel=0.03)


def test_what_a_clear_body_displaces_of_a_colour_is_given_back():
    juice = add_box("Juice", (-0.5, -0.5, -1.0), (0.5, 0.5, 1.0), previewed("Juice", **JUICE))
    tell(juice, 1.0)
    ice = add_box("Ice", (-0.3, -0.3, -0.7), (0.3, 0.3, 0.3), previewed("Ice", ior=1.0))
    tell(ice, -1.0, LEFT, 1.0)
    assert seen_through(juice, ice) == pytest.approx(LEFT, rel=0.03)


def test_what_the_analysis_tells_shows_without_faces_that_are_cut():
    """Four surfaces of the same reflectance, of which light is reflected to and fro."""
    for priority, (radius, ior) in enumerate([(0.5, 1.0), (1.0, 1.333)]):
        add_sphere("Body", radius, nd.new_material("Body", ior=ior), priority)
    nd.prepare(bpy.context.scene)
    for obj in bpy.data.objects:
        show_preview(obj.active_material)
    set_half_world(2, 1.0)
    add_camera((0.003, 0.002, 9.0), (0.003, 0.002, 0.0), width=0.002)
    once = fresnel(0.0, 1.0, 1.333)
    assert show()[1] == near(4.0 * once / (1.0 + 3.0 * once))
