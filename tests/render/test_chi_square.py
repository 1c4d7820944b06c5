"""Directions that the shader draws are distributed as the pdfs that it weighs them by say.

Each case draws many directions and counts them in bins of the sphere; what is expected in a bin is the shader's own pdf,
integrated over it. Bins are even in an angle around the case's middle direction, in units of its width.
"""

import math

import numpy as np
import pytest
from scenes import fresnel
from shading import evaluate, tiles

SIGNIFICANCE = 0.01
"""Chance that any case of one test fails without a fault (Sidak 1967)."""

LEAST_EXPECTED = 5.0
"""Bins of which less is expected are counted as one."""

BINS = 12
"""Of the angle, and of the azimuth."""

HEADER = """
#define SAMPLE %(sample)d
#define COLUMNS %(columns)d
#define SIZE %(size)d
#define FINER %(finer)d /* places where a pdf is looked at, along either side of a pixel */
#include "bounds.h"
#include "light.h"
#include "random.h"
#include "%(include)s"

/* Where a direction stands around a middle one: the angle, in units of a width, and the azimuth, both from 0 to 1. */
vector place_of(vector direction, vector middle, float width)
{
  vector t = perpendicular(middle);
  float x = dot(direction, t), y = dot(direction, cross(middle, t));
  float angle = atan2(sqrt(x * x + y * y), dot(direction, middle));
  float most = M_PI / (M_PI + width);
  return vector(angle / (angle + width) / most, mod(atan2(y, x) / M_2PI + 1.0, 1.0), 0.0);
}

/* One of FINER * FINER places in the point's part of the case, at random within its own part of that. */
vector finer_place(int i)
{
  vector p = P * COLUMNS;
  float x = (i %% FINER + random(20 + 2 * i)) / FINER - 0.5;
  float y = (i / FINER + random(21 + 2 * i)) / FINER - 0.5;
  return p - floor(p) + vector(x, y, 0.0) / SIZE;
}

/* The direction in a place, and the solid angle of the square of all places that is there. */
vector direction_at(vector place, vector middle, float width, output float solid_angle)
{
  float most = M_PI / (M_PI + width);
  float s = place[0] * most;
  float angle = width * s / (1.0 - s);
  solid_angle = M_2PI * sin(angle) * width / ((1.0 - s) * (1.0 - s)) * most;
  vector t = perpendicular(middle);
  vector aside = t * cos(M_2PI * place[1]) + cross(middle, t) * sin(M_2PI * place[1]);
  return middle * cos(angle) + aside * sin(angle);
}

"""

ROUGH = """
shader test(output color Result = color(0.0))
{
  int c = (int)floor(P[0] * COLUMNS) + COLUMNS * (int)floor(P[1] * COLUMNS);
  float alphas[3] = {0.01, 0.16, 0.81};
  Lobe lobe;
  lobe.distribution = (c % 2) ? DISTRIBUTION_BECKMANN : DISTRIBUTION_GGX;
  int refracts = (c / 2) % 2;
  lobe.alpha_y = alphas[(c / 4) % 3];
  lobe.alpha_x = lobe.alpha_y * (((c / 12) % 2) ? 0.3 : 1.0);
  float angle = radians(((c / 24) % 2) ? 70.0 : 20.0);
  float eta = (c / 48) ? 1.0 / 1.5 : 1.5;
  normal n = normal(sin(angle) * cos(0.7), sin(angle) * sin(0.7), cos(angle));
  ShadingFrame frame = {n, vector(0.0), vector(0.3, 1.0, 0.2), 0.0};
  MicrofacetBsdf s = make_bsdf(lobe, refracts, frame, eta);
  vector middle = refracts ? refract(-I, n, 1.0 / eta) : reflect(-I, n);
  if (dot(middle, middle) == 0.0)
    middle = -n;
  float width = max(lobe.alpha_x, lobe.alpha_y);
  float pdf = 0.0;
  if (SAMPLE) {
    vector direction = bsdf_sample(s, random(RANDOM_BSDF_SAMPLE), random(RANDOM_BSDF_SAMPLE + 1));
    float value = (dot(direction, direction) > 0.0) ? bsdf_eval(s, direction, pdf) : 0.0;
    vector place = place_of(direction, middle, width);
    Result = (pdf > 0.0) ? color(place[0], place[1], value / pdf) : color(2.0, 0.0, 0.0);
  }
  else {
    for (int i = 0; i < FINER * FINER; i++) {
      float solid_angle;
      vector direction = direction_at(finer_place(i), middle, width, solid_angle);
      float value = bsdf_eval(s, direction, pdf);
      Result += color(pdf, value, 0.0) * (solid_angle / (FINER * FINER));
    }
  }
}
"""

LIGHTS = """
shader test(output color Result = color(0.0))
{
  int c = (int)floor(P[0] * COLUMNS) + COLUMNS * (int)floor(P[1] * COLUMNS);
  Light light;
  int kinds[5] = {LIGHT_POINT, LIGHT_SUN, LIGHT_SPOT, LIGHT_AREA, LIGHT_ELLIPSE};
  light.kind = kinds[c % 5];
  float large = (c / 5) ? 0.9 : 0.05;
  light.centre = (light.kind == LIGHT_SUN) ? vector(0.36, 0.48, 0.8) : vector(0.3, -0.4, 1.2);
  light.axis = normalize(vector(0.2, 0.5, -1.0));
  vector t = perpendicular(light.axis);
  light.edge_x = 2.0 * large * t;
  light.edge_y = 0.7 * large * cross(light.axis, t);
  light.size = large;
  light.aperture = (light.kind == LIGHT_SPOT) ? -1.0 : M_PI / 2;
  light.blend = 0.0;
  vector middle = normalize(light.centre);
  float width = large;
  if (SAMPLE) {
    LightSample p = light_sample(light, random(RANDOM_LIGHT_SAMPLE), random(RANDOM_LIGHT_SAMPLE + 1));
    vector place = place_of(p.direction, middle, width);
    Result = (p.pdf > 0.0) ? color(place[0], place[1], p.radiance / p.pdf) : color(2.0, 0.0, 0.0);
  }
  else {
    for (int i = 0; i < FINER * FINER; i++) {
      float solid_angle;
      LightSample p = light_intersect(light, direction_at(finer_place(i), middle, width, solid_angle));
      Result += color(p.pdf, p.radiance, 0.0) * (solid_angle / (FINER * FINER));
    }
  }
}
"""


RANDOM = """
shader test(output color Result = color(0.0))
{
  int c = (int)floor(P[0] * COLUMNS);
  int first[4] = {RANDOM_SLOPE, RANDOM_LIGHT_SAMPLE, RANDOM_BSDF_SAMPLE, RANDOM_LIGHT_CHOICE};
  Result = color(random(first[c]), random(first[c] + 1), 0.5 + 0.5 * erf(random_gaussian(RANDOM_SLOPE) / sqrt(2.0)));
}
"""

SIZE = 12 * BINS
"""Pixels along a side of each case: so many squared directions are drawn."""

ROUGH_COLUMNS, ROUGH_ROWS = 12, 8
LIGHT_COLUMNS, LIGHT_ROWS = 5, 2


def run(body: str, include: str, columns: int, rows: int, sample: bool, finer: int = 3) -> np.ndarray:
    """What a shader draws in every case, or expects; (cases, points, 3)."""
    text = HEADER % {"sample": sample, "columns": columns, "size": SIZE, "include": include, "finer": finer} + body
    return tiles(evaluate(text, columns * SIZE, rows * SIZE), columns)


def run_rough(sample: bool, body: str = ROUGH) -> np.ndarray:
    """As :func:`run`, of rough surfaces."""
    return run(body, "microfacet.h", ROUGH_COLUMNS, ROUGH_ROWS, sample)


@pytest.fixture(scope="module")
def rough() -> tuple[np.ndarray, np.ndarray]:
    """Directions of rough surfaces, and what is expected of them."""
    return run_rough(True), run_rough(False)


@pytest.fixture(scope="module")
def lights() -> tuple[np.ndarray, np.ndarray]:
    """Directions to lights, and what is expected of them."""
    return tuple(run(LIGHTS, "light.h", LIGHT_COLUMNS, LIGHT_ROWS, sample, finer=6) for sample in (True, False))


def p_value(drawn: np.ndarray, expected: np.ndarray) -> float:
    """Chance of counts at least as far from what is expected (Pearson 1900); no direction is one more bin.

    ``drawn`` (points, 3) holds places, beyond 1 where there is none; ``expected`` (points, 3) pdfs at a grid of places.
    """
    met = drawn[:, 0] <= 1.0
    counts, _, _ = np.histogram2d(drawn[met, 1], drawn[met, 0], bins=BINS, range=((0, 1), (0, 1)))
    part = SIZE // BINS
    shares = expected[:, 0].reshape(BINS, part, BINS, part).mean(axis=(1, 3)) / BINS**2
    counts = np.append(counts, len(drawn) - met.sum())
    return chi_square(counts, np.append(shares, max(1.0 - shares.sum(), 0.0)) * len(drawn))


def chi_square(counts: np.ndarray, expected: np.ndarray) -> float:
    """Chance of counts at least as far from what is expected; rare bins are counted together."""
    order = np.argsort(expected)
    counts, expected = counts[order], expected[order]
    pooled = int(np.searchsorted(np.cumsum(expected), LEAST_EXPECTED)) + 1
    rare = max(pooled, int((expected < LEAST_EXPECTED).sum()))
    counts = np.append(counts[rare:], counts[:rare].sum())
    expected = np.append(expected[rare:], expected[:rare].sum())
    if len(counts) == 1:
        return 1.0
    return above(((counts - expected) ** 2 / expected).sum(), len(counts) - 1)


def above(statistic: float, freedom: int) -> float:
    """Chance that chi-square of so many degrees of freedom is above a number (Wilson and Hilferty 1931)."""
    scale = 2.0 / (9.0 * freedom)
    return 0.5 * math.erfc(((statistic / freedom) ** (1.0 / 3.0) - 1.0 + scale) / math.sqrt(2.0 * scale))


def level(cases: int) -> float:
    """Significance of one of many cases."""
    return 1.0 - (1.0 - SIGNIFICANCE) ** (1.0 / cases)


def assert_weights(drawn: np.ndarray, expected: np.ndarray) -> None:
    """The mean of value over pdf is the value's integral: within 4 standard errors and what the integral errs.

    Where one direction in fifty leads anywhere, a standard error is none that the few tell.
    """
    weights = drawn[..., 2]
    mean, error = weights.mean(axis=1), weights.std(axis=1) / math.sqrt(weights.shape[1])
    integral = expected[..., 1].mean(axis=1)
    worst = (np.abs(mean - integral) - INTEGRATION * integral - 1e-5) / np.maximum(error, 1e-12)
    worst[expected[..., 0].mean(axis=1) < 0.02] = 0.0
    case = worst.argmax()
    assert worst[case] < 4.0, f"case {case}: {mean[case]:.5f} instead of {integral[case]:.5f} +- {error[case]:.5f}"


INTEGRATION = 1e-3
"""Relative error of a pdf's integral over all places: edges of lights and of total reflection lie between places."""


def test_directions_of_rough_surfaces_are_drawn_by_their_pdf(rough):
    """Both lobes, GGX and Beckmann, three roughnesses, round and stretched, at 20 and 70 degrees, from either medium."""
    chances = np.array([p_value(*case) for case in zip(*rough)])
    assert chances.min() > level(len(chances)), f"case {chances.argmin()}: {chances.min():.2g}"


def test_a_pdf_that_is_a_tenth_too_wide_would_show(rough):
    """The power of the test above: only where total reflection leaves next to nothing may it stay unseen."""
    drawn = run_rough(True, ROUGH.replace("bsdf_sample(s,", "bsdf_sample(wide,").replace("vector middle =", WIDER, 1))
    chances = np.array([p_value(*case) for case in zip(drawn, rough[1])])
    there = rough[1][..., 0].mean(axis=1) > 0.2
    assert np.mean(chances[there] < level(len(chances))) > 0.95


WIDER = "MicrofacetBsdf wide = s; wide.lobe.alpha_x *= 1.1; wide.lobe.alpha_y *= 1.1; vector middle ="


def test_what_rough_surfaces_send_is_as_much_by_drawing_as_by_integrating(rough):
    assert_weights(*rough)


def test_a_pdf_is_never_more_than_certain(rough, lights):
    assert np.all(rough[1][..., 0].mean(axis=1) < 1.0 + INTEGRATION)
    assert np.allclose(lights[1][..., 0].mean(axis=1), 1.0, atol=INTEGRATION)


def test_narrow_lobes_send_what_fresnel_says(rough):
    """A mirror in the limit: lobes of a roughness of 0.1 at 20 degrees lose nothing."""
    reflected, refracted = rough[1][0, :, 1].mean(), rough[1][2, :, 1].mean()
    assert reflected == pytest.approx(fresnel(20.0, 1.0, 1.5), rel=2e-3)
    assert reflected + refracted == pytest.approx(1.0, abs=1e-3)


def test_points_of_lights_are_drawn_by_their_solid_angle(lights):
    """Spheres, a sun, a spot, a rectangle and an ellipse, small and large, seen at a slant."""
    chances = np.array([p_value(*case) for case in zip(*lights)])
    assert chances.min() > level(len(chances)), f"case {chances.argmin()}: {chances.min():.2g}"


def test_lights_give_as_much_by_drawing_as_by_integrating(lights):
    assert_weights(*lights)


def test_random_numbers_are_even_in_pairs_and_normal_where_they_say():
    drawn = run(RANDOM, "random.h", 4, 1, True)
    chances = []
    for case in drawn:
        counts, _, _ = np.histogram2d(case[:, 0], case[:, 1], bins=BINS, range=((0, 1), (0, 1)))
        chances.append(chi_square(counts.ravel(), np.full(BINS**2, len(case) / BINS**2)))
    counts, _ = np.histogram(drawn[..., 2], bins=BINS**2, range=(0, 1))
    chances.append(chi_square(counts, np.full(BINS**2, counts.sum() / BINS**2)))
    assert min(chances) > level(len(chances)), chances
