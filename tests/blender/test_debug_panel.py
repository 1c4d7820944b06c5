"""Debug views in panels: the switch, its notices, its legend, passes, and undoing them."""

import bpy
import pytest
from scenes import new_scene
from ui import add_media, labels_and_operators

import nested_dielectric as nd
from nested_dielectric import registration
from nested_dielectric.model.contract import DebugView
from nested_dielectric.model.debug_views import ALARM, STEPS, VIEWS, medium_colour, step_of
from nested_dielectric.nodes.group import ensure_group
from nested_dielectric.nodes.names import DEBUG_THROUGH, DEBUG_VIEW
from nested_dielectric.scene import debug_views
from nested_dielectric.ui import legend_overlay, legends, media_list
from nested_dielectric.ui.panels import debug_panel, notices, scene_panels

SWITCH = "nested_dielectric.debug_view"


@pytest.fixture
def scene(registered):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.view_settings.view_transform = "Standard"
    add_media(Glass=2, Water=5, Ice=5)
    return scene


def test_the_switch_shows_one_view_at_a_time_and_none_leaves_nothing(scene):
    for choice in VIEWS[1:]:
        assert bpy.ops.nested_dielectric.debug_view(view=choice.keyword, through=2) == {"FINISHED"}
        assert scene[DEBUG_VIEW] == DebugView[choice.keyword] and scene[DEBUG_THROUGH] == 2
        assert debug_views.get_debug_view(scene).name == choice.keyword
    bpy.ops.nested_dielectric.debug_view(view="NONE", through=2)
    assert DEBUG_VIEW not in scene and DEBUG_THROUGH not in scene
    with pytest.raises(nd.ParameterError, match="MEDIUM, VALIDITY"):
        debug_views.set_debug_view(scene, "COLOUR")


@pytest.mark.parametrize("number", [99, -99, "MEDIUM", 2.5, None])
def test_an_unknown_number_is_no_view(scene, number):
    scene[DEBUG_VIEW] = number if number is not None else {}
    assert debug_views.get_debug_view(scene) == DebugView.NONE and not debug_views.debug_notice(scene)


def test_a_view_and_passes_are_undone_step_by_step(scene):
    bpy.ops.ed.undo_push(message="Before")
    bpy.ops.nested_dielectric.debug_view("EXEC_DEFAULT", True, view="DEPTH")
    bpy.ops.nested_dielectric.add_debug_passes("EXEC_DEFAULT", True)
    assert len(bpy.context.scene.view_layers) == 7
    bpy.ops.ed.undo()
    assert len(bpy.context.scene.view_layers) == 1
    assert debug_views.get_debug_view(bpy.context.scene) == DebugView.DEPTH
    bpy.ops.ed.undo()
    assert debug_views.get_debug_view(bpy.context.scene) == DebugView.NONE
    bpy.ops.ed.redo()
    assert debug_views.get_debug_view(bpy.context.scene) == DebugView.DEPTH


def test_the_legend_names_media_by_priority_and_draws_a_swatch_for_each(scene, draw):
    bpy.ops.nested_dielectric.debug_view(view="MEDIUM")
    steps = debug_views.legend(DebugView.MEDIUM, media_list.listed_media(scene).rows)
    assert [step.words for step in steps[:3]] == ["2: Glass", "5: Ice, Water", "Air"]
    assert steps[1].colour == medium_colour(5) and steps[-1] == ALARM
    drawn = draw(debug_panel.DebugPanel)
    labels, operators = labels_and_operators(drawn)
    assert "5: Ice, Water" in labels and SWITCH in operators
    icons = [keywords["icon_value"] for name, _, keywords in drawn if name == "label" and "icon_value" in keywords]
    assert len(icons) == len(steps)  # whose numbers are 0 without a window


@pytest.mark.parametrize("view", [view for view in DebugView if view])
def test_every_view_has_a_legend_whose_colours_differ(scene, draw, view):
    bpy.ops.nested_dielectric.debug_view(view=view.name)
    labels, _ = labels_and_operators(draw(debug_panel.DebugPanel))
    assert all(step.words in labels for step in STEPS[view])
    assert len({step.colour for step in (*STEPS[view], ALARM)}) == len(STEPS[view]) + 1


def test_numbers_find_the_row_whose_words_are_theirs():
    for number, words in (
        (0, "None: told"),
        (1, "1"),
        (2, "2 to 3"),
        (3, "2 to 3"),
        (64, "64 to 127"),
        (1e6, "128 or more"),
    ):
        assert STEPS[DebugView.RAYS][step_of(DebugView.RAYS, number)].words == words
    for number, words in ((1, "1"), (7, "7"), (8, "8 or more"), (40, "8 or more")):
        assert STEPS[DebugView.DEPTH][step_of(DebugView.DEPTH, number)].words == words


def test_near_priorities_differ_in_colour():
    colours = [medium_colour(number) for number in range(89)]
    for first in range(89):
        for other in range(first + 1, min(first + 8, 89)):
            assert max(abs(a - b) for a, b in zip(colours[first], colours[other])) > 0.1


def test_a_view_that_is_on_is_told_in_panels_and_before_a_render(scene, draw, capfd):
    off = labels_and_operators(draw(scene_panels.SidebarPanel))
    assert SWITCH not in off[1]
    bpy.ops.nested_dielectric.debug_view(view="TOLD")
    labels, operators = labels_and_operators(draw(scene_panels.SidebarPanel))
    assert "debug view 'Told'" in " ".join(labels.split()) and SWITCH in operators
    assert "'Told'" in notices._debug_notice(scene)
    registration.warn_before_render(scene)
    assert "renders show the debug view 'Told', not light" in capfd.readouterr().err
    bpy.ops.nested_dielectric.debug_view(view="NONE")
    registration.warn_before_render(scene)
    assert "debug view" not in capfd.readouterr().err


def test_look_through_has_buttons_for_one_less_and_one_more(scene, draw):
    bpy.ops.nested_dielectric.debug_view(view="MEDIUM", through=3)
    labels, operators = labels_and_operators(draw(debug_panel.DebugPanel))
    assert "Look Through: 3" in labels and operators.count(SWITCH) == 2


def test_a_view_transform_that_changes_colours_is_named(scene, draw):
    bpy.ops.nested_dielectric.debug_view(view="MEDIUM")
    assert legends.colour_note(scene) == ""
    scene.view_settings.view_transform = "AgX"
    assert "View Transform AgX" in labels_and_operators(draw(debug_panel.DebugPanel, 900))[0]


def test_passes_show_what_the_first_view_layer_shows_and_go_again(scene):
    hidden = bpy.data.collections.new("Hidden")
    scene.collection.children.link(hidden)
    first = scene.view_layers[0]
    first.layer_collection.children["Hidden"].exclude = True
    assert not bpy.ops.nested_dielectric.remove_debug_passes.poll()
    assert bpy.ops.nested_dielectric.add_debug_passes() == {"FINISHED"}
    assert [layer.name for layer in scene.view_layers][1:] == list(debug_views.LAYERS.values())
    for layer, view in zip(list(scene.view_layers)[1:], debug_views.LAYERS):
        assert layer[DEBUG_VIEW] == -view and debug_views.get_debug_view(scene, layer) == view
        assert layer.samples == 1 and layer.use_pass_emit and layer.layer_collection.children["Hidden"].exclude
    assert debug_views.get_debug_view(scene) == debug_views.get_debug_view(scene, first) == DebugView.NONE
    changes = nd.add_passes(scene)
    assert not any("ND " in change for change in changes)
    assert bpy.ops.nested_dielectric.remove_debug_passes() == {"FINISHED"}
    assert list(scene.view_layers) == [first]


def test_nothing_is_drawn_over_views_in_the_background():
    assert bpy.app.background
    legend_overlay.show_legends()()


def test_a_scene_without_media_has_no_switch(registered):
    assert not bpy.ops.nested_dielectric.debug_view.poll()


def test_files_and_groups_keep_their_version_and_the_setting(tmp_path):
    scene = new_scene()
    ensure_group()
    debug_views.set_debug_view(scene, "RAYS", 1)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "file.blend"))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "file.blend"))
    assert debug_views.get_debug_view(bpy.context.scene) == DebugView.RAYS
    assert debug_views.get_through(bpy.context.scene) == 1
