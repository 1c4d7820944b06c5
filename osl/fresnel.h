/* Light at a smooth interface of two dielectrics: closed forms. */
#pragma once

#include "bounds.h"

/* Reflectance of unpolarised light at a smooth interface (Fresnel 1823); 1 where it is reflected totally.
 * cos_i: cosine between the ray and the normal, in [0, 1]; eta: n2 / n1, from the ray's side to the other. */
float fresnel_dielectric(float cos_i, float eta)
{
  float g2 = eta * eta - 1.0 + cos_i * cos_i;
  if (g2 <= 0.0)
    return 1.0;
  float g = sqrt(g2);
  float a = (g - cos_i) / (g + cos_i);
  float b = (cos_i * (g + cos_i) - 1.0) / (cos_i * (g - cos_i) + 1.0);
  return 0.5 * a * a * (1.0 + b * b);
}

/* Rs (x) and Rp (y): reflectances of light that is polarised across and in the plane of incidence (Fresnel 1823). */
vector fresnel_polarized(float cos_i, float eta)
{
  float g2 = eta * eta - 1.0 + cos_i * cos_i;
  if (g2 <= 0.0)
    return vector(1.0, 1.0, 0.0);
  float g = sqrt(g2);
  float rs = (cos_i - g) / (cos_i + g);
  float rp = (eta * eta * cos_i - g) / (eta * eta * cos_i + g);
  return vector(rs * rs, rp * rp, 0.0);
}

/* F0: reflectance at normal incidence. */
float fresnel_f0(float eta)
{
  float r = (eta - 1.0) / (eta + 1.0);
  return r * r;
}

/* The refracted direction (Snell 1621); zero where all is reflected. */
vector refracted_direction(normal n, float eta)
{
  return refract(-I, n, 1.0 / eta);
}
