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

/* What both lobes of a surface share, as Cycles' closures take it. */
struct Optics {
  float ior;
  float inverse_abbe; /* of the ratio of both indices; 0 where the closure is to split no light */
  float film_thickness; /* nm */
  float film_ior;
  int front_ior;        /* see make_optics() */
};

/* `eta` goes from the ray's side to the other; the film's index is relative to the medium the ray is in. With `front_ior`
 * closures take both as they are met from the front, and turn them on back faces themselves (Blender 5.3 on). Those
 * closures also refract anisotropically. */
Optics make_optics(float eta, float film_thickness, float film_ior, int front_ior)
{
  Optics o = {eta, 0.0, film_thickness, film_ior, front_ior};
  if (front_ior && backfacing()) {
    o.ior = 1.0 / eta;
    o.film_ior = film_ior / eta;
  }
  return o;
}

/* The direction that a surface's tangents are made from: where the normal points along it they have a pole. */
vector tangent_axis(vector tangent, int source, vector refracted_way)
{
  if (source == TANGENT_REFRACTION)
    return (dot(refracted_way, refracted_way) > 0.0) ? refracted_way : -I;
  return has_direction(tangent) ? normalize(tangent) : normalize(transform("object", "world", vector(0.0, 0.0, 1.0)));
}

/* The artist's tangent, the way of the refracted light along the surface, or a circle around the object's Z axis. */
vector tangent_along(vector tangent, int source, vector axis)
{
  vector along = axis;
  if (source == TANGENT_GIVEN && !has_direction(tangent))
    along = cross(axis, P - transform("object", "world", point(0.0)));
  along -= N * dot(along, N);
  return (dot(along, along) > 1e-12) ? normalize(along) : normalize(dPdu);
}

/* A lobe from the artist's numbers. `blur` makes it round where the normal points along the tangents' axis. */
Lobe make_lobe(int distribution, float roughness, float anisotropy, float blur, vector axis)
{
  Lobe lobe;
  lobe.distribution = distribution;
  anisotropic_alpha(min(roughness, 1.0), anisotropy, lobe.alpha_x, lobe.alpha_y);
  if (anisotropy != 0.0 && blur > 0.0) {
    float mean = sqrt(lobe.alpha_x * lobe.alpha_y);
    float pole = pow(abs(dot(axis, N)), 1.0 / blur - 1.0);
    lobe.alpha_x = mix(lobe.alpha_x, mean, pole);
    lobe.alpha_y = mix(lobe.alpha_y, mean, pole);
  }
  return lobe;
}

/* Smith's masking function Lambda (Heitz 2014, equations 68, 69, 72), where `a2` is the squared product of the width and
 * the tangent of the direction's angle. */
float masking(int distribution, float a2)
{
  if (distribution != DISTRIBUTION_BECKMANN)
    return 0.5 * (sqrt(1.0 + a2) - 1.0);
  if (a2 < 0.39)
    return 0.0;
  float a = 1.0 / sqrt(a2);
  return (1.0 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a);
}

float width_towards(Lobe lobe, vector w)
{
  return (lobe.alpha_x * lobe.alpha_x * w[0] * w[0] + lobe.alpha_y * lobe.alpha_y * w[1] * w[1]) / (w[2] * w[2]);
}

/* Part of a lobe's microfacets around a normal that a direction sees. */
float visible_part(Lobe lobe, vector x, normal n, vector w)
{
  vector local = vector(dot(w, x), dot(w, cross(n, x)), dot(w, n));
  return (abs(local[2]) > 1e-4) ? 1.0 / (1.0 + masking(lobe.distribution, width_towards(lobe, local))) : 0.0;
}

/* Up to Blender 5.2 Cycles refracts isotropically, so the part of an anisotropic lobe that is longer one way is drawn here,
 * by turning the normal; `rest` is the isotropic remainder.
 *
 * Slopes of Beckmann's (1963) distribution are Gaussian with a variance of alpha^2 / 2, and Gaussians add up. GGX's
 * (Walter et al. 2007) are the same divided by the root of an exponentially distributed number, as the ratio of two
 * such numbers is distributed as GGX's squared slope. `weight`: light sees more of what is turned towards it, and as much of
 * the whole lobe as Smith's masking leaves. */
normal drawn_normal(normal n, vector along, Lobe lobe, float eta, output Lobe rest, output float weight)
{
  float least = min(lobe.alpha_x, lobe.alpha_y);
  float most = max(lobe.alpha_x, lobe.alpha_y);
  float narrowing = (lobe.distribution == DISTRIBUTION_BECKMANN) ? 1.0 : max(-log(1.0 - random(RANDOM_NARROWING)), 1e-6);
  float slope = sqrt((most * most - least * least) / (2.0 * narrowing)) * random_gaussian(RANDOM_SLOPE);
  vector x = normalize(along - n * dot(along, n));
  vector t = (lobe.alpha_y > lobe.alpha_x) ? cross(n, x) : x;
  rest.distribution = DISTRIBUTION_BECKMANN;
  rest.alpha_x = rest.alpha_y = min(least / sqrt(narrowing), 1.0);
  normal turned = normalize(n - slope * t);
  vector out = refract(-I, turned, 1.0 / eta);
  weight = max(dot(n - slope * t, I), 0.0) / max(dot(n, I), 1e-3) * visible_part(lobe, x, n, I) / visible_part(rest, x, turned, I);
  if (dot(out, out) > 0.0)
    weight *= visible_part(lobe, x, n, out) / max(visible_part(rest, x, turned, out), 1e-3);
  return (weight > 0.0) ? turned : n;
}

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
    return generalized_schlick_bsdf(n, along, reflection_tint, transmission_tint, ax, ay, color(fresnel_normal(o.ior)),
                                    color(1.0), -o.ior, distributions[lobe.distribution], "thinfilm_thickness",
                                    o.film_thickness, "thinfilm_ior", o.film_ior, "inv_abbe", o.inverse_abbe);
  if (o.film_thickness > THIN_FILM_CUTOFF)
    return generalized_schlick_bsdf(n, along, reflection_tint, transmission_tint, ax, ay, color(fresnel_normal(o.ior)),
                                    color(1.0), -o.ior, distributions[lobe.distribution], "thinfilm_thickness",
                                    o.film_thickness, "thinfilm_ior", o.film_ior);
  return dielectric_bsdf(n, along, reflection_tint, transmission_tint, ax, ay, o.ior, distributions[lobe.distribution]);
}

/* Cycles takes a smooth surface as it is here. Where scattered light meets one, Cycles blurs it (Filter Glossy), leaves it out of
 * caustics or walks through it to lamps; and it turns a normal that would reflect light into its face, or nearly along it. */
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

/* Reflection and refraction; `separate` if their lobes differ. */
closure color dielectric(color reflection_tint,
                         color transmission_tint,
                         Lobe reflects,
                         Lobe refracts,
                         int separate,
                         vector along,
                         normal n,
                         float eta,
                         Optics o)
{
  int smooth = !separate && refracts.alpha_x == 0.0 && refracts.alpha_y == 0.0 && o.film_thickness <= THIN_FILM_CUTOFF &&
               o.inverse_abbe == 0.0 && stays_smooth(n);
  if (smooth)
    return smooth_closure(reflection_tint, transmission_tint, n, eta, o.ior);
  int turns = !o.front_ior && refracts.alpha_x != refracts.alpha_y;
  if (!separate && !turns)
    return lobe_closure(reflection_tint, transmission_tint, refracts, along, n, o);
  Lobe rest = refracts;
  normal turned = n;
  float weight = 1.0;
  if (turns)
    turned = drawn_normal(n, along, refracts, eta, rest, weight);
  return lobe_closure(reflection_tint, color(0.0), reflects, along, n, o) +
         lobe_closure(color(0.0), transmission_tint * weight, rest, along, turned, o);
}
