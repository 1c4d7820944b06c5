/* Reflection and refraction as closures of Cycles. */
#pragma once

#include "visible_normal.h"
#include "weights.h"

/* Thin films below this do not interfere visibly (Cycles' own cut-off, nm). */
#define THIN_FILM_CUTOFF 0.1

/* What both lobes of a surface share, as Cycles' closures take it. */
struct Optics {
  float ior;
  float inverse_abbe;   /* of the ratio of both indices; 0 where the closure is to split no light */
  float film_thickness; /* nm */
  float film_ior;
  int front_ior; /* see make_optics() */
};

/* The index goes from the ray's side to the other; the film's is relative to the medium the ray is in. With `front_ior`
 * closures take both as they are met from the front, and turn them on back faces themselves (Blender 5.3 on). Those
 * closures also refract anisotropically. */
Optics make_optics(Interface s, Incidence at, int front_ior, float film_thickness, float film_ior)
{
  float relative = bounded(film_ior, THIN_FILM_IOR_LIMITS) / s.from.ior.at_path;
  Optics o = {at.eta, 0.0, bounded(film_thickness, THIN_FILM_THICKNESS_LIMITS), relative, front_ior};
  if (front_ior && backfacing()) {
    o.ior = 1.0 / at.eta;
    o.film_ior = relative / at.eta;
  }
  return o;
}

/* Lets closures split white light by the ratio of both indices, as met from the front. */
void split_by_closures(Interface s, output Optics o)
{
  o.ior = backfacing() ? dispersing_ratio(s.to.ior, s.from.ior, o.inverse_abbe) :
                         dispersing_ratio(s.from.ior, s.to.ior, o.inverse_abbe);
}

/* Up to Blender 5.2 Cycles refracts isotropically, so the part of an anisotropic lobe that is longer one way is drawn here,
 * by turning the normal; `residual` is the isotropic remainder.
 *
 * Slopes of Beckmann's (1963) distribution are Gaussian with a variance of alpha^2 / 2, and Gaussians add up. GGX's
 * (Walter et al. 2007) are the same divided by the root of an exponentially distributed number, as the ratio of two
 * such numbers is distributed as GGX's squared slope. `weight`: light sees more of what is turned towards it, and as much of
 * the whole lobe as Smith's masking leaves. */
normal sample_anisotropic_normal(normal n, vector along, Lobe lobe, float eta, output Lobe residual, output float weight)
{
  float least = min(lobe.alpha_x, lobe.alpha_y);
  float most = max(lobe.alpha_x, lobe.alpha_y);
  float narrowing = (lobe.distribution == DISTRIBUTION_BECKMANN) ? 1.0 : max(-log(1.0 - random(RANDOM_NARROWING)), 1e-6);
  float slope = sqrt((most * most - least * least) / (2.0 * narrowing)) * random_gaussian(RANDOM_SLOPE);
  vector x = normalize(along - n * dot(along, n));
  vector t = (lobe.alpha_y > lobe.alpha_x) ? cross(n, x) : x;
  residual.distribution = DISTRIBUTION_BECKMANN;
  residual.alpha_x = residual.alpha_y = min(least / sqrt(narrowing), 1.0);
  normal turned = normalize(n - slope * t);
  vector out = refract(-I, turned, 1.0 / eta);
  weight = max(dot(n - slope * t, I), 0.0) / max(dot(n, I), 1e-3) * smith_g1(lobe, x, n, I) / smith_g1(residual, x, turned, I);
  if (dot(out, out) > 0.0)
    weight *= smith_g1(lobe, x, n, out) / max(smith_g1(residual, x, turned, out), 1e-3);
  return (weight > 0.0) ? turned : n;
}

/* Microfacets of Walter et al. (2007) with Cycles' closures; a film's interference is Belcour and Barla's (2017) there. */
closure color lobe_closure(color reflection_tint, color transmission_tint, Lobe lobe, vector along, normal n, Optics o)
{
  string distributions[3] = {"ggx", "multi_ggx", "beckmann"};
  float ax = 0.0, ay = 0.0;
  if (abs(o.ior - 1.0) > INDEX_MATCHED) {
    ax = lobe.alpha_x;
    ay = lobe.alpha_y;
  }
  /* A negative exponent is Cycles' word for the exact Fresnel equations of that index. */
  if (o.inverse_abbe != 0.0)
    return generalized_schlick_bsdf(n, along, reflection_tint, transmission_tint, ax, ay, color(fresnel_f0(o.ior)), color(1.0),
                                    -o.ior, distributions[lobe.distribution], "thinfilm_thickness", o.film_thickness,
                                    "thinfilm_ior", o.film_ior, "inv_abbe", o.inverse_abbe);
  if (o.film_thickness > THIN_FILM_CUTOFF)
    return generalized_schlick_bsdf(n, along, reflection_tint, transmission_tint, ax, ay, color(fresnel_f0(o.ior)), color(1.0),
                                    -o.ior, distributions[lobe.distribution], "thinfilm_thickness", o.film_thickness,
                                    "thinfilm_ior", o.film_ior);
  return dielectric_bsdf(n, along, reflection_tint, transmission_tint, ax, ay, o.ior, distributions[lobe.distribution]);
}

/* Cycles takes a smooth surface as it is here. Where scattered light meets one, Cycles blurs it (Filter Glossy), leaves it out of
 * caustics or walks through it to lights; and it turns a normal that would reflect light into its face, or nearly along it. */
int stays_smooth(normal n)
{
  return (raytype("camera") || raytype("singular")) && dot(reflect(-I, n), Ng) > 0.01;
}

/* A smooth surface by closures that name no distribution: Cycles makes strings to compare a name with at every hit, a tenth
 * of all sampling time. */
closure color smooth_closure(color reflection_tint, color transmission_tint, normal n, float eta, float ior)
{
  float reflected = fresnel_dielectric(clamp(dot(I, n), 0.0, 1.0), eta);
  return (reflection_tint * reflected) * reflection(n) + (transmission_tint * (1.0 - reflected)) * refraction(n, ior);
}

/* Whether light passes through the facets that it sees as if none masked another.
 *
 * A surface between equal indices is not there: all light passes. Facets that mask each other lose light in single scattering,
 * up to half of it at a grazing angle, however near the indices are; in truth it meets the next facet, and goes on nearly
 * straight. Multi-scatter GGX gives it back, but its tables in Cycles end at a relative change of 0.0021 (0.0088 in 5.2), below
 * which up to 40 % are lost and up to 11 % made. So it is not used there, and the others lose as much less as the indices are
 * nearer. */
int passes_unmasked(Lobe lobe, float eta)
{
  float change = abs(eta - 1.0);
  if (max(lobe.alpha_x, lobe.alpha_y) == 0.0 || change >= INDEX_NEARLY_MATCHED || change <= INDEX_MATCHED)
    return 0;
  return lobe.distribution == DISTRIBUTION_MULTI_GGX || random(RANDOM_MASKING) * INDEX_NEARLY_MATCHED > change;
}

/* A rough surface between nearly equal indices: its normal is drawn here, and the surface is smooth about it. Where it would reflect
 * light into the surface Cycles turns it, so none is lost. A lobe that the artist separates stays as it is. Walks take the surface
 * for smooth, as they need one normal in one place. */
closure color unmasked_closure(Weights tint, Lobe reflects, Lobe refracts, int separate, ShadingFrame frame, Incidence at,
                               Optics o)
{
  Lobe facet = {refracts.distribution, 0.0, 0.0};
  normal turned = frame.n;
  if (!at.is_walk) {
    turned = visible_normal(refracts, frame);
    if (dot(refract(-I, turned, 1.0 / at.eta), Ng) > 0.0)
      turned = frame.n; /* light that does not get through */
  }
  if (!separate)
    return lobe_closure(tint.reflected, tint.transmitted, facet, frame.along, turned, o);
  Lobe mirror = facet;
  normal mirror_n = turned;
  if (reflects.alpha_x != refracts.alpha_x || reflects.alpha_y != refracts.alpha_y ||
      reflects.distribution != refracts.distribution) {
    mirror = reflects;
    mirror_n = frame.n;
  }
  return lobe_closure(tint.reflected, color(0.0), mirror, frame.along, mirror_n, o) +
         lobe_closure(color(0.0), tint.transmitted, facet, frame.along, turned, o);
}

/* Reflection and refraction; `rough` if refraction may be, which folds where it is not; `separate` if their lobes differ. */
closure color dielectric_closure(Weights tint, Lobe reflects, Lobe refracts, int rough, int separate, ShadingFrame frame,
                                 Incidence at, Optics o)
{
  int smooth = !separate && refracts.alpha_x == 0.0 && refracts.alpha_y == 0.0 && o.film_thickness <= THIN_FILM_CUTOFF &&
               o.inverse_abbe == 0.0 && stays_smooth(frame.n);
  if (smooth)
    return smooth_closure(tint.reflected, tint.transmitted, frame.n, at.eta, o.ior);
  if (rough && passes_unmasked(refracts, at.eta))
    return unmasked_closure(tint, reflects, refracts, separate, frame, at, o);
  int turns = !o.front_ior && refracts.alpha_x != refracts.alpha_y;
  if (!separate && !turns)
    return lobe_closure(tint.reflected, tint.transmitted, refracts, frame.along, frame.n, o);
  Lobe residual = refracts;
  normal turned = frame.n;
  float weight = 1.0;
  if (turns)
    turned = sample_anisotropic_normal(frame.n, frame.along, refracts, at.eta, residual, weight);
  return lobe_closure(tint.reflected, color(0.0), reflects, frame.along, frame.n, o) +
         lobe_closure(color(0.0), tint.transmitted * weight, residual, frame.along, turned, o);
}
