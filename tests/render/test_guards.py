"""What cannot render shows magenta or as a surface of its own, and never as a wrong picture."""

import bpy  # before bmesh, which lives inside it

from nested_dielectric.model.shader_source import inlined_source

import bmesh  # isort: skip
import numpy as np
import pytest
from furnace import ball_in_furnace
from scenes import add_box, add_camera, add_emission_port, add_mesh, add_sphere, emission, new_scene, render, set_world

import nested_dielectric as nd
from nested_dielectric.nodes import closures, group


def test_a_material_that_finds_nothing_of_a_newer_osl_refuses(monkeypatch):
    """A Blender of the future may have lost what tells its way with indices: no picture may be guessed."""
    signs = dict.fromkeys(("nothing", "nothing.more"), ("Scene", "nothing"))
    monkeypatch.setattr(closures, "FRONT_IOR_SIGNS", signs)
    source = inlined_source
    monkeypatch.setattr(group, "inlined_source", lambda name: source(name).replace(">= 11600", ">= 11000"))
    ball_in_furnace()
    red, green, blue = render(16).mean(axis=(0, 1))
    assert green < 0.01 and red > 0.5 and blue > 0.5


def test_cycles_without_osl_shows_magenta_not_a_wrong_picture():
    ball_in_furnace()
    bpy.context.scene.cycles.shading_system = False
    red, green, blue = render(16).mean(axis=(0, 1))
    assert green < 0.01 and red > 0.5 and blue > 0.5


def test_where_the_shader_cannot_trace_rays_it_shows_magenta(monkeypatch):
    """On a GPU trace() meets nothing and leaves no record; a message that no device knows stands for one here."""
    source = inlined_source
    monkeypatch.setattr(group, "inlined_source", lambda name: source(name).replace('"hit", hit', '"no such", hit'))
    ball_in_furnace()
    red, green, blue = render(16).mean(axis=(0, 1))
    assert green < 0.01 and red > 0.5 and blue > 0.5


def test_an_open_mesh_renders_without_nan_or_gain():
    new_scene(24)
    set_world()
    add_camera((3, -4, 3), (0, 0, 0), angle=30)
    tint = {"transmittance": (0.9, 0.5, 0.3), "transmittance_depth": 0.8}
    add_mesh(
        "Sheet",
        lambda bm: bmesh.ops.create_grid(bm, x_segments=4, y_segments=4, size=1.0),
        nd.new_material("Sheet", ior=1.33, **tint),
        2,
    )
    add_box("Ice", (-0.5, -0.5, -0.5), (0.5, 0.5, 0.5), nd.new_material("Ice", ior=1.31, **tint), 1)
    picture = render(16)
    assert np.isfinite(picture).all() and picture.max() <= 1.0 + 1e-5


@pytest.mark.parametrize(
    "socket, value",
    [("IOR", float("nan")), ("Roughness", float("nan")), ("Transmittance Depth", float("inf")), ("IOR", 1e30)],
)
def test_numbers_no_slider_would_give_render_finite(socket, value):
    ball = ball_in_furnace()
    add_sphere("Inner", 0.5, nd.new_material("Water", preset="water"), 1)
    ball.active_material.node_tree.nodes["Nested Dielectric"].inputs[socket].default_value = value
    assert np.isfinite(render(16)).all()


def test_a_label_on_a_bottle_leaves_the_bottle_closed():
    """Some faces carry a foreign material; what lies inside still knows that it is inside."""
    new_scene(16)
    set_world((0, 0, 0))
    glass = nd.new_material("Glass", preset="glass")
    bottle = add_box("Bottle", (-1, -1, -1), (1, 1, 1), glass, 1)
    bottle.data.materials.append(emission(1.0))
    top = max(bottle.data.polygons, key=lambda face: face.center.z)
    top.material_index = 1
    inner = nd.new_material("Water", preset="water")
    add_emission_port(inner, "Emission at Interfaces")
    add_box("Water", (-0.5, -0.5, -0.5), (0.5, 0.5, 0.5), inner, 2)
    add_camera((0.2, -4, 0.1), (0.2, 0, 0.1), width=0.1)
    hidden = render(16)
    bpy.data.objects.remove(bottle)
    assert render(16).mean() > 0.5  # without the bottle the water glows
    assert hidden.mean() < 0.2  # inside the glass, which wins, it does not exist
