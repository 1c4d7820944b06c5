/* A medium: what it does to light, and which of several wins.
 *
 * Priorities order media: where several fill the same point the lowest number wins.
 * Air fills what no medium claims, so its priority is above every number an artist can give. */
#pragma once

#include "dispersion.h"

#define AIR_PRIORITY 1e9

struct Medium {
  float priority;
  DispersiveIor ior;
  int disperses;
  color transmittance;       /* of white light after transmittance_depth */
  float transmittance_depth; /* scene units */
  int absorbs;               /* for surfaces to charge */
  int by_volume;             /* it absorbs, but Cycles' volumes charge all of it */
};

Medium air()
{
  /* OSL does not initialise a struct within a struct by a list. */
  Medium m;
  m.priority = AIR_PRIORITY;
  m.ior.at_path = m.ior.white = 1.0;
  m.ior.cauchy_b = 0.0;
  m.ior.nearly_linear = 1;
  m.disperses = 0;
  m.transmittance = color(1.0);
  m.transmittance_depth = 1.0;
  m.absorbs = 0;
  m.by_volume = 0;
  return m;
}

void set_absorption(output Medium m, color transmittance, float transmittance_depth)
{
  m.transmittance = bounded(transmittance, TRANSMITTANCE_LIMITS);
  m.transmittance_depth = bounded(transmittance_depth, TRANSMITTANCE_DEPTH_LIMITS);
  m.absorbs = min(m.transmittance[0], min(m.transmittance[1], m.transmittance[2])) < 1.0 && m.transmittance_depth > 0.0;
}

/* A medium that splits no light. */
Medium plain_medium(float priority, float ior, color transmittance, float transmittance_depth)
{
  Medium m = air();
  m.priority = bounded(priority, PRIORITY_LIMITS);
  m.ior.at_path = m.ior.white = bounded(ior, IOR_LIMITS);
  set_absorption(m, transmittance, transmittance_depth);
  return m;
}

/* The shaded material's medium: as its parameters are. `splits`: how its index spreads matters; wavelength: nm, 0 for white
 * light; the volume absorbs for all rays where by_volume is 1. */
Medium material_medium(int priority, float ior, DispersionCurve curve, int splits, float wavelength, color transmittance,
                       float transmittance_depth, int by_volume)
{
  Medium m;
  m.priority = bounded(priority, PRIORITY_LIMITS);
  m.ior = dispersive_ior(bounded(ior, IOR_LIMITS), curve, splits, wavelength);
  m.disperses = curve.disperses;
  set_absorption(m, transmittance, transmittance_depth * (1 - by_volume));
  return m;
}

/* Whether an object's own priority counts: a whole number that the artist may give. Whatever else is stored there leaves
 * the material's in force, as in own_priority() of addon/scene/media.py. */
int is_priority(float own[4])
{
  float p = own[0];
  return (own[3] > 0.0) * (own[1] == p) * (own[2] == p) * (floor(p) == p) * within(p, PRIORITY_LIMITS);
}

/* The priority of the object that is shaded: its own value, or else its material's. */
float own_priority(float material_priority)
{
  float own[4] = {0.0, 0.0, 0.0, 0.0};
  getattribute(OBJECT_PRIORITY, own);
  return is_priority(own) ? own[0] : material_priority;
}
