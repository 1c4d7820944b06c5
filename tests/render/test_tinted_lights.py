"""Lamps inside media that absorb light what is outside through them."""

from __future__ import annotations

import bpy  # before mathutils, which lives inside it
import pytest
from drinks import lit_floor
from scenes import mostly_again, render
from slabs import beer_lambert

import nested_dielectric as nd

LIGHTS = mostly_again(["POINT", "MESH", "AREA", "SPOT"], 2)


@pytest.mark.parametrize("kind", LIGHTS)
@pytest.mark.parametrize("iced", [False, True], ids=["alone", "through ice"])
def test_a_light_inside_a_tint_lights_what_is_outside_through_it(kind, iced):
    lit_floor(kind)
    bare = render(16).reshape(-1, 3).mean(axis=0)
    lit_floor(kind, (0.3, 1.4), *([(0.5, 0.7)] if iced else []))
    problems = nd.prepare(bpy.context.scene).problems
    assert not problems
    expected = bare * beer_lambert(0.7 - (0.2 if iced else 0.0))
    # The same seed draws the same points of the light, which is so small that the way to its rim is the same.
    assert render(16).reshape(-1, 3).mean(axis=0) == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("kind", ["MESH"])
def test_a_glowing_mesh_inside_a_tint_lights_what_is_outside_through_it_without_an_analysis(kind):
    lit_floor(kind)
    bare = render(16).reshape(-1, 3).mean(axis=0)
    lit_floor(kind, (0.3, 1.4), (0.5, 0.7))
    assert render(16).reshape(-1, 3).mean(axis=0) == pytest.approx(bare * beer_lambert(0.5), rel=0.01)


def test_a_light_lights_what_stands_in_the_same_tint_through_it():
    """No surface of the medium lies between them."""
    pictures = []
    for boxes in ((), ((-1.0, 1.4),)):
        lit_floor("POINT", *boxes)
        nd.prepare(bpy.context.scene)
        pictures.append(render(16).reshape(-1, 3).mean(axis=0))
    bare, inside = pictures
    assert inside == pytest.approx(bare * beer_lambert(1.0) * beer_lambert(0.2), rel=0.02)
