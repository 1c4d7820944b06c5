/* Weights of reflection and refraction, as the artist's controls have them. */
#pragma once

#include "incidence.h"
#include "lobe.h"
#include "random.h"

/* Of both lobes: their weights, or factors on these. */
struct Weights {
  color reflected;
  color transmitted;
};

/* The artist's factors on both lobes, and on the light that they carry. */
struct ScaleControls {
  float reflection;
  float refraction;
  float direct_reflection;
  float direct_refraction;
};

/* The artist's limits of reflections inside a medium. */
struct InteriorControls {
  int keeps_weak; /* all that are not total */
  int keeps_caustic;
  float probability; /* of weak ones */
  int most;
};

/* The artist's switches of light that leads to a diffuse surface's. */
struct CausticSwitches {
  int keeps_refraction;
  int keeps_reflection; /* by a medium's outside */
  int keeps_total_reflection;
  int keeps_direct_refraction; /* of light that lobes carry */
  int keeps_direct_reflection;
};

/* Weak reflections inside media are left out, or now and then (Russian roulette: Arvo and Kirk 1990); many reflections end
 * there. Total reflection carries the refracted energy: what leaves out weak ones leaves it alone. */
void limit_interior_reflections(Incidence at, InteriorControls controls, output color reflected)
{
  float probability = bounded(controls.probability, REFLECTION_PROBABILITY_LIMITS);
  int most = bounded(controls.most, MAX_INTERIOR_REFLECTIONS_LIMITS);
  if (at.inside) {
    if (!at.is_tir) {
      if (!(controls.keeps_weak && (controls.keeps_caustic || !at.on_caustic)))
        reflected = color(0.0);
      else if (probability > 0.0 && probability < 1.0)
        reflected *= (random(RANDOM_REFLECTION) < probability) ? 1.0 / probability : 0.0;
    }
    if (most < UNLIMITED_REFLECTIONS) {
      int reflections = 0;
      getattribute("path:glossy_depth", reflections);
      if (reflections >= most)
        reflected = color(0.0);
    }
  }
}

/* Leaves out what the artist does not want on the way to a diffuse surface's light. Refraction takes paths on to the exits
 * where lobes carry `lights`. */
void switch_caustics(Incidence at, CausticSwitches caustics, int lights, output Weights weight)
{
  if (at.on_caustic) {
    if ((at.is_tir && !caustics.keeps_total_reflection) || (!at.inside && !caustics.keeps_reflection))
      weight.reflected = color(0.0);
    if (!(caustics.keeps_refraction || (lights && caustics.keeps_direct_refraction && !at.exits)))
      weight.transmitted = color(0.0);
  }
}

/* Gives up what carries less of the light, of which `path` is left so far, than 10 to the exponent. How much a rough surface
 * reflects is its microfacets' matter. */
void cut_off_energy(Incidence at, float exponent, LobeControls refraction_lobe, LobeControls reflection_lobe, color path,
                    output Weights weight)
{
  float cutoff = bounded(exponent, ENERGY_CUTOFF_EXPONENT_LIMITS);
  if (cutoff > NO_CUTOFF && !at.is_walk) {
    float reflectance = 1.0, transmittance = 1.0;
    if (refraction_lobe.roughness == 0.0 && reflection_lobe.roughness == 0.0) {
      reflectance = fresnel_dielectric(at.cos_i, at.eta);
      transmittance = 1.0 - reflectance;
    }
    float least = pow(10.0, cutoff);
    if (max_component(path * weight.reflected) * reflectance < least)
      weight.reflected = color(0.0);
    if (max_component(path * weight.transmitted) * transmittance < least)
      weight.transmitted = color(0.0);
  }
}

/* Multiplies weights of both lobes. */
void scale_weights(Weights factor, output Weights weight)
{
  weight.reflected *= factor.reflected;
  weight.transmitted *= factor.transmitted;
}
