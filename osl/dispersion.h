/* How an index of refraction changes with the wavelength, and what carries a path's wavelength. Wavelengths are in nm. */
#pragma once

#include "bounds.h"

#define DISPERSION_ABBE 0
#define DISPERSION_SELLMEIER 1
#define DISPERSION_JF 2

/* Fraunhofer's lines (ISO 7944). IOR is the index at d. */
#define LINE_C 656.2725
#define LINE_D 587.5618
#define LINE_F 486.1327

/* Ends of the visible spectrum, as in the spectral tables. */
#define SHORTEST 380.0
#define LONGEST 780.0

/* What Cycles calls the time where it samples none: in the viewport, and without motion blur. */
#define STILL_TIME 0.5

struct DispersionCurve {
  int disperses; /* starts dispersion; light that is split already is bent by every medium's own curve */
  int model;
  float abbe;
  vector sellmeier_b;
  vector sellmeier_c; /* square micrometres */
  float spread;       /* JF's */
};

/* What a medium does to all wavelengths: the index of white light, and how it spreads around it as Cauchy's second term
 * has it, in nm^2. */
struct Index {
  float at_path; /* at the path's wavelength; that of white light while it has none */
  float white;
  float slope;
  int regular; /* the slope describes it */
};

/* An index of refraction that Snell's law can use, whatever a curve comes to. */
float usable_ior(float ior)
{
  return select(1.0, ior, within(ior, 1e-3, 1e3, 1.0));
}

/* How far a wavelength is from the d line, in the units Cauchy's second term is linear in. */
float cauchy_distance(float wavelength)
{
  return 1.0 / (wavelength * wavelength) - 1.0 / (LINE_D * LINE_D);
}

/* Sellmeier (1872). */
float sellmeier_ior(vector b, vector c, float wavelength)
{
  float l2 = wavelength * wavelength * 1e-6;
  return sqrt(max(1.0 + dot(b, vector(l2) / (vector(l2) - c)), 0.0));
}

/* JF Nested Dielectric (2014). */
float jf_offset(float spread, float wavelength)
{
  float t = (wavelength - 370.0) / 410.0;
  return ((1.0 - t) * (1.0 - t) - 0.5) * spread;
}

/* n at a wavelength, where `ior` is the artist's. Sellmeier's curve is shifted to go through it at the d line; Abbe's
 * number is that of Cauchy's (1836) two terms. */
float ior_at(float ior, DispersionCurve d, float wavelength)
{
  if (d.model == DISPERSION_SELLMEIER)
    return ior + sellmeier_ior(d.sellmeier_b, d.sellmeier_c, wavelength) - sellmeier_ior(d.sellmeier_b, d.sellmeier_c, LINE_D);
  if (d.model == DISPERSION_JF)
    return ior + jf_offset(d.spread, wavelength);
  if (d.abbe > 0.0)
    return ior + (ior - 1.0) / d.abbe * cauchy_distance(wavelength) / (cauchy_distance(LINE_F) - cauchy_distance(LINE_C));
  return ior;
}

/* The index of a medium. `splits`: how it spreads matters; wavelength: 0 for white light. */
Index medium_index(float ior, DispersionCurve d, int splits, float wavelength)
{
  Index n;
  /* A medium of JF's that splits no light has its index as it was typed, as there. */
  n.white = usable_ior((d.model == DISPERSION_JF && d.disperses) ? ior + jf_offset(d.spread, LINE_D) : ior);
  n.at_path = n.white;
  n.slope = 0.0;
  n.regular = 1;
  if (splits) {
    float spread = ior_at(ior, d, LINE_F) - ior_at(ior, d, LINE_C);
    float slope = spread / (cauchy_distance(LINE_F) - cauchy_distance(LINE_C));
    n.slope = select(0.0, slope, is_number(slope));
    /* No glass is further off at the ends. */
    n.regular = abs(ior_at(ior, d, SHORTEST) - n.white - n.slope * cauchy_distance(SHORTEST)) < 0.05 &&
                abs(ior_at(ior, d, LONGEST) - n.white - n.slope * cauchy_distance(LONGEST)) < 0.05;
    if (wavelength > 0.0)
      n.at_path = usable_ior(ior_at(ior, d, wavelength));
  }
  return n;
}

/* Ratio of two indices of white light's wavelength with that Cauchy distance. */
float eta_at(Index from, Index to, float distance)
{
  return max(to.white + to.slope * distance, 1e-3) / max(from.white + from.slope * distance, 1e-3);
}

/* The ratio of two indices of white light, and how far it spreads over the spectrum as a number of Abbe's kind: both are
 * near linear in the Cauchy distance. A ratio of 1 has no such number, so it is moved by what bends no light visibly. */
float dispersing_ratio(Index outer, Index inner, output float inverse_abbe)
{
  float ratio = eta_at(outer, inner, 0.0);
  if (abs(ratio - 1.0) < 1e-4)
    ratio = 1.0 + 1e-4;
  inverse_abbe = (eta_at(outer, inner, cauchy_distance(LINE_F)) - eta_at(outer, inner, cauchy_distance(LINE_C))) / (ratio - 1.0);
  return ratio;
}
