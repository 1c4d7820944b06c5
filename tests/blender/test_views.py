"""While viewports show materials, cut surfaces stand there for the artist's media, which stay his to select and edit."""

import types

import bpy
import pytest
from scenes import add_box, add_sphere, new_scene

import nested_dielectric as nd
from nested_dielectric.analysis import surroundings
from nested_dielectric.cutting import (
    copied_settings,
    cut_scene,
    views,
)
from nested_dielectric.preparation import file_handlers, idle, live, prepare_scene
from nested_dielectric.scene import ray_visibility


@pytest.fixture
def ball() -> bpy.types.Object:
    """A ball that stands half in a block; its scene is cut."""
    scene = new_scene()
    ball = add_sphere("Ball", 0.8, nd.new_material("Dense", ior=1.5), 1, segments=24)
    add_box("Block", (-0.8, -0.8, -0.9), (0.8, 0.8, 0.4), nd.new_material("Thin", ior=1.3), 2)
    assert set(nd.prepare(scene, cut=True).cut.media) == {"Ball", "Block"}
    return ball


def scene() -> bpy.types.Scene:
    return bpy.context.scene


def surface() -> bpy.types.Object:
    return bpy.data.objects["Ball (cut)"]


def seen(obj: bpy.types.Object) -> set[str]:
    """Kinds of rays that meet an object."""
    return {kind for kind in ray_visibility.RAY_KINDS if getattr(obj, f"visible_{kind}")}


def depsgraph() -> bpy.types.Depsgraph:
    bpy.context.view_layer.update()
    return bpy.context.view_layer.depsgraph


def faces() -> int:
    """Of the ball's surface as viewports show it."""
    return len(surface().evaluated_get(depsgraph()).data.polygons)


ALL = set(ray_visibility.RAY_KINDS)


def test_a_viewport_that_shows_materials_shows_cut_surfaces_alone(ball):
    ball.visible_glossy = False
    for _ in range(2):
        views.show(scene(), True)
        assert not seen(ball) and not surface().hide_viewport and surface().hide_select and faces() > 100
        assert not ball.hide_viewport and not ball.hide_select
    nd.prepare(scene())  # as before a render
    assert seen(surface()) == ALL - {"glossy"}
    views.show(scene(), True)
    nd.prepare(scene())
    assert seen(surface()) == ALL - {"glossy"}
    views.show(scene(), False)
    assert seen(ball) == ALL - {"glossy"} and surface().hide_viewport and ball.hide_render


def test_what_is_switched_on_meanwhile_stays_on(ball):
    ball.visible_glossy = False
    views.show(scene(), True)
    ball.visible_glossy = True
    views.show(scene(), True)
    assert not seen(ball)
    views.show(scene(), False)
    assert seen(ball) == ALL


def test_what_is_hidden_in_viewports_has_no_surface_there(ball):
    views.show(scene(), True)
    ball.hide_set(True)
    views.show(scene(), True)
    assert not surface().visible_get()
    ball.hide_set(False)
    views.show(scene(), True)
    assert surface().visible_get()
    ball.hide_viewport = True
    views.show(scene(), True)
    assert surface().hide_viewport


@pytest.mark.parametrize(
    "end",
    [
        lambda: nd.prepare(scene(), cut=False),
        lambda: prepare_scene.put_back(scene()),
        live.remove,
        lambda: scene().collection.objects.unlink(bpy.data.objects["Block"]) or live.update_cut(scene()),
    ],
    ids=["not cut", "put back", "without the extension", "nothing crosses"],
)
def test_media_are_seen_again_once_no_surface_stands_for_them(ball, end):
    views.show(scene(), True)
    end()
    assert seen(ball) == ALL


def test_a_file_that_was_saved_meanwhile_is_opened_with_all_as_it_was(ball, tmp_path):
    views.show(scene(), True)
    file = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file)
    bpy.ops.wm.open_mainfile(filepath=file, load_ui=False)
    assert seen(surface()) == ALL
    nd.prepare(scene(), cut=False)
    assert seen(bpy.data.objects["Ball"]) == ALL


def test_objects_that_are_appended_from_such_a_scene_are_seen(ball, tmp_path):
    views.show(scene(), True)
    file = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file, copy=True)
    new_scene()
    with bpy.data.libraries.load(file) as (_, wanted):
        wanted.objects = ["Ball"]
    file_handlers.unhide_orphans()
    assert seen(wanted.objects[0]) == ALL and not wanted.objects[0].hide_render


def test_a_copy_of_an_object_that_is_not_seen_is_cut_and_seen_too(ball):
    views.show(scene(), True)
    copy = ball.copy()
    scene().collection.objects.link(copy)
    copy.location.x += 0.3
    live.update_cut(scene())
    twin = bpy.data.objects[copy.name + copied_settings.SUFFIX]
    assert seen(twin) == ALL
    views.show(scene(), False)
    assert seen(copy) == ALL


def test_what_animates_by_which_rays_an_object_is_met_is_left_alone(ball):
    ball.keyframe_insert("visible_camera", frame=1)
    views.show(scene(), True)
    assert seen(ball) == ALL and surface().hide_viewport


def test_surfaces_in_viewports_change_nothing_that_is_known_of_a_scene(ball):
    found = surroundings.last_found(scene())
    views.show(scene(), True)
    assert not cut_scene.may_change_cut(scene(), types.SimpleNamespace(updates=[]))
    again = nd.prepare(scene())
    assert (
        surroundings.last_found(scene()) == found and set(again.cut.media) == {"Ball", "Block"} and not again.problems
    )


def test_while_changes_follow_on_each_other_surfaces_move_as_they_are(ball):
    views.show(scene(), True)
    before = faces()
    views.freeze(scene(), bpy.context.view_layer)
    assert faces() == before and len(surface().data.polygons) == before
    ball.location.z += 0.3
    assert faces() == before
    assert surface().evaluated_get(depsgraph()).matrix_world.translation.z == pytest.approx(
        ball.matrix_world.translation.z
    )
    live.update_cut(scene())
    views.show(scene(), True)
    assert (
        not len(surface().data.polygons)
        and faces() != before
        and surface().material_slots[0].material == ball.active_material
    )


def test_a_render_cuts_what_viewports_hold(ball):
    views.show(scene(), True)
    assert faces()
    views.freeze(scene(), bpy.context.view_layer)
    modifier = surface().modifiers[0]
    assert len(surface().data.polygons) and modifier.show_render and not modifier.show_viewport


@pytest.mark.parametrize(
    "shading, playing, engine, lit",
    [
        ("SOLID", False, "CYCLES", False),
        ("WIREFRAME", False, "CYCLES", False),
        ("MATERIAL", False, "CYCLES", True),
        ("RENDERED", False, "CYCLES", True),
        ("MATERIAL", True, "CYCLES", False),
        ("RENDERED", True, "CYCLES", True),
        ("RENDERED", False, "BLENDER_WORKBENCH", False),
    ],
)
def test_which_viewports_show_materials(shading, playing, engine, lit):
    """To preview them is to be quick while an animation plays."""
    scene = new_scene()
    scene.render.engine = engine
    space = types.SimpleNamespace(shading=types.SimpleNamespace(type=shading))
    area = types.SimpleNamespace(type="VIEW_3D", spaces=types.SimpleNamespace(active=space))
    screen = types.SimpleNamespace(areas=[area], is_animation_playing=playing)
    assert (scene in views.lit_scenes([types.SimpleNamespace(scene=scene, screen=screen)])) == lit


def test_in_edit_mode_viewports_go_on_showing_cut_surfaces(ball):
    views.show(scene(), True)
    bpy.context.view_layer.objects.active = ball
    bpy.ops.object.mode_set(mode="EDIT")
    idle.update_idle_scenes()
    assert surface().modifiers[0].show_viewport and not seen(ball)
    bpy.ops.object.mode_set(mode="OBJECT")
    idle.update_idle_scenes()
    assert seen(surface()) == ALL
