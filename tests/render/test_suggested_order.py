"""A drink whose media are in a wrong order renders as the right one once suggested priorities are accepted."""

import math
from itertools import pairwise

import bpy  # noqa: F401  before bmesh and mathutils, which live inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from mathutils import Matrix
from scenes import add_box, add_camera, add_mesh, add_sphere, new_scene, render, set_striped_world

import nested_dielectric as nd

RIGHT = {"glass": 10, "wine_white": 30, "ice": 20, "air_bubble": 0}

PROFILE = (
    *((0.0, -1.2), (0.6, -1.2), (0.6, -1.1), (0.08, -1.0), (0.08, -0.4), (0.5, -0.1), (0.7, 0.3), (0.65, 0.9)),
    *((0.6, 0.9), (0.64, 0.3), (0.45, 0.0), (0.0, -0.2)),
)
"""Half of a wine glass cut along its axis: radius and height of corners, from below the foot to the inside."""

WINE = ((0.0, -0.22), (0.47, -0.02), (0.67, 0.3), (0.655, 0.5), (0.0, 0.5))
"""The wine, which reaches into the wall."""


def add_turned(name, profile, material):
    """A closed body of revolution."""

    def build(bm):
        verts = [bm.verts.new((radius, 0.0, height)) for radius, height in profile]
        edges = [bm.edges.new(pair) for pair in pairwise(verts)]
        bmesh.ops.spin(
            bm, geom=verts + edges, axis=(0, 0, 1), cent=(0, 0, 0), angle=2 * math.pi, steps=24, use_duplicate=False
        )
        bmesh.ops.remove_doubles(bm, verts=bm.verts, dist=1e-5)
        bmesh.ops.recalc_face_normals(bm, faces=bm.faces)

    return add_mesh(name, build, material, smooth=True)


def wine_glass(**priorities):
    """A wine glass with wine, an ice cube that floats in it, and bubbles in the wine, at the glass and in the ice."""
    scene = new_scene(32, with_group=True)
    set_striped_world()
    media = {key: nd.new_material(key, preset=key, priority=priority) for key, priority in priorities.items()}
    add_turned("Wine Glass", PROFILE, media["glass"])
    add_turned("Wine", WINE, media["wine_white"])
    ice = add_box("Cube", (-0.2, -0.2, -0.2), (0.2, 0.2, 0.2), media["ice"])
    ice.matrix_world = Matrix.Translation((0.05, 0.0, 0.42)) @ Matrix.Rotation(0.3, 4, "Y")
    for index, place in enumerate(((-0.3, -0.2, 0.2), (0.3, -0.57, 0.3), (0.05, 0.0, 0.4))):
        add_sphere(f"Bubble {index}", 0.08, media["air_bubble"], None, place, segments=16)
    add_camera((0.2, -6.0, 1.3), (0.0, 0.0, 0.15), angle=20)
    return scene


@pytest.mark.parametrize(
    "wrong",
    [
        {"glass": 30, "wine_white": 10, "ice": 20, "air_bubble": 40},
        {"glass": 10, "wine_white": 10, "ice": 10, "air_bubble": 10},
    ],
    ids=["reversed", "all equal"],
)
def test_a_wine_glass_in_a_wrong_order_renders_as_the_right_one_once_suggestions_are_accepted(wrong):
    assert not nd.suggest_priorities(wine_glass(**RIGHT))
    right = render(16)
    scene = wine_glass(**wrong)
    before = render(16)
    # A wrong order has other surfaces; in the right one the same paths are drawn, whatever the numbers are.
    assert np.abs(before - right).mean() > 0.02 * right.mean()
    changes, kept = nd.accept_priorities(scene, nd.suggest_priorities(scene))
    assert changes and not kept
    assert np.abs(render(16) - right).mean() < 1e-6 * right.mean()
