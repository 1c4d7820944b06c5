"""Whatever artists call things, media are told the same, cut the same and saved the same as under plain names."""

import os

import bpy
import numpy as np
import pytest
from odd_names import ODD_NAMES
from scenes import add, add_box, add_camera, add_point_light, add_sphere, new_scene, render
from storms import raised_by_handlers

import nested_dielectric as nd
from nested_dielectric import cli
from nested_dielectric.cutting.cut_collection import surfaces_of
from nested_dielectric.cutting.cutter import cutter_of
from nested_dielectric.preparation import live
from nested_dielectric.ui.panels import light_panel, scene_panels

EVERYTHING = "ND_STRESS" in os.environ
TOGETHER = 'q"]\\\n{x} 💧מ'
"""What is worst of all names in one."""


def build(name: str) -> bpy.types.Scene:
    """A scene in which everything has a name, but for numbers that Blender adds."""
    scene = new_scene(8, with_group=True)
    scene.name = scene.view_layers[0].name = name
    scene.world = bpy.data.worlds.new(name)
    collection = bpy.data.collections.new(name)
    scene.collection.children.link(collection)
    glass = nd.new_material(name, preset="glass")
    water = nd.new_material(name, preset="water", transmittance=(0.5, 0.7, 0.9), transmittance_depth=2.0)
    ball = add_sphere(name, 0.6, glass, 1, segments=12)
    box = add_box(name, (-1, -1, -1), (1, 1, 0.1), water)
    add_box(name, (-1, -1, -1.5), (1, 1, -1), nd.new_material(name, preset="ice"))
    for obj in (ball, box):
        scene.collection.objects.unlink(obj)
        collection.objects.link(obj)
    ball[name[:40]] = 0.5
    ball.keyframe_insert(f'["{bpy.utils.escape_identifier(name[:40])}"]', frame=1)
    ball.data.attributes.new(name, "FLOAT_COLOR", "POINT").data.foreach_set(
        "color", np.ones(4 * len(ball.data.vertices))
    )
    tree = glass.node_tree
    tree.nodes["Nested Dielectric"].node_tree.name = name
    reader = tree.nodes.new("ShaderNodeAttribute")
    reader.name = reader.attribute_name = name
    tree.links.new(reader.outputs["Fac"], tree.nodes["Nested Dielectric"].inputs["Specular Scale"])
    add_point_light((2.0, 2.0, 4.0), 100.0)
    lamp = bpy.data.objects["Lamp"]
    lamp.name = lamp.data.name = name
    lamp.visible_transmission = False
    add(name, bpy.data.lights.new(name, "AREA"), (0, 0, 5)).visible_glossy = False
    add_camera((0.13, -6, 0.41), (0.02, 0, 0.01), angle=35).name = name
    return scene


def described(preparation: nd.Preparation) -> tuple:
    """What a preparation found, without names and the order that they make."""
    found = preparation.found
    kinds = (found.known, found.asking, found.overlapping, found.coincident, found.doubts, preparation.cut.media)
    return (*map(len, kinds), len(preparation.chosen.native), len(preparation.chosen.osl), len(preparation.problems))


def prepared(name: str, backend: str) -> tuple:
    """Prepare a scene of a name twice; describe what was found, its picture and how many drivers it has."""
    scene = build(name)
    first = nd.prepare(scene, cut=True, backend=backend)
    nd.add_passes(scene)
    assert nd.prepare(scene).changes == () and nd.add_passes(scene) == ()
    animated = [obj.animation_data for obj in (cutter_of(scene), *surfaces_of(scene).values()) if obj.animation_data]
    drivers = [curve.driver for data in animated for curve in data.drivers]
    assert all(driver.is_valid and driver.variables[0].targets[0].id for driver in drivers)
    scene.render.use_compositing = False
    return described(first), render(4), len(drivers)


@pytest.fixture(scope="module", params=["AUTO", "NATIVE"] if EVERYTHING else ["AUTO"])
def plain(request):
    return request.param, prepared("Plain", request.param)


@pytest.mark.parametrize("name", ODD_NAMES if EVERYTHING else [pytest.param(TOGETHER, marks=pytest.mark.always)])
def test_media_of_any_name_are_told_cut_and_rendered_as_those_of_plain_names(name, plain, registered, draw):
    backend, (found, picture, drivers) = plain
    with raised_by_handlers() as raised:
        same, rendered, driven = prepared(name, backend)
        for panel in (scene_panels.SidebarPanel, scene_panels.SidebarAnalysisPanel, light_panel.LightsPanel):
            draw(panel)
        scene = bpy.context.scene
        for obj in list(scene.objects):
            bpy.ops.nested_dielectric.show_problem(name=obj.name)
        bpy.ops.ed.undo_push(message="before")
        live.bake_cut(bpy.context.scene)
        bpy.ops.ed.undo_push(message="after")
        bpy.ops.ed.undo()
    assert raised == []
    assert (same, driven) == (found, drivers)
    assert np.abs(rendered - picture).max() < 0.2 and np.allclose(rendered.mean(), picture.mean(), rtol=0.02)


@pytest.mark.parametrize("name", ODD_NAMES if EVERYTHING else [pytest.param(TOGETHER, marks=pytest.mark.always)])
def test_files_of_any_name_are_prepared_where_they_lie(name, tmp_path, capsys):
    name = name.replace("/", "_")
    folder = tmp_path / name.replace("\\", "_")
    folder.mkdir()
    new_scene(8, with_group=True)
    add_box("Glass", (-1, -1, -1), (1, 1, 1), nd.new_material(name, preset="glass"))
    file = folder / f"{name}.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "plain.blend"))
    os.rename(folder / "plain.blend", file)
    assert cli.main(["prepare", str(file)]) == 0, capsys.readouterr().err
    assert sorted(os.listdir(folder)) == sorted((file.name, f"{file.name}1"))
