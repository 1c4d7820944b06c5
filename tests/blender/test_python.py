"""The Python interface: keywords, values, priorities and preparation."""

from pathlib import Path

import bpy
import numpy as np
import pytest
from scenes import add, add_box, add_sphere, native, new_scene

import nested_dielectric as nd
from nested_dielectric.model import parameters, presets, shader_source
from nested_dielectric.model.parameter import BASIC_KEYWORDS, BASICS
from nested_dielectric.model.spectral_tables import spectral_table
from nested_dielectric.scene import media
from nested_dielectric.scene.material_spectra import material_table

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(autouse=True)
def empty_scene():
    new_scene()


def socket(material: bpy.types.Material, name: str):
    return material.node_tree.nodes["Nested Dielectric"].inputs[name].default_value


def test_keywords_are_socket_names_in_snake_case():
    assert parameters.BY_KEYWORD["ior"].name == "IOR"
    assert parameters.BY_KEYWORD["thin_film_thickness"].name == "Thin Film Thickness"
    assert all(keyword.isidentifier() for keyword in parameters.BY_KEYWORD)


def test_a_preset_is_set_first_and_keywords_override_it():
    material = nd.new_material("Water", preset="water", roughness=0.25)
    assert socket(material, "IOR") == pytest.approx(1.3334, abs=1e-5)
    assert socket(material, "Roughness") == 0.25
    assert socket(nd.new_material("Heavy", preset="water", ior=1.4), "IOR") == pytest.approx(1.4)


@pytest.mark.parametrize("keyword", ["shadow_mode", "distribution", "dispersion_model"])
def test_enumerations_are_upper_case_words(keyword):
    parameter = parameters.BY_KEYWORD[keyword]
    for place, choice in enumerate(parameter.choices):
        material = nd.new_material("M", **{keyword: choice.keyword})
        assert socket(material, parameter.name) == (place if parameter.kind == "INDEX" else choice.name)
    with pytest.raises(nd.ParameterError, match="one of"):
        nd.new_material("M", **{keyword: "black"})


@pytest.mark.parametrize(
    "keywords, words",
    [
        ({"iorr": 1.3}, "unknown parameter 'iorr'; known are"),
        ({"ior": -1.0}, "outside 0.01 to 100"),
        ({"ior": float("nan")}, "finite"),
        ({"ior": "high"}, "a number"),
        ({"roughness": 2}, "outside 0 to 1"),
        ({"priority": 1.5}, "whole number"),
        ({"transmittance": 0.5}, "three numbers"),
        ({"internal_reflections": "yes"}, "True or False"),
        ({"emission_at_exits": 1}, "link a shader node"),
        ({"preset": "wter"}, "unknown preset 'wter'; known are"),
    ],
)
def test_a_wrong_keyword_or_value_is_named_and_nothing_is_made(keywords, words):
    with pytest.raises(nd.ParameterError, match=words):
        nd.new_material("M", **keywords)
    assert not bpy.data.materials


def test_a_preset_name_serves_as_a_material_and_is_shared():
    first, second = add_sphere("A", 1.0), add_sphere("B", 1.0)
    assert nd.assign(first, "water", priority=3) == nd.assign(second, "water")
    assert first.active_material == second.active_material
    assert nd.get_priority(first) == 3
    assert nd.get_priority(second) == presets.load_preset("water").parameters["priority"]


def test_what_cannot_be_a_medium_is_named():
    with pytest.raises(nd.ParameterError, match="'Lamp' is light"):
        nd.assign(add("Lamp", bpy.data.lights.new("Lamp", "POINT")), "water")
    with pytest.raises(nd.ParameterError, match="'Nothing' is empty"):
        nd.assign(add("Nothing", None), "water")
    with pytest.raises(nd.ParameterError, match="has no node"):
        nd.assign(add_sphere("Ball", 1.0), bpy.data.materials.new("Plain"))
    with pytest.raises(nd.ParameterError, match="assign"):
        nd.get_priority(add_sphere("Bare", 1.0))


def test_an_object_overrides_the_priority_of_its_material_until_told_otherwise():
    ball = add_sphere("Ball", 1.0, nd.new_material("Water", priority=7))
    assert nd.get_priority(ball) == 7
    nd.set_priority(ball, 0)
    assert nd.get_priority(ball) == 0
    copy = ball.copy()
    assert nd.get_priority(copy) == 0
    nd.set_priority(ball, None)
    assert nd.get_priority(ball) == 7
    with pytest.raises(nd.ParameterError, match="outside"):
        nd.set_priority(ball, -1)


def test_priorities_are_plain_custom_properties_that_files_keep(tmp_path):
    nd.set_priority(add_sphere("Ball", 1.0, nd.new_material("Water")), 42)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "file.blend"))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "file.blend"))
    assert bpy.data.objects["Ball"]["nd_priority"] == 42


def names() -> list[tuple[str, int]]:
    return [(obj.name, nd.get_priority(obj)) for obj in media.media(bpy.context.scene)]


def test_media_are_listed_in_winning_order_with_those_of_instanced_collections():
    material = nd.new_material("M")
    for name, priority in (("C", 3), ("A", 1), ("B", 2)):
        add_box(name, (0, 0, 0), (1, 1, 1), material, priority)
    hidden = bpy.data.collections.new("Hidden")
    bpy.context.scene.collection.objects.unlink(bpy.data.objects["B"])
    hidden.objects.link(bpy.data.objects["B"])
    instance = add("Instance", None)
    instance.instance_type, instance.instance_collection = "COLLECTION", hidden
    assert names() == [("A", 1), ("B", 2), ("C", 3)]


def test_preparing_says_what_it_changed_and_a_second_time_changes_nothing():
    scene = bpy.context.scene
    add_sphere("Ball", 1.0, nd.new_material("Glass"))
    scene.cycles.shading_system = False
    scene.cycles.max_bounces = 12
    scene.cycles.transparent_max_bounces = 1000
    preparation = nd.prepare(scene, backend="OSL")
    assert "Open Shading Language: off -> on" in str(preparation)
    assert scene.cycles.max_bounces == 64
    assert scene.cycles.transparent_max_bounces == 1000
    assert nd.prepare(scene).changes == ()


def dispersing_object():
    material = nd.new_material("Glass", preset="bk7", disperse=True)
    add_sphere("Ball", 1.0, material)
    return material


def test_preparing_gives_paths_a_time_only_where_something_disperses():
    scene = bpy.context.scene
    add_sphere("Plain", 1.0, nd.new_material("Plain", preset="bk7"))
    nd.prepare(scene)
    assert not scene.render.use_motion_blur
    dispersing_object()
    changes = str(nd.prepare(scene))
    assert "Motion Blur: off -> on" in changes and "Shutter: 0.5 -> 0" in changes
    assert scene.render.use_motion_blur and scene.render.motion_blur_shutter == 0.0
    assert nd.prepare(scene).changes == ()


def test_preparing_leaves_motion_blur_that_is_in_use_alone():
    scene = bpy.context.scene
    dispersing_object()
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = 0.7
    scene.cycles.rolling_shutter_type = "TOP"
    nd.prepare(scene)
    assert scene.render.motion_blur_shutter == pytest.approx(0.7)
    assert scene.cycles.rolling_shutter_type == "TOP"


def test_preparing_makes_every_time_as_likely():
    scene = bpy.context.scene
    dispersing_object()
    scene.cycles.rolling_shutter_type = "TOP"
    scene.render.motion_blur_shutter_curve.curves[0].points[0].location[1] = 0.2
    scene.render.motion_blur_shutter_curve.update()
    assert "Shutter Curve: flat" in nd.prepare(scene).changes
    assert scene.cycles.rolling_shutter_type == "NONE"
    assert nd.prepare(scene).changes == ()


def test_what_else_uses_portals_or_vectors_is_named():
    scene = bpy.context.scene
    dispersing_object()
    add_box("Gate", (2, 2, 2), (3, 3, 3), native("Gate", "ShaderNodeBsdfRayPortal"))
    scene.view_layers[0].use_pass_vector = True
    problems = "\n".join(map(str, nd.prepare(scene).problems))
    assert "'Gate' has a Ray Portal" in problems and "has a Vector pass" in problems


def test_sellmeier_coefficients_bring_their_own_index():
    diamond = presets.load_preset("diamond").parameters
    curve = {key: diamond[key] for key in ("dispersion_model", "sellmeier_b", "sellmeier_c")}
    assert socket(nd.new_material("Diamond", **curve), "IOR") == pytest.approx(2.41748, abs=1e-5)
    assert socket(nd.new_material("Cut", ior=2.4, **curve), "IOR") == pytest.approx(2.4)
    with pytest.raises(nd.ParameterError, match=r"no index of refraction at 587\.56 nm"):
        nd.new_material("Odd", sellmeier_b=(-9.0, 0.0, 0.0), sellmeier_c=(0.0, 0.0, 0.0))


def test_materials_of_equal_spectra_share_a_table():
    materials = [
        nd.new_material("A"),
        nd.new_material("B", spectral_distribution="SUNSET"),
        nd.new_material("C", spectral_distribution="sunset", spectral_gamut="REC709"),
        nd.new_material("D", clamp_negative=False),
    ]
    assert [socket(material, "Spectral Table") for material in materials] == [0, 1, 1, 2]
    (image,) = bpy.data.images
    assert tuple(image.size) == (4096, 3) and image.packed_file is not None


def test_a_spectrum_that_cannot_be_read_is_named_and_nothing_is_made():
    for keywords, words in (
        ({"spectral_distribution": "nowhere.csv"}, "nowhere.csv"),
        ({"spectral_gamut": "CMYK"}, "one of SCENE"),
        ({"spectral_saturation": 2.0}, "outside 0 to 1"),
    ):
        with pytest.raises(nd.ParameterError, match=words):
            nd.new_material("M", **keywords)
    assert not bpy.data.materials and not bpy.data.node_groups and not bpy.data.images


def test_preparing_bakes_tables_for_the_files_own_working_space_again():
    scene = bpy.context.scene
    material = dispersing_object()
    table = material_table(material)
    bpy.ops.wm.set_working_color_space(working_space="Linear Rec.2020")
    assert "Spectral Table of Glass: baked again" in nd.prepare(scene).changes
    assert not np.array_equal(material_table(material), table)
    assert np.array_equal(material_table(material), spectral_table(gamut="REC2020"))


def test_presets_work_together_without_setting_priorities():
    """A bubble wins over glass, glass over ice, ice over water."""
    order = [presets.load_preset(key).parameters["priority"] for key in ("air_bubble", "glass", "ice", "water")]
    assert order == sorted(set(order))


def test_a_broken_preset_file_is_named(tmp_path):
    (tmp_path / "bad.toml").write_text(
        'name = "Bad"\ngroup = "Glass"\ntags = []\ndescription = ""\nsource = ""\n[parameters]\niorr = 1.0\n'
    )
    with pytest.raises(nd.ParameterError, match=r"bad\.toml.*iorr"):
        presets.load_preset("bad", tmp_path)


def test_every_socket_has_its_limits_and_a_description():
    group = nd.new_material("M").node_tree.nodes["Nested Dielectric"].node_tree
    sockets = {
        item.name: item for item in group.interface.items_tree if item.item_type == "SOCKET" and item.in_out == "INPUT"
    }
    set_by_the_extension = {"Spectral Table", "Spectral Table Means"} | {
        name for name, socket in sockets.items() if socket.parent.name == "Scene Analysis"
    }
    first = [parameters.BY_KEYWORD[keyword].name for keyword in BASIC_KEYWORDS]
    assert [name for name in sockets if name not in set_by_the_extension] == first + [
        parameter.name for parameter in parameters.SOCKETS if parameter.name not in first
    ]
    for parameter in parameters.SOCKETS:
        item = sockets[parameter.name]
        assert item.description == parameter.description
        assert item.parent.name == ("" if parameter.panel == BASICS else parameter.panel)
        if parameter.kind in ("INT", "FLOAT"):
            assert (item.min_value, item.max_value) == pytest.approx((parameter.minimum, parameter.maximum))


def test_the_shader_takes_exactly_the_tables_parameters():
    source = shader_source.inlined_source("nested_dielectric.osl")
    body = source[source.index("shader nested_dielectric(") :]
    inputs = [line.split("=")[0].split()[-1] for line in body[: body.index("output")].splitlines()[1:] if "=" in line]
    assert inputs == [parameter.osl_name for parameter in parameters.SOCKETS] + [
        "Exterior",
        "ExteriorSolePriority",
        "OverlapsItself",
        "MayHoldObjects",
        "ExteriorMedium",
        "ExteriorTransmittance",
        "AnalysedScene",
        "AnalysisHolds",
        "ByVolume",
        "Cut",
        "GivesBack",
        "AttributeRequests",
        "FrontIOR",
        "CountsPortals",
        "Disperses",
        "Emitter",
        "Lights",
        "LightKind",
        "LightCentre",
        "LightAxis",
        "LightEdgeX",
        "LightEdgeY",
        "LightShape",
        "LightStrength",
        "LightTotal",
        "LightCarried",
        "Spectral",
        "Table",
        "TableMeans",
        "Weight",
        "Wavelength",
        "View",
    ]
