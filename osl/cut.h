/* What the geometry itself says: a face of a surface that is cut where media cross (addon/cutting_nodes.py) carries what lies
 * outside it. Nothing is asked then, and nothing is remembered. */
#pragma once

#include "medium.h"

/* Attributes of faces. The first is 0 where nothing is told, CUT_AIR in air, CUT_HIDDEN inside a winner, else the index of the
 * medium outside, negative where that one's colour and dispersion are to be read, too. One number for nearly all surfaces, as
 * a look-up costs most where it waits for memory. */
#define CUT_FACE "nd_cut"
#define CUT_AIR 1.0
#define CUT_HIDDEN 1e6
#define CUT_PRIORITY "nd_cut_priority"
#define CUT_TINT "nd_cut_tint"
#define CUT_DEPTH "nd_cut_depth"
#define CUT_BY_VOLUME "nd_cut_by_volume" /* the scene in which its volume absorbs for all rays, by number */
#define CUT_CURVE "nd_cut_curve" /* Dispersion Model, more by CUT_SPLITS where the medium disperses; Abbe; Dispersion */
#define CUT_SELLMEIER_B "nd_cut_sellmeier_b"
#define CUT_SELLMEIER_C "nd_cut_sellmeier_c"
#define CUT_SPLITS 3

/* How the index of the medium outside the face changes with the wavelength. */
DispersionCurve cut_dispersion()
{
  DispersionCurve d = {0, DISPERSION_ABBE, 0.0, vector(0.0), vector(0.0), 0.0};
  vector curve = vector(0.0);
  getattribute(CUT_CURVE, curve);
  d.disperses = curve[0] > CUT_SPLITS - 0.5;
  d.model = bounded((int)(curve[0] + 0.5) - CUT_SPLITS * d.disperses, DISPERSION_MODEL_LIMITS);
  d.abbe = bounded(curve[1], ABBE_LIMITS);
  d.spread = bounded(curve[2], DISPERSION_LIMITS);
  if (d.model == DISPERSION_SELLMEIER) {
    getattribute(CUT_SELLMEIER_B, d.sellmeier_b);
    getattribute(CUT_SELLMEIER_C, d.sellmeier_c);
    d.sellmeier_b = bounded(d.sellmeier_b, SELLMEIER_B_LIMITS);
    d.sellmeier_c = bounded(d.sellmeier_c, SELLMEIER_C_LIMITS);
  }
  return d;
}

/* The medium outside the shaded face; 0 if the face tells nothing. `exists`: no winner fills the place; wants_priority: its
 * number matters, not only that it is none of air. */
int cut_outside(int wants_priority, int curves, float wavelength, int scene, output Medium outer, output int exists)
{
  float index = 0.0;
  getattribute(CUT_FACE, index);
  exists = index < CUT_HIDDEN;
  if (index == 0.0 || index == CUT_AIR || !exists)
    return index != 0.0;
  outer.priority = 0.0;
  if (wants_priority || index < 0.0)
    getattribute(CUT_PRIORITY, outer.priority);
  float ior = bounded(abs(index), IOR_LIMITS);
  outer.ior.at_path = outer.ior.white = ior;
  if (index < 0.0) {
    color left = color(1.0);
    float depth = 0.0;
    getattribute(CUT_TINT, left);
    getattribute(CUT_DEPTH, depth);
    tint(outer, left, depth);
    float by_volume = 0.0;
    getattribute(CUT_BY_VOLUME, by_volume);
    outer.by_volume = outer.absorbs && by_volume == scene;
    outer.absorbs -= outer.by_volume;
    DispersionCurve d = cut_dispersion();
    outer.disperses = d.disperses;
    outer.ior = medium_index(ior, d, curves == CURVES_ALL || (curves != CURVES_NONE && d.disperses), wavelength);
  }
  return 1;
}
