"""With the extension, what is told follows every change."""

import bpy  # before bmesh, which lives inside it
import pytest
from mathutils import Matrix
from scenes import add, diffuse
from told import ORDINARY, ball, codes, inputs, ordinary_scene, snapshot

import nested_dielectric as nd
from nested_dielectric.nodes.names import ANALYSED
from nested_dielectric.preparation import idle, windows


def move(bead) -> None:
    bead.location.x = 0.7


def bend_mesh(bead) -> None:
    bead.data.transform(Matrix.Translation((0.7, 0.0, 0.0)))
    bead.data.update()


def turn_on_a_modifier(bead) -> None:
    bead.modifiers.new("Array", "ARRAY").relative_offset_displace = (0.7, 0.0, 0.0)


def change_a_priority(bead) -> None:
    nd.set_priority(bead, 9)


def change_a_value(bead) -> None:
    inputs(bpy.data.materials["Water"])["IOR"].default_value = 1.4


def link_a_value(bead) -> None:
    tree = bpy.data.materials["Water"].node_tree
    tree.links.new(tree.nodes.new("ShaderNodeValue").outputs[0], inputs(bpy.data.materials["Water"])["IOR"])


def copy_the_medium_around(bead) -> None:
    twin = bpy.data.objects["Water"].copy()
    twin.location.x = 5.3
    bpy.context.scene.collection.objects.link(twin)


def remove_the_medium_around(bead) -> None:
    bpy.data.objects.remove(bpy.data.objects["Water"])


def give_another_material(bead) -> None:
    bpy.data.objects["Water"].active_material = bpy.data.materials["Bystander"]


def keyframe(bead) -> None:
    bead.keyframe_insert("location", frame=1)


def parent_to_what_moves(bead) -> None:
    parent = add("Parent", None)
    parent.keyframe_insert("location", frame=1)
    bead.parent = parent


def hide_the_medium_around(bead) -> None:
    bpy.data.objects["Water"].hide_viewport = bpy.data.objects["Water"].hide_render = True


def add_something_foreign(bead) -> None:
    ball("Foreign", 0.2, diffuse())


def move_something_foreign_away(bead) -> None:
    bpy.data.objects["Nearby"].location.x = -50.0


def swap_meshes(bead) -> None:
    bead.data = bpy.data.objects["Water"].data


EVERY_CHANGE = pytest.mark.parametrize(
    "change",
    [
        move,
        bend_mesh,
        turn_on_a_modifier,
        change_a_priority,
        change_a_value,
        link_a_value,
        copy_the_medium_around,
        remove_the_medium_around,
        give_another_material,
        keyframe,
        parent_to_what_moves,
        hide_the_medium_around,
        add_something_foreign,
        move_something_foreign_away,
        swap_meshes,
    ],
    ids=lambda change: change.__name__,
)


@pytest.fixture
def with_extension():
    nd.register()
    yield
    nd.unregister()


@pytest.fixture
def in_window(with_extension, monkeypatch):
    """As in a window, except that nothing comes to rest by itself."""
    monkeypatch.setattr(windows, "has_window", lambda: True)
    monkeypatch.setattr(idle, "IDLE_SECONDS", 1e9)


def analysed_scene() -> tuple[bpy.types.Scene, bpy.types.Object]:
    """The ordinary scene with something foreign nearby, and all that was told evaluated."""
    scene, bead = ordinary_scene()
    ball("Nearby", 0.2, diffuse(), None, (-0.6, 0.0, 0.0))
    nd.analyse(scene)
    bpy.context.view_layer.update()
    return scene, bead


@EVERY_CHANGE
def test_with_the_extension_every_change_is_followed(change, with_extension):
    """Without being asked to, it tells what an analysis from scratch would."""
    scene, bead = analysed_scene()
    before = snapshot()
    change(bead)
    bpy.context.view_layer.update()
    followed = snapshot()
    nd.analyse(scene)
    assert followed == snapshot()
    assert followed != before


def holds(scene: bpy.types.Scene) -> bool:
    """Whether media believe what they are told."""
    return scene[ANALYSED][0] == 1.0


@EVERY_CHANGE
def test_in_a_window_media_that_change_ask_until_all_rests(change, in_window):
    """What is told comes back as updates, which are no change. Other objects are followed at once."""
    scene, bead = analysed_scene()
    change(bead)
    for _ in range(3):
        bpy.context.view_layer.update()
    assert holds(scene) == (change in (add_something_foreign, move_something_foreign_away))
    assert idle.update_idle_scenes() is None
    for _ in range(3):
        bpy.context.view_layer.update()
    assert holds(scene)
    at_rest = snapshot()
    nd.analyse(scene)
    assert at_rest == snapshot()


def test_in_a_window_a_file_is_saved_with_what_an_analysis_tells(in_window, tmp_path):
    scene, bead = analysed_scene()
    bead.location.x = 0.1
    bpy.context.view_layer.update()
    assert not holds(scene)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved.blend"), copy=True)
    assert holds(scene) and codes() == ORDINARY


def test_in_a_window_nothing_is_analysed_while_the_mouse_works(in_window, monkeypatch):
    scene, bead = analysed_scene()
    bead.location.x = 0.1
    bpy.context.view_layer.update()
    assert bpy.app.timers.is_registered(idle.update_idle_scenes)
    monkeypatch.setattr(windows, "is_at_work", lambda: True)
    assert idle.update_idle_scenes() == idle.IDLE_SECONDS
    assert not holds(scene)
