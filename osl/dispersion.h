/* How an index of refraction changes with the wavelength. Wavelengths are in nm. */
#pragma once

#include "bounds.h"

/* The artist's parameters of a medium's dispersion. */
struct DispersionCurve {
  int disperses; /* starts dispersion; light that is split already is bent by every medium's own curve */
  int model;
  float abbe;
  vector sellmeier_b;
  vector sellmeier_c; /* square micrometres */
  float spread;       /* JF's */
};

DispersionCurve dispersion_curve(int disperses, int model, float abbe, vector sellmeier_b, vector sellmeier_c, float spread)
{
  DispersionCurve d = {disperses,
                       bounded(model, DISPERSION_MODEL_LIMITS),
                       bounded(abbe, ABBE_LIMITS),
                       bounded(sellmeier_b, SELLMEIER_B_LIMITS),
                       bounded(sellmeier_c, SELLMEIER_C_LIMITS),
                       bounded(spread, DISPERSION_LIMITS)};
  return d;
}

/* What a medium does to all wavelengths: the index at the d line, and how it spreads around it as Cauchy's second term
 * has it, in nm^2. */
struct DispersiveIor {
  float at_path; /* at the path's wavelength; that of white light while it has none */
  float white;   /* at the d line */
  float cauchy_b;
  int nearly_linear; /* cauchy_b describes it */
};

/* An index of refraction that Snell's law can use, whatever a curve comes to. */
float sanitized_ior(float ior)
{
  return select(1.0, ior, within(ior, 1e-3, 1e3, 1.0));
}

/* How far a wavelength is from the d line, in the units Cauchy's second term is linear in. */
float inverse_square_offset(float wavelength)
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
    return ior + (ior - 1.0) / d.abbe * inverse_square_offset(wavelength) /
                     (inverse_square_offset(LINE_F) - inverse_square_offset(LINE_C));
  return ior;
}

/* The index of a medium. `splits`: how it spreads matters; wavelength: 0 for white light. */
DispersiveIor dispersive_ior(float ior, DispersionCurve d, int splits, float wavelength)
{
  DispersiveIor n;
  /* A medium of JF's that splits no light has its index as it was typed, as there. */
  n.white = sanitized_ior((d.model == DISPERSION_JF && d.disperses) ? ior + jf_offset(d.spread, LINE_D) : ior);
  n.at_path = n.white;
  n.cauchy_b = 0.0;
  n.nearly_linear = 1;
  if (splits) {
    float spread = ior_at(ior, d, LINE_F) - ior_at(ior, d, LINE_C);
    float cauchy_b = spread / (inverse_square_offset(LINE_F) - inverse_square_offset(LINE_C));
    n.cauchy_b = select(0.0, cauchy_b, is_number(cauchy_b));
    /* No glass is further off at the ends. */
    n.nearly_linear = abs(ior_at(ior, d, SHORTEST) - n.white - n.cauchy_b * inverse_square_offset(SHORTEST)) < 0.05 &&
                      abs(ior_at(ior, d, LONGEST) - n.white - n.cauchy_b * inverse_square_offset(LONGEST)) < 0.05;
    if (wavelength > 0.0)
      n.at_path = sanitized_ior(ior_at(ior, d, wavelength));
  }
  return n;
}

/* Ratio of two indices at a wavelength with that offset. */
float eta_at(DispersiveIor from, DispersiveIor to, float offset)
{
  return max(to.white + to.cauchy_b * offset, 1e-3) / max(from.white + from.cauchy_b * offset, 1e-3);
}

/* The ratio of two indices of white light, and how far it spreads over the spectrum as a number of Abbe's kind: both are
 * near linear in the offset. A ratio of 1 has no such number. */
float dispersing_ratio(DispersiveIor outer, DispersiveIor inner, output float inverse_abbe)
{
  float ratio = eta_at(outer, inner, 0.0);
  if (abs(ratio - 1.0) < RATIO_MARGIN)
    ratio = 1.0 + RATIO_MARGIN;
  inverse_abbe = (eta_at(outer, inner, inverse_square_offset(LINE_F)) - eta_at(outer, inner, inverse_square_offset(LINE_C))) /
                 (ratio - 1.0);
  return ratio;
}
