/* How much light a rough surface sends from one direction into another. */
#pragma once

#include "lamp.h"
#include "lobes.h"

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

/* What a rough surface makes of light from a lamp. */
struct Rough {
  Lobe lobe;
  int refracts;
  vector x; /* frame of the lobe */
  vector y;
  vector z;
  float eta; /* index on the lamp's side of a refracting surface over that on the viewer's */
};

Rough rough_surface(Lobe lobe, int refracts, vector along, normal n, float eta)
{
  Rough s;
  s.lobe = lobe;
  s.lobe.alpha_x = max(lobe.alpha_x, 1e-3); /* below this a lobe is a mirror to single precision */
  s.lobe.alpha_y = max(lobe.alpha_y, 1e-3);
  s.refracts = refracts;
  s.eta = eta;
  s.z = n;
  s.x = along - n * dot(along, n);
  s.x = (dot(s.x, s.x) < 1e-12) ? perpendicular(n) : normalize(s.x);
  s.y = cross(n, s.x);
  return s;
}

/* Share of the light from a direction that leaves towards the viewer, per solid angle (Walter et al. 2007, equations 20
 * and 21, without the radiance's n^2, as Cycles has it), and the density with which rough_way() draws the direction. */
float rough_light(Rough s, vector way, output float density)
{
  density = 0.0;
  vector i = vector(dot(I, s.x), dot(I, s.y), dot(I, s.z));
  vector o = vector(dot(way, s.x), dot(way, s.y), dot(way, s.z));
  if (i[2] <= 1e-6 || (s.refracts ? o[2] >= -1e-6 : o[2] <= 1e-6))
    return 0.0;
  vector h = s.refracts ? i + s.eta * o : i + o;
  float size2 = dot(h, h);
  if (size2 < 1e-12)
    return 0.0;
  h *= (h[2] < 0.0) ? -1.0 / sqrt(size2) : 1.0 / sqrt(size2);
  float cos_hi = dot(h, i), cos_ho = dot(h, o);
  if (cos_hi <= 0.0 || (s.refracts && cos_ho >= 0.0))
    return 0.0;
  float normals = normals_density(s.lobe, h);
  float f = fresnel_dielectric(min(cos_hi, 1.0), s.eta);
  float turns = s.refracts ? s.eta * s.eta * abs(cos_ho) / size2 : 0.25 / cos_hi;
  density = normals * h[2] * turns;
  float shadowing = 1.0 + masking(s.lobe.distribution, width_towards(s.lobe, i)) +
                    masking(s.lobe.distribution, width_towards(s.lobe, o));
  return (s.refracts ? 1.0 - f : f) * normals * turns * cos_hi / (i[2] * shadowing);
}

/* Draws a direction by two numbers in [0, 1), as the microfacets' normals are distributed; zero if it leads nowhere. */
vector rough_way(Rough s, float r1, float r2)
{
  float slope = (s.lobe.distribution == DISTRIBUTION_BECKMANN) ? sqrt(-log(1.0 - r1)) : sqrt(r1 / (1.0 - r1));
  vector h = normalize(s.z - slope * (s.lobe.alpha_x * cos(M_2PI * r2) * s.x + s.lobe.alpha_y * sin(M_2PI * r2) * s.y));
  if (dot(h, I) <= 0.0)
    return vector(0.0);
  return s.refracts ? refract(-I, h, 1.0 / s.eta) : reflect(-I, h);
}

/* Points of a lamp, and directions of a lobe, that are drawn at a surface. */
#define LAMP_POINTS 4
#define LOBE_WAYS 4

/* Number k of n that are spread evenly: a lattice (Korobov 1959) that is shifted as a whole. */
vector spread_evenly(int k, int n, float r1, float r2)
{
  return vector(mod(r1 + k / (float)n, 1.0), mod(r2 + k * 0.618034, 1.0), 0.0);
}

/* Light of a lamp with a strength of 1 by a rough surface: points of the lamp and directions of the lobe, weighed by
 * their densities (Veach and Guibas 1995). What lies between is opaque. */
float lamp_by(Rough s, Lamp lamp)
{
  float sum = 0.0;
  float r1 = random(RANDOM_LAMP), r2 = random(RANDOM_LAMP + 1), r3 = random(RANDOM_LOBE), r4 = random(RANDOM_LOBE + 1);
  for (int k = 0; k < LAMP_POINTS + LOBE_WAYS; k++) {
    LampPoint p;
    if (k < LAMP_POINTS) {
      vector r = spread_evenly(k, LAMP_POINTS, r1, r2);
      p = lamp_point(lamp, r[0], r[1]);
    }
    else {
      vector r = spread_evenly(k - LAMP_POINTS, LOBE_WAYS, r3, r4);
      p = lamp_met(lamp, rough_way(s, r[0], r[1]));
    }
    if (p.radiance > 0.0) {
      float density;
      float light = rough_light(s, p.way, density) * p.radiance;
      if (light > 0.0 && !trace(P, p.way, "maxdist", p.range * 0.9999))
        sum += light / (LAMP_POINTS * p.density + LOBE_WAYS * density);
    }
  }
  return sum;
}
