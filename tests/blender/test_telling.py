"""Telling a second time changes nothing, and clearing leaves no trace."""

import bpy  # before bmesh, which lives inside it
from scenes import add_mesh, diffuse, updated_by
from told import ball, balls, instance, instanced_by_geometry_nodes, into_collection, medium, ordinary_scene, snapshot

import nested_dielectric as nd
from nested_dielectric.model.contract import Exterior
from nested_dielectric.nodes.identity import SCENE_PROPERTY


def everything_told() -> bpy.types.Scene:
    """Media told by their materials and for themselves, one of them in instances, and one that is doubled."""
    scene, bead = ordinary_scene()
    ball("Second", 0.3, bead.active_material, 4, (-5.0, 0.0, 0.0))
    ball("Third", 0.3, bpy.data.materials["Water"], 4, (-5.2, 0.0, 0.0))
    ball("Alone", 0.3, medium("Alone", 1.5), 1, (0.0, 5.0, 0.0))
    add_mesh("Double", balls((0.8, (-0.4, 9, 0)), (0.8, (0.4, 9, 0))), bpy.data.materials["Bystander"], 1)
    instance(into_collection(ball("Instanced", 0.3, medium("Instanced", 1.5), 1, (0.0, 0.0, 0.7))), (0.2, 0.0, 0.0))
    return scene


def test_a_second_analysis_changes_nothing():
    """Not even what Blender would have to evaluate again."""
    scene = everything_told()
    first = nd.analyse(scene)
    told = snapshot()
    assert {Exterior.BY_OBJECT, Exterior.AIR} <= {
        values[0] for key, values in told.items() if not key.startswith("object ")
    }
    found = []
    assert updated_by(lambda: found.append(nd.analyse(scene))) == []
    assert found == [first]
    assert snapshot() == told
    assert updated_by(lambda: setattr(bpy.data.objects["Bead"].location, "x", 0.01))  # what is written is noticed


def traces() -> list:
    """Names of all custom properties and attributes, and all that is told."""
    named = [(data.name, sorted(data.keys())) for data in (*bpy.data.scenes, *bpy.data.objects, *bpy.data.meshes)]
    attributes = [(mesh.name, sorted(mesh.attributes.keys())) for mesh in bpy.data.meshes]
    return [named, attributes, snapshot()]


def test_clearing_leaves_no_trace():
    scene = everything_told()
    before = traces()
    nd.analyse(scene)
    assert traces()[2] != before[2]
    nd.clear_analysis(scene)
    del scene[SCENE_PROPERTY]  # a scene keeps its number
    assert traces() == before


def test_clearing_reaches_what_geometry_nodes_show():
    scene, bead = ordinary_scene()
    before = snapshot()
    nd.analyse(scene)
    instanced_by_geometry_nodes(bead)
    nd.clear_analysis(scene)
    assert {name: told for name, told in snapshot().items() if name in before} == before


def test_media_that_lose_their_material_keep_no_trace():
    scene, _ = ordinary_scene()
    before = traces()
    nd.analyse(scene)
    for name in ("Water", "Crossing"):
        bpy.data.objects[name].active_material = diffuse()
    nd.analyse(scene)
    nd.clear_analysis(scene)
    del scene[SCENE_PROPERTY]
    assert traces()[:2] == before[:2]
