"""Cut Surfaces in the panel and in menus."""

import bpy
import pytest
from crossing_blocks import add_crossing
from scenes import new_scene, updated_by
from ui import labels_and_operators

import nested_dielectric as nd
from nested_dielectric.cutting import baked_cut, cut_plan, cut_scene
from nested_dielectric.preparation import idle, live, windows
from nested_dielectric.scene.media import HIDDEN_BY_CUT, media
from nested_dielectric.ui.panels import scene_panels

CUT, KEEP = "nested_dielectric.cut_surfaces", "nested_dielectric.keep_cut"


@pytest.fixture
def registered(registered):
    """The same where media may ask: with Open Shading Language."""
    bpy.context.scene.cycles.shading_system = True


def test_a_button_switches_it_on_and_off_and_shows_which(registered, draw):
    scene = bpy.context.scene
    assert CUT not in labels_and_operators(draw(scene_panels.SidebarPanel))[1]
    add_crossing()
    assert CUT in labels_and_operators(draw(scene_panels.SidebarPanel))[1]
    assert not bpy.ops.nested_dielectric.keep_cut.poll()
    assert bpy.ops.nested_dielectric.cut_surfaces() == {"FINISHED"}
    assert cut_scene.is_cut(scene) and scene.objects["Water"].hide_render
    assert {obj.name for obj in scene.objects} >= {"Water (cut)", "Block (cut)"}
    assert KEEP in labels_and_operators(draw(scene_panels.SidebarPanel))[1]
    assert bpy.ops.nested_dielectric.cut_surfaces() == {"FINISHED"}
    assert not cut_scene.is_cut(scene) and not scene.objects["Water"].hide_render
    assert len(scene.objects) == 2


def test_lists_and_the_selection_show_the_artists_objects_alone(registered):
    scene = bpy.context.scene
    add_crossing()
    nd.prepare(scene, cut=True)
    assert {obj.name for obj in media(scene)} == {"Block", "Water"}
    bpy.ops.object.select_all(action="SELECT")
    assert {obj.name for obj in bpy.context.selected_objects} == {"Block", "Water"}


def test_the_panel_says_what_is_not_cut_and_why(registered, draw):
    add_crossing(open_one=True)
    preparation = nd.prepare(bpy.context.scene, cut=True)
    assert dict(preparation.cut.asking) == {"Water": "is not closed", "Block": "may meet 'Water', which is not cut"}
    labels, operators = labels_and_operators(draw(scene_panels.SidebarPanel))
    assert "2 of 2 Not Cut" in labels and "Is not closed" in labels and "nested_dielectric.show_problem" in operators
    assert not any(obj.hide_render for obj in bpy.context.scene.objects)


def test_none_keeps_the_scenes_own_setting_and_putting_back_ends_it(registered):
    scene = bpy.context.scene
    add_crossing()
    assert nd.prepare(scene).cut == cut_plan.CutReport()
    nd.prepare(scene, cut=True)
    assert nd.prepare(scene).cut.media == ("Block", "Water")
    bpy.ops.nested_dielectric.put_back()
    assert (
        not cut_scene.is_cut(scene)
        and len(scene.objects) == 2
        and not bpy.data.node_groups.get("Nested Dielectric Cut")
    )


def test_bringing_it_up_to_date_changes_nothing_where_nothing_has_changed(registered):
    """Or a window would never come to rest."""
    scene = bpy.context.scene
    add_crossing()
    scene.objects["Block"]["spice"] = [1.0, 2.0]
    nd.prepare(scene, cut=True)
    assert updated_by(lambda: live.update_cut(scene)) == []


def test_what_may_change_the_cut_is_looked_at_in_a_window_and_a_selection_is_not(registered, monkeypatch):
    scene = bpy.context.scene
    add_crossing()
    nd.prepare(scene, cut=True)
    bpy.context.view_layer.update()
    waits = []
    monkeypatch.setattr(windows, "has_window", lambda: True)
    monkeypatch.setattr(idle, "schedule_update", lambda: waits.append(True))

    def waits_after(change):
        waits.clear()
        change()
        bpy.context.view_layer.update()
        return bool(waits)

    water = scene.objects["Water"]
    assert not waits_after(lambda: water.select_set(not water.select_get()))
    assert waits_after(lambda: setattr(water.location, "x", 0.1))
    assert waits_after(lambda: setattr(scene.render, "use_motion_blur", True))


def test_media_that_are_appended_without_their_surfaces_are_rendered(registered, tmp_path):
    add_crossing()
    nd.prepare(bpy.context.scene, cut=True)
    path = str(tmp_path / "cut.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.append(directory=f"{path}/Object/", filename="Water")
    assert not bpy.data.objects["Water"].hide_render and HIDDEN_BY_CUT not in bpy.data.objects["Water"]


def test_what_renders_show_otherwise_than_the_viewport_cannot_be_kept():
    scene = new_scene()
    add_crossing()
    modifier = scene.objects["Water"].modifiers.new("Finer", "SUBSURF")
    modifier.levels, modifier.render_levels = 1, 2
    nd.prepare(scene, cut=True)
    assert "'Water'" in live.bake_cut(scene) and not baked_cut.is_baked(scene)
