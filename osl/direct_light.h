/* Light of the scene's lights that lobes carry instead of Cycles' rays. */
#pragma once

#include "microfacet.h"
#include "weights.h"

/* Points of a light, and directions of a lobe, that are drawn at a surface. */
#define LIGHT_SAMPLES 4
#define BSDF_SAMPLES 4

/* Number k of n that are spread evenly: a lattice (Korobov 1959) that is shifted as a whole. */
vector lattice_point(int k, int n, float r1, float r2)
{
  return vector(mod(r1 + k / (float)n, 1.0), mod(r2 + k * 0.618034, 1.0), 0.0);
}

/* Light of a light with a strength of 1 by a rough surface: points of the light and directions of the lobe, weighed by
 * their pdfs (balance heuristic: Veach and Guibas 1995). What lies between is opaque. */
float direct_light_mis(MicrofacetBsdf bsdf, Light light)
{
  float sum = 0.0;
  float r1 = random(RANDOM_LIGHT_SAMPLE), r2 = random(RANDOM_LIGHT_SAMPLE + 1);
  float r3 = random(RANDOM_BSDF_SAMPLE), r4 = random(RANDOM_BSDF_SAMPLE + 1);
  for (int k = 0; k < LIGHT_SAMPLES + BSDF_SAMPLES; k++) {
    LightSample s;
    if (k < LIGHT_SAMPLES) {
      vector r = lattice_point(k, LIGHT_SAMPLES, r1, r2);
      s = light_sample(light, r[0], r[1]);
    }
    else {
      vector r = lattice_point(k - LIGHT_SAMPLES, BSDF_SAMPLES, r3, r4);
      s = light_intersect(light, bsdf_sample(bsdf, r[0], r[1]));
    }
    if (s.radiance > 0.0) {
      float pdf;
      float scattered = bsdf_eval(bsdf, s.direction, pdf) * s.radiance;
      if (scattered > 0.0 && !trace(P, s.direction, "maxdist", s.distance * 0.9999))
        sum += scattered / (LIGHT_SAMPLES * s.pdf + BSDF_SAMPLES * pdf);
    }
  }
  return sum;
}

/* The artist's controls of how a lobe of direct refraction gets wider. */
struct Widening {
  float offset;
  float depth_multiplier; /* for each bounce of the path */
  float depth_adder;
  float caustic_offset; /* on the way to a diffuse surface's light */
};

/* Makes the lobe of direct refraction as wide as it is to be at this bounce, where it is `used`. */
void widen_lobe(int used, Incidence at, Widening by, output float roughness)
{
  if (used) {
    float multiplier = bounded(by.depth_multiplier, DIRECT_ROUGHNESS_DEPTH_MULTIPLIER_LIMITS);
    float adder = bounded(by.depth_adder, DIRECT_ROUGHNESS_DEPTH_ADDER_LIMITS);
    roughness += bounded(by.offset, DIRECT_ROUGHNESS_OFFSET_LIMITS);
    if (at.on_caustic)
      roughness += bounded(by.caustic_offset, CAUSTIC_ROUGHNESS_OFFSET_LIMITS);
    if (multiplier != 1.0 || adder != 0.0) {
      int depth = 0;
      getattribute("path:ray_depth", depth);
      roughness = roughness * min(pow(multiplier, (float)depth), LARGEST) + adder * depth;
    }
  }
}

/* The artist's controls of a second lobe of direct refraction. */
struct SecondLobe {
  float scale; /* its share */
  float roughness_multiplier;
};

/* Through the surface, as direct_light_mis(): a share of it by a second, wider lobe. */
float direct_refraction(Incidence at, Light light, LobeControls direct, SecondLobe second, ShadingFrame frame)
{
  float refracted = direct_light_mis(make_bsdf(make_lobe(direct, frame), 1, frame, at.eta), light);
  float scale = bounded(second.scale, DIRECT_SECOND_SCALE_LIMITS);
  if (scale > 0.0) {
    LobeControls wider = direct;
    wider.roughness *= bounded(second.roughness_multiplier, DIRECT_SECOND_ROUGHNESS_MULTIPLIER_LIMITS);
    refracted = mix(refracted, direct_light_mis(make_bsdf(make_lobe(wider, frame), 1, frame, at.eta), light), scale);
  }
  return refracted;
}

/* Part of a light that the lobes bring to the viewer: refracted out of all media, or reflected where it would enter.
 * Microfacets let light through even where the surface as a whole would not. `carried`: whether lobes carry it in refraction
 * (x), in reflection (y). */
color carried_light(Incidence at, Light light, vector carried, ScaleControls scale, CausticSwitches caustics,
                    LobeControls direct, SecondLobe second, Lobe reflects, ShadingFrame frame, Weights factor)
{
  color part = color(0.0);
  if (carried[0] > 0.0 && at.exits && (!at.on_caustic || caustics.keeps_direct_refraction))
    part = factor.transmitted * (scale.refraction * bounded(scale.direct_refraction, DIRECT_REFRACTION_LIMITS) *
                                 direct_refraction(at, light, direct, second, frame));
  if (carried[1] > 0.0 && at.enters && (!at.on_caustic || caustics.keeps_direct_reflection))
    part = factor.reflected * (scale.reflection * bounded(scale.direct_reflection, DIRECT_REFLECTION_LIMITS) *
                               direct_light_mis(make_bsdf(reflects, 0, frame, at.eta), light));
  return part;
}

/* Adds the part of a light that lobes carry, where there is any; `total` and `strength` are the shader's LightTotal and
 * LightStrength. */
void add_carried_light(closure color emitter, color carried, float total, vector strength, output closure color surface)
{
  if (max_component(carried) > 0.0)
    surface += emitter * (carried * total / EMITTER_RADIANCE * (color)strength);
}
