/* What lies outside a surface, as far as an analysis of the scene tells (addon/analysis.py), and checks of it. */
#pragma once

#include "medium.h"

#define OUTSIDE_UNKNOWN 0   /* the scene is asked */
#define OUTSIDE_AIR 1
#define OUTSIDE_MEDIUM 2    /* the one medium that the analysis names */
#define OUTSIDE_WINNER 3    /* a medium that wins over the surface's own */
#define OUTSIDE_BY_OBJECT 5 /* the object's own properties tell */

/* One in so many surfaces that the analysis tells of is asked all the same. Where the scene answers otherwise the surface
 * is so many times as bright as a white one, or few samples would hide it. */
#define SPOT_CHECKS 512.0
#define ALARM 64.0

struct Outside {
  int outside;
  float level; /* the only priority that may be around, whose nearest surface decides; below 0 there are more */
  int overlaps_itself;
  int foreign;   /* foreign objects may stand in the medium or in those that it touches */
  int scene;     /* number of the one whose analysis holds, below 0 of none */
  int gives_back; /* volumes of media that lose absorb where ways end at this surface */
  Medium medium; /* of OUTSIDE_MEDIUM */
};

/* A medium that splits no light. */
Medium plain_medium(float priority, float ior, color transmittance, float transmittance_depth)
{
  Medium m = air();
  m.priority = bounded(priority, PRIORITY_LIMITS);
  m.ior.at_path = m.ior.white = bounded(ior, IOR_LIMITS);
  tint(m, transmittance, transmittance_depth);
  return m;
}

/* What the object's own custom properties tell. The first number holds, from its lowest digit on: what lies outside,
 * whether the object overlaps itself, whether nothing foreign is near, whether the medium absorbs, and the level counted
 * from 1. An object without the properties reads zeros, which tell nothing. */
Outside told_by_object(int gives_back, int scene)
{
  float object[4] = {OUTSIDE_UNKNOWN, 0.0, 1.0, 0.0}; /* then the medium's priority, IOR and Transmittance Depth */
  float left[4] = {1.0, 1.0, 1.0, 1.0};
  getattribute("\001object:nd_outside", object);
  int facts = (int)object[0];
  if (facts & 32)
    getattribute("\001object:nd_outside_transmittance", left);
  Outside told;
  told.outside = facts & 7;
  told.overlaps_itself = (facts & 8) != 0;
  told.foreign = (facts & 16) == 0;
  told.gives_back = gives_back;
  told.scene = scene;
  told.level = (facts >> 6) - 1;
  told.medium = plain_medium(object[1], object[2], color(left[0], left[1], left[2]), object[3]);
  return told;
}

/* True for one point in SPOT_CHECKS of every face. */
int spot_check()
{
  float place = 9973.0 * u + 7919.0 * v;
  return place - floor(place) < 1.0 / SPOT_CHECKS;
}

/* Another direction to the same side. */
vector askew(vector direction)
{
  return normalize(direction + 0.37 * normalize(dPdu) + 0.21 * normalize(cross(direction, dPdu)));
}
