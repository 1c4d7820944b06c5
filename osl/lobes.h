/* The lobes that rough surfaces reflect and refract light into. */
#pragma once

#include "optics.h"
#include "random.h"

#define DISTRIBUTION_GGX 0
#define DISTRIBUTION_MULTI_GGX 1
#define DISTRIBUTION_BECKMANN 2

#define TANGENT_GIVEN 0
#define TANGENT_REFRACTION 1

/* Below this relative change of index light neither bends nor reflects measurably (F < 1e-10), and the half vector of a
 * rough lobe is not defined. */
#define INDEX_MATCHED 2e-5

/* Thin films below this do not interfere visibly (Cycles' own cut-off, nm). */
#define THIN_FILM_CUTOFF 0.1

struct Lobe {
  int distribution;
  float alpha_x; /* along the tangent */
  float alpha_y; /* across it */
};

/* What both lobes of a surface share. */
struct Film {
  float thickness; /* nm */
  float ior;       /* relative to the medium the ray is in */
};

/* The direction that a surface's tangents are made from: where the normal points along it they have a pole. */
vector tangent_axis(vector tangent, int source, vector refracted_way)
{
  if (source == TANGENT_REFRACTION)
    return (dot(refracted_way, refracted_way) > 0.0) ? refracted_way : -I;
  return (dot(tangent, tangent) > 0.0) ? normalize(tangent) : normalize(transform("object", "world", vector(0.0, 0.0, 1.0)));
}

/* The artist's tangent, the way of the refracted light along the surface, or a circle around the object's Z axis. */
vector tangent_along(vector tangent, int source, vector axis)
{
  vector along = axis;
  if (source == TANGENT_GIVEN && dot(tangent, tangent) == 0.0)
    along = cross(axis, P - transform("object", "world", point(0.0)));
  along -= N * dot(along, N);
  return (dot(along, along) > 1e-12) ? normalize(along) : normalize(dPdu);
}

/* A lobe from the artist's numbers. `blur` makes it round where the normal points along the tangents' axis. */
Lobe make_lobe(int distribution, float roughness, float anisotropy, float blur, vector axis)
{
  Lobe lobe;
  lobe.distribution = distribution;
  anisotropic_alpha(clamp(roughness, 0.0, 1.0), anisotropy, lobe.alpha_x, lobe.alpha_y);
  if (anisotropy != 0.0 && blur > 0.0) {
    float mean = sqrt(lobe.alpha_x * lobe.alpha_y);
    float pole = pow(abs(dot(axis, N)), 1.0 / min(blur, 1.0) - 1.0);
    lobe.alpha_x = mix(lobe.alpha_x, mean, pole);
    lobe.alpha_y = mix(lobe.alpha_y, mean, pole);
  }
  return lobe;
}

/* Cycles refracts isotropically, so the part of an anisotropic lobe that is longer one way is drawn here, by turning
 * the normal: `lobe` becomes the isotropic rest.
 *
 * Slopes of Beckmann's (1963) distribution are Gaussian with a variance of alpha^2 / 2, and Gaussians add up. GGX's
 * (Walter et al. 2007) are the same divided by the root of an exponentially distributed number, as the ratio of two
 * such numbers is distributed as GGX's squared slope. */
normal drawn_normal(normal n, vector along, Lobe lobe, output Lobe rest)
{
  float least = min(lobe.alpha_x, lobe.alpha_y);
  float most = max(lobe.alpha_x, lobe.alpha_y);
  float narrowing = (lobe.distribution == DISTRIBUTION_BECKMANN) ? 1.0 : max(-log(1.0 - random(RANDOM_NARROWING)), 1e-6);
  float slope = sqrt((most * most - least * least) / (2.0 * narrowing)) * random_gaussian(RANDOM_SLOPE);
  vector t = normalize(along - n * dot(along, n));
  if (lobe.alpha_y > lobe.alpha_x)
    t = cross(n, t);
  rest.distribution = DISTRIBUTION_BECKMANN;
  rest.alpha_x = rest.alpha_y = min(least / sqrt(narrowing), 1.0);
  normal turned = normalize(n - slope * t);
  return (dot(turned, I) > 0.0) ? turned : n;
}

closure color lobe_closure(
    color reflection_tint, color transmission_tint, Lobe lobe, vector along, normal n, float eta, Film film)
{
  string distributions[3] = {"ggx", "multi_ggx", "beckmann"};
  float ax = 0.0, ay = 0.0;
  if (abs(eta - 1.0) > INDEX_MATCHED) {
    ax = lobe.alpha_x;
    ay = lobe.alpha_y;
  }
  if (film.thickness > THIN_FILM_CUTOFF) {
    /* A negative exponent is Cycles' word for the exact Fresnel equations of that index. */
    return generalized_schlick_bsdf(n, along, reflection_tint, transmission_tint, ax, ay, color(fresnel_normal(eta)), color(1.0),
                                    -eta, distributions[lobe.distribution], "thinfilm_thickness", film.thickness,
                                    "thinfilm_ior", film.ior);
  }
  return dielectric_bsdf(n, along, reflection_tint, transmission_tint, ax, ay, eta, distributions[lobe.distribution]);
}

/* Reflection and refraction; `separate` if their lobes differ. */
closure color dielectric(color reflection_tint,
                         color transmission_tint,
                         Lobe reflects,
                         Lobe refracts,
                         int separate,
                         vector along,
                         normal n,
                         float eta,
                         Film film)
{
  if (!separate && refracts.alpha_x == refracts.alpha_y)
    return lobe_closure(reflection_tint, transmission_tint, refracts, along, n, eta, film);
  Lobe rest = refracts;
  normal turned = n;
  if (refracts.alpha_x != refracts.alpha_y)
    turned = drawn_normal(n, along, refracts, rest);
  return lobe_closure(reflection_tint, color(0.0), reflects, along, n, eta, film) +
         lobe_closure(color(0.0), transmission_tint, rest, along, turned, eta, film);
}
