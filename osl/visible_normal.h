/* Normals of a rough surface's microfacets, drawn as the viewer sees them. */
#pragma once

#include "light.h"
#include "lobe.h"
#include "random.h"

/* Tries after which a slope of Beckmann's is turned to the viewer; each succeeds by a half at least. */
#define VISIBLE_TRIES 16

/* Slopes along and across the horizontal part of the viewer's direction of a Gaussian surface of alpha 1, weighed by how much of
 * each facet is seen: (cos - slope sin)+. More than that is cos for all and -slope sin for those turned to the viewer, both of
 * which are easily drawn, so drawn ones are kept by the ratio of the two (von Neumann 1951). */
vector visible_beckmann_slopes(float cos_i, float sin_i)
{
  float across = random_gaussian(RANDOM_VISIBLE_NORMAL) * sqrt(0.5);
  float turned = sin_i * 0.5 / sqrt(M_PI);
  float along = 0.0;
  for (int i = 1; i <= VISIBLE_TRIES; i++) {
    int purpose = RANDOM_VISIBLE_NORMAL + 4 * i;
    if (random(purpose) * (cos_i + turned) < turned)
      along = -sqrt(-log(1.0 - random(purpose + 1)));
    else
      along = random_gaussian(purpose + 1) * sqrt(0.5);
    if (along <= 0.0 || random(purpose + 3) * cos_i < cos_i - along * sin_i)
      return vector(along, across, 0.0);
  }
  return vector(-along, across, 0.0);
}

/* A normal of the microfacets that the viewer sees. The surface is stretched until it is round and its alpha 1 (Heitz and d'Eon
 * 2014); there GGX's normals are half way from the viewer to points spread evenly over a cap of the sphere (Dupuy and Benyoub
 * 2023). */
normal visible_normal(Lobe lobe, ShadingFrame frame)
{
  vector x = frame.along - frame.n * dot(frame.along, frame.n);
  x = (dot(x, x) < 1e-12) ? perpendicular(frame.n) : normalize(x);
  vector y = cross(frame.n, x);
  vector seen = normalize(vector(lobe.alpha_x * dot(I, x), lobe.alpha_y * dot(I, y), max(dot(I, frame.n), 1e-4)));
  vector h = vector(0.0, 0.0, 1.0);
  if (lobe.distribution == DISTRIBUTION_BECKMANN) {
    float sin_i = hypot(seen[0], seen[1]);
    vector away = (sin_i > 1e-6) ? vector(seen[0], seen[1], 0.0) / sin_i : vector(1.0, 0.0, 0.0);
    vector slopes = visible_beckmann_slopes(seen[2], sin_i);
    h -= slopes[0] * away + slopes[1] * vector(-away[1], away[0], 0.0);
  }
  else {
    float turn = M_2PI * random(RANDOM_VISIBLE_NORMAL);
    float z = 1.0 - (1.0 + seen[2]) * random(RANDOM_VISIBLE_NORMAL + 1);
    float radius = sqrt(max(1.0 - z * z, 0.0));
    h = vector(radius * cos(turn), radius * sin(turn), z) + seen;
  }
  return normalize(lobe.alpha_x * h[0] * x + lobe.alpha_y * h[1] * y + max(h[2], 1e-6) * frame.n);
}
