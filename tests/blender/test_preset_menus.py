"""Presets in Blender's window: menus, what is said of an edited material, and presets of the user's own."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from scenes import add_sphere, new_scene

import nested_dielectric as nd
from nested_dielectric import cli, registration
from nested_dielectric.model import presets
from nested_dielectric.model.parameters import ParameterError
from nested_dielectric.scene import materials, preset_library, preset_materials
from nested_dielectric.ui import object_menu, preferences
from nested_dielectric.ui.presets import preset_menus, preset_operators, preset_pictures

pytestmark = pytest.mark.quick

NODE = "Nested Dielectric"
SAVE, RENAME, DELETE = (f"{word}_preset" for word in ("save", "rename", "delete"))


@pytest.fixture(autouse=True)
def folder(monkeypatch, tmp_path):
    """The user's folder, which is not there yet; the extension is registered in an empty scene."""
    path = tmp_path / "mine"
    monkeypatch.setattr(preset_library, "user_folder", lambda: path)
    for module in (preset_operators, preferences):
        if hasattr(module, "user_folder"):
            monkeypatch.setattr(module, "user_folder", lambda: path)
    new_scene()
    nd.register()
    yield path
    nd.unregister()


@pytest.fixture
def ball():
    obj = add_sphere("Ball", 0.5, segments=16)
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    return obj


def call(operator: str, /, *arguments, **keywords):
    return getattr(bpy.ops.nested_dielectric, operator)(*arguments, **keywords)


# An edited material ---------------------------------------------------------------------------------------------------


@pytest.fixture
def edited(ball):
    """A ball of water that was made rough."""
    material = nd.assign(ball, "water")
    material.node_tree.nodes[NODE].inputs["Roughness"].default_value = 0.3
    return material


def test_a_preset_whose_material_was_edited_gives_a_clean_copy_and_names_both(edited, ball):
    said = run_assign(preset="water")
    assert ball.active_material != edited
    assert materials.is_preset(ball.active_material, presets.load_preset("water"))
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
    del material[materials.KEY_PROPERTY]
    with pytest.raises(RuntimeError, match="'Water' knows no preset"):
        call("fit_depth", depth="MEASURED")
    ball.data.clear_geometry()
    with pytest.raises(RuntimeError, match="'Ball' has no thickness"):
        call("fit_depth", depth="FIT")


def depth(obj) -> float:
    return obj.active_material.node_tree.nodes[NODE].inputs["Transmittance Depth"].default_value


# Presets of the user's ------------------------------------------------------------------------------------------------


def save_wine(folder):
    wine = presets.Preset(
        "my_wine", "My Wine", "Drinks", ("red", "homemade"), "Red.", "Invented.",
        {"ior": 1.34, "transmittance": [0.6, 0.1, 0.15], "transmittance_depth": 0.05, "priority": 20},
    )  # fmt: skip
    presets.save_preset(wine, folder)
    return wine


def test_a_saved_medium_comes_back_as_it_was(ball, folder):
    bpy.context.scene.unit_settings.scale_length = 0.01
    made = nd.new_material(
        'Blue "Glass"',
        ior=1.62,
        transmittance=(0.2, 0.4, 0.9),
        transmittance_depth=7.0,
        roughness=0.05,
        disperse=True,
        abbe=33.3,
        shadow_mode="BLACK",
        internal_reflections=False,
        spectral_distribution="LED",
        priority=7,
    )
    nd.assign(ball, made)
    call(SAVE, name='Blue "Glass" é', group="Glass", tags="cobalt,  blue , cobalt", text="As blue as\nit gets.")
    (path,) = folder.iterdir()
    assert path.name == "blue_glass_é.toml"
    preset = preset_library.load_preset("blue_glass_é")
    assert (preset.name, preset.group, preset.tags) == ('Blue "Glass" é', "Glass", ("cobalt", "blue"))
    assert preset.depth == pytest.approx(0.07)
    again = nd.new_material("Again", preset="blue_glass_é")
    assert materials.is_preset(again, preset) and materials.is_preset(made, preset)
    assert again.node_tree.nodes[NODE].inputs["Transmittance Depth"].default_value == pytest.approx(7.0)
    assert nd.preset_names() == tuple(sorted(nd.preset_names())) and "blue_glass_é" in nd.preset_names()


@pytest.mark.parametrize("space", ["Linear Rec.709", "ACEScg"])
def test_every_preset_survives_being_saved(ball, folder, space):
    bpy.ops.wm.set_working_color_space(convert_colors=False, working_space=space)
    for key in presets.preset_names():
        material = nd.new_material("Any", preset=key)
        saved = preset_materials.preset_from(material, f"My {key}", "Glass", (), "")
        presets.save_preset(saved, folder)
        assert materials.is_preset(material, presets.load_preset(saved.key, folder)), key
    bpy.ops.wm.set_working_color_space(convert_colors=False, working_space="Linear Rec.709")


@pytest.mark.parametrize(
    "name, key",
    [("Red Wine", "red_wine"), ("../../etc/passwd", "etc_passwd"), ("C:\\NUL", "c_nul"), ("nul", "nul_preset"),
     ("赤ワイン", "赤ワイン"), ("  a.b  ", "a_b"), ("x" * 300, "x" * presets.LONGEST_KEY)],
)  # fmt: skip
def test_no_name_leads_out_of_the_folder(name, key):
    assert presets.key_of(name) == key


def test_names_that_are_taken_or_none_are_refused_and_nothing_is_written(ball, folder):
    nd.assign(ball, "ice")
    for name, words in (("Water", "'Water' is a preset of"), ("water!", "extension's"), ("BK7 glass", "extension's")):
        with pytest.raises(RuntimeError, match=words):
            call(SAVE, name=name)
    with pytest.raises(RuntimeError, match="a letter"):
        call(SAVE, name="?")
    assert not folder.exists()


def test_the_dialog_begins_with_a_free_name_and_what_the_preset_says_of_itself(ball, monkeypatch):
    nd.assign(ball, "diamond")
    operator = SimpleNamespace(name="", group="", tags="", text="")
    opened = []
    manager = SimpleNamespace(invoke_props_dialog=lambda *_, **keywords: opened.append(keywords))
    context = SimpleNamespace(object=ball, window_manager=manager)
    preset_operators.SavePreset.invoke(operator, context, None)
    assert (operator.name, operator.group) == ("My Diamond", "Gems and Crystals")
    assert "jewel" in operator.tags and opened


def test_what_other_nodes_make_is_named_when_a_preset_is_saved(ball, capfd):
    material = nd.new_material("Coated")
    nd.assign(ball, material)
    tree = material.node_tree
    value = tree.nodes.new("ShaderNodeMath")
    tree.links.new(value.outputs[0], tree.nodes[NODE].inputs["Roughness"])
    call(SAVE, name="Coated")
    assert "'Coated': other nodes make Roughness" in "".join(capfd.readouterr())


def test_a_file_of_the_users_that_is_called_as_a_built_in_preset_does_not_take_its_place(folder):
    (folder / "x").mkdir(parents=True)
    presets.save_preset(presets.Preset("water", "Wine", "Drinks", (), "", "", {"ior": 2.0}), folder)
    found = preset_library.catalogue()
    assert found.presets["water"].name == "Water" and not found.own
    assert "water.toml" in found.problems[0] and "rename" in found.problems[0]
    assert preset_library.load_preset("water").parameters["ior"] == pytest.approx(1.3334033)


def test_saving_again_replaces_and_a_full_disk_leaves_the_old(ball, folder, monkeypatch):
    nd.assign(ball, nd.new_material("M", ior=1.4))
    call(SAVE, name="Mine")
    nd.assign(ball, nd.new_material("M", ior=1.6))
    call(SAVE, name="mine")
    assert preset_library.load_preset("mine").parameters["ior"] == 1.6
    before = (folder / "mine.toml").read_bytes()

    def fail(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("nested_dielectric.model.files.os.fsync", fail)
    with pytest.raises(RuntimeError, match="No space left"):
        call(SAVE, name="mine")
    assert [path.name for path in folder.iterdir()] == ["mine.toml"]
    assert (folder / "mine.toml").read_bytes() == before


def test_a_preset_of_the_users_is_renamed_and_deleted_and_built_in_ones_are_not(folder):
    save_wine(folder)
    call(RENAME, preset="my_wine", name="House Wine")
    assert [path.name for path in folder.iterdir()] == ["house_wine.toml"]
    assert preset_library.load_preset("house_wine").name == "House Wine"
    assert preset_library.load_preset("house_wine").tags == ("red", "homemade")
    save_wine(folder)
    for name, words in (("House wine", "another preset of yours"), ("Water", "extension's"), ("", "a letter")):
        with pytest.raises(RuntimeError, match=words):
            call(RENAME, "EXEC_DEFAULT", preset="my_wine", name=name)
    call(RENAME, preset="my_wine", name="MY WINE")
    assert preset_library.load_preset("my_wine").name == "MY WINE"
    call(DELETE, preset="house_wine")
    assert [path.name for path in folder.iterdir()] == ["my_wine.toml"]
    with pytest.raises(TypeError):
        call(DELETE, preset="water")
    with pytest.raises(ParameterError, match="no preset of yours"):
        preset_library.delete_user_preset("../../presets/water")
    call(DELETE, preset="my_wine")
    assert not bpy.ops.nested_dielectric.delete_preset.poll()


@pytest.mark.parametrize(
    "text, words",
    [("nonsense", "Expected"), ('name = "X"', "'group' is missing"),
     ('name = 3\ngroup="G"\ntags=[]\ndescription=""\nsource=""\n[parameters]\n', "name must be a text"),
     ('name = "X"\ngroup="G"\ntags=["a", 1]\ndescription=""\nsource=""\n[parameters]\n', "list of words"),
     ('name = "X"\ngroup="G"\ntags=[]\ndescription=""\nsource=""\n[parameters]\nior = "high"\n', "ior"),
     ('name = "X"\ngroup="G"\ntags=[]\ndescription=""\nsource=""\nparameters = 3\n', "parameters")],
)  # fmt: skip
def test_a_wrong_file_of_the_users_is_named_with_the_remedy_and_the_menu_goes_on(text, words, folder, draw):
    save_wine(folder)
    (folder / "bad.toml").write_text(text)
    found = preset_library.catalogue()
    assert words in found.problems[0] and "bad.toml" in found.problems[0] and "correct the file" in found.problems[0]
    assert "my_wine" in nd.preset_names() and "bad" not in nd.preset_names()
    with pytest.raises(ParameterError, match="bad.toml"):
        preset_library.load_preset("bad")
    labels = " ".join(keywords.get("text", "") for name, _, keywords in draw("Drinks") if name == "label")
    assert "bad.toml" in labels.replace(" ", "")


def test_the_command_line_lists_the_users_presets_and_names_wrong_files(folder, capsys):
    save_wine(folder)
    (folder / "bad.toml").write_text("nonsense")
    assert cli.main(["presets"]) == 0
    printed = capsys.readouterr()
    (line,) = [line for line in printed.out.splitlines() if line.startswith("my_wine ")]
    assert line.endswith("Red. (yours)")
    assert "bad.toml" in printed.err and "correct the file" in printed.err


def test_presets_that_come_and_go_are_seen_at_once(folder):
    before = nd.preset_names()
    save_wine(folder)
    assert set(nd.preset_names()) - set(before) == {"my_wine"}
    (folder / "my_wine.toml").unlink()
    assert nd.preset_names() == before


# Menus ----------------------------------------------------------------------------------------------------------------


@pytest.fixture
def draw():
    """Draw the popover with a group or words; what it draws, as names, arguments and keywords."""

    class Layout:
        def __init__(self, drawn):
            self.__dict__["drawn"] = drawn

        def __getattr__(self, name):
            def call(*arguments, **keywords):
                self.drawn.append((name, arguments, keywords))
                return Layout(self.drawn)

            return call

        def __setattr__(self, name, value):
            self.drawn.append((name, (value,), {}))

    def draw(group="Glass", search="", cls=preset_menus.PresetPopover):
        state = bpy.context.window_manager.nested_dielectric_presets
        state.group, state.search = group, search
        drawn = []
        cls.draw(SimpleNamespace(layout=Layout(drawn), bl_label=getattr(cls, "bl_label", "")), bpy.context)
        return drawn

    return draw


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
    shown = preset_pictures._pictures
    assert shown.keys() >= set(presets.preset_names())
    drawn = np.empty(4 * preset_pictures.DRAWN_SIZE**2, dtype=np.float32)
    shown[f"colour {tuple(wine.parameters['transmittance'])}"].image_pixels_float.foreach_get(drawn)
    red, green, _, alpha = drawn.reshape(preset_pictures.DRAWN_SIZE, -1, 4)[40, 48]
    assert red > 2.0 * green and alpha == 1.0


# Preferences ----------------------------------------------------------------------------------------------------------


def test_the_users_folder_is_blenders_for_the_user_unless_the_preferences_name_another(monkeypatch, tmp_path):
    monkeypatch.undo()
    assert "nested_dielectric" in str(preset_library.user_folder())
    assert str(preset_library.user_folder()).startswith(bpy.utils.resource_path("USER"))
    addon = bpy.context.preferences.addons.new()
    addon.module = preset_library.PACKAGE
    try:
        addon.preferences.preset_folder = str(tmp_path)
        assert preset_library.user_folder() == tmp_path
        assert preferences.preference("depth") == "FIT"
        addon.preferences.depth = "MEASURED"
        assert preferences.preference("depth") == "MEASURED"
    finally:
        bpy.context.preferences.addons.remove(addon)
    assert preferences.preference("depth") == "FIT"
    assert preferences.website().startswith("https://")


def test_every_setting_has_a_tooltip_without_a_full_stop():
    classes = (preferences.Preferences, *preset_operators.CLASSES, preset_menus.NestedDielectricPresetChoice)
    for cls in classes:
        for name, prop in cls.__annotations__.items():
            words = prop.keywords
            if "HIDDEN" not in words.get("options", ()):
                assert words["description"] and not words["description"].endswith("."), (cls, name)


def test_every_operator_can_be_undone_but_those_that_change_files_or_what_a_list_shows():
    kept = {"save_preset", "rename_preset", "delete_preset", "open_material"}
    for cls in registration.CLASSES:
        if issubclass(cls, bpy.types.Operator):
            assert ("UNDO" in cls.bl_options) == (cls.bl_idname.partition(".")[2] not in kept), cls.bl_idname
