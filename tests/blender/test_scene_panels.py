"""The list of media in the panel: rows, their order, and buttons."""

from types import SimpleNamespace

import bpy
import pytest
from panels import CUBE, PANELS, activate, add_media, exclude
from scenes import add_box, mostly_again
from ui import Layout, labels_and_operators

import nested_dielectric as nd
from nested_dielectric.scene import media
from nested_dielectric.ui import media_list, media_rows
from nested_dielectric.ui.panels import media_list_panel, scene_panels


@pytest.fixture(autouse=True)
def scene():
    """The extension is registered in an empty scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    media_list._opened.clear()
    nd.register()
    yield bpy.context.scene
    nd.unregister()


def numbers():
    found = {
        m.name: m.node_tree.nodes["Nested Dielectric"].inputs["Priority"].default_value for m in bpy.data.materials
    }
    return found | {obj.name: obj["nd_priority"] for obj in bpy.data.objects if "nd_priority" in obj}


def rows(text=""):
    """What the list shows, in order."""
    scene = bpy.context.scene
    media_rows._make_wanted()
    lines = media_list.listed_lines(scene).lines
    manager = bpy.context.window_manager
    shown = SimpleNamespace(filter_name=text, bitflag_filter_item=1 << 30)
    flags, order = media_list_panel.MediaList.filter_items(shown, bpy.context, manager, "nested_dielectric_places")
    assert (
        len(flags) == len(manager.nested_dielectric_places) >= len(lines)
        and order == []
        and not any(flags[len(lines) :])
    )
    return [line.chosen.name for line, flag in zip(lines, flags) if flag]


def choose(name):
    lines = media_list.listed_lines(bpy.context.scene).lines
    index = next(index for index, line in enumerate(lines) if line.chosen.name == name)
    bpy.context.scene.nested_dielectric_active = index
    return index


def open_material(name):
    bpy.ops.nested_dielectric.open_material(number=bpy.data.materials[name].session_uid)


def test_a_row_is_a_material_that_opens_to_its_objects_and_an_object_with_its_own_number_is_a_row_too():
    add_media(Water=30, Ice=20, Odd=[25], Air=0)
    add_box("Drop", *CUBE, bpy.data.materials["Water"])
    add_box("Wall", *CUBE, bpy.data.materials.new("Plain"))
    bpy.context.view_layer.update()
    assert rows() == ["Air", "Ice", "Odd Cube", "Water"]
    open_material("Water")
    assert rows() == ["Air", "Ice", "Odd Cube", "Water", "Drop", "Water Cube"]
    assert rows("drop") == ["Water", "Drop"] and rows("ice") == ["Ice"]
    open_material("Water")
    assert rows() == ["Air", "Ice", "Odd Cube", "Water"]


def drawn_row(name):
    """What a row of the list draws."""
    scene, found = bpy.context.scene, []
    lines = media_list.listed_lines(scene).lines
    index = next(index for index, line in enumerate(lines) if line.chosen.name == name)
    area = bpy.context.window.screen.areas[0]
    with bpy.context.temp_override(area=area, region=area.regions[0]):
        layout = bpy.context.window_manager.popover_begin__internal(ui_units_x=10).layout
        context = SimpleNamespace(scene=scene)
        media_list_panel.MediaList.draw_item(None, context, Layout(layout, found), None, None, 0, None, "", index)
    return found


def test_a_row_shows_a_colour_a_name_how_many_objects_and_a_number_to_edit():
    add_media(Water=30, Odd=[15])
    add_box("Drop", *CUBE, bpy.data.materials["Water"])
    bpy.context.view_layer.update()
    found = drawn_row("Water")
    assert [keywords["text"] for name, _, keywords in found if name == "label"] == ["Water (2)"]
    sockets = [arguments[0].name for name, arguments, _ in found if name == "prop"]
    assert sockets == ["Transmittance", "Priority"]
    found = drawn_row("Odd Cube")
    assert [arguments[1] for name, arguments, _ in found if name == "prop"] == ["name", '["nd_priority"]']
    assert [keywords["icon"] for name, _, keywords in found if name == "operator"] == ["PINNED"]
    open_material("Water")
    assert [keywords["icon"] for name, _, keywords in drawn_row("Drop") if name == "operator"] == ["UNPINNED"]


def test_the_active_row_follows_the_active_object_until_a_material_is_chosen(scene):
    add_media(Water=30, Odd=[25], Ice=20)

    def active():
        line = media_rows.active_line(scene)
        return None if line is None else line.chosen.name

    activate("Odd Cube")
    assert active() == "Odd Cube"
    activate("Water Cube")
    assert active() == "Water"
    choose("Ice")
    assert active() == "Ice" and bpy.context.view_layer.objects.active.name == "Water Cube"
    activate("Odd Cube")
    assert active() == "Odd Cube"
    open_material("Water")
    activate("Water Cube")
    assert active() == "Water Cube"
    bpy.context.view_layer.objects.active = add_box("Wall", *CUBE)
    assert active() is None


def test_choosing_an_object_selects_it_and_nothing_else(scene):
    add_media(A=1, One=[2], Two=[3])
    choose("One Cube")
    assert [obj.name for obj in bpy.context.selected_objects] == ["One Cube"]
    assert bpy.context.view_layer.objects.active.name == "One Cube"
    exclude("Two Cube")
    choose("Two Cube")
    assert [obj.name for obj in bpy.context.selected_objects] == ["One Cube"]


def test_objects_of_the_active_material_are_selected_by_a_button(capfd):
    add_media(Water=30, Ice=20)
    for index in range(3):
        add_box(f"Drop {index}", *CUBE, bpy.data.materials["Water"])
    bpy.context.view_layer.update()
    bpy.data.objects["Drop 1"].hide_set(True)
    choose("Water")
    assert bpy.ops.nested_dielectric.select_objects() == {"FINISHED"}
    assert {obj.name for obj in bpy.context.selected_objects} == {"Water Cube", "Drop 0", "Drop 2"}
    assert "'Drop 1' is hidden in the viewport; show it" in "".join(capfd.readouterr())


def test_arrows_move_the_active_row_and_undo_takes_every_step_back(scene):
    add_media(Air=0, Ice=20, Water=30, Odd=[40])
    start = numbers()
    bpy.ops.ed.undo_push(message="start")
    activate("Water Cube")
    bpy.ops.nested_dielectric.priority_move("EXEC_DEFAULT", True, direction="UP")
    assert numbers() == start | {"Water": 10}
    bpy.ops.nested_dielectric.priority_move("EXEC_DEFAULT", True, name="Odd Cube", direction="UP")
    assert numbers() == start | {"Water": 10, "Odd Cube": 15}
    bpy.ops.nested_dielectric.priority_move("EXEC_DEFAULT", True, material="Ice", direction="UP")
    assert numbers() == start | {"Water": 10, "Odd Cube": 15, "Ice": 12}
    bpy.ops.nested_dielectric.space_out("EXEC_DEFAULT", True)
    assert numbers() == {"Air": 10, "Water": 20, "Ice": 30, "Odd Cube": 40}
    for expected in ({"Water": 10, "Odd Cube": 15, "Ice": 12}, {"Water": 10, "Odd Cube": 15}, {"Water": 10}, {}):
        bpy.ops.ed.undo()
        assert numbers() == start | expected


def test_a_move_that_finds_no_number_says_what_to_press_and_changes_nothing(scene):
    add_media(Ice=20, Water=21, Oil=22)
    before = numbers()
    with pytest.raises(RuntimeError, match="'Oil' finds no free number between 20 and 21; press Space Out Priorities"):
        bpy.ops.nested_dielectric.priority_move(material="Oil", direction="UP")
    assert numbers() == before
    assert bpy.ops.nested_dielectric.priority_move(material="Ice", direction="UP") == {"CANCELLED"}
    with pytest.raises(RuntimeError, match="no object of the scene has its priority from material 'Tea'"):
        bpy.ops.nested_dielectric.priority_move(material="Tea", direction="UP")


def test_an_own_priority_starts_at_the_one_in_force_and_returns_to_that_of_the_material():
    add_media(Water=30)
    (water,) = bpy.context.scene.objects
    bpy.ops.nested_dielectric.priority_own(name=water.name)
    assert media.own_priority(water) == 30
    nd.set_priority(water, 7)
    bpy.ops.nested_dielectric.priority_own(name=water.name)
    assert media.own_priority(water) is None and nd.get_priority(water) == 30
    bpy.ops.nested_dielectric.priority_own(name=water.name)
    water.keyframe_insert('["nd_priority"]')
    with pytest.raises(RuntimeError, match="has keyframes or a driver of its priority"):
        bpy.ops.nested_dielectric.priority_own(name=water.name)


def test_buttons_for_media_are_greyed_out_where_there_are_none():
    for name in ("priority_move", "priority_own", "space_out", "select_objects"):
        with pytest.raises(RuntimeError, match="The scene has no medium; assign a preset first"):
            getattr(bpy.ops.nested_dielectric, name)()
    with pytest.raises(RuntimeError, match="The scene is not prepared"):
        bpy.ops.nested_dielectric.put_back()


@pytest.mark.parametrize("panel", mostly_again(PANELS))
def test_the_panel_says_over_whom_the_active_row_wins(draw, panel):
    add_media(Air=0, Ice=20, Water=30)
    activate("Ice Cube")
    labels, buttons = labels_and_operators(draw(panel))
    assert "Ice wins over Water; gives way to Air" in labels
    for operator in ("priority_move", "space_out", "select_objects"):
        assert f"nested_dielectric.{operator}" in buttons


def test_places_for_rows_are_made_where_there_are_too_few(draw):
    add_media(**{f"Medium {index}": index for index in range(30)})
    manager = bpy.context.window_manager
    assert len(manager.nested_dielectric_places) == 0
    draw(scene_panels.SidebarPanel)
    assert bpy.app.timers.is_registered(media_rows._make_wanted)
    bpy.app.timers.unregister(media_rows._make_wanted)
    media_rows._make_wanted()
    assert len(manager.nested_dielectric_places) == 30
    draw(scene_panels.SidebarPanel)
    assert not bpy.app.timers.is_registered(media_rows._make_wanted)
