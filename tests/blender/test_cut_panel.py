"""Cut Surfaces in the panel, in menus and on the command line, and the cut that is kept in a file."""

import bpy
import numpy as np
import pytest
from scenes import add_box, add_camera, new_scene, read_picture, render, set_striped_world
from test_command_line import run
from ui import labels_and_operators

import nested_dielectric as nd
from nested_dielectric.cutting import cutting
from nested_dielectric.preparation import live
from nested_dielectric.scene.media import media
from nested_dielectric.ui.panels import scene_panels

CUT, KEEP = "nested_dielectric.cut_surfaces", "nested_dielectric.keep_cut"


def add_crossing(open_one=False):
    """A block of glass that a block of water reaches into; or with a face of the water missing."""
    add_box("Block", (-1, -1, -1), (0.1, 1, 1), nd.new_material("Glass", ior=1.5), 1)
    water = add_box("Water", (-0.2, -0.7, -0.8), (1, 0.6, 0.9), nd.new_material("Water", ior=1.33), 2)
    if open_one:
        faces = [tuple(polygon.vertices) for polygon in water.data.polygons][1:]
        points = [tuple(vertex.co) for vertex in water.data.vertices]
        water.data.clear_geometry()
        water.data.from_pydata(points, [], faces)
    bpy.context.view_layer.update()


def add_view():
    set_striped_world()
    add_camera((2.1, -4.3, 1.7), (0, 0, 0))


@pytest.fixture
def registered(registered):
    """The same where media may ask: with Open Shading Language."""
    bpy.context.scene.cycles.shading_system = True


@pytest.mark.quick
def test_a_button_switches_it_on_and_off_and_shows_which(registered, draw):
    scene = bpy.context.scene
    assert CUT not in labels_and_operators(draw(scene_panels.SidebarPanel))[1]
    add_crossing()
    assert CUT in labels_and_operators(draw(scene_panels.SidebarPanel))[1]
    assert not bpy.ops.nested_dielectric.keep_cut.poll()
    assert bpy.ops.nested_dielectric.cut_surfaces() == {"FINISHED"}
    assert cutting.is_cut(scene) and scene.objects["Water"].hide_render
    assert {obj.name for obj in scene.objects} >= {"Water (cut)", "Block (cut)"}
    assert KEEP in labels_and_operators(draw(scene_panels.SidebarPanel))[1]
    assert bpy.ops.nested_dielectric.cut_surfaces() == {"FINISHED"}
    assert not cutting.is_cut(scene) and not scene.objects["Water"].hide_render
    assert len(scene.objects) == 2


@pytest.mark.quick
def test_lists_and_the_selection_show_the_artists_objects_alone(registered):
    scene = bpy.context.scene
    add_crossing()
    nd.prepare(scene, cut=True)
    assert {obj.name for obj in media(scene)} == {"Block", "Water"}
    bpy.ops.object.select_all(action="SELECT")
    assert {obj.name for obj in bpy.context.selected_objects} == {"Block", "Water"}


@pytest.mark.quick
def test_the_panel_says_what_is_not_cut_and_why(registered, draw):
    add_crossing(open_one=True)
    preparation = nd.prepare(bpy.context.scene, cut=True)
    assert dict(preparation.cut.asking) == {"Water": "is not closed", "Block": "may meet 'Water', which is not cut"}
    labels, operators = labels_and_operators(draw(scene_panels.SidebarPanel))
    assert "2 of 2 Not Cut" in labels and "Is not closed" in labels and "nested_dielectric.show_problem" in operators
    assert not any(obj.hide_render for obj in bpy.context.scene.objects)


@pytest.mark.quick
def test_none_keeps_the_scenes_own_setting_and_putting_back_ends_it(registered):
    scene = bpy.context.scene
    add_crossing()
    assert nd.prepare(scene).cut == cutting.Cut()
    nd.prepare(scene, cut=True)
    assert nd.prepare(scene).cut.media == ("Block", "Water")
    bpy.ops.nested_dielectric.put_back()
    assert (
        not cutting.is_cut(scene) and len(scene.objects) == 2 and not bpy.data.node_groups.get("Nested Dielectric Cut")
    )


@pytest.mark.quick
def test_bringing_it_up_to_date_changes_nothing_where_nothing_has_changed(registered):
    """Or a window would never come to rest."""
    scene = bpy.context.scene
    add_crossing()
    scene.objects["Block"]["spice"] = [1.0, 2.0]
    nd.prepare(scene, cut=True)
    bpy.context.view_layer.update()
    updates = []
    watch = bpy.app.handlers.persistent(
        lambda scene, depsgraph: updates.extend(each.id.name for each in depsgraph.updates)
    )
    bpy.app.handlers.depsgraph_update_post.append(watch)
    live.update_cut(scene)
    bpy.context.view_layer.update()
    bpy.app.handlers.depsgraph_update_post.remove(watch)
    assert not updates


@pytest.mark.quick
def test_what_may_change_the_cut_is_looked_at_in_a_window_and_a_selection_is_not(registered, monkeypatch):
    scene = bpy.context.scene
    add_crossing()
    nd.prepare(scene, cut=True)
    bpy.context.view_layer.update()
    waits = []
    monkeypatch.setattr(live, "has_window", lambda: True)
    monkeypatch.setattr(live, "_wait_for_rest", lambda: waits.append(True))

    def waits_after(change):
        waits.clear()
        change()
        bpy.context.view_layer.update()
        return bool(waits)

    water = scene.objects["Water"]
    assert not waits_after(lambda: water.select_set(not water.select_get()))
    assert waits_after(lambda: setattr(water.location, "x", 0.1))
    assert waits_after(lambda: setattr(scene.render, "use_motion_blur", True))


@pytest.mark.quick
def test_media_that_are_appended_without_their_surfaces_are_rendered(registered, tmp_path):
    add_crossing()
    nd.prepare(bpy.context.scene, cut=True)
    path = str(tmp_path / "cut.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.append(directory=f"{path}/Object/", filename="Water")
    assert not bpy.data.objects["Water"].hide_render and cutting.HIDDEN_BY_CUT not in bpy.data.objects["Water"]


def test_the_cut_of_one_frame_is_kept_until_a_medium_changes():
    scene = new_scene(24)
    add_view()
    add_crossing()
    nd.prepare(scene, cut=True)
    picture = render(8)
    assert live.keep_cut(scene) == "" and cutting.is_kept(scene)
    faces = [len(obj.data.polygons) for obj in scene.objects if obj.name.endswith("(cut)")]
    assert min(faces) > 0
    assert np.array_equal(render(8), picture) and cutting.is_kept(scene)
    scene.frame_set(scene.frame_current + 1)
    assert np.array_equal(render(8), picture)
    scene.objects["Water"].location.x += 0.1
    live.update_cut(scene)
    assert not cutting.is_kept(scene)
    assert not np.array_equal(render(8), picture)


@pytest.mark.quick
def test_what_renders_show_otherwise_than_the_viewport_cannot_be_kept():
    scene = new_scene()
    add_crossing()
    modifier = scene.objects["Water"].modifiers.new("Finer", "SUBSURF")
    modifier.levels, modifier.render_levels = 1, 2
    nd.prepare(scene, cut=True)
    assert "'Water'" in live.keep_cut(scene) and not cutting.is_kept(scene)


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    new_scene(24)
    add_view()
    add_crossing()
    path = tmp_path_factory.mktemp("file") / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def test_the_command_line_cuts_unless_told_not_to_and_keeps_the_cut_in_a_file(file, tmp_path):
    whole = run("render", file, "-o", tmp_path / "whole.exr", "--samples", 64, "--no-cut")
    assert whole.returncode == 0 and "cut:" not in whole.stdout
    cut = run("render", file, "-o", tmp_path / "cut.exr", "--samples", 64)
    assert cut.returncode == 0 and "cut: cut where they cross: 'Block', 'Water'" in cut.stdout
    kept = run("prepare", file, "--cut", "-o", tmp_path / "kept.blend")
    assert kept.returncode == 0 and "the cut of frame 1 is in the file" in kept.stdout
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "kept.blend"))
    assert cutting.is_cut(bpy.context.scene) and cutting.is_kept(bpy.context.scene)
    back = run("prepare", tmp_path / "kept.blend", "--no-cut")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "kept.blend"))
    assert back.returncode == 0 and not cutting.is_cut(bpy.context.scene) and not bpy.data.objects["Water"].hide_render
    # The same picture within the noise of 64 samples, whose error in the mean of 24 x 24 pixels is below a thousandth.
    means = [read_picture(tmp_path / f"{name}.exr").mean() for name in ("whole", "cut")]
    assert means[0] == pytest.approx(means[1], rel=4e-3)
