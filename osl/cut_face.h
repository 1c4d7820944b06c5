/* What a face of a surface that is cut where media cross (addon/nodes/cutting) carries of the medium outside it. Nothing is
 * asked then, and nothing is remembered. */
#pragma once

#include "neighbour.h"

/* How the index of the medium outside the face changes with the wavelength. */
DispersionCurve cut_dispersion()
{
  DispersionCurve d = {0, DISPERSION_ABBE, 0.0, vector(0.0), vector(0.0), 0.0};
  vector curve = vector(0.0);
  getattribute(CUT_CURVE_ATTRIBUTE, curve);
  d.disperses = curve[CURVE_MODEL] > CUT_SPLITS - 0.5;
  d.model = bounded((int)(curve[CURVE_MODEL] + 0.5) - CUT_SPLITS * d.disperses, DISPERSION_MODEL_LIMITS);
  d.abbe = bounded(curve[CURVE_ABBE], ABBE_LIMITS);
  d.spread = bounded(curve[CURVE_SPREAD], DISPERSION_LIMITS);
  if (d.model == DISPERSION_SELLMEIER) {
    getattribute(CUT_SELLMEIER_B_ATTRIBUTE, d.sellmeier_b);
    getattribute(CUT_SELLMEIER_C_ATTRIBUTE, d.sellmeier_c);
    d.sellmeier_b = bounded(d.sellmeier_b, SELLMEIER_B_LIMITS);
    d.sellmeier_c = bounded(d.sellmeier_c, SELLMEIER_C_LIMITS);
  }
  return d;
}

/* The medium outside the shaded face; 0 if the face tells nothing. `exists`: no winner fills the place; wants_priority: its
 * number matters, not only that it is none of air. */
int cut_exterior(int wants_priority, int curves, float wavelength, int scene, output Medium outer, output int exists)
{
  float index = 0.0;
  getattribute(CUT_ATTRIBUTE, index);
  exists = index < CUT_HIDDEN;
  if (index == 0.0 || index == CUT_AIR || !exists)
    return index != 0.0;
  outer.priority = 0.0;
  if (wants_priority || index < 0.0)
    getattribute(CUT_PRIORITY_ATTRIBUTE, outer.priority);
  float ior = bounded(abs(index), IOR_LIMITS);
  outer.ior.at_path = outer.ior.white = ior;
  if (index < 0.0) {
    color transmittance = color(1.0);
    float depth = 0.0;
    getattribute(CUT_TINT_ATTRIBUTE, transmittance);
    getattribute(CUT_DEPTH_ATTRIBUTE, depth);
    set_absorption(outer, transmittance, depth);
    float by_volume = 0.0;
    getattribute(CUT_BY_VOLUME_ATTRIBUTE, by_volume);
    outer.by_volume = outer.absorbs && by_volume == scene;
    outer.absorbs -= outer.by_volume;
    DispersionCurve d = cut_dispersion();
    outer.disperses = d.disperses;
    outer.ior = dispersive_ior(ior, d, curves == CURVES_ALL || (curves != CURVES_NONE && d.disperses), wavelength);
  }
  return 1;
}
