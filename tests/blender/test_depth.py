"""Colour at depth: a preset's colour is that of the body it is given to, however large the scene's units make it."""

import bpy  # before bmesh and mathutils, which live inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from mathutils import Matrix
from scenes import add, add_box, add_mesh, add_sphere, new_scene

import nested_dielectric as nd
from nested_dielectric.geometry import meshes
from nested_dielectric.model import presets
from nested_dielectric.model.parameter import ParameterError
from nested_dielectric.model.presets import Preset
from nested_dielectric.scene import materials, preset_materials, shapes
from nested_dielectric.scene.new_materials import KEY_PROPERTY
from nested_dielectric.scene.preset_values import measured_depth

WINE = Preset(
    "wine", "Wine", "Drinks", ("red",), "Red.", "Invented.",
    {"ior": 1.34, "transmittance": [0.6, 0.1, 0.15], "transmittance_depth": 0.05, "priority": 20},
)  # fmt: skip


@pytest.fixture(autouse=True)
def wine(monkeypatch):
    """An empty scene in metres, and a preset with a colour that no file changes."""
    new_scene()
    known = preset_materials.load_preset

    def load(key):
        return WINE if key == "wine" else known(key)

    for module in ("new_materials", "preset_materials"):
        monkeypatch.setattr(f"nested_dielectric.scene.{module}.load_preset", load)


def depth(material) -> float:
    return material.node_tree.nodes["Nested Dielectric"].inputs["Transmittance Depth"].default_value


def cylinder(name: str, radius: float, height: float):
    return add_mesh(
        name,
        lambda bm: bmesh.ops.create_cone(
            bm, cap_ends=True, cap_tris=True, segments=256, radius1=radius, radius2=radius, depth=height
        ),
    )


@pytest.mark.parametrize("place", [Matrix(), Matrix.Translation((5, 0, 0)) @ Matrix.Diagonal((1, 1, -1, 1))])
def test_the_ways_through_bodies_are_as_long_as_closed_forms_say(place):
    """Two thirds of a ball's diameter (a sphere of 96 segments is 0.2 % smaller), the edge of a cube by two thirds, twice a
    thin slab's thickness (its sides take 0.2 %), a long cylinder's diameter (its ends take 0.5 %).
    """
    shapes_and_chords = [
        (add_sphere("Ball", 0.5, segments=96), 2 / 3, 3e-3),
        (add_box("Cube", (0, 0, 0), (3, 3, 3)), 2.0, 1e-6),
        (add_box("Slab", (0, 0, 0), (10, 10, 0.01)), 0.02, 3e-3),
        (cylinder("Rod", 0.1, 20.0), 0.2, 6e-3),
    ]
    for obj, chord, tolerance in shapes_and_chords:
        obj.matrix_world = place
        assert shapes.thickness(obj) == pytest.approx(chord, rel=tolerance), obj.name


def test_a_body_counts_as_its_modifiers_and_its_place_make_it():
    ball = add_sphere("Ball", 0.5, segments=64)
    ball.scale = (0.1, 0.1, 0.1)
    assert shapes.thickness(ball) == pytest.approx(0.2 / 3, rel=5e-3)
    hollow = add_box("Hollow", (-1, -1, -1), (1, 1, 1))
    inner = add_box("Inner", (-0.9, -0.9, -0.9), (0.9, 0.9, 0.9))
    cut = hollow.modifiers.new("Cut", "BOOLEAN")
    cut.object = inner
    volume, area = 8 - 1.8**3, 6 * (4 + 1.8**2)
    assert shapes.thickness(hollow) == pytest.approx(4 * volume / area, rel=1e-5)


def test_what_is_open_is_as_thick_as_the_smallest_side_of_its_box_and_a_plane_has_no_thickness():
    box = add_box("Box", (0, 0, 0), (3, 2, 1))
    box.scale = (1.0, 0.1, 1.0)
    shape = bmesh.new()
    shape.from_mesh(box.data)
    shape.faces.ensure_lookup_table()
    bmesh.ops.delete(shape, geom=[shape.faces[0]], context="FACES_ONLY")
    shape.to_mesh(box.data)
    assert shapes.thickness(box) == pytest.approx(0.2)
    plane = add_mesh("Plane", lambda bm: bmesh.ops.create_grid(bm, x_segments=1, y_segments=1, size=1.0))
    assert shapes.thickness(plane) == 0.0
    assert shapes.thickness(add("Nothing", bpy.data.meshes.new("Nothing"))) == 0.0
    assert depth(nd.assign(plane, "wine")) == pytest.approx(0.05)


def test_a_text_is_as_thick_as_its_mesh():
    text = bpy.data.curves.new("Text", "FONT")
    text.body, text.extrude = "I", 0.5
    letter = add("Text", text)
    box = np.array(letter.evaluated_get(bpy.context.evaluated_depsgraph_get()).bound_box)
    wide, high = (box.max(axis=0) - box.min(axis=0))[:2]
    volume, area = wide * high, 2 * (wide * high + wide + high)
    assert shapes.thickness(letter) == pytest.approx(4 * volume / area, rel=1e-3)


def test_no_triangles_have_no_thickness():
    assert meshes.mean_chord(np.zeros((0, 3)), np.zeros((0, 3), dtype=int)) == 0.0
    assert meshes.mean_chord(np.zeros((3, 3)), np.array([[0, 1, 2]])) == 0.0


@pytest.mark.parametrize("size", [0.07, 7.0])
def test_red_wine_is_as_red_in_a_ball_of_seven_centimetres_as_in_one_of_seven_units(size):
    ball = add_sphere("Ball", size / 2, segments=64)
    material = nd.assign(ball, "wine")
    assert depth(material) == pytest.approx(2 / 3 * size, rel=5e-3)
    assert tuple(material.node_tree.nodes["Nested Dielectric"].inputs["Transmittance"].default_value)[
        :3
    ] == pytest.approx((0.6, 0.1, 0.15))


def test_without_an_object_the_depth_is_the_presets_own_metres_in_units_of_the_scene():
    assert depth(nd.new_material("Wine", preset="wine")) == pytest.approx(0.05)
    bpy.context.scene.unit_settings.scale_length = 0.01
    assert depth(nd.new_material("Wine", preset="wine")) == pytest.approx(5.0)
    assert measured_depth(WINE) == pytest.approx(5.0)
    assert depth(nd.new_material("Wine", preset="wine", transmittance_depth=3.0)) == pytest.approx(3.0)
    assert depth(nd.new_material("Water", preset="water")) == 1.0


def test_objects_share_a_material_while_its_depth_is_near_theirs():
    small, double, large = (add_sphere(name, radius) for name, radius in (("S", 0.05), ("D", 0.099), ("L", 1.0)))
    first = nd.assign(small, "wine")
    assert nd.assign(double, "wine") == first
    second = nd.assign(large, "wine")
    assert second != first
    assert nd.assign(small, "wine") == first
    assert depth(first) == pytest.approx(0.1 * 2 / 3, rel=1e-2)


def test_the_thickest_of_several_objects_shows_the_presets_colour():
    small, large = add_sphere("S", 0.05), add_sphere("L", 1.0)
    material = preset_materials.preset_material("wine", [small, large])
    assert depth(material) == pytest.approx(4 / 3, rel=1e-2)


def test_what_nobody_uses_any_more_takes_the_depth_of_the_next():
    large = add_box("Large", (0, 0, 0), (2, 2, 2))
    first = nd.assign(large, "wine")
    bpy.data.objects.remove(large)
    small = add_sphere("Small", 0.035)
    assert nd.assign(small, "wine") == first
    assert depth(first) == pytest.approx(0.07 * 2 / 3, rel=1e-2)
    first.use_fake_user = True
    bpy.data.objects.remove(small)
    assert nd.assign(add_sphere("Large", 1.0), "wine") != first


def test_an_object_that_has_been_scaled_keeps_its_material_and_shares_it_with_nobody_unasked():
    ball = add_sphere("Ball", 1.0)
    material = nd.assign(ball, "wine")
    ball.scale = (0.05, 0.05, 0.05)
    assert nd.assign(ball, "wine") == material
    assert depth(material) == pytest.approx(0.1 * 2 / 3, rel=1e-2)
    twin = add("Twin", ball.data)
    twin.scale = (1.0, 1.0, 1.0)
    ball.scale = (1.0, 1.0, 1.0)
    assert nd.assign(ball, "wine") != material  # which its twin shows, too, until then
    own = add_sphere("Own", 0.1)
    own.data.materials.append(None)
    own.material_slots[0].link = "OBJECT"
    third = nd.assign(own, "wine")
    own.scale = (90.0, 90.0, 90.0)
    assert nd.assign(own, "wine") == third


def test_clear_media_keep_their_depth_and_are_used_again_at_any():
    water = nd.assign(add_sphere("A", 0.01), "water")
    water.node_tree.nodes["Nested Dielectric"].inputs["Transmittance Depth"].default_value = 7.0
    assert nd.assign(add_sphere("B", 100.0), "water") == water
    assert depth(water) == 7.0


@pytest.mark.parametrize("change", ["link", "key"])
def test_a_depth_that_something_else_sets_is_left_to_it(change):
    material = nd.new_material("Wine", preset="wine")
    tree = material.node_tree
    socket = tree.nodes["Nested Dielectric"].inputs["Transmittance Depth"]
    if change == "key":
        socket.keyframe_insert("default_value")
    else:
        value = tree.nodes.new("ShaderNodeMath")
        tree.links.new(value.outputs[0], socket)
    with pytest.raises(ParameterError, match=r"'Wine'.*Transmittance Depth"):
        preset_materials.fit_depth(material, 2.0)


def test_a_material_knows_its_preset_and_one_of_an_older_version_does_not():
    material = nd.new_material("Any Name", preset="water")
    assert preset_materials.preset_of(material).key == "water"
    for wrong in ("no_preset_of_that_name", 3):
        material[KEY_PROPERTY] = wrong
        assert preset_materials.preset_of(material) is None
    del material[KEY_PROPERTY]
    assert preset_materials.preset_of(material) is None
    assert preset_materials.preset_of(None) is None


def test_a_preset_has_its_colour_in_every_working_space():
    """Blender's own conversion of colours, which an artist's colours take when the working space of a file is changed."""
    new_scene()
    wine = nd.new_material("Wine", preset="wine_rose")
    bpy.ops.wm.set_working_color_space(convert_colors=True, working_space="ACEScg")
    there = nd.new_material("There", preset="wine_rose")
    colours = [materials.dielectric_node(each).inputs["Transmittance"].default_value[:3] for each in (wine, there)]
    # Blender adapts the white as Bradford does, to a few digits.
    assert colours[1] == pytest.approx(colours[0], abs=2e-3)
    assert colours[1] != pytest.approx(presets.load_preset("wine_rose").parameters["transmittance"], abs=0.02)
    assert preset_materials.is_preset(there, presets.load_preset("wine_rose"))
    kept = preset_materials.preset_from(there, "Mine", "Drinks", (), "")
    expected = presets.load_preset("wine_rose").parameters["transmittance"]
    assert kept.parameters["transmittance"] == pytest.approx(expected, abs=1e-5)
    bpy.ops.wm.set_working_color_space(convert_colors=False, working_space="Linear Rec.709")
