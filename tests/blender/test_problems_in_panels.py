"""The panel says whether a scene is ready, and what is wrong with it."""

from dataclasses import replace
from types import SimpleNamespace

import bpy
import pytest
from faults import fault_of
from panels import PANELS, activate, add_media, exclude
from scenes import add_plane, mostly_again
from ui import Layout, labels_and_operators, texts

import nested_dielectric as nd
from nested_dielectric.analysis.validity import is_analysed
from nested_dielectric.checking.finding import Action, Finding
from nested_dielectric.checking.kinds import KINDS
from nested_dielectric.preparation.prepare_scene import put_back
from nested_dielectric.preparation.report import keep_findings, last_report
from nested_dielectric.ui import media_list
from nested_dielectric.ui.operators import preparation_operators
from nested_dielectric.ui.panels import notices, scene_panels


@pytest.fixture(autouse=True)
def scene():
    """The extension is registered in an empty scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    media_list._opened.clear()
    nd.register()
    yield bpy.context.scene
    nd.unregister()


def alerts(drawn):
    """Texts that stand in red."""
    return [keywords["text"] for name, _, keywords in drawn if name == "label" and keywords.get("icon") == "ERROR"]


@pytest.mark.parametrize("panel", mostly_again(PANELS))
@pytest.mark.parametrize("engine", mostly_again(("BLENDER_EEVEE", "CYCLES")))
def test_a_scene_without_media_shows_nothing_red_and_says_what_a_medium_needs(draw, panel, engine, scene):
    scene.render.engine = engine
    scene.cycles.device = "GPU"
    nd.new_material("Nobody's")
    drawn = draw(panel)
    assert alerts(drawn) == []
    assert (
        "No media yet. Select an object and assign a preset; Prepare Scene then sets" in labels_and_operators(drawn)[0]
    )
    assert notices.render_problem(scene) is None


def test_a_blender_that_cannot_render_media_is_no_alarm_in_a_scene_without_any(draw, monkeypatch):
    for module in (scene_panels, notices):
        monkeypatch.setattr(module, "blender_problem", lambda: "this Blender cannot")
    drawn = draw(scene_panels.SidebarPanel)
    assert alerts(drawn) == [] and "They would not render here: this Blender cannot" in texts(drawn)[0]
    add_media(Water=30)
    assert alerts(draw(scene_panels.SidebarPanel)) == ["This Blender cannot"]


@pytest.mark.parametrize("panel", mostly_again(PANELS))
def test_the_panel_says_ready_until_settings_or_media_change(draw, panel, scene):
    add_media(Water=30)
    assert "renders with EEVEE" in labels_and_operators(draw(panel))[0] and alerts(draw(panel))
    bpy.ops.nested_dielectric.prepare()
    labels, buttons = labels_and_operators(draw(panel))
    assert "Ready to Render As of the last Prepare" in labels and "nested_dielectric.put_back" in buttons
    assert "Render Engine: EEVEE -> Cycles" in labels and "Max Bounces: 12 -> 64" in labels
    assert "Media are told what surrounds them" in labels and " Changes " in labels
    scene.render.engine = "BLENDER_WORKBENCH"
    drawn = draw(panel)
    assert "Ready" not in labels_and_operators(drawn)[0] and alerts(drawn)
    scene.render.engine = "CYCLES"
    assert "Ready" in labels_and_operators(draw(panel))[0]
    add_media(Ice=20)
    assert "Media have come or gone since the last Prepare" in labels_and_operators(draw(panel))[0]


@pytest.mark.parametrize("panel", mostly_again(PANELS))
def test_problems_stay_to_be_read_each_with_a_button_and_its_remedy(draw, panel):
    add_media(Water=30)
    for index in range(5):
        add_plane(f"Sheet {index}", 1.0, (9, 9, index), (0, 0, 1), bpy.data.materials["Water"])
    bpy.ops.nested_dielectric.prepare()
    drawn = draw(panel)
    labels, _, buttons = texts(drawn)
    assert "5 Problems As of the last check" in labels and "Ready" not in labels
    assert {f"Sheet {index}" for index in range(5)} <= buttons.keys()
    assert labels.count("Is not closed") == 5 and labels.count("recalculate its normals") == 5
    closed = [keywords["default_closed"] for name, _, keywords in drawn if name == "panel"]
    assert closed == [False] + [True] * 6  # the last are what has been changed, and what renders
    # Whatever has happened since.
    bpy.data.objects.remove(bpy.data.objects["Sheet 0"])
    assert "5 Problems As of the last check" in texts(draw(panel))[0]


def test_each_problem_has_a_button_that_mends_it_and_notes_stand_apart(draw, scene):
    add_media(Water=30)
    wrong = fault_of(Action.CLOSE_HOLES)
    slow = Finding(KINDS["self-overlap"], "Ice Cube", "overlaps itself", "make it one surface")
    note = Finding(KINDS["light-inside"], "Lamp", "shines from inside", "nothing to do")
    keep_findings(scene, 1, [wrong, replace(wrong, fix=replace(wrong.fix, safe=False)), slow, note])
    drawn = draw(scene_panels.SidebarPanel)
    labels, _, buttons = texts(drawn)
    assert "3 Problems As of the last check" in labels and "1 Note" in labels and "Ready" not in labels
    assert "Shows: light that leaves through" in labels and "Shows: dark or clear patches" in labels
    icons = [keywords["icon"] for name, _, keywords in drawn if name == "label" and keywords.get("text") == ""]
    assert icons == ["ERROR", "ERROR", "TIME", "INFO"]
    _, operators = labels_and_operators(drawn)
    assert operators.count("nested_dielectric.fix") == 2 and operators.count("nested_dielectric.fix_all") == 1
    assert {"Box", "Ice Cube", "Lamp"} <= buttons.keys()
    closed = {arguments[0]: keywords["default_closed"] for name, arguments, keywords in drawn if name == "panel"}
    assert closed["nested_dielectric_problem_0"] is False and closed["nested_dielectric_notes"] is True
    keep_findings(scene, 1, [replace(wrong, fix=replace(wrong.fix, safe=False)), note])
    assert "nested_dielectric.fix_all" not in labels_and_operators(draw(scene_panels.SidebarPanel))[1]


def test_a_scene_that_was_only_checked_is_not_called_ready(draw, scene):
    add_media(Water=30)
    scene.render.engine = "CYCLES"
    scene.cycles.shading_system = True
    bpy.ops.nested_dielectric.check()
    labels, buttons = labels_and_operators(draw(scene_panels.SidebarPanel, 800))
    assert "No problems at the last check; Prepare Scene makes it ready" in labels and "Ready to Render" not in labels
    assert "nested_dielectric.put_back" not in buttons and not is_analysed(scene)


def test_the_report_of_the_operator_ends_with_whether_the_scene_is_ready(capfd):
    add_media(Water=30)
    bpy.ops.nested_dielectric.prepare()
    lines = "".join(capfd.readouterr()).splitlines()
    assert "Info: Render Engine: EEVEE -> Cycles" in lines and lines[-1] == "Info: Ready to render"
    add_plane("Sheet", 1.0, (9, 9, 9), (0, 0, 1), bpy.data.materials["Water"])
    bpy.ops.nested_dielectric.prepare()
    lines = "".join(capfd.readouterr()).splitlines()
    assert any(line.startswith("Warning: 'Sheet' is not closed") for line in lines)
    assert lines[-1] == "Warning: 1 problem to look at before rendering"


def test_preparing_and_putting_back_are_undone_with_what_is_kept_of_them(scene):
    add_media(Water=30)
    bpy.ops.ed.undo_push(message="water")

    def found():
        scene = bpy.context.scene
        return scene.render.engine, scene.cycles.max_bounces, last_report(scene) is not None, is_analysed(scene)

    before = found()
    bpy.ops.nested_dielectric.prepare("EXEC_DEFAULT", True)
    after = found()
    assert before[2:] == (False, False) and after == ("CYCLES", 64, True, True)
    bpy.ops.nested_dielectric.put_back("EXEC_DEFAULT", True)
    assert found() == before
    bpy.ops.ed.undo()
    assert found() == after
    bpy.ops.ed.undo()
    assert found() == before
    bpy.ops.ed.redo()
    assert found() == after and put_back(bpy.context.scene)


@pytest.mark.parametrize("where", mostly_again(("here", "hidden", "excluded", "instanced", "unselectable")))
def test_a_problem_selects_its_object_or_says_why_it_cannot(where, capfd, scene):
    add_media(Water=30, Ice=20)
    obj = bpy.data.objects["Water Cube"]
    if where == "hidden":
        obj.hide_set(True)
    elif where == "unselectable":
        obj.hide_select = True
    elif where == "excluded":
        exclude(obj.name)
    elif where == "instanced":
        collection = bpy.data.collections.new("Pool")
        collection.objects.link(obj)
        scene.collection.objects.unlink(obj)
        empty = bpy.data.objects.new("Instance", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        scene.collection.objects.link(empty)
    bpy.context.view_layer.update()
    activate("Ice Cube")
    bpy.data.objects["Ice Cube"].select_set(True)
    result = bpy.ops.nested_dielectric.show_problem(name="Water Cube")
    output = "".join(capfd.readouterr())
    selected = [each.name for each in bpy.context.selected_objects]
    expected, said = {
        "here": ("Water Cube", ""),
        "hidden": ("Ice Cube", "'Water Cube' is hidden in the viewport; show it"),
        "unselectable": ("Ice Cube", "'Water Cube' may not be selected; allow it"),
        "excluded": ("Ice Cube", "'Water Cube' is not in view layer 'ViewLayer'; include its collection"),
        "instanced": ("Instance", "'Water Cube' is in a collection that is instanced; its instances are selected"),
    }[where]
    assert selected == [expected] and said in output
    assert result == ({"CANCELLED"} if expected == "Ice Cube" else {"FINISHED"})


def test_a_problem_of_a_material_selects_its_objects_and_of_nothing_says_so(capfd, scene):
    add_media(Water=30, Ice=20)
    assert bpy.ops.nested_dielectric.show_problem(name="Ice") == {"FINISHED"}
    assert [obj.name for obj in bpy.context.selected_objects] == ["Ice Cube"]
    for name, said in (
        ("Gone", "'Gone' is gone; prepare the scene again"),
        (scene.name, "is no object; its problem concerns the whole scene"),
        ("ViewLayer", "is no object; its problem concerns the whole scene"),
    ):
        assert bpy.ops.nested_dielectric.show_problem(name=name) == {"CANCELLED"}
        assert said in "".join(capfd.readouterr())
    assert [obj.name for obj in bpy.context.selected_objects] == ["Ice Cube"]
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Leave this mode for Object Mode first"):
        bpy.ops.nested_dielectric.show_problem(name="Ice")


def test_what_keeps_media_from_showing_is_named(scene):
    add_media(Water=30)
    nd.prepare(scene, backend="OSL")
    assert notices.render_problem(scene) is None
    inputs = bpy.data.materials["Water"].node_tree.nodes["Nested Dielectric"].inputs
    for setting, value, other, words in (
        ("render.engine", "BLENDER_WORKBENCH", "CYCLES", "renders with BLENDER_WORKBENCH"),
        ("cycles.device", "GPU", "CPU", "renders on the GPU"),
        ("cycles.shading_system", False, True, "without Open Shading Language"),
    ):
        owner, _, name = setting.partition(".")
        setattr(getattr(scene, owner), name, value)
        assert words in notices.render_problem(scene)
        setattr(getattr(scene, owner), name, other)
    inputs["Disperse"].default_value = True
    bpy.context.view_layer.update()
    assert "without motion blur" in notices.render_problem(scene)
    nd.prepare(scene)
    assert notices.render_problem(scene) is None
    tree = bpy.data.materials["Water"].node_tree
    node = tree.nodes["Nested Dielectric"]
    node.node_tree.interface.remove(node.node_tree.interface.items_tree["IOR"])
    bpy.context.view_layer.update()
    assert "is damaged" in notices.render_problem(scene)


def drawn_by(function, **context):
    found = []
    area = bpy.context.window.screen.areas[0]
    values = {
        "scene": bpy.context.scene,
        "region": SimpleNamespace(width=300),
        "preferences": SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)),
    }
    with bpy.context.temp_override(area=area, region=area.regions[0]):
        layout = bpy.context.window_manager.popover_begin__internal(ui_units_x=10).layout
        function(SimpleNamespace(layout=Layout(layout, found)), SimpleNamespace(**values | context))
    return found


@pytest.mark.parametrize("place, function", notices.PLACES)
def test_blenders_own_panels_and_headers_say_why_media_will_not_show(place, function, scene):
    picture = SimpleNamespace(image=SimpleNamespace(type="RENDER_RESULT"))
    assert function in getattr(bpy.types, place)._dyn_ui_initialize()
    assert drawn_by(function, space_data=picture) == []
    add_media(Water=30)
    found = drawn_by(function, space_data=picture)
    assert "renders with" in " ".join(alerts(found))
    nd.prepare(scene)
    assert drawn_by(function, space_data=picture) == []
    nd.unregister()
    assert function not in getattr(bpy.types, place)._dyn_ui_initialize()


def test_other_pictures_than_renders_carry_no_notice():
    add_media(Water=30)
    for picture in (None, SimpleNamespace(type="IMAGE")):
        assert drawn_by(notices.draw_over_picture, space_data=SimpleNamespace(image=picture)) == []


def test_long_reasons_are_shortened_where_there_is_one_line(monkeypatch):
    add_media(Water=30)
    monkeypatch.setattr(notices, "settings_problem", lambda scene: "it is so " * 40)
    (line,) = alerts(drawn_by(notices.draw_in_line))
    assert len(line) <= notices.MOST_CHARACTERS and line.startswith("It is so") and line.endswith("...")


def test_prepare_reports_not_thousands_of_problems(monkeypatch, capfd):
    add_media(Water=30)
    monkeypatch.setattr(preparation_operators, "MOST_REPORTS", 2)
    for index in range(4):
        add_plane(f"Sheet {index}", 1.0, (9, 9, index), (0, 0, 1), bpy.data.materials["Water"])
    bpy.ops.nested_dielectric.prepare()
    lines = "".join(capfd.readouterr()).splitlines()
    assert sum("is not closed (" in line for line in lines) == 2
