"""Which body of each material renders a scene, what decides it, and what artists are told of that."""

import bpy
import numpy as np
import pytest
from scenes import add_box, add_plane, add_point_light, add_sphere, mostly_again, new_scene
from ui import labels_and_operators

import nested_dielectric as nd
from nested_dielectric.cutting import backends, cutting
from nested_dielectric.model.dispersion import LINE_C, LINE_D, LINE_F, abbe_deviation
from nested_dielectric.model.parameters import PARAMETERS, limits_at_work
from nested_dielectric.nodes import compatibility, node_group
from nested_dielectric.preparation import live
from nested_dielectric.preparation.preparation import put_back
from nested_dielectric.scene.materials import dielectric_node
from nested_dielectric.ui import notices
from nested_dielectric.ui.panels import scene_panels

pytestmark = pytest.mark.quick

HERE = bpy.app.version
HAS_DISPERSION = HERE >= compatibility.NATIVE_DISPERSION_VERSION


@pytest.fixture(autouse=True)
def scene():
    """An empty scene on the CPU with Open Shading Language."""
    return new_scene()


@pytest.fixture
def without_osl(monkeypatch):
    monkeypatch.setattr(compatibility, "has_osl", lambda: False)
    for module in (backends, __import__("nested_dielectric.preparation.preparation", fromlist=["preparation"])):
        monkeypatch.setattr(module, "has_osl", lambda: False)


def ball(name="Ball", x=0.0, **keywords):
    material = nd.new_material(name, **{"ior": 1.5} | keywords)
    return add_sphere(name, 1.0, material, location=(x, 0, 0), segments=16)


def crossing():
    """A block of glass that a block of water reaches into."""
    add_box("Block", (-1, -1, -1), (0.1, 1, 1), nd.new_material("Glass", ior=1.5), 1)
    return add_box("Water", (-0.2, -0.7, -0.8), (1, 0.6, 0.9), nd.new_material("Water", ior=1.33), 2)


def sheet(material=None):
    """A medium that is not closed, and so cannot be cut or told anything."""
    return add_plane("Sheet", 1.0, (0, 0, 9), (0, 0, 1), material or nd.new_material("Open", ior=1.5))


def sockets():
    """Whether Cycles' own nodes render each material, as its socket has it."""
    return {
        material.name: dielectric_node(material).inputs[node_group.NATIVE_SOCKET].default_value
        for material in bpy.data.materials
        if dielectric_node(material) is not None
    }


def face_values(scene):
    """What the faces of surfaces that renders show say, by object."""
    found = {}
    for obj in scene.objects:
        if obj.name.endswith(cutting.SUFFIX):
            obj.hide_viewport = False
            bpy.context.view_layer.update()
            mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
            values = np.zeros(len(mesh.polygons), dtype=np.float32)
            mesh.attributes[node_group.CUT].data.foreach_get("value", values)
            found[obj.name.removesuffix(cutting.SUFFIX)] = values
            obj.hide_viewport = True
    return found


# The setting --------------------------------------------------------------------------------------------------------


def test_a_scene_is_native_by_its_setting_its_device_and_its_switch(scene, monkeypatch):
    assert compatibility.get_backend(scene) == "AUTO" and not compatibility.is_native(scene)
    for name, value, back in (("device", "GPU", "CPU"), ("shading_system", False, True)):
        setattr(scene.cycles, name, value)
        assert compatibility.is_native(scene)
        compatibility.set_backend(scene, "OSL")
        assert not compatibility.is_native(scene) and compatibility.settings_problem(scene)
        compatibility.set_backend(scene, "AUTO")
        setattr(scene.cycles, name, back)
    compatibility.set_backend(scene, "NATIVE")
    assert compatibility.is_native(scene) and compatibility.settings_problem(scene) is None
    compatibility.set_backend(scene, "AUTO")
    assert compatibility.BACKEND_SETTING not in scene
    scene[compatibility.BACKEND_SETTING] = ["others", "nonsense"]
    assert compatibility.get_backend(scene) == "AUTO"
    monkeypatch.setattr(compatibility, "has_osl", lambda: False)
    assert compatibility.is_native(scene)


def test_another_word_is_refused_and_changes_nothing(scene):
    ball()
    with pytest.raises(nd.ParameterError, match="AUTO, OSL, NATIVE"):
        nd.prepare(scene, backend="CUDA")
    assert (
        compatibility.get_backend(scene) == "AUTO" and scene.cycles.max_bounces == 256 and not any(sockets().values())
    )


# What is chosen -----------------------------------------------------------------------------------------------------


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
    bpy.context.view_layer.update()
    updates = []
    watch = bpy.app.handlers.persistent(
        lambda scene, depsgraph: updates.extend(each.id.name for each in depsgraph.updates)
    )
    bpy.app.handlers.depsgraph_update_post.append(watch)
    backends.choose(scene)
    bpy.context.view_layer.update()
    bpy.app.handlers.depsgraph_update_post.remove(watch)
    assert not updates


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
    monkeypatch.setattr(live, "has_window", lambda: True)
    monkeypatch.setattr(live, "_wait_for_rest", lambda: None)
    body = ball()
    nd.prepare(scene)
    bpy.context.view_layer.update()
    assert sockets() == {"Ball": True}
    body.location.x = 1.0
    bpy.context.view_layer.update()
    assert sockets() == {"Ball": False}
    live.analyse_at_rest()
    bpy.context.view_layer.update()
    assert sockets() == {"Ball": True}


# What needs the shader ----------------------------------------------------------------------------------------------


def test_the_defaults_of_all_parameters_need_no_shader():
    values = {parameter.keyword: parameter.default for parameter in PARAMETERS}
    for lamps in (False, True):
        at_work = limits_at_work(values | {"lamps_by_lobe": lamps, "tinted_media": True}, HERE)
        assert [parameter.name for parameter in at_work.values()] == ["Direct Refraction"] * lamps


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


def test_a_lamp_that_lobes_carry_needs_the_shader(scene):
    ball()
    add_point_light((0, 0, 5), 100.0)
    next(obj for obj in scene.objects if obj.type == "LIGHT").visible_transmission = False
    assert "has Direct Refraction:" in str(nd.prepare(scene).chosen)


def test_a_mask_for_the_artists_own_volume_needs_the_shader(scene):
    material = ball().active_material
    tree = material.node_tree
    volume = tree.nodes.new("ShaderNodeVolumeScatter")
    tree.links.new(dielectric_node(material).outputs[node_group.MASK_OUTPUT], volume.inputs["Density"])
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
    by_volume = dielectric_node(bpy.data.materials["Ball"]).inputs[node_group.BY_VOLUME_SOCKET].default_value > 0
    assert sockets()["Ball"] == by_volume


# Preparing ------------------------------------------------------------------------------------------------------------


def test_open_shading_language_is_switched_on_only_where_a_medium_needs_it_and_goes_back(scene):
    scene.cycles.shading_system = False
    crossing()
    preparation = nd.prepare(scene)
    assert not scene.cycles.shading_system and preparation.cut.media == ("Block", "Water") and not preparation.problems
    inputs = dielectric_node(bpy.data.materials["Glass"]).inputs
    inputs["Energy Cutoff Exponent"].default_value = -3.0
    (change,) = (each for each in nd.prepare(scene).changes if each.startswith("Open Shading"))
    assert change.startswith("Open Shading Language: off -> on, because 'Glass' has Energy Cutoff Exponent")
    assert scene.cycles.shading_system and not cutting.is_cut(scene) and not cutting.is_shown(scene)
    assert nd.prepare(scene).changes == ()
    inputs["Energy Cutoff Exponent"].default_value = -20.0
    nd.prepare(scene)
    assert not scene.cycles.shading_system and all(sockets().values())


def test_a_scene_leaves_the_gpu_only_for_media_that_must_ask_and_can_be_told_nothing(scene):
    scene.cycles.device = "GPU"
    crossing()
    ball("Cut off", 20.0, energy_cutoff_exponent=-3.0)
    preparation = nd.prepare(scene)
    assert scene.cycles.device == "GPU" and preparation.cut.media == ("Block", "Water") and all(sockets().values())
    (problem,) = preparation.problems
    assert problem.name == "Cut off" and "Energy Cutoff" in problem.text and "Render With" in problem.remedy
    open_one = sheet()
    preparation = nd.prepare(scene)
    assert scene.cycles.device == "CPU"
    assert any(each.startswith("Device: ") and "because 'Sheet' must ask" in each for each in preparation.changes)
    assert "is not closed" in str(preparation.chosen)
    assert nd.prepare(scene).changes == ()
    bpy.data.objects.remove(open_one)
    nd.prepare(scene)
    assert scene.cycles.device == "GPU"


def test_native_never_moves_a_scene_and_names_what_cannot_be_rendered_so(scene):
    scene.cycles.device = "GPU"
    sheet()
    preparation = nd.prepare(scene, backend="NATIVE")
    assert scene.cycles.device == "GPU" and all(sockets().values())
    (problem,) = [each for each in preparation.problems if "must ask" in each.text]
    assert problem.name == "Sheet" and "is not closed" in problem.text and "Render With to Automatic" in problem.remedy
    assert "'Sheet' must ask" in notices.render_problem(scene)


def test_the_shader_alone_takes_a_scene_to_the_cpu_and_automatic_takes_it_back(scene):
    scene.cycles.device, scene.cycles.shading_system = "GPU", False
    ball()
    nd.prepare(scene, backend="OSL")
    assert compatibility.runs_osl(scene) and sockets() == {"Ball": False}
    nd.prepare(scene, backend="AUTO")
    assert scene.cycles.device == "GPU" and not scene.cycles.shading_system and sockets() == {"Ball": True}


def test_a_blender_without_osl_renders_by_own_nodes_and_says_what_it_lacks(scene, without_osl):
    crossing()
    sheet()
    preparation = nd.prepare(scene)
    assert compatibility.is_native(scene) and all(sockets().values()) and preparation.cut.media == ("Block", "Water")
    (problem,) = [each for each in preparation.problems if "must ask" in each.text]
    assert "a Blender with Open Shading Language" in problem.remedy
    nd.prepare(scene, backend="OSL")
    assert "which this Blender was built without" in compatibility.settings_problem(scene)


def test_own_nodes_split_light_from_blender_5_3_on_and_how_far_off_is_said(scene):
    scene.cycles.device = "GPU"
    ball("Prism", disperse=True, dispersion_model="SELLMEIER")
    preparation = nd.prepare(scene)
    assert not scene.render.use_motion_blur and scene.cycles.device == "GPU"
    named = any(problem.name == "Prism" for problem in preparation.problems)
    assert named != HAS_DISPERSION
    assert ("off the medium's own" in str(preparation)) == HAS_DISPERSION
    assert (compatibility.achromatic_reason(scene) is None) == HAS_DISPERSION


@pytest.mark.pure
def test_how_far_own_dispersion_is_off_has_a_closed_form():
    """JF's curve is a parabola of the wavelength, furthest from Cauchy's at the violet end."""
    ior, spread = 1.5, 0.03

    def parabola(nm):
        return (1.0 - (nm - 370.0) / 410.0) ** 2

    slope = spread * (parabola(LINE_F) - parabola(LINE_C)) / (LINE_F**-2 - LINE_C**-2)
    expected = abs(spread * (parabola(380.0) - parabola(LINE_D)) - slope * (380.0**-2 - LINE_D**-2))
    values = {"ior": ior, "dispersion_model": "JF", "dispersion": spread}
    assert abbe_deviation(values) == pytest.approx(expected, rel=1e-9)
    assert abbe_deviation({"ior": ior, "dispersion_model": "ABBE", "abbe": 30.0}) == pytest.approx(0.0, abs=1e-12)
    assert abbe_deviation({"ior": ior, "dispersion_model": "ABBE", "abbe": 0.0}) == 0.0


# Told by faces --------------------------------------------------------------------------------------------------------


def test_a_scene_of_own_nodes_is_cut_whatever_its_setting_says_and_not_any_more_when_it_is_none(scene):
    scene.cycles.device = "GPU"
    crossing()
    nd.prepare(scene, cut=False)
    assert cutting.is_cut(scene) and not cutting.is_set_to_cut(scene) and scene.objects["Water"].hide_render
    scene.cycles.device = "CPU"
    live.update_cut(scene)
    assert not cutting.is_shown(scene) and not scene.objects["Water"].hide_render


def test_a_lone_medium_that_stays_is_told_by_the_analysis_and_not_cut(scene):
    ball()
    assert nd.prepare(scene, backend="NATIVE").cut == cutting.Cut()
    assert [obj.name for obj in scene.objects] == ["Ball"] and sockets() == {"Ball": True}


def test_the_faces_of_a_lone_medium_that_moves_say_air(scene):
    body = ball()
    for frame, x in ((1, 0.0), (20, 3.0)):
        body.location.x = x
        body.keyframe_insert("location", frame=frame)
    preparation = nd.prepare(scene)
    assert dict(preparation.chosen.osl).keys() == {"Ball"} and not cutting.is_shown(scene)
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
    compatibility.set_backend(scene, "NATIVE")
    assert live.update_cut(scene).media == ("Ball",)
    assert np.all(face_values(scene)["Ball"] == 1.0)


def test_a_scene_without_media_is_never_cut(scene):
    compatibility.set_backend(scene, "NATIVE")
    add_box("Wall", (0, 0, 0), (1, 1, 1))
    assert not cutting.is_cut(scene) and live.update_cut(scene) == cutting.Cut()


# The panel ------------------------------------------------------------------------------------------------------------


def test_the_panel_shows_what_renders_and_the_menu_changes_it(draw):
    nd.register()
    try:
        scene = bpy.context.scene
        assert "Render With" not in str(draw(scene_panels.SidebarPanel))
        ball("Lone", 20.0)
        crossing()
        nd.prepare(scene)
        drawn = draw(scene_panels.SidebarPanel)
        labels, _ = labels_and_operators(drawn)
        assert "3 materials: 1 by Cycles' own nodes, 2 by OSL" in labels and "ust ask what lies outside it" in labels
        menus = [keywords["text"] for name, _, keywords in drawn if name == "operator_menu_enum"]
        assert menus == ["Render With: Automatic"]
        assert bpy.ops.nested_dielectric.cut_surfaces.poll()
        assert bpy.ops.nested_dielectric.render_with(backend="NATIVE") == {"FINISHED"}
        assert all(sockets().values()) and cutting.is_shown(scene) and not bpy.ops.nested_dielectric.cut_surfaces.poll()
        labels, _ = labels_and_operators(draw(scene_panels.SidebarPanel))
        assert "3 materials: Cycles' own nodes" in labels
        bpy.ops.nested_dielectric.render_with(backend="OSL")
        assert not any(sockets().values()) and not cutting.is_shown(scene)
    finally:
        nd.unregister()
