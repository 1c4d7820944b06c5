/* How much light a rough surface sends from one direction into another. */
#pragma once

#include "lobes.h"

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

/* Density of microfacet normals (Walter et al. 2007; Beckmann and Spizzichino 1963), for a normal in the frame of
 * tangent, bitangent and surface normal. */
float normals_density(Lobe lobe, vector h)
{
  float z2 = h[2] * h[2];
  if (z2 < 1e-12)
    return 0.0;
  float slope2 = (h[0] * h[0] / (lobe.alpha_x * lobe.alpha_x) + h[1] * h[1] / (lobe.alpha_y * lobe.alpha_y)) / z2;
  float scale = 1.0 / (M_PI * lobe.alpha_x * lobe.alpha_y * z2 * z2);
  return (lobe.distribution == DISTRIBUTION_BECKMANN) ? scale * exp(-slope2) : scale / ((1.0 + slope2) * (1.0 + slope2));
}

float width_towards(Lobe lobe, vector w)
{
  return (lobe.alpha_x * lobe.alpha_x * w[0] * w[0] + lobe.alpha_y * lobe.alpha_y * w[1] * w[1]) / (w[2] * w[2]);
}

/* Share of the light from direction `to_light` that leaves towards the viewer, per solid angle of the light, through
 * (`refracts`) or from the surface (Walter et al. 2007, equations 20 and 21, without the radiance's n^2, as Cycles has it).
 * eta: index on the light's side of a refracting surface over that on the viewer's. */
float rough_light(Lobe lobe, int refracts, vector to_light, vector along, normal n, float eta)
{
  vector t = along - n * dot(along, n);
  t = (dot(t, t) > 1e-12) ? normalize(t) : normalize(cross(n, (abs(n[0]) < 0.9) ? vector(1, 0, 0) : vector(0, 1, 0)));
  vector b = cross(n, t);
  vector i = vector(dot(I, t), dot(I, b), dot(I, n));
  vector o = vector(dot(to_light, t), dot(to_light, b), dot(to_light, n));
  if (i[2] <= 1e-6 || (refracts ? o[2] >= -1e-6 : o[2] <= 1e-6))
    return 0.0;
  vector h = refracts ? -(i + eta * o) : i + o;
  float size2 = dot(h, h);
  if (size2 < 1e-12)
    return 0.0;
  h *= (h[2] < 0.0) ? -1.0 / sqrt(size2) : 1.0 / sqrt(size2);
  float cos_hi = dot(h, i), cos_ho = dot(h, o);
  if (cos_hi <= 0.0 || (refracts && cos_ho >= 0.0))
    return 0.0;
  Lobe wide = lobe; /* below this a lobe is a mirror to single precision */
  wide.alpha_x = max(lobe.alpha_x, 1e-3);
  wide.alpha_y = max(lobe.alpha_y, 1e-3);
  float f = fresnel_dielectric(min(cos_hi, 1.0), eta);
  float lets = refracts ? (1.0 - f) * eta * eta / size2 * abs(cos_hi * cos_ho) : 0.25 * f;
  float shadowing = 1.0 + masking(lobe.distribution, width_towards(wide, i)) + masking(lobe.distribution, width_towards(wide, o));
  return lets * normals_density(wide, h) / (i[2] * shadowing);
}
