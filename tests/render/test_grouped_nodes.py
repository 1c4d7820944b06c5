"""A nested dielectric renders the same wherever an artist puts its node."""

import bpy
import numpy as np
import pytest
from places_of_nodes import duplicated, grouped, renamed, twice_grouped
from scenes import add_camera, add_sphere, new_scene, render, set_striped_world

import nested_dielectric as nd


def test_media_whose_nodes_are_grouped_renamed_or_copied_render_as_plain_ones():
    """Each reads the other's index, on both sides of a common surface."""
    pictures = []
    for ways in ((), (twice_grouped, duplicated), (renamed, grouped)):
        new_scene(24)
        set_striped_world()
        tint = {"transmittance": (0.5, 0.7, 0.9), "transmittance_depth": 0.5}
        media = nd.new_material("Glass", ior=1.5, priority=1, **tint), nd.new_material("Water", ior=1.33, priority=2)
        for material, way in zip(media, ways):
            way(material)
        glass, water = media
        add_sphere("Outer", 1.0, water, segments=32)
        add_sphere("Inner", 0.6, glass, None, (0.5, 0, 0), segments=32)
        add_camera((0.1, -6, 0.3), (0.05, 0, 0), angle=24)
        assert nd.prepare(bpy.context.scene).problems == ()
        pictures.append(render(8))
    for picture in pictures[1:]:
        # The same rays; what surrounds a surface is asked here and known there, which rounding tells apart at few samples, and
        # the tint is the surface's here and the volume's there, so that Cycles draws some lobes otherwise.
        assert np.mean(np.abs(picture - pictures[0]).max(axis=-1) > 1e-3) < 0.05
        assert picture.mean() == pytest.approx(pictures[0].mean(), rel=1e-3)
