"""Presets of the user's own are saved, renamed and deleted, and named where they are wrong."""

from types import SimpleNamespace

import bpy
import pytest
from preset_menus import NODE, add_active_ball, call, draw_popover, save_wine

import nested_dielectric as nd
from nested_dielectric import cli
from nested_dielectric.model import presets
from nested_dielectric.model.parameter import ParameterError
from nested_dielectric.scene import preset_library, preset_materials
from nested_dielectric.ui import preferences
from nested_dielectric.ui.presets import own_preset_operators

SAVE, RENAME, DELETE = (f"{word}_preset" for word in ("save", "rename", "delete"))


@pytest.fixture(autouse=True)
def folder(preset_folder, registered):
    return preset_folder


@pytest.fixture
def ball():
    return add_active_ball()


@pytest.fixture
def draw():
    return draw_popover


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
    assert preset_materials.is_preset(again, preset) and preset_materials.is_preset(made, preset)
    assert again.node_tree.nodes[NODE].inputs["Transmittance Depth"].default_value == pytest.approx(7.0)
    assert nd.preset_names() == tuple(sorted(nd.preset_names())) and "blue_glass_é" in nd.preset_names()


@pytest.mark.parametrize("space", ["Linear Rec.709", "ACEScg"])
def test_every_preset_survives_being_saved(ball, folder, space):
    bpy.ops.wm.set_working_color_space(convert_colors=False, working_space=space)
    for key in presets.preset_names():
        material = nd.new_material("Any", preset=key)
        saved = preset_materials.preset_from(material, f"My {key}", "Glass", (), "")
        presets.save_preset(saved, folder)
        assert preset_materials.is_preset(material, presets.load_preset(saved.key, folder)), key
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
    own_preset_operators.SavePreset.invoke(operator, context, None)
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
    with pytest.raises(ParameterError, match=r"bad\.toml"):
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
