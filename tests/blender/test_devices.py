"""What is rendered by which nodes decides about the device and Open Shading Language."""

import bpy
import pytest
from backends import HERE, ball, crossing, sockets
from scenes import add_plane, new_scene
from ui import labels_and_operators

import nested_dielectric as nd
from nested_dielectric.cutting import (
    cut_collection,
    cut_scene,
    needs,
)
from nested_dielectric.nodes import compatibility
from nested_dielectric.nodes.render_settings import achromatic_reason, settings_problem
from nested_dielectric.nodes.render_with import BACKEND_SETTING, get_backend, is_native, runs_osl, set_backend
from nested_dielectric.scene.materials import dielectric_node
from nested_dielectric.ui.panels import notices, scene_panels

HAS_DISPERSION = HERE >= compatibility.NATIVE_DISPERSION_VERSION


@pytest.fixture(autouse=True)
def scene():
    """An empty scene on the CPU with Open Shading Language."""
    return new_scene()


@pytest.fixture
def without_osl(monkeypatch):
    monkeypatch.setattr(compatibility, "has_osl", lambda: False)
    for module in (
        needs,
        __import__("nested_dielectric.preparation.required_settings", fromlist=["required_settings"]),
    ):
        monkeypatch.setattr(module, "has_osl", lambda: False)


def sheet(material=None):
    """A medium that is not closed, and so cannot be cut or told anything."""
    return add_plane("Sheet", 1.0, (0, 0, 9), (0, 0, 1), material or nd.new_material("Open", ior=1.5))


def test_a_scene_is_native_by_its_setting_its_device_and_its_switch(scene, monkeypatch):
    assert get_backend(scene) == "AUTO" and not is_native(scene)
    for name, value, back in (("device", "GPU", "CPU"), ("shading_system", False, True)):
        setattr(scene.cycles, name, value)
        assert is_native(scene)
        set_backend(scene, "OSL")
        assert not is_native(scene) and settings_problem(scene)
        set_backend(scene, "AUTO")
        setattr(scene.cycles, name, back)
    set_backend(scene, "NATIVE")
    assert is_native(scene) and settings_problem(scene) is None
    set_backend(scene, "AUTO")
    assert BACKEND_SETTING not in scene
    scene[BACKEND_SETTING] = ["others", "nonsense"]
    assert get_backend(scene) == "AUTO"
    monkeypatch.setattr(compatibility, "has_osl", lambda: False)
    assert is_native(scene)


def test_another_word_is_refused_and_changes_nothing(scene):
    ball()
    with pytest.raises(nd.ParameterError, match="AUTO, OSL, NATIVE"):
        nd.prepare(scene, backend="CUDA")
    assert get_backend(scene) == "AUTO" and scene.cycles.max_bounces == 256 and not any(sockets().values())


def test_open_shading_language_is_switched_on_only_where_a_medium_needs_it_and_goes_back(scene):
    scene.cycles.shading_system = False
    crossing()
    preparation = nd.prepare(scene)
    assert not scene.cycles.shading_system and preparation.cut.media == ("Block", "Water") and not preparation.problems
    inputs = dielectric_node(bpy.data.materials["Glass"]).inputs
    inputs["Energy Cutoff Exponent"].default_value = -3.0
    (change,) = (each for each in nd.prepare(scene).changes if each.startswith("Open Shading"))
    assert change.startswith("Open Shading Language: off -> on, because 'Glass' has Energy Cutoff Exponent")
    assert scene.cycles.shading_system and not cut_scene.is_cut(scene) and not cut_collection.is_shown(scene)
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
    assert runs_osl(scene) and sockets() == {"Ball": False}
    nd.prepare(scene, backend="AUTO")
    assert scene.cycles.device == "GPU" and not scene.cycles.shading_system and sockets() == {"Ball": True}


def test_a_blender_without_osl_renders_by_own_nodes_and_says_what_it_lacks(scene, without_osl):
    crossing()
    sheet()
    preparation = nd.prepare(scene)
    assert is_native(scene) and all(sockets().values()) and preparation.cut.media == ("Block", "Water")
    (problem,) = [each for each in preparation.problems if "must ask" in each.text]
    assert "a Blender with Open Shading Language" in problem.remedy
    nd.prepare(scene, backend="OSL")
    assert "which this Blender was built without" in settings_problem(scene)


def test_own_nodes_split_light_from_blender_5_3_on_and_how_far_off_is_said(scene):
    scene.cycles.device = "GPU"
    ball("Prism", disperse=True, dispersion_model="SELLMEIER")
    preparation = nd.prepare(scene)
    assert not scene.render.use_motion_blur and scene.cycles.device == "GPU"
    named = any(problem.name == "Prism" for problem in preparation.problems)
    assert named != HAS_DISPERSION
    assert ("off the medium's own" in str(preparation)) == HAS_DISPERSION
    assert (achromatic_reason(scene) is None) == HAS_DISPERSION


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
        assert (
            all(sockets().values())
            and cut_collection.is_shown(scene)
            and not bpy.ops.nested_dielectric.cut_surfaces.poll()
        )
        labels, _ = labels_and_operators(draw(scene_panels.SidebarPanel))
        assert "3 materials: Cycles' own nodes" in labels
        bpy.ops.nested_dielectric.render_with(backend="OSL")
        assert not any(sockets().values()) and not cut_collection.is_shown(scene)
    finally:
        nd.unregister()
