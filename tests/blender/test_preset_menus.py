"""Menus and pictures of presets."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from preset_menus import NODE, add_active_ball, call, draw_popover, save_wine
from scenes import add_sphere

import nested_dielectric as nd
from nested_dielectric import registration
from nested_dielectric.model import presets
from nested_dielectric.scene import new_materials, preset_library, preset_materials
from nested_dielectric.ui import pictures, preferences
from nested_dielectric.ui.panels import object_menu
from nested_dielectric.ui.presets import own_preset_operators, preset_menus, preset_operators, preset_pictures


@pytest.fixture(autouse=True)
def folder(preset_folder, registered):
    return preset_folder


@pytest.fixture
def edited(ball):
    """A ball of water that was made rough."""
    material = nd.assign(ball, "water")
    material.node_tree.nodes[NODE].inputs["Roughness"].default_value = 0.3
    return material


@pytest.fixture
def ball():
    return add_active_ball()


@pytest.fixture
def draw():
    return draw_popover


def test_a_preset_whose_material_was_edited_gives_a_clean_copy_and_names_both(edited, ball):
    said = run_assign(preset="water")
    assert ball.active_material != edited
    assert preset_materials.is_preset(ball.active_material, presets.load_preset("water"))
    assert "'Water' was edited, so 'Water.001'" in said[-1]
    assert "Use Edited" in said[-1]


def test_or_the_edited_one_where_the_user_says_so(edited, ball):
    other = add_sphere("Other", 0.5, segments=16)
    ball.select_set(False)
    bpy.context.view_layer.objects.active = other
    other.select_set(True)
    said = run_assign(preset="water", material="EDITED")
    assert other.active_material == edited
    assert "'Water' was edited" in said[-1]
    assert len(bpy.data.materials) == 1


def test_a_material_that_is_as_the_preset_has_it_is_no_edited_one(ball):
    nd.assign(ball, "water")
    said = run_assign(preset="water", material="EDITED")
    assert said == ["Water assigned to Ball"]
    assert preset_materials.edited_material(presets.load_preset("water")) is None


def run_assign(**keywords) -> list[str]:
    """Run the operator; what it reports."""
    said = []
    operator = SimpleNamespace(
        material="CLEAN",
        depth="FIT",
        report=lambda kind, text: said.append(text),
        properties=SimpleNamespace(is_property_set=lambda name: False),
    )
    vars(operator).update(keywords)
    assert preset_operators.AssignPreset.execute(operator, bpy.context) == {"FINISHED"}
    return said


def test_the_choice_is_not_kept_for_the_next_time(edited, ball):
    call("assign_preset", preset="water", material="EDITED")
    assert ball.active_material == edited
    call("assign_preset", preset="water")
    assert ball.active_material != edited


def test_the_depth_is_that_of_the_object_or_as_measured_as_the_user_says(ball, folder):
    save_wine(folder)
    call("assign_preset", preset="my_wine", depth="MEASURED")
    assert depth(ball) == pytest.approx(0.05)
    call("assign_preset", preset="my_wine")
    assert depth(ball) == pytest.approx(2 / 3, rel=0.05)
    bpy.ops.ed.undo_push(message="wine")
    call("fit_depth", "EXEC_DEFAULT", True, depth="MEASURED")
    ball = bpy.data.objects["Ball"]
    assert depth(ball) == pytest.approx(0.05)
    ball.scale = (2.0, 2.0, 2.0)
    call("fit_depth", "EXEC_DEFAULT", True, depth="FIT")
    assert depth(ball) == pytest.approx(4 / 3, rel=0.05)
    bpy.ops.ed.undo()
    assert depth(bpy.data.objects["Ball"]) == pytest.approx(0.05)


def test_fitting_says_why_it_cannot(ball):
    assert not bpy.ops.nested_dielectric.fit_depth.poll()
    material = nd.assign(ball, "water")
    del material[new_materials.KEY_PROPERTY]
    with pytest.raises(RuntimeError, match="'Water' knows no preset"):
        call("fit_depth", depth="MEASURED")
    ball.data.clear_geometry()
    with pytest.raises(RuntimeError, match="'Ball' has no thickness"):
        call("fit_depth", depth="FIT")


def depth(obj) -> float:
    return obj.active_material.node_tree.nodes[NODE].inputs["Transmittance Depth"].default_value


def buttons(drawn) -> list[str]:
    return [keywords["text"] for name, arguments, keywords in drawn if name == "operator" and "assign" in arguments[0]]


def test_the_popover_shows_the_presets_of_a_group_each_with_a_picture(draw):
    groups = preset_library.catalogue().groups()
    for group, members in groups.items():
        drawn = draw(group)
        assert buttons(drawn) == [preset.name for preset in members]
        assert len([name for name, *_ in drawn if name == "template_icon"]) == len(members)
        assert [arguments[2] for name, arguments, _ in drawn if name == "prop_enum"] == [*groups, "My Presets"]


def test_words_find_presets_of_all_groups_by_name_tag_and_description(draw, folder):
    save_wine(folder)
    assert buttons(draw(search="HomeMade")) == ["My Wine"]
    assert "Diamond" in buttons(draw(search="gem fire"))
    assert not buttons(draw(search="no such thing"))
    assert buttons(draw("Drinks")).count("My Wine") == 1


def test_only_the_users_presets_can_be_changed(draw, folder):
    save_wine(folder)
    drawn = draw("Drinks")
    assert [a[0] for n, a, _ in drawn if n == "operator" and a[0].endswith(("rename_preset", "delete_preset"))] == [
        "nested_dielectric.rename_preset",
        "nested_dielectric.delete_preset",
    ]
    assert not [a for n, a, _ in draw("Glass") if n == "operator" and a[0].endswith("delete_preset")]


def test_the_object_menu_leads_to_every_group_that_has_presets_and_is_far_from_delete(draw, folder):
    first = bpy.types.VIEW3D_MT_object._dyn_ui_initialize()
    assert first.index(object_menu.draw_entry) == 0
    menus = [arguments[0] for name, arguments, _ in draw(cls=preset_menus.PresetMenu) if name == "menu"]
    groups = list(preset_library.catalogue().groups())
    assert [getattr(bpy.types, menu).bl_label for menu in menus] == groups
    save_wine(folder)
    for menu in preset_menus.GROUP_MENUS:
        wanted = preset_library.catalogue().groups().get(menu.bl_label, [])
        assert buttons(draw(cls=menu)) == [preset.name for preset in wanted]


def test_menus_hold_every_operator_that_needs_no_row_of_a_list_so_that_searching_finds_it(draw):
    drawn = [arguments[0] for name, arguments, _ in draw(cls=object_menu.ObjectMenu) if name.startswith("operator")]
    elsewhere = {"nested_dielectric.assign_preset", "nested_dielectric.add_node"}
    operators = [cls for cls in registration.CLASSES if issubclass(cls, bpy.types.Operator)]
    assert set(drawn) | elsewhere == {cls.bl_idname for cls in operators if "INTERNAL" not in cls.bl_options}


def test_presets_are_found_by_their_tags_in_the_search_and_keep_their_numbers(folder):
    before = {item[0]: item for item in preset_pictures.searched_items()}
    assert "jewel" in before["diamond"][1]
    save_wine(folder)
    after = {item[0]: item for item in preset_pictures.searched_items()}
    assert all(after[key][4] == item[4] for key, item in before.items())
    assert [item[0] for item in preset_pictures.own_items()] == ["my_wine"]


def test_every_preset_has_a_picture_rendered_or_drawn(folder):
    wine = save_wine(folder)
    for preset in preset_library.catalogue().presets.values():
        preset_pictures.picture(preset)  # which has no number in a Blender without a window
    shown = pictures._pictures
    assert shown.keys() >= set(presets.preset_names())
    drawn = np.empty(4 * preset_pictures.DRAWN_SIZE**2, dtype=np.float32)
    shown[f"colour {tuple(wine.parameters['transmittance'])}"].image_pixels_float.foreach_get(drawn)
    red, green, _, alpha = drawn.reshape(preset_pictures.DRAWN_SIZE, -1, 4)[40, 48]
    assert red > 2.0 * green and alpha == 1.0


def test_every_setting_has_a_tooltip_without_a_full_stop():
    classes = (
        preferences.Preferences,
        *preset_operators.CLASSES,
        *own_preset_operators.CLASSES,
        preset_menus.NestedDielectricPresetChoice,
    )
    for cls in classes:
        for name, prop in cls.__annotations__.items():
            words = prop.keywords
            if "HIDDEN" not in words.get("options", ()):
                assert words["description"] and not words["description"].endswith("."), (cls, name)


def test_every_operator_can_be_undone_but_those_that_change_files_the_clipboard_or_what_a_list_shows():
    kept = {"save_preset", "rename_preset", "delete_preset", "open_material", "copy_faults"}
    for cls in registration.CLASSES:
        if issubclass(cls, bpy.types.Operator):
            assert ("UNDO" in cls.bl_options) == (cls.bl_idname.partition(".")[2] not in kept), cls.bl_idname
