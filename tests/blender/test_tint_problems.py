"""What media that absorb cannot show is named with the remedy."""

from __future__ import annotations

import bpy  # before mathutils, which lives inside it
import pytest
from drinks import (
    add_scattering,
    glass_marble,
    hair,
    leaf_over_a_spoon,
    lit_floor,
    scattering_domain,
    see_through,
    tea_with_a_bubble,
)
from scenes import add_box, emission, new_scene
from slabs import tinted

import nested_dielectric as nd
from nested_dielectric.checking.check import check as find_problems


def problems() -> str:
    return "\n".join(map(str, find_problems(bpy.context.scene)))


def test_a_light_in_a_tint_that_must_ask_is_named_with_the_remedy():
    lit_floor("POINT", (0.3, 1.4), (0.5, 0.7))
    assert nd.prepare(bpy.context.scene).problems == ()
    bpy.data.objects["Ice"].keyframe_insert("location", frame=1)
    (problem,) = nd.prepare(bpy.context.scene).problems
    assert problem.name == "Lamp" and "'Tint'" in problem.text and "move" in problem.remedy
    bpy.data.objects["Lamp"].location.z = 3.0
    assert problems() == ""


@pytest.mark.parametrize(
    "build", [scattering_domain, leaf_over_a_spoon, glass_marble, hair], ids=lambda build: build.__name__
)
def test_what_sends_light_on_in_a_tint_that_must_ask_is_named(build):
    tea_with_a_bubble(True, build)
    bpy.data.objects["Bubble"].keyframe_insert("location", frame=1)
    (problem,) = nd.prepare(bpy.context.scene).problems
    assert problem.name in ("Smoke", "Leaf", "Marble", "Hair")


def test_a_volume_of_the_artists_without_the_mask_is_named_where_another_medium_wins():
    tea_with_a_bubble(True, None, add_scattering)
    assert nd.prepare(bpy.context.scene).problems == ()
    bubble = bpy.data.objects["Bubble"]
    bubble.scale.x = -1.0
    assert [problem.name for problem in nd.prepare(bpy.context.scene).problems] == ["Bubble"]
    bubble.scale.x = 1.0
    tree = bpy.data.materials["Tea"].node_tree
    tree.links.remove(tree.nodes["Nested Dielectric"].outputs["Volume Mask"].links[0])
    (problem,) = nd.prepare(bpy.context.scene).problems
    assert problem.name == "Tea" and "'Bubble'" in problem.text and "'Volume Mask'" in problem.remedy


def test_a_label_with_holes_on_a_tinted_bottle_is_named():
    new_scene()
    bottle = add_box("Bottle", (-1, -1, -1), (1, 1, 1), tinted("Beer", 1.33), 1)
    bottle.data.materials.append(emission())
    assert problems() == ""
    bottle.data.materials[1] = see_through(0.5)
    assert "'Bottle' is tinted and has the label" in problems()
