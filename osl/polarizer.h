/* A polarising filter before the camera. */
#pragma once

#include "weights.h"

/* What an ideal filter that lets light through along `filter` makes of a surface's reflectance (x) and transmittance
 * (y), as factors; light that comes to the surface is unpolarised, and the exposure makes up for the half that the
 * filter takes (Malus 1809). */
vector polarizer_factors(vector filter, normal n, float cos_i, float eta)
{
  vector crossed = filter - I * dot(filter, I);
  vector plane = n - I * dot(n, I);
  float in_plane = dot(crossed, plane);
  in_plane *= in_plane / max(dot(crossed, crossed) * dot(plane, plane), 1e-20);
  vector reflectances = fresnel_polarized(cos_i, eta);
  float f = 0.5 * (reflectances[0] + reflectances[1]);
  float filtered = mix(reflectances[0], reflectances[1], min(in_plane, 1.0));
  return vector(filtered / max(f, 1e-12), (1.0 - filtered) / max(1.0 - f, 1e-12), 0.0);
}

/* Filters what the camera sees, where the artist wants it; `angle` turns the filter clockwise from its vertical (radians). */
void filter_polarization(int wanted, float angle, Incidence at, output Weights factor)
{
  if (wanted && raytype("camera")) {
    float turned = bounded(angle, POLARIZATION_ANGLE_LIMITS);
    vector filter = vector(sin(turned), cos(turned), 0.0);
    vector factors = polarizer_factors(transform("camera", "world", filter), at.n, at.cos_i, at.eta);
    factor.reflected *= factors[0];
    factor.transmitted *= factors[1];
  }
}
