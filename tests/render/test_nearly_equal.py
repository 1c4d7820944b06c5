"""Rough surfaces between nearly equal indices lose no light that would pass straight through."""

import bpy  # before bmesh, which lives inside it
import numpy as np
import pytest
from references import reference_batches
from scenes import (
    add_camera,
    add_sphere,
    batches,
    cycles_glass,
    new_scene,
    render,
    set_striped_world,
    set_world,
)
from shading import evaluate, tiles
from significance import assert_same_picture

import nested_dielectric as nd
from nested_dielectric.model.contract import INDEX_NEARLY_MATCHED

CHANGES = (-8e-3, -3e-3, -1e-3, -1e-4, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 8e-3)
PIXELS = 16


def energies(distribution: str, roughness: float, backend: str, changes=CHANGES) -> np.ndarray:
    """How much of a white world each of some balls shows, whose indices are 1 and these changes."""
    scene = new_scene(PIXELS)
    set_world()
    scene.render.resolution_x = PIXELS * len(changes)
    for index, change in enumerate(changes):
        medium = nd.new_material("Medium", ior=1.0 + change, roughness=roughness, distribution=distribution)
        add_sphere("Ball", 0.45, medium, location=(index, 0.0, 0.0))
    middle = (len(changes) - 1) / 2
    add_camera((middle, -5.0, 0.0), (middle, 0.0, 0.0), width=len(changes))
    nd.prepare(scene, backend=backend)
    picture = render(64).mean(axis=2).reshape(PIXELS, len(changes), PIXELS)
    x, y = np.meshgrid(*[(np.arange(PIXELS) + 0.5) / PIXELS - 0.5] * 2)
    return picture.transpose(1, 0, 2)[:, np.hypot(x, y) < 0.4].mean(axis=1)


@pytest.mark.parametrize("roughness", [0.3, 1.0])
def test_multiple_scattering_between_nearly_equal_indices_keeps_all_light(roughness):
    """No weight is other than 1, so there is no noise. Cycles' own Glass shows 0.77 to 1.02 of a ball of roughness 1."""
    np.testing.assert_allclose(energies("MULTI_GGX", roughness, "OSL"), 1.0, atol=1e-4)


@pytest.mark.parametrize("distribution", ["GGX", "BECKMANN"])
def test_single_scattering_loses_the_less_the_nearer_the_indices_are(distribution):
    """From none, as there is no surface between equal indices, to what facets mask at the limit, and no step there."""
    parts = np.array([3e-5 / INDEX_NEARLY_MATCHED, 0.25, 0.5, 0.75, 0.99, 1.01])
    for sign in (-1.0, 1.0):
        lost = 1.0 - energies(distribution, 1.0, "OSL", tuple(sign * INDEX_NEARLY_MATCHED * parts))
        assert lost[-1] > 0.05
        # Light passes the ball's surface twice, and what is lost there is lost at once: so a line, less half its square.
        np.testing.assert_allclose(lost, lost[-1] * np.minimum(parts, 1.0), atol=0.1 * lost[-1])
        assert lost[0] < 0.01 * lost[-1]
        assert lost[-2] == pytest.approx(lost[-1], rel=0.05)


@pytest.mark.parametrize("distribution", ["MULTI_GGX", "GGX", "BECKMANN"])
def test_own_nodes_show_a_rough_surface_between_nearly_equal_indices_smooth(distribution):
    """It gets rough from six tenths of the limit on."""
    changes = tuple(change for change in CHANGES if abs(change) < 0.6 * INDEX_NEARLY_MATCHED)
    np.testing.assert_allclose(energies(distribution, 1.0, "NATIVE", changes), 1.0, atol=1e-4)
    if distribution == "MULTI_GGX":
        # Single samples weigh more and less than 1 there.
        np.testing.assert_allclose(energies(distribution, 1.0, "NATIVE", (-8e-3, 8e-3)), 1.0, atol=5e-3)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_just_below_the_limit_light_is_spread_as_by_cycles_own_glass(sign):
    ior = 1.0 + sign * 0.98 * INDEX_NEARLY_MATCHED

    def reference() -> bpy.types.Material:
        material = cycles_glass(ior, 0.6)
        material.node_tree.nodes["Glass BSDF"].distribution = "MULTI_GGX"
        return material

    def picture(material, look=batches) -> np.ndarray:
        new_scene(48)
        set_striped_world()
        bpy.context.scene.world.cycles.sampling_method = "NONE"  # what is drawn is compared, not what lights add
        add_camera((0, -5, 0.3), (0, 0, 0), angle=26)
        add_sphere("Ball", 1.0, material())
        return look(64, 16)

    ours = picture(lambda: nd.new_material("Glass", ior=ior, roughness=0.6, distribution="MULTI_GGX"))
    # Steep facets send light aside by more than a degree, and single scattering masks those otherwise than the rest; and Cycles
    # turns normals that would reflect light into the surface. Were it smooth, tiles would differ by 8 %.
    assert_same_picture(ours, picture(reference, reference_batches), bias=1.5e-2)


NORMALS = """
#define COLUMNS %(columns)d
#include "visible_normal.h"

shader test(output color Result = color(0.0))
{
  int c = (int)floor(P[0] * COLUMNS);
  float alphas[3] = {0.09, 0.36, 1.0};
  Lobe lobe;
  lobe.distribution = (c %% 2) ? DISTRIBUTION_BECKMANN : DISTRIBUTION_GGX;
  lobe.alpha_y = alphas[(c / 2) %% 3];
  lobe.alpha_x = 0.5 * lobe.alpha_y;
  float angle = radians((c / 6) ? 80.0 : 35.0);
  vector x = vector(cos(angle), 0.0, sin(angle));
  normal n = normal(-sin(angle), 0.0, cos(angle));
  ShadingFrame frame = {n, vector(0.0), normalize(x + vector(0.0, 1.0, 0.0)), 0.0};
  vector along = frame.along;
  vector across = cross(n, along);
  normal m = visible_normal(lobe, frame);
  Result = 0.5 + 0.5 * color(dot(m, along), dot(m, across), dot(m, n));
}
"""


def expected_moments(beckmann: bool, alpha: float, degrees: float) -> np.ndarray:
    """Means of a visible normal's components along, across and off the surface, and of their squares: (2, 3).

    Slopes are spread evenly by their own distribution; each counts as much as the viewer sees of its facet (Heitz 2014, 19).
    """
    u, turn = np.meshgrid((np.arange(1500) + 0.5) / 1500, (np.arange(360) + 0.5) * np.pi / 180.0)
    radius = np.sqrt(-np.log1p(-u)) if beckmann else np.sqrt(u / (1.0 - u))
    slope_x, slope_y = 0.5 * alpha * radius * np.cos(turn), alpha * radius * np.sin(turn)
    angle = np.radians(degrees)
    # The viewer is in the plane of the normal and of what lies half way between the tangent and the bitangent.
    seen_x, seen_y, seen_z = np.sin(angle) / np.sqrt(2.0), -np.sin(angle) / np.sqrt(2.0), np.cos(angle)
    facing = np.maximum(-slope_x * seen_x - slope_y * seen_y + seen_z, 0.0)
    normals = np.stack([-slope_x, -slope_y, np.ones_like(slope_x)]) / np.sqrt(1.0 + slope_x**2 + slope_y**2)
    return np.array([(normals**power * facing).sum(axis=(1, 2)) / facing.sum() for power in (1, 2)])


def test_facets_are_drawn_as_they_are_seen():
    """GGX and Beckmann, three roughnesses, stretched, from 35 and 80 degrees."""
    size, columns = 128, 12
    drawn = 2.0 * tiles(evaluate(NORMALS % {"columns": columns}, columns * size, size), columns) - 1.0
    for case, normals in enumerate(drawn):
        expected = expected_moments(case % 2 == 1, (0.09, 0.36, 1.0)[case // 2 % 3], 80.0 if case >= 6 else 35.0)
        for power, mean in enumerate(expected, 1):
            powers = normals.astype(float) ** power
            error = powers.std(axis=0) / np.sqrt(len(powers)) + 1e-5
            assert np.all(np.abs(powers.mean(axis=0) - mean) < 4.5 * error), (case, power, powers.mean(axis=0), mean)
