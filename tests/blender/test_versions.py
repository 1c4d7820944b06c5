"""Materials of older versions and copies become materials of this version, with all that an artist made of them."""

import subprocess
import sys

import bpy
import numpy as np
import pytest
from released import IORS, NODE, TINT, build_scene
from released_files import FILES, FIRST, FRONT_IOR, open_file
from scenes import add_box, new_scene

import nested_dielectric as nd
from nested_dielectric.checking.version_checks import version_problems
from nested_dielectric.model import shader_source
from nested_dielectric.model.spectral_tables import spectral_table
from nested_dielectric.nodes.animation import curves
from nested_dielectric.nodes.material_version import MATERIAL_VERSION, find_group, group_version
from nested_dielectric.nodes.names import (
    DISPERSER_NODE,
    LIGHTS_NAME,
    LIGHTS_VERSION_PROPERTY,
    OFFSET_GROUP,
    SOURCE_HASH,
    VERSION_PROPERTY,
)
from nested_dielectric.preparation import versions
from nested_dielectric.preparation.offset_modifier import ensure_offset_group
from nested_dielectric.scene.lights import listed_lights, update_lights
from nested_dielectric.scene.material_spectra import material_table

RELEASED = sorted(FILES.glob("released_*.blend"))


@pytest.fixture
def registered():
    """The extension is registered."""
    nd.register()
    yield
    nd.unregister()


def inputs(name: str) -> bpy.types.NodeInputs:
    return bpy.data.materials[name].node_tree.nodes[NODE].inputs


def own_data() -> dict[str, list[str]]:
    """What the extension keeps in a file, by kind; parts of groups, named with a dot, where they are not one of each."""
    trees = [tree for tree in bpy.data.node_groups if tree.name not in PARTS]
    return {
        "groups": sorted(tree.name for tree in trees),
        "texts": sorted(text.name for text in bpy.data.texts),
        "images": sorted(image.name for image in bpy.data.images),
    }


PARTS = {
    f".Nested Dielectric Native {part}".rstrip()
    for part in (
        "",
        "Coefficients",
        "Debug Number",
        "Surroundings",
        "Light",
        "Weights",
        "Tangents",
        "Stretched",
        "Glass",
        "Special",
        "Spread",
        "Dispersing",
        "Preview",
    )
} | {".Nested Dielectric Debug View"}

ONE_OF_EACH = {
    "groups": ["Nested Dielectric", "Nested Dielectric Lights"],
    "texts": ["light.osl", "nested_dielectric.osl", "spectral_coordinate.osl", "volume_mask.osl"],
    "images": ["Nested Dielectric Spectra"],
}


def assert_all_is_kept(scene: bpy.types.Scene) -> None:
    """Everything that `released.build_scene` made is there and works."""
    for frame, ior in IORS.items():
        scene.frame_set(frame)
        assert inputs("Glass")["IOR"].default_value == pytest.approx(ior)
    scene.frame_set(1)
    assert tuple(inputs("Glass")["Transmittance"].default_value)[:3] == pytest.approx(TINT["transmittance"])
    ball = bpy.data.objects["Water"]
    ball["roughness"] = 0.125
    ball.update_tag()
    inputs("Glass")["Transmittance Depth"].default_value = 0.75
    bpy.context.view_layer.update()
    layer = bpy.context.evaluated_depsgraph_get()
    water = bpy.data.materials["Water"].evaluated_get(layer).node_tree.nodes[NODE]
    assert water.inputs["Roughness"].default_value == pytest.approx(0.125)
    assert ball.evaluated_get(layer)["follows"] == pytest.approx(0.75)
    ball["roughness"] = 0.25
    ball.update_tag()
    inputs("Glass")["Transmittance Depth"].default_value = TINT["transmittance_depth"]
    (link,) = inputs("Glass")["Emission at Exits"].links
    assert link.from_node.inputs["Strength"].default_value == 0.125
    expected = spectral_table("FL2", gamut="REC709", clamp_negative=False).astype(np.float32)
    assert np.array_equal(material_table(bpy.data.materials["Prism"]), expected)
    assert inputs("Prism")["Disperse"].default_value and not inputs("Water")["Disperse"].default_value
    assert [light.name for light in listed_lights(bpy.context.scene)] == ["Lamp"]
    assert [nd.get_priority(bpy.data.objects[name]) for name in ("Water", "Glass")] == [1, 2]


@pytest.mark.parametrize("path", RELEASED, ids=lambda path: path.stem)
def test_a_file_of_each_release_is_updated_and_keeps_all(path):
    scene = open_file(path)
    old = path == FIRST
    changes = nd.update_materials()
    assert [f"{name}: was version 1" in changes for name in ("Glass", "Water", "Prism", "Bubble")] == [old] * 4
    assert nd.update_materials() == () and versions.outdated_materials() == []
    assert own_data() == ONE_OF_EACH
    assert_all_is_kept(scene)


@pytest.mark.skipif(not FRONT_IOR, reason="this Blender takes indices as the first release did")
def test_a_file_that_would_be_wrong_here_is_made_right_when_it_is_opened(registered, capfd):
    scene = open_file(FIRST)
    assert versions.outdated_materials() == []
    assert "updated Glass: was version 1" in capfd.readouterr().err
    assert_all_is_kept(scene)


@pytest.mark.skipif(not FRONT_IOR, reason="this Blender takes indices as the first release did")
def test_what_is_appended_from_a_file_that_would_be_wrong_here_is_made_right(registered):
    new_scene()
    with bpy.data.libraries.load(str(FIRST)) as (_, wanted):
        wanted.materials = ["Prism"]
    assert versions.outdated_materials() == [] and find_group().users == 1
    lightless = [name for name in ONE_OF_EACH["texts"] if name != "light.osl"]
    assert own_data() == ONE_OF_EACH | {"texts": lightless}


@pytest.mark.skipif(FRONT_IOR, reason="this Blender takes indices otherwise than the first release did")
def test_a_file_that_is_right_here_is_left_until_the_artist_updates_it(registered):
    open_file(FIRST)
    assert versions.outdated_materials() == ["Bubble", "Glass", "Prism", "Water"]
    assert bpy.ops.nested_dielectric.update_materials() == {"FINISHED"}
    assert versions.outdated_materials() == [] and not bpy.ops.nested_dielectric.update_materials.poll()


@pytest.mark.skipif(not FRONT_IOR, reason="closures of this Blender do not disperse")
def test_a_file_from_a_blender_without_cycles_dispersion_shows_colours_once_it_is_opened(tmp_path, registered):
    new_scene()
    nd.new_material("Prism", disperse=True)
    scale = find_group().nodes[DISPERSER_NODE].inputs["Transmission Dispersion Scale"]
    assert scale.default_value == 1.0
    scale.default_value = 0.0
    bpy.data.materials["Prism"].use_fake_user = True
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    open_file(tmp_path / "scene.blend")
    scale = find_group().nodes[DISPERSER_NODE].inputs["Transmission Dispersion Scale"]
    assert scale.default_value == 1.0


def make_older(tree: bpy.types.NodeTree) -> bpy.types.NodeTree:
    """A copy of a group as an older version may have had it: other places, one socket more and one less."""
    old = tree.copy()
    del old[VERSION_PROPERTY]
    old[SOURCE_HASH] = "old"
    for node in (node for node in old.nodes if node.type == "SCRIPT"):
        node.script = node.script.copy()
    items = {item.name: item for item in old.interface.items_tree if item.item_type == "SOCKET"}
    old.interface.move(items["IOR"], 12)
    old.interface.move(items["Priority"], 4)
    old.interface.new_socket("Gone", in_out="INPUT", socket_type="NodeSocketFloat", parent=items["Priority"].parent)
    old.interface.remove(items["Polarize"])
    return old


def test_keyframes_and_drivers_follow_sockets_that_moved():
    scene = build_scene()
    new = find_group()
    old = make_older(new)
    names = [socket.name for socket in inputs("Glass")]
    owners = {
        name: [
            names[int(curve.data_path.partition("inputs[")[2].partition("]")[0])]
            for curve in curves(bpy.data.materials[name].node_tree.animation_data)
        ]
        for name in ("Glass", "Water")
    }
    for material in bpy.data.materials:
        if material.node_tree.nodes.get(NODE):
            material.node_tree.nodes[NODE].node_tree = old
    assert [socket.name for socket in inputs("Glass")] != names
    # The paths as that version would have written them.
    places = {name: place for place, name in enumerate(socket.name for socket in inputs("Glass"))}
    for name, sockets in owners.items():
        for curve, socket in zip(curves(bpy.data.materials[name].node_tree.animation_data), sockets, strict=True):
            curve.data_path = f'nodes["{NODE}"].inputs[{places[socket]}].default_value'
    target = bpy.data.objects["Water"].animation_data.drivers[0].driver.variables[0].targets[0]
    before = names.index("Transmittance Depth")
    after = places["Transmittance Depth"]
    assert before != after
    target.data_path = target.data_path.replace(f"inputs[{before}]", f"inputs[{after}]")
    inputs("Bubble")["Gone"].default_value = 3.0

    changes = nd.update_materials()
    assert "Bubble: 'Gone' could not be kept" in changes
    assert [socket.name for socket in inputs("Glass")] == names and inputs("Glass")["Polarize"].default_value is False
    assert_all_is_kept(scene)
    assert own_data() == ONE_OF_EACH


@pytest.mark.parametrize("is_registered", [False, True], ids=["when updated", "at once with the extension"])
def test_what_appends_bring_twice_becomes_one(is_registered, tmp_path, request):
    if is_registered:
        request.getfixturevalue("registered")
    build_scene()
    library = tmp_path / "library.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(library))
    scene = build_scene()
    for obj in list(bpy.data.objects):
        if obj.name in ("Glass", "Bubble", "Prism"):
            bpy.data.objects.remove(obj)
    for name in ("Glass", "Prism"):
        bpy.data.materials.remove(bpy.data.materials[name])
    for name in ("Glass", "Prism"):
        with bpy.data.libraries.load(str(library)) as (_, wanted):
            wanted.objects = [name]
        scene.collection.objects.link(wanted.objects[0])
    copies = [tree for tree in bpy.data.node_groups if group_version(tree) is not None]
    if is_registered:
        assert len(copies) == 1 and versions.outdated_materials() == []
    else:
        assert len(copies) > 1 and len(bpy.data.images) > 1
        assert set(versions.outdated_materials()) == {"Glass", "Prism"}
        assert "Glass: was one of several copies" in nd.update_materials()
    assert own_data() == ONE_OF_EACH
    expected = spectral_table("FL2", gamut="REC709", clamp_negative=False).astype(np.float32)
    assert np.array_equal(material_table(bpy.data.materials["Prism"]), expected)
    assert [light.name for light in listed_lights(bpy.context.scene)] == ["Lamp"]


def test_groups_that_part_faces_become_one():
    new_scene()
    for name in ("A", "B"):
        obj = add_box(name, (0, 0, 0), (1, 1, 1))
        tree = ensure_offset_group().copy() if name == "B" else ensure_offset_group()
        obj.modifiers.new("Offset", "NODES").node_group = tree
    assert nd.update_materials() == (f"{OFFSET_GROUP}: 2 copies became one",)
    assert [tree.name for tree in bpy.data.node_groups] == [OFFSET_GROUP]
    assert all(bpy.data.objects[name].modifiers[0].node_group == bpy.data.node_groups[0] for name in ("A", "B"))


def test_a_group_that_parts_faces_is_known_again_if_only_a_copy_is_left():
    new_scene()
    copy = ensure_offset_group()
    copy.name, copy.use_fake_user = f"{OFFSET_GROUP}.001", True
    assert nd.update_materials() == (f"{OFFSET_GROUP}: has its name back",)
    assert [tree.name for tree in bpy.data.node_groups] == [OFFSET_GROUP] and nd.update_materials() == ()


def test_a_node_inside_an_artists_group_is_updated_too():
    new_scene()
    material = nd.new_material("Glass", ior=1.7)
    wrapper = bpy.data.node_groups.new("Wrapper", "ShaderNodeTree")
    wrapped = wrapper.nodes.new("ShaderNodeGroup")
    wrapped.node_tree = make_older(find_group())
    wrapped.inputs["IOR"].default_value = 1.6
    assert versions.outdated_materials() == ["Wrapper"]
    nd.update_materials()
    assert wrapped.node_tree == material.node_tree.nodes[NODE].node_tree == find_group()
    assert wrapped.inputs["IOR"].default_value == pytest.approx(1.6)


def test_a_newer_material_is_named_and_left():
    new_scene()
    material = nd.new_material("Glass")
    tree = find_group()
    tree[VERSION_PROPERTY] = MATERIAL_VERSION + 1
    assert versions.outdated_materials() == [] and nd.update_materials() == ()
    assert material.node_tree.nodes[NODE].node_tree == tree
    (problem,) = version_problems()
    assert "'Glass' was made by a newer version" in str(problem)
    assert str(problem) in map(str, nd.prepare(bpy.context.scene).problems)


def test_linked_materials_that_are_wrong_here_are_named_with_the_remedy():
    new_scene()
    with bpy.data.libraries.load(str(FIRST), link=True) as (_, wanted):
        wanted.materials = ["Glass"]
    problems = [str(problem) for problem in version_problems()]
    assert len(problems) == FRONT_IOR
    assert all(
        "'Glass' comes from a file of an older version" in text and "Update Materials" in text for text in problems
    )
    assert nd.update_materials() == ()


def test_the_command_updates_a_file_and_a_second_time_has_nothing_to_do(tmp_path):
    file = tmp_path / "scene.blend"
    file.write_bytes(FIRST.read_bytes())
    printed = []
    for _ in range(2):
        done = subprocess.run(
            [sys.executable, "-m", "nested_dielectric", "update", str(file)], check=True, capture_output=True, text=True
        )
        printed.append(done.stdout)
    assert "Glass: was version 1" in printed[0] and "nothing to change" in printed[1]
    assert_all_is_kept(open_file(file))


def test_lights_are_listed_again_in_the_way_of_this_version():
    scene = build_scene()
    tree = bpy.data.node_groups[LIGHTS_NAME]
    del tree[LIGHTS_VERSION_PROPERTY]
    assert update_lights(scene) and not update_lights(scene)


def test_what_stands_in_files_of_this_version_is_what_the_last_release_of_it_made():
    """Whoever changes the shader or the group's sockets after a release counts MATERIAL_VERSION on."""
    new_scene()
    nd.new_material("Glass")
    made = described(find_group())
    for path in RELEASED:
        open_file(path)
        if tree := find_group():
            assert described(tree) == made, f"{path.name} has another group: set MATERIAL_VERSION to one more"


def described(tree: bpy.types.NodeTree) -> tuple[list[str], list[str]]:
    """A group's sockets and shaders; what comments say is no matter."""
    sockets = [f"{item.name} {item.socket_type}" for item in tree.interface.items_tree if item.item_type == "SOCKET"]
    shaders = [shader_source.without_comments(node.script.as_string()) for node in tree.nodes if node.type == "SCRIPT"]
    return sockets, shaders
