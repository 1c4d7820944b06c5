/* How much light a rough surface scatters from one direction into another (Walter et al. 2007). */
#pragma once

#include "fresnel.h"
#include "light.h"
#include "lobe.h"

/* D: density of microfacet normals (Walter et al. 2007; Beckmann and Spizzichino 1963), for a normal in the frame of
 * tangent, bitangent and surface normal. */
float microfacet_ndf(Lobe lobe, vector h)
{
  float z2 = h[2] * h[2];
  if (z2 < 1e-12)
    return 0.0;
  float slope2 = (h[0] * h[0] / (lobe.alpha_x * lobe.alpha_x) + h[1] * h[1] / (lobe.alpha_y * lobe.alpha_y)) / z2;
  float scale = 1.0 / (M_PI * lobe.alpha_x * lobe.alpha_y * z2 * z2);
  return (lobe.distribution == DISTRIBUTION_BECKMANN) ? scale * exp(-slope2) : scale / ((1.0 + slope2) * (1.0 + slope2));
}

/* Reflection or refraction of a rough surface, from a direction wi into that of the viewer, wo = I. */
struct MicrofacetBsdf {
  Lobe lobe;
  int refracts;
  vector x; /* frame of the lobe */
  vector y;
  vector z;
  float eta; /* index on the light's side of a refracting surface over that on the viewer's */
};

MicrofacetBsdf make_bsdf(Lobe lobe, int refracts, ShadingFrame frame, float eta)
{
  MicrofacetBsdf s;
  s.lobe = lobe;
  s.lobe.alpha_x = max(lobe.alpha_x, 1e-3); /* below this a lobe is a mirror to single precision */
  s.lobe.alpha_y = max(lobe.alpha_y, 1e-3);
  s.refracts = refracts;
  s.eta = eta;
  s.z = frame.n;
  s.x = frame.along - frame.n * dot(frame.along, frame.n);
  s.x = (dot(s.x, s.x) < 1e-12) ? perpendicular(frame.n) : normalize(s.x);
  s.y = cross(frame.n, s.x);
  return s;
}

/* f cos: share of the light from a direction that leaves towards the viewer, per solid angle (Walter et al. 2007, equations
 * 20 and 21, without the radiance's n^2, as Cycles has it), and the pdf with which bsdf_sample() draws the direction. */
float bsdf_eval(MicrofacetBsdf s, vector direction, output float pdf)
{
  pdf = 0.0;
  vector wo = vector(dot(I, s.x), dot(I, s.y), dot(I, s.z));
  vector wi = vector(dot(direction, s.x), dot(direction, s.y), dot(direction, s.z));
  if (wo[2] <= 1e-6 || (s.refracts ? wi[2] >= -1e-6 : wi[2] <= 1e-6))
    return 0.0;
  vector h = s.refracts ? wo + s.eta * wi : wo + wi;
  float size2 = dot(h, h);
  if (size2 < 1e-12)
    return 0.0;
  h *= (h[2] < 0.0) ? -1.0 / sqrt(size2) : 1.0 / sqrt(size2);
  float cos_ho = dot(h, wo), cos_hi = dot(h, wi);
  if (cos_ho <= 0.0 || (s.refracts && cos_hi >= 0.0))
    return 0.0;
  float d = microfacet_ndf(s.lobe, h);
  float f = fresnel_dielectric(min(cos_ho, 1.0), s.eta);
  float dwh_dwi = s.refracts ? s.eta * s.eta * abs(cos_hi) / size2 : 0.25 / cos_ho;
  pdf = d * h[2] * dwh_dwi;
  float inverse_g = 1.0 + smith_lambda(s.lobe.distribution, alpha2_tan2_theta(s.lobe, wo)) +
                    smith_lambda(s.lobe.distribution, alpha2_tan2_theta(s.lobe, wi));
  return (s.refracts ? 1.0 - f : f) * d * dwh_dwi * cos_ho / (wo[2] * inverse_g);
}

/* Draws a direction by two numbers in [0, 1), as the microfacets' normals are distributed; zero if it leads nowhere. */
vector bsdf_sample(MicrofacetBsdf s, float r1, float r2)
{
  float slope = (s.lobe.distribution == DISTRIBUTION_BECKMANN) ? sqrt(-log(1.0 - r1)) : sqrt(r1 / (1.0 - r1));
  vector h = normalize(s.z - slope * (s.lobe.alpha_x * cos(M_2PI * r2) * s.x + s.lobe.alpha_y * sin(M_2PI * r2) * s.y));
  if (dot(h, I) <= 0.0)
    return vector(0.0);
  return s.refracts ? refract(-I, h, 1.0 / s.eta) : reflect(-I, h);
}
