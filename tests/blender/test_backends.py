"""Which body of each material renders a scene, what decides it, and what artists are told of that."""

import bpy
import numpy as np
import pytest
from backends import HERE, ball, crossing, sockets
from scenes import add_box, add_point_light, add_sphere, mostly_again, new_scene, updated_by

import nested_dielectric as nd
from nested_dielectric.cutting import (
    backends,
    copied_settings,
    cut_collection,
    cut_plan,
    cut_scene,
)
from nested_dielectric.model.contract import BY_VOLUME_SOCKET, CUT
from nested_dielectric.model.effects import limits_at_work
from nested_dielectric.model.parameters import PARAMETERS
from nested_dielectric.nodes.names import MASK_OUTPUT
from nested_dielectric.nodes.render_with import set_backend
from nested_dielectric.preparation import idle, live, windows
from nested_dielectric.preparation.prepare_scene import put_back
from nested_dielectric.scene.materials import dielectric_node


@pytest.fixture(autouse=True)
def scene():
    """An empty scene on the CPU with Open Shading Language."""
    return new_scene()


def face_values(scene):
    """What the faces of surfaces that renders show say, by object."""
    found = {}
    for obj in scene.objects:
        if obj.name.endswith(copied_settings.SUFFIX):
            obj.hide_viewport = False
            bpy.context.view_layer.update()
            mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
            values = np.zeros(len(mesh.polygons), dtype=np.float32)
            mesh.attributes[CUT].data.foreach_get("value", values)
            found[obj.name.removesuffix(copied_settings.SUFFIX)] = values
            obj.hide_viewport = True
    return found


def test_media_that_are_told_what_lies_outside_are_rendered_by_own_nodes_and_those_that_ask_by_the_shader(scene):
    ball("Lone", 20.0)
    crossing()
    chosen = nd.prepare(scene).chosen
    assert sockets() == {"Lone": True, "Glass": False, "Water": False}
    assert chosen.native == ("Lone",) and dict(chosen.osl).keys() == {"Glass", "Water"}
    assert "must ask what lies outside" in str(chosen)
    nd.prepare(scene, cut=True)
    assert all(sockets().values())
    chosen = nd.prepare(scene, backend="OSL").chosen
    assert not any(sockets().values()) and len(chosen.osl) == 3


def test_media_that_may_meet_are_of_one_kind(scene):
    """What a ray of the shader's finds out of a medium is exported by materials of the shader's alone."""
    inner = ball("Inner", reflect_sky=False, roughness=0.3)
    inner.scale = (0.3, 0.3, 0.3)
    ball("Outer", priority=5)
    ball("Far", 20.0)
    chosen = nd.prepare(scene).chosen
    assert sockets() == {"Inner": False, "Outer": False, "Far": True}
    reasons = dict(chosen.osl)
    assert "Reflect Sky" in reasons["Inner"] and "'Inner'" in reasons["Outer"]


def test_a_material_is_rendered_by_own_nodes_only_where_all_its_objects_are(scene):
    crossing()
    ball("Other", 20.0).active_material = bpy.data.materials["Glass"]
    add_sphere("Inner", 0.3, nd.new_material("Inner", ior=1.2), 0, location=(20, 0, 0), segments=16)
    ball("Far", 40.0)
    nd.prepare(scene)
    assert sockets() == {"Glass": False, "Water": False, "Inner": False, "Other": False, "Far": True}


def test_where_one_medium_splits_light_the_shader_renders_all(scene):
    ball("Prism", disperse=True)
    ball("Far", 20.0)
    reasons = dict(nd.prepare(scene).chosen.osl)
    assert not any(sockets().values()) and "'Prism' splits light" in reasons["Far"]
    assert scene.render.use_motion_blur


def test_what_is_chosen_already_is_not_written_again(scene):
    ball("Lone", 20.0)
    crossing()
    nd.prepare(scene)
    assert updated_by(lambda: backends.choose(scene)) == []


def test_media_that_ask_again_are_left_to_the_shader(scene):
    ball()
    nd.prepare(scene)
    assert sockets() == {"Ball": True}
    nd.clear_analysis(scene)
    assert sockets() == {"Ball": False}
    nd.prepare(scene)
    put_back(scene)
    assert sockets() == {"Ball": False}


def test_in_a_window_media_are_left_to_the_shader_while_they_are_moved(scene, monkeypatch):
    """They ask then, and a rendered view would show the alarm."""
    monkeypatch.setattr(windows, "has_window", lambda: True)
    monkeypatch.setattr(idle, "schedule_update", lambda: None)
    body = ball()
    nd.prepare(scene)
    bpy.context.view_layer.update()
    assert sockets() == {"Ball": True}
    body.location.x = 1.0
    bpy.context.view_layer.update()
    assert sockets() == {"Ball": False}
    idle.update_idle_scenes()
    bpy.context.view_layer.update()
    assert sockets() == {"Ball": True}


def test_the_defaults_of_all_parameters_need_no_shader():
    values = {parameter.keyword: parameter.default for parameter in PARAMETERS}
    for lights in (False, True):
        at_work = limits_at_work(values | {"lights_by_lobe": lights, "tinted_media": True}, HERE)
        assert [parameter.name for parameter in at_work.values()] == ["Direct Refraction"] * lights


NEEDS = {
    "Separate Reflection": {"separate_reflection": True, "roughness": 0.2},
    "Specular Scale": {"specular_scale": 0.5, "roughness": 0.2},
    "Refract Sky": {"refract_sky": False, "thin_film_thickness": 400.0},
    "Polarize": {"polarize": True, "roughness": 0.2},
    "Caustic Max Distance": {"caustic_max_distance": 3.0, "roughness": 0.2},
    "Direct World": {"direct_world": True},
    "Energy Cutoff Exponent": {"energy_cutoff_exponent": -3.0},
    "Disperse": {"disperse": True},
}
"""Parameters that need the shader, and values with which they do."""


@pytest.mark.parametrize("name", mostly_again(NEEDS))
def test_a_parameter_that_only_the_shader_renders_is_named(scene, name):
    ball(**NEEDS[name])
    (reason,) = dict(nd.prepare(scene).chosen.osl).values()
    assert f"has {name}:" in reason


@pytest.mark.parametrize(
    "keywords", mostly_again([{"separate_reflection": True}, {"specular_scale": 0.5}, {"polarize": True}])
)
def test_what_own_nodes_render_on_smooth_surfaces_needs_no_shader_there(scene, keywords):
    ball(**keywords)
    nd.prepare(scene)
    assert sockets() == {"Ball": True}


def test_anisotropy_needs_the_shader_before_blender_5_3(scene):
    ball(anisotropy=0.5, roughness=0.2)
    nd.prepare(scene)
    assert sockets() == {"Ball": HERE >= (5, 3, 0)}


def test_a_value_that_is_linked_or_keyframed_may_be_any(scene):
    node = dielectric_node(ball(roughness=0.2).active_material)
    nd.prepare(scene)
    assert sockets() == {"Ball": True}
    node.inputs["Polarize"].keyframe_insert("default_value", frame=1)
    nd.prepare(scene)
    assert sockets() == {"Ball": False}


def test_a_light_that_lobes_carry_needs_the_shader(scene):
    ball()
    add_point_light((0, 0, 5), 100.0)
    next(obj for obj in scene.objects if obj.type == "LIGHT").visible_transmission = False
    assert "has Direct Refraction:" in str(nd.prepare(scene).chosen)


def test_a_mask_for_the_artists_own_volume_needs_the_shader(scene):
    material = ball().active_material
    tree = material.node_tree
    volume = tree.nodes.new("ShaderNodeVolumeScatter")
    tree.links.new(dielectric_node(material).outputs[MASK_OUTPUT], volume.inputs["Density"])
    assert "Volume Mask" in str(nd.prepare(scene).chosen)


def test_things_in_tinted_media_need_the_shader_unless_the_volume_absorbs_for_all_rays(scene):
    tint = {"transmittance": (0.5, 0.7, 0.9)}
    ball(**tint)
    add_box("Spoon", (-0.1, -0.1, -0.1), (0.1, 0.1, 0.1), bpy.data.materials.new("Steel"))
    nd.prepare(scene)
    assert sockets() == {"Ball": True}  # nothing wins over it, so it is left to its volume
    ball("Clear", 1.5, priority=0).scale = (0.5, 0.5, 0.5)
    dielectric_node(bpy.data.materials["Ball"]).inputs["Priority"].default_value = 5
    nd.prepare(scene, cut=True)
    by_volume = dielectric_node(bpy.data.materials["Ball"]).inputs[BY_VOLUME_SOCKET].default_value > 0
    assert sockets()["Ball"] == by_volume


def test_a_scene_of_own_nodes_is_cut_whatever_its_setting_says_and_not_any_more_when_it_is_none(scene):
    scene.cycles.device = "GPU"
    crossing()
    nd.prepare(scene, cut=False)
    assert cut_scene.is_cut(scene) and not cut_scene.is_set_to_cut(scene) and scene.objects["Water"].hide_render
    scene.cycles.device = "CPU"
    live.update_cut(scene)
    assert not cut_collection.is_shown(scene) and not scene.objects["Water"].hide_render


def test_a_lone_medium_that_stays_is_told_by_the_analysis_and_not_cut(scene):
    ball()
    assert nd.prepare(scene, backend="NATIVE").cut == cut_plan.CutReport()
    assert [obj.name for obj in scene.objects] == ["Ball"] and sockets() == {"Ball": True}


def test_the_faces_of_a_lone_medium_that_moves_say_air(scene):
    body = ball()
    for frame, x in ((1, 0.0), (20, 3.0)):
        body.location.x = x
        body.keyframe_insert("location", frame=frame)
    preparation = nd.prepare(scene)
    assert dict(preparation.chosen.osl).keys() == {"Ball"} and not cut_collection.is_shown(scene)
    preparation = nd.prepare(scene, backend="NATIVE")
    assert preparation.cut.media == ("Ball",) and not preparation.problems and sockets() == {"Ball": True}
    values = face_values(scene)["Ball"]
    assert len(values) == len(body.data.polygons) and np.all(values == 1.0)


def test_media_that_stay_among_others_that_move_are_told_by_their_faces(scene):
    body = ball("Mover")
    body.keyframe_insert("location", frame=1)
    crossing()
    nd.prepare(scene, backend="NATIVE")
    values = face_values(scene)
    assert values.keys() == {"Mover", "Block", "Water"}
    assert np.all(np.concatenate(list(values.values())) != 0.0)
    assert {round(float(value), 4) for value in values["Water"]} <= {1.0, 1.5}


def test_a_medium_that_nobody_has_analysed_is_told_by_its_faces(scene):
    ball()
    set_backend(scene, "NATIVE")
    assert live.update_cut(scene).media == ("Ball",)
    assert np.all(face_values(scene)["Ball"] == 1.0)


def test_a_scene_without_media_is_never_cut(scene):
    set_backend(scene, "NATIVE")
    add_box("Wall", (0, 0, 0), (1, 1, 1))
    assert not cut_scene.is_cut(scene) and live.update_cut(scene) == cut_plan.CutReport()
