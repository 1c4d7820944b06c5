"""The asset library: what it holds, what an append of it brings, and how Blender comes to list it."""

import importlib.util
import json
import re
import sys

import bpy
import numpy as np
import pytest
from dropped_media import ROOT, append, build_library
from scenes import add_sphere, new_scene

import nested_dielectric as nd
from nested_dielectric.model.parameter import GROUP_NAME
from nested_dielectric.model.presets import GROUPS, load_preset, preset_names
from nested_dielectric.nodes.material_version import find_group, group_version
from nested_dielectric.scene import materials, shapes
from nested_dielectric.scene.new_materials import KEY_PROPERTY
from nested_dielectric.scene.preset_materials import is_preset
from nested_dielectric.ui import asset_library, preferences
from nested_dielectric.ui.presets import dropped
from nested_dielectric.ui.presets.preset_pictures import picture_path


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return build_library(tmp_path_factory.mktemp("assets"))


def module(name: str):
    """One of the scripts in presets/assets."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "presets" / "assets" / f"{name}.py")
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


def test_the_library_holds_every_preset_once_with_its_catalogue_tags_licence_and_priority(library):
    new_scene()
    with bpy.data.libraries.load(str(library / asset_library.FILE.name), assets_only=True) as (held, loaded):
        loaded.materials = held.materials
    presets = {preset.name: preset for preset in map(load_preset, preset_names())}
    assert {material.name for material in loaded.materials} == presets.keys()
    catalogues = dict(
        line.split(":")[:2] for line in (library / "blender_assets.cats.txt").read_text().splitlines() if ":" in line
    )
    paths = ["Nested Dielectric", *(f"Nested Dielectric/{group}" for group in GROUPS)]
    assert sorted(catalogues.values()) == sorted(paths)
    for material in loaded.materials:
        preset, data = presets[material.name], material.asset_data
        assert catalogues[data.catalog_id] == f"Nested Dielectric/{preset.group}"
        assert set(preset.tags) <= {tag.name for tag in data.tags}
        assert (data.license, data.author) == ("CC0-1.0", "Nested Dielectric developers")
        assert preset.description in data.description
        assert is_preset(material, preset), material.name
        pixels = np.empty(4 * np.prod(material.preview.image_size), dtype=np.float32)
        material.preview.image_pixels_float.foreach_get(pixels)
        assert pixels.std() > 0.05
    assert len({material.node_tree.nodes["Nested Dielectric"].node_tree for material in loaded.materials}) == 1


def test_the_library_stays_small(library):
    """Ten times as many media as there were in the first one stay below 25 MB, what the zip has room for."""
    size = (library / asset_library.FILE.name).stat().st_size
    assert size < 400_000 * len(preset_names())


def test_what_is_dragged_from_the_library_is_a_medium_of_one_group_with_its_priority(library, registered, capfd):
    materials = append(library, "Water", "Diamond")
    groups = [tree for tree in bpy.data.node_groups if tree.name.startswith(GROUP_NAME)]
    assert [tree.name for tree in groups if group_version(tree)] == ["Nested Dielectric"]
    kept = (*bpy.data.texts, *bpy.data.node_groups, *bpy.data.images, *bpy.data.materials)
    assert not [data.name for data in kept if re.search(r"\.\d{3}$", data.name)]
    assert not [data.name for data in kept if data.library]
    for key, material in zip(("water", "diamond"), materials):
        ball = add_sphere(key, 1.0, material)
        assert nd.get_priority(ball) == load_preset(key).parameters["priority"]
        assert material[KEY_PROPERTY] == key
        assert material.node_tree.nodes["Nested Dielectric"].node_tree == find_group()
    assert not [each for each in nd.prepare(bpy.context.scene).problems if "version" in str(each)]
    assert "Error" not in "".join(capfd.readouterr())


@pytest.fixture
def libraries(library, monkeypatch):
    """Blender's list of libraries, and the built one in place of that of the extension."""
    monkeypatch.setattr(asset_library, "FOLDER", library)
    monkeypatch.setattr(asset_library, "FILE", library / asset_library.FILE.name)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    listed = bpy.context.preferences.filepaths.asset_libraries
    before = {each.name: each.path for each in listed}
    yield listed
    nd.unregister()
    assert {each.name: each.path for each in listed} == before


def test_the_library_is_listed_while_the_extension_is_registered_and_never_twice(libraries, library):
    nd.register()
    ours = [each for each in libraries if each.path == str(library)]
    assert [(each.name, each.import_method) for each in ours] == [("Nested Dielectric", "APPEND")]
    nd.unregister()
    assert not [each for each in libraries if each.path == str(library)]
    libraries.new(name="Nested Dielectric", directory=str(library))  # as saved preferences bring it
    nd.register()
    nd.register()
    assert len([each for each in libraries if each.path == str(library)]) == 1


def test_a_library_that_another_installation_left_is_taken_over_and_the_users_are_not(libraries, library, tmp_path):
    libraries.new(name="Nested Dielectric", directory=str(tmp_path))
    libraries.new(name="Nested Dielectric", directory=str(tmp_path / "gone" / "nested_dielectric" / "library"))
    mine = sorted((each.name, each.path) for each in libraries if each.path == str(tmp_path))
    nd.register()
    assert len([each for each in libraries if each.path.endswith("library")]) == 1
    nd.unregister()
    assert sorted((each.name, each.path) for each in libraries if each.path == str(tmp_path)) == mine
    for each in [each for each in libraries if each.path == str(tmp_path)]:
        libraries.remove(each)


def test_the_preferences_take_the_library_out_and_put_it_back(libraries, library):
    addon = bpy.context.preferences.addons.new()
    addon.module = preferences.PACKAGE
    try:
        nd.register()
        addon.preferences.asset_library = False
        assert str(library) not in [each.path for each in libraries]
        nd.unregister()
        nd.register()
        assert str(library) not in [each.path for each in libraries]
        addon.preferences.asset_library = True
        assert [each.path for each in libraries].count(str(library)) == 1
    finally:
        nd.unregister()
        bpy.context.preferences.addons.remove(addon)


def test_without_a_library_none_is_listed(libraries, monkeypatch, tmp_path):
    monkeypatch.setattr(asset_library, "FILE", tmp_path / "nothing.blend")
    before = len(libraries)
    nd.register()
    assert len(libraries) == before
    assert not asset_library.is_there()


def test_a_preview_is_a_small_picture_of_what_its_preset_is_now():
    previews = module("previews")
    for key in preset_names():
        path = picture_path(key)
        assert previews.shown_digest(path) == previews.digest(load_preset(key)), f"{key}: run make assets"
        assert previews.oiio.ImageBuf(str(path)).spec().width == previews.SIZE
    assert sum(picture_path(key).stat().st_size for key in preset_names()) < 1.5e6
    known = {picture_path(key).name for key in preset_names()}
    assert not [path.name for path in picture_path("any").parent.iterdir() if path.name not in known]


def test_every_preset_suits_a_scene_and_another_value_asks_for_another_preview():
    previews = module("previews")
    scenes = sys.modules["preview_scenes"]
    for key in preset_names():
        assert scenes.kind_of(load_preset(key)) in scenes._KINDS
    water = load_preset("water")
    digest = previews.digest(water)
    assert digest == previews.digest(load_preset("water"))
    changed = json.loads(json.dumps(water.parameters)) | {"roughness": 0.1}
    assert previews.digest(type(water)(**(vars(water) | {"parameters": changed}))) != digest


def test_a_brilliant_is_a_closed_body_of_58_facets_and_a_girdle():
    module("previews")
    new_scene()
    mesh = sys.modules["preview_scenes"].brilliant()
    girdle = [face for face in mesh.polygons if abs(face.normal.z) < 1e-3]
    assert len(mesh.polygons) - len(girdle) == 57  # without a culet


def test_a_medium_that_is_dragged_onto_an_object_has_its_colour_at_that_objects_thickness(library, registered):
    """Without a window Blender runs no timers: the test calls what the timer would."""
    file = next(library.glob("*.blend"))

    def drop(name, obj):
        bpy.ops.wm.append(directory=f"{file}/Material/", filename=name)
        assert dropped._appended and bpy.app.timers.is_registered(dropped.fit_appended)
        obj.data.materials.append(bpy.data.materials[name])
        dropped.fit_appended()
        return materials.dielectric_node(bpy.data.materials[name]).inputs["Transmittance Depth"].default_value

    bpy.ops.mesh.primitive_cube_add(size=3.0)
    assert (
        drop("Whisky", bpy.context.object) == pytest.approx(shapes.thickness(bpy.context.object)) == pytest.approx(2.0)
    )
    assert drop("Water", bpy.context.object) == 1.0  # clear
    bpy.ops.wm.append(directory=f"{file}/Material/", filename="Red Wine")
    dropped.fit_appended()  # nobody has it
    wine = materials.dielectric_node(bpy.data.materials["Red Wine"])
    assert wine.inputs["Transmittance Depth"].default_value == pytest.approx(0.07)


def test_what_an_artists_own_objects_bring_keeps_its_depth(tmp_path, registered):
    bpy.ops.mesh.primitive_cube_add(size=3.0)
    bpy.context.object.name = "Brought"
    nd.assign(bpy.context.object, nd.new_material("Own", preset="whisky"))
    file = tmp_path / "own.blend"
    bpy.data.libraries.write(str(file), {bpy.context.object})
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.append(directory=f"{file}/Object/", filename="Brought")
    assert not dropped._appended
