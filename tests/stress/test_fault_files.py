"""What lies in files beside the scene may be damaged or gone: presets, pictures, tables, the asset library, older files."""

import os
import random
import shutil

import bpy
import numpy as np
import pytest
from released_files import FILES
from scenes import add_box, new_scene
from storms import raised_by_handlers

import nested_dielectric as nd
from nested_dielectric import cli
from nested_dielectric.analysis.surroundings import clear_analysis
from nested_dielectric.model import presets
from nested_dielectric.model.spectral_tables import spectral_table
from nested_dielectric.nodes.material_version import find_group
from nested_dielectric.nodes.spectral_tables import uses_table
from nested_dielectric.preparation import prepare_scene, render_handlers
from nested_dielectric.scene import preset_library
from nested_dielectric.ui import asset_library
from nested_dielectric.ui.presets import preset_pictures

EVERYTHING = "ND_STRESS" in os.environ
WATER = (presets.PRESET_FOLDER / "water.toml").read_text(encoding="utf-8")

DAMAGED = {
    "empty": "",
    "null": "\0",
    "half": WATER[: len(WATER) // 2],
    "deep": "a = " + "[" * 100_000,
    "nested": "[parameters]\n" + ".".join(["a"] * 5000) + " = 1\n",
    "list": WATER.replace("ior = ", "ior = [1, {a = 1}] # "),
    "date": WATER.replace("ior = ", "ior = 1979-05-27 # "),
    "infinite": WATER.replace("ior = ", "ior = inf # "),
    "huge": WATER.replace("ior = ", f"ior = {'9' * 4000} # "),
    "nameless": WATER.replace('name = "Water"', 'name = ""'),
    "tags": WATER.replace("tags = [", "tags = [[1], "),
}


@pytest.mark.always
def test_damaged_presets_of_the_users_are_named_and_keep_no_others_away(preset_folder, registered):
    preset_folder.mkdir()
    for key, text in DAMAGED.items():
        (preset_folder / f"{key}.toml").write_text(text, encoding="utf-8")
    (preset_folder / "binary.toml").write_bytes(b"\xff\xfe\0")
    (preset_folder / "folder.toml").mkdir()
    (preset_folder / "link.toml").symlink_to(preset_folder / "gone")
    (preset_folder / "loop.toml").symlink_to(preset_folder / "loop.toml")
    (preset_folder / ".#mine.toml").symlink_to("somebody@edits.it")  # as Emacs locks a file
    (preset_folder / "mine.toml").write_text(
        WATER.replace('name = "Water"', 'name = "Wa\\nter \\" 💧"'), encoding="utf-8"
    )
    found = preset_library.catalogue()
    assert found.own == {"mine"} and len(found.presets) > 50
    assert len(found.problems) == len(DAMAGED) + 4
    assert len(preset_pictures.items()) == len(preset_pictures.searched_items()) == len(found.presets)
    (preset_folder / "more.toml").write_text(WATER.replace('name = "Water"', 'name = "More"'), encoding="utf-8")
    assert preset_library.catalogue().own == {"mine", "more"}


@pytest.mark.always
def test_a_damaged_preset_of_the_extensions_is_named_and_keeps_no_others_away(
    tmp_path, preset_folder, monkeypatch, capsys
):
    copy = tmp_path / "presets"
    shutil.copytree(presets.PRESET_FOLDER, copy, ignore=shutil.ignore_patterns("*.py", "assets", "build", "previews"))
    (copy / "water.toml").write_text(WATER[:100], encoding="utf-8")
    monkeypatch.setattr(preset_library, "PRESET_FOLDER", copy)
    found = preset_library.catalogue()
    assert "water" not in found.presets and "glass" in found.presets
    assert len(found.problems) == 1 and "install the extension again" in found.problems[0]
    assert cli.main(["presets"]) == 0 and "water.toml" in capsys.readouterr().err
    shutil.rmtree(copy)
    assert preset_library.catalogue().presets == {} and cli.main(["presets"]) == 0


@pytest.mark.always
def test_damaged_pictures_and_a_damaged_asset_library_keep_nothing_away(tmp_path, monkeypatch):
    new_scene()
    shown = tmp_path / "library"
    shown.mkdir()
    (shown / "nested_dielectric.blend").write_bytes(b"BLENDER junk")
    monkeypatch.setattr(asset_library, "FOLDER", shown)
    monkeypatch.setattr(asset_library, "FILE", shown / "nested_dielectric.blend")
    picture = tmp_path / "water.jpg"
    picture.write_bytes(b"\xff\xd8\xff\xe0 junk")
    monkeypatch.setattr(preset_pictures, "picture_path", lambda key: picture)
    libraries = bpy.context.preferences.filepaths.asset_libraries
    before = [library.name for library in libraries]
    nd.register()
    try:
        asset_library.follow(True)
        assert [library.name for library in libraries] == [*before, "Nested Dielectric"]
        (shown / "nested_dielectric.blend").unlink()
        asset_library.follow(True)
        assert [library.name for library in libraries] == before
        assert len(preset_pictures.items()) > 50
    finally:
        nd.unregister()
    assert [library.name for library in libraries] == before


def lose(image: bpy.types.Image) -> None:
    image.unpack(method="REMOVE")
    image.source = "FILE"
    image.filepath = "//gone.exr"
    image.reload()


TABLES = {
    "lost with its file": lose,
    "no numbers": lambda image: image.pixels.foreach_set(np.full(len(image.pixels), np.nan, np.float32)),
    "infinite": lambda image: image.pixels.foreach_set(np.full(len(image.pixels), np.inf, np.float32)),
    "another size": lambda image: image.scale(3, 3),
    "a colour space": lambda image: setattr(image.colorspace_settings, "name", "sRGB"),
    "made up": lambda image: setattr(image, "source", "GENERATED"),
    "a film": lambda image: setattr(image, "source", "MOVIE"),
    "tiled": lambda image: setattr(image, "source", "TILED"),
    "its alpha": lambda image: setattr(image, "alpha_mode", "NONE"),
}


@pytest.mark.always
def test_a_damaged_image_of_spectral_tables_is_made_anew(registered, tmp_path):
    scene = bpy.context.scene
    add_box("Prism", (-1, -1, -1), (1, 1, 1), nd.new_material("Prism", preset="bk7", disperse=True))
    nd.prepare(scene)
    for what, damage in TABLES.items():
        with raised_by_handlers() as raised:
            damage(find_group().nodes["Spectral Tables"].image)
            bpy.context.view_layer.update()
            bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "x.blend"), copy=True)
            nd.prepare(scene)
        assert raised == [], what
        node = bpy.data.materials["Prism"].node_tree.nodes["Nested Dielectric"]
        assert uses_table(node, spectral_table(gamut="REC709")) and node.node_tree == find_group(), what
        assert nd.prepare(scene).changes == (), what


@pytest.mark.always
@pytest.mark.parametrize("path", sorted(FILES.glob("released_*.blend")), ids=lambda path: path.stem)
def test_files_of_older_versions_are_opened_moved_saved_undone_and_prepared(path, registered, tmp_path):
    shutil.copy(path, tmp_path / "old.blend")
    uses = (
        lambda: setattr(bpy.data.objects["Glass"].location, "x", 0.1),
        lambda: bpy.context.scene.frame_set(bpy.context.scene.frame_current + 1),
        lambda: render_handlers.analyse_before_render(bpy.context.scene),
        lambda: bpy.ops.wm.save_mainfile(),
        lambda: (bpy.ops.ed.undo_push(message="a"), bpy.ops.ed.undo_push(message="b"), bpy.ops.ed.undo()),
        lambda: nd.prepare(bpy.context.scene, cut=True),
        lambda: clear_analysis(bpy.context.scene),
        lambda: prepare_scene.put_back(bpy.context.scene),
        lambda: nd.update_materials(),
    )
    for seed in range(10 if EVERYTHING else 1):
        with raised_by_handlers() as raised:
            bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "old.blend"))
            objects = {obj.name for obj in bpy.data.objects}
            for use in random.Random(seed).sample(uses, len(uses)):
                use()
                bpy.context.view_layer.update()
        assert raised == [], seed
        assert objects <= {obj.name for obj in bpy.data.objects}
    with pytest.raises(RuntimeError, match="gone"):
        bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "gone.blend"))
