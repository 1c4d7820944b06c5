"""Panels show the media that a scene has, and do not look for them at every redraw."""

import bpy
import pytest
from scenes import add, add_sphere, new_scene

import nested_dielectric as nd
from nested_dielectric.checking.check import check as find_problems
from nested_dielectric.scene import materials
from nested_dielectric.ui.media_list import listed_media


@pytest.fixture
def registered():
    nd.register()
    yield
    nd.unregister()


def names() -> list[str]:
    bpy.context.view_layer.update()
    return [obj.name for obj in listed_media(bpy.context.scene).objects]


def test_the_list_follows_every_change_of_media(registered):
    scene = new_scene()
    glass, water = nd.new_material("Glass", priority=1), nd.new_material("Water", priority=2)
    ball, pool = add_sphere("Ball", 1.0, glass), add_sphere("Pool", 1.0, water)
    assert names() == ["Ball", "Pool"]
    nd.set_priority(pool, 0)
    assert names() == ["Pool", "Ball"]
    add_sphere("Another", 1.0, glass)
    assert names() == ["Pool", "Another", "Ball"]
    ball.active_material = None
    assert names() == ["Pool", "Another"]
    glass.node_tree.nodes["Nested Dielectric"].inputs["Priority"].default_value = 0
    assert names() == ["Another", "Pool"]
    bpy.data.objects.remove(pool)
    assert names() == ["Another"]
    collection = bpy.data.collections.new("Collection")
    collection.objects.link(bpy.data.objects["Another"])
    scene.collection.objects.unlink(bpy.data.objects["Another"])
    empty = add("Instance", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    assert names() == ["Another"]  # of an instanced collection


def test_a_move_changes_no_list(registered):
    new_scene()
    ball = add_sphere("Ball", 1.0, nd.new_material("Glass"))
    names()
    before = listed_media(bpy.context.scene)
    ball.location.x = 3.0
    names()
    assert listed_media(bpy.context.scene) is before


def test_the_nodes_of_a_material_are_looked_through_once_for_all_of_its_objects(monkeypatch):
    scene = new_scene()
    glass = nd.new_material("Glass")
    for index in range(20):
        add_sphere(f"Ball {index}", 0.1, glass, None, (index, 0.0, 0.0), segments=8)
    looks = []
    monkeypatch.setattr(materials, "shows_dielectric", lambda material: looks.append(material) or True)
    assert len(nd.prepare(scene).found.known) == 20
    once = len(looks)
    for index in range(20, 60):
        add_sphere(f"Ball {index}", 0.1, glass, None, (index, 0.0, 0.0), segments=8)
    looks.clear()
    assert len(nd.prepare(scene).found.known) == 60
    assert len(looks) <= once + 5


def test_a_medium_wholly_inside_another_of_its_priority_is_named():
    scene = new_scene()
    add_sphere("Ice", 1.0, nd.new_material("Ice", ior=1.31), 1)
    add_sphere("Water", 0.5, nd.new_material("Water", ior=1.33), 1)
    add_sphere("Apart", 0.5, nd.new_material("Oil", ior=1.47), 1, (5.0, 0.0, 0.0))
    add_sphere("Alike", 0.2, bpy.data.materials["Ice"], 1, (0.7, 0.0, 0.0))
    texts = [str(problem) for problem in find_problems(scene)]
    assert len(texts) == 1 and "'Ice'" in texts[0] and "'Water'" in texts[0] and "lower priority" in texts[0]
