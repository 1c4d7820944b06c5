"""Whatever is taken out of the extension's groups is noticed, and made anew by a preparation."""

import os
import random

import bpy
import pytest
from scenes import add, add_box, add_point_light, add_sphere, new_scene
from storms import raised_by_handlers

import nested_dielectric as nd
from nested_dielectric.checking.check import check as find_problems
from nested_dielectric.cutting.baked_cut import delete_bake
from nested_dielectric.cutting.cut_collection import find_collection, surfaces_of
from nested_dielectric.cutting.cutter import cutter_of
from nested_dielectric.nodes import wholeness
from nested_dielectric.nodes.lights_group import find_lights
from nested_dielectric.nodes.material_version import DAMAGED, MATERIAL_VERSION, find_group, group_version
from nested_dielectric.nodes.wholeness import is_whole
from nested_dielectric.preparation import live, prepare_scene
from nested_dielectric.ui import media_list

EVERYTHING = "ND_STRESS" in os.environ


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """A scene that is cut, with a light that a lobe carries and faces that are parted."""
    scene = new_scene(8, with_group=True)
    add_sphere("Ball", 0.6, nd.new_material("Prism", preset="bk7"), 1, segments=12)
    add_box("Water", (-1, -1, -1), (1, 1, 0.1), nd.new_material("Sea", preset="water"))
    add_box("Floor", (-1, -1, -1.5), (1, 1, -1), nd.new_material("Floor", preset="glass"))
    add_point_light((2.0, 2.0, 4.0), 100.0)
    bpy.data.objects["Lamp"].visible_transmission = False
    nd.prepare(scene, cut=True)
    path = str(tmp_path_factory.mktemp("insides") / "whole.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    return path


@pytest.fixture
def scene(path):
    bpy.ops.wm.open_mainfile(filepath=path)
    return bpy.context.scene


def within(tree: bpy.types.NodeTree) -> list[bpy.types.NodeTree]:
    """A group and the groups within it."""
    found = [tree]
    for each in found:  # which grows meanwhile
        found += [node.node_tree for node in each.nodes if node.type == "GROUP" and node.node_tree not in found]
    return list(dict.fromkeys(found))


def take_out(tree: bpy.types.NodeTree, part: str, chance: random.Random) -> str:
    """Take a node, a link or a socket out of a group."""
    owner = {"node": tree.nodes, "link": tree.links, "socket": tree.interface}[part]
    taken = chance.choice(list(tree.interface.items_tree if part == "socket" else owner))
    name = f"{part} {getattr(taken, 'name', '')} of {tree.name}"
    owner.remove(taken)
    return name


def cut_shapes(scene: bpy.types.Scene) -> dict[str, tuple[int, int]]:
    """Numbers of points and faces of all surfaces that are cut, by their media."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    shapes = {}
    for obj, surface in surfaces_of(scene).items():
        surface.hide_viewport = False
        depsgraph.update()
        mesh = surface.evaluated_get(depsgraph).to_mesh()
        shapes[obj.name] = len(mesh.vertices), len(mesh.polygons)
        surface.hide_viewport = True
    return shapes


@pytest.mark.always
@pytest.mark.parametrize("part", ["node", "link", "socket"])
def test_a_material_from_whose_group_anything_is_taken_is_damaged(part, path):
    bpy.ops.wm.open_mainfile(filepath=path)
    chance = random.Random(part)
    names = [tree.name for tree in within(find_group()) if tree != find_lights()]
    assert len(names) > 10
    for name in names if EVERYTHING else chance.sample(names, 3):
        bpy.ops.wm.open_mainfile(filepath=path)
        group = find_group()
        taken = take_out(bpy.data.node_groups[name], part, chance)
        assert group_version(group) == DAMAGED, taken
        assert any("is damaged" in str(problem) for problem in find_problems(bpy.context.scene)), taken


@pytest.mark.always
def test_links_that_an_older_blender_has_dropped_are_missed_by_the_newer_one_alone(scene, monkeypatch):
    tree = find_group()
    take_out(bpy.data.node_groups[".Nested Dielectric Native Special"], "link", random.Random(0))
    assert not is_whole(tree)
    monkeypatch.setattr(wholeness, "_version", lambda: 100 * bpy.app.version[0] + bpy.app.version[1] - 1)
    assert is_whole(tree)
    take_out(bpy.data.node_groups[".Nested Dielectric Native Special"], "node", random.Random(0))
    assert not is_whole(tree)


@pytest.mark.always
def test_a_damaged_material_is_made_anew_with_its_values(scene):
    node = bpy.data.materials["Sea"].node_tree.nodes["Nested Dielectric"]
    node.inputs["Roughness"].default_value = 0.25
    before = find_group()
    take_out(bpy.data.node_groups[".Nested Dielectric Native Weights"], "link", random.Random(0))
    changes = nd.prepare(scene).changes
    assert "Sea: was damaged" in changes and "Prism: was damaged" in changes
    node = bpy.data.materials["Sea"].node_tree.nodes["Nested Dielectric"]
    assert node.node_tree == find_group() and group_version(node.node_tree) == MATERIAL_VERSION
    assert node.inputs["Roughness"].default_value == 0.25
    assert before not in bpy.data.node_groups.values()
    assert nd.prepare(scene).changes == () and find_problems(scene) == []
    assert [tree.name for tree in bpy.data.node_groups if tree.name.endswith(".001")] == []


@pytest.mark.always
@pytest.mark.parametrize("part", ["node", "link", "socket"])
def test_what_is_taken_from_groups_that_cut_and_light_is_made_anew(part, scene):
    before = cut_shapes(scene)
    assert min(before["Ball"]) > 10
    chance = random.Random(part)
    used = {modifier.node_group for obj in surfaces_of(scene).values() for modifier in obj.modifiers}
    trees = [*used, *within(cutter_of(scene).modifiers[0].node_group), find_lights()]
    assert len(trees) >= 5
    for tree in trees:
        take_out(tree, part, chance)
    with raised_by_handlers() as raised:
        nd.prepare(scene)
    assert raised == []
    used = {modifier.node_group for obj in surfaces_of(scene).values() for modifier in obj.modifiers}
    assert all(map(is_whole, [*used, *within(cutter_of(scene).modifiers[0].node_group), find_lights()]))
    assert cut_shapes(scene) == before
    assert nd.prepare(scene).changes == ()


@pytest.mark.always
def test_the_cutter_gets_its_drivers_back(scene):
    cutter = cutter_of(scene)
    driven = {curve.data_path for curve in cutter.animation_data.drivers}
    assert driven
    cutter.animation_data.drivers.remove(cutter.animation_data.drivers[0])
    nd.prepare(scene)
    assert {curve.data_path for curve in cutter_of(scene).animation_data.drivers} == driven


@pytest.mark.always
def test_an_object_that_an_artist_gives_the_mesh_of_a_cut_surface_stays(scene):
    live.bake_cut(scene)
    surface = surfaces_of(scene)[bpy.data.objects["Ball"]]
    add("Mine", surface.data)
    assert delete_bake(scene)
    assert bpy.data.objects["Mine"].data != surface.data
    bpy.data.objects["Mine"].data = surface.data
    prepare_scene.put_back(scene)
    assert len(bpy.data.objects["Mine"].data.vertices) == 0


@pytest.mark.always
@pytest.mark.parametrize("end", [nd.prepare, prepare_scene.put_back])
def test_what_an_artist_puts_into_the_collection_of_cut_surfaces_stays(end, scene):
    collection = find_collection(scene)
    mine = bpy.data.objects.new("Mine", bpy.data.meshes.new("Mine"))
    inner = bpy.data.objects.new("Inner", bpy.data.meshes.new("Inner"))
    collection.objects.link(mine)
    child = bpy.data.collections.new("Child")
    child.objects.link(inner)
    collection.children.link(child)
    collection.objects.link(bpy.data.objects["Floor"])
    if end == prepare_scene.put_back:
        del surfaces_of(scene)[bpy.data.objects["Ball"]]["nd_cut_of"]
    end(scene)
    assert {"Mine", "Inner", "Floor", "Ball"} <= set(scene.objects.keys())
    assert mine.name in scene.collection.objects and child.name in scene.collection.children
    shown = [obj.name for obj in scene.objects if obj.name.startswith("Ball (cut)")]
    assert len(shown) == (end == nd.prepare)


@pytest.mark.always
def test_a_group_that_was_deleted_is_named_in_panels_and_by_a_preparation(scene):
    bpy.data.node_groups.remove(find_group())
    problems = nd.prepare(scene).problems
    assert {problem.name for problem in problems} == {"Ball", "Water", "Floor"}
    assert all("whose group was deleted" in problem.text for problem in problems)
    media_list.forget_media()
    assert len(media_list.listed_media(scene).problems) == 3


@pytest.mark.skipif(not EVERYTHING, reason="takes long: make stress")
@pytest.mark.parametrize("seed", range(40))
def test_anything_that_is_taken_out_or_deleted_raises_nothing(seed, scene):
    chance = random.Random(seed)
    tree = chance.choice([tree for tree in bpy.data.node_groups if len(tree.links)])
    taken = take_out(tree, chance.choice(("node", "link", "socket")), chance)
    with raised_by_handlers() as raised:
        bpy.data.objects["Ball"].location.x += 0.01
        bpy.context.view_layer.update()
        nd.prepare(scene)
        assert nd.prepare(scene).changes == (), taken
    assert raised == [], taken
