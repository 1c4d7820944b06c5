"""Media from the asset library render as those that are assigned."""

import bpy
import pytest
from dropped_media import append, build_library
from scenes import add_camera, add_sphere, new_scene, render, set_world

import nested_dielectric as nd


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return build_library(tmp_path_factory.mktemp("assets"))


def test_media_from_the_library_render_as_those_that_are_assigned(library, registered):
    """In a white world glass without absorption shows white where rays find a way out: within 1 %, what bounces leave."""
    new_scene(24)
    material = append(library, "BK7 Glass")[0]
    add_sphere("Ball", 1.0, material)
    set_world()
    add_camera((0.1, -5.0, 0.2), (0.0, 0.0, 0.0), 3.0)
    nd.prepare(bpy.context.scene)
    assert render(4).reshape(-1, 3).mean(axis=0) == pytest.approx([1.0, 1.0, 1.0], abs=0.01)
