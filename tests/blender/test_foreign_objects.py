"""Media look out for foreign objects that may be in reach, and for no others."""

from collections.abc import Callable

import bpy  # before bmesh, which lives inside it
import pytest
from scenes import add, add_box, add_camera, add_plane, diffuse
from told import TINT, ball, displacing, fresh, instance, into_collection, medium, told_foreign

import nested_dielectric as nd


def far() -> None:
    ball("Foreign", 0.3, diffuse(), None, (9, 0, 0))


def hidden_everywhere() -> None:
    foreign = ball("Foreign", 0.3, diffuse())
    foreign.hide_viewport = foreign.hide_render = True


def without_a_surface() -> None:
    add("Empty", None)
    add("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    add_camera((0, 0, 0), (0, 1, 0))


def inside() -> None:
    ball("Foreign", 0.1, diffuse())


def in_the_medium_around() -> None:
    ball("Sea", 3.0, medium("Sea", 1.2), 9)
    ball("Foreign", 0.3, diffuse(), None, (2, 0, 0))


def in_the_last_of_a_chain_of_one_priority() -> None:
    for index in range(2):
        ball(f"Link {index}", 0.7, medium(f"Link {index}", 1.33, **TINT), 5, (1 + index, 0, 0))
    ball("Foreign", 0.1, diffuse(), None, (2.5, 0, 0))


def moving() -> None:
    foreign = ball("Foreign", 0.3, diffuse())
    foreign.location = (9, 0, 0)
    foreign.keyframe_insert("location", frame=1)


def instanced_by_what_moves() -> None:
    instancer = instance(into_collection(ball("Foreign", 0.3, diffuse())), (9, 0, 0))
    instancer.keyframe_insert("location", frame=1)


def displaced() -> None:
    add_plane("Foreign", 3.0, (0, 0, -1.5), (0, 0, 1), displacing(diffuse()))


def with_another_shape_in_renders() -> None:
    foreign = add_box("Foreign", (-3, -3, -1.5), (3, 3, -1.2), diffuse())
    modifier = foreign.modifiers.new("Solidify", "SOLIDIFY")
    modifier.thickness, modifier.offset, modifier.show_viewport = 3.0, 1.0, False


def hidden_in_the_viewport_alone() -> None:
    ball("Foreign", 0.3, diffuse()).hide_viewport = True


def hidden_by_the_eye() -> None:
    ball("Foreign", 0.3, diffuse()).hide_set(True)


def in_a_collection_hidden_in_the_viewport() -> None:
    collection = into_collection(ball("Foreign", 0.3, diffuse()))
    bpy.context.scene.collection.children.link(collection)
    collection.hide_viewport = True


def in_another_view_layer() -> None:
    collection = into_collection(ball("Foreign", 0.3, diffuse()))
    bpy.context.scene.collection.children.link(collection)
    bpy.context.scene.view_layers.new("Second")
    bpy.context.scene.view_layers[0].layer_collection.children["Collection"].exclude = True


def foreign_looked_out_for(place: Callable[[], None]) -> bool:
    """Whether a tinted medium about the origin looks out for foreign objects."""
    scene = fresh()
    water = ball("Water", 0.7, medium("Water", 1.33, **TINT), 5)
    place()
    found = nd.analyse(scene)
    assert not found.doubts
    return told_foreign(water)


@pytest.mark.parametrize("place", [far, hidden_everywhere, without_a_surface], ids=lambda place: place.__name__)
def test_media_do_not_look_out_for_foreign_objects_out_of_reach(place):
    assert not foreign_looked_out_for(place)


@pytest.mark.parametrize(
    "place",
    [
        inside,
        in_the_medium_around,
        in_the_last_of_a_chain_of_one_priority,
        moving,
        instanced_by_what_moves,
        displaced,
        with_another_shape_in_renders,
        hidden_in_the_viewport_alone,
        hidden_by_the_eye,
        in_a_collection_hidden_in_the_viewport,
        in_another_view_layer,
    ],
    ids=lambda place: place.__name__,
)
def test_media_look_out_for_foreign_objects_that_may_be_in_reach(place):
    assert foreign_looked_out_for(place)
