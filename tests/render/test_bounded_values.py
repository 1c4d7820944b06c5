"""Values that are linked count in a render as what physics allows."""

from functools import cache

import bpy
import numpy as np
import pytest
from odd_values import BOUNDED, INF, NAN, PRIORITIES
from scenes import (
    add_box,
    add_camera,
    add_plane,
    add_point_light,
    add_sphere,
    emission,
    mostly_again,
    new_scene,
    render,
    set_striped_world,
    set_world,
)

import nested_dielectric as nd
from nested_dielectric.model.parameters import BY_NAME
from nested_dielectric.scene.lights import update_lights

ON = dict.fromkeys(("disperse", "separate_reflection", "separate_direct_lobe", "polarize", "direct_world"), True)


def node(material: bpy.types.Material) -> bpy.types.ShaderNodeGroup:
    return material.node_tree.nodes["Nested Dielectric"]


def set_socket(material, name, value) -> None:
    """As a script does, which no limit of the panel stops."""
    socket = node(material).inputs[name]
    if hasattr(socket.default_value, "__len__"):
        size = len(socket.default_value)
        value = value if hasattr(value, "__len__") else (value,) * 3
        socket.default_value = (*value, 1.0)[:size]
    else:
        socket.default_value = value


def link(obj, name, *values) -> None:
    """Link a socket to one number or three that Cycles learns while it renders: products with the object's index."""
    obj.pass_index = 2
    tree = obj.active_material.node_tree
    index = tree.nodes.new("ShaderNodeObjectInfo").outputs["Object Index"]
    parts = tree.nodes.new("ShaderNodeCombineXYZ")
    for value, part in zip(values, parts.inputs):
        product = tree.nodes.new("ShaderNodeMath")
        product.operation = "MULTIPLY"
        product.inputs[1].default_value = 0.5 * value
        tree.links.new(index, product.inputs[0])
        tree.links.new(product.outputs[0], part)
    number = product.outputs[0] if len(values) == 1 else parts.outputs[0]
    tree.links.new(number, node(obj.active_material).inputs[name])


def ball(build=lambda obj: None):
    """A ball whose every control matters, with a light that a lobe carries."""
    scene = new_scene(12)
    set_striped_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=24)
    add_point_light((0.5, 4.0, 1.0), 200.0, 0.5)
    bpy.data.objects["Lamp"].visible_transmission = bpy.data.objects["Lamp"].visible_glossy = False
    obj = add_sphere("Ball", 1.0, nd.new_material("Glass", **ON), segments=24)
    build(obj)
    update_lights(scene)
    return render(8)


def numbers(value):
    """All, but of those beyond limits no anisotropies: up to Blender 5.2 their lobes are drawn by random numbers that hang
    on the last bit of a place.
    """
    return [parameter for parameter in BOUNDED if not np.isfinite(value) or "Anisotropy" not in parameter.name]


def all_set(value):
    """What the picture is with every number at what the value counts as."""

    def build(obj):
        for parameter in numbers(value):
            triple = parameter.kind in ("COLOR", "VECTOR")
            set_socket(obj.active_material, parameter.name, parameter.bounded((value,) * 3 if triple else value))

    return build


def all_linked(value):
    def build(obj):
        for parameter in numbers(value):
            link(obj, parameter.name, *(value,) * (3 if parameter.kind in ("COLOR", "VECTOR") else 1))
        for name in ("Normal", "Tangent"):
            if not np.isfinite(value):
                link(obj, name, value, value, value)

    return build


@cache
def expected(value):
    return ball(all_set(value))


def is_same(picture, other) -> bool:
    """The same paths but for rounding, which sends a few another way at rough and dispersing surfaces."""
    close = np.isclose(picture, other, rtol=1e-3, atol=1e-5)
    return np.isfinite(other).all() and other.std() > 1e-3 and close.mean() > 0.95


@pytest.mark.parametrize("value", mostly_again((NAN, 1e5, INF, -1e5), first=2))
def test_whatever_is_linked_counts_as_what_physics_allows(value):
    assert is_same(ball(all_linked(value)), expected(value if np.isfinite(value) else NAN))


def test_what_is_no_number_in_a_socket_counts_as_the_default():
    def build(obj):
        for parameter in BOUNDED:
            if parameter.kind not in ("INT", "INDEX"):
                set_socket(obj.active_material, parameter.name, NAN)

    assert is_same(ball(build), expected(NAN))


@pytest.mark.parametrize("name", ("Refraction Scale", "Specular Scale"))
@pytest.mark.parametrize("value", mostly_again((2.0, -3.0), first=1))
def test_a_linked_scale_never_makes_light_nor_takes_more_than_there_is(name, value):
    new_scene(16)
    set_world()
    add_camera((0, -4, 0.03), (0.02, 0, 0), angle=30)
    obj = add_sphere("Ball", 0.9, nd.new_material("Glass", ior=1.5), segments=32)
    link(obj, name, value)
    picture = render(16)
    assert picture.max() <= 1.0 + 1e-4 and picture.min() >= 0.0
    if value > 1.0:
        assert picture.mean() == pytest.approx(1.0, abs=1e-3)  # a path or two may end at an edge


ABSORPTION = (
    (True, (0.5, 0.25, 1.0), 2.0, (0.5, 0.25, 1.0)),
    (True, (2.0, 2.0, 2.0), 2.0, 1.0),
    (True, (NAN, 0.5, 0.5), 2.0, 1.0),
    (False, (0.5, 0.25, 4.0), NAN, (0.25, 0.0625, 1.0)),
    (True, (0.5, 0.25, 1.0), INF, (0.25, 0.0625, 1.0)),
    (True, (0.5, 0.25, 1.0), -3.0, 1.0),
    (False, (NAN, NAN, 0.5), 2.0, 1.0),
)
"""Whether they are linked, transmittance, its depth, and what is left after twice the default depth."""


@pytest.mark.parametrize("case", mostly_again(ABSORPTION, first=4), ids=str)
def test_light_inside_a_medium_is_absorbed_by_bounded_values(case):
    """From a camera in the medium to an emitter in it, 2 away: Beer-Lambert's law, charged by the native volume."""
    linked, transmittance, depth, left = case
    new_scene(4)
    set_world((0, 0, 0))
    sea = add_box("Sea", (-9, -9, -9), (9, 9, 9), nd.new_material("Sea", ior=1.33))
    add_plane("Lamp", 4.0, (0.03, 1.0, 0.07), (0, -1, 0), emission(1.0))
    add_camera((0.03, -1.0, 0.07), (0.03, 0, 0.07), width=0.1)
    if linked:
        link(sea, "Transmittance", *transmittance)
        link(sea, "Transmittance Depth", depth)
    else:
        set_socket(sea.active_material, "Transmittance", transmittance)
        set_socket(sea.active_material, "Transmittance Depth", depth)
    assert render(1).mean(axis=(0, 1)) == pytest.approx(np.broadcast_to(left, 3), abs=1e-4)


ODD = {
    "Priority": 5000,
    "IOR": NAN,
    "Transmittance": (0.4, 3.0, -2.0),
    "Transmittance Depth": -INF,
    "Disperse": True,
    "Dispersion Model": 0,
    "Abbe": 1e30,
    "Sellmeier B": (NAN, 0.0, 0.0),
}
ODDER = {"Priority": -3, "IOR": 1e30, "Transmittance": (NAN, 0.2, 0.2), "Dispersion Model": -4, "Abbe": NAN}


@pytest.mark.parametrize("odd", (ODD, ODDER), ids=("odd", "odder"))
def test_neighbours_read_of_a_socket_what_its_own_surface_does(odd):
    def picture(values, prepared):
        scene = new_scene(12)
        scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 0.0
        set_striped_world()
        add_camera((0, -5, 0.3), (0, 0, 0), angle=26)
        sea = nd.new_material("Sea", ior=1.2)
        for name, value in values.items():
            set_socket(sea, name, value)
        add_sphere("Ball", 0.8, nd.new_material("Glass", ior=1.6, priority=7), segments=24)
        add_box("Sea", (-1, -1, -1), (1, 1, 0.1), sea)
        if prepared:
            text = "\n".join(map(str, nd.prepare(scene).problems))
            assert all(f"for {name!r} in material 'Sea'" in text for name in ("IOR", "Priority", "Abbe"))
            scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 0.0
        return render(4)

    bounded = {name: BY_NAME[name].bounded(value) for name, value in odd.items()}
    usual = picture(bounded, False)
    assert is_same(picture(odd, False), usual)
    assert is_same(picture(odd, True), usual)


def test_an_odd_priority_counts_in_a_render_as_in_python():
    """Balls of one material in one sea, each with another thing stored."""

    def picture(store):
        new_scene(8)
        bpy.context.scene.render.resolution_x = 8 * len(PRIORITIES)
        set_striped_world()
        add_camera((0, -5, 0), (0, 0, 0), width=2.0 * len(PRIORITIES))
        glass = nd.new_material("Glass", ior=1.6, priority=4)
        for index, (value, number) in enumerate(PRIORITIES):
            obj = add_sphere("Ball", 0.8, glass, None, (2.0 * index - len(PRIORITIES) + 1.0, 0, 0), segments=24)
            store(obj, value, 4 if number is None else number)
        add_box("Sea", (-99, -0.6, -1), (99, 0.6, 0.7), nd.new_material("Sea", ior=1.2, priority=2))
        return render(4)

    usual = picture(lambda obj, _, number: nd.set_priority(obj, number))
    assert np.array_equal(picture(lambda obj, value, _: obj.__setitem__("nd_priority", value)), usual)
    assert not np.allclose(picture(lambda obj, *_: None), usual, atol=0.01)
