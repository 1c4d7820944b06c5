/* What a point lies in, asked of the scene. */
#pragma once

#include "crossing.h"
#include "exterior.h"

/* Priorities that one run of a probe sums at the same time; where more are open it runs again for those it left. */
#define PROBE_LEVELS 64

/* What lies around a surface of one medium. */
struct Surroundings {
  Medium medium;      /* the winner among the other media */
  int holders;        /* objects of its priority that hold the point */
  float own_priority; /* of the surface's object; the material's while nothing asked for it */
  int can_trace;      /* 0 where Cycles cannot trace rays from shaders, or they tell less than is needed */
  int complete;       /* 0 where more is in the way than a probe may count */
};

Surroundings nothing_around(float material_priority)
{
  Surroundings s;
  s.medium = air();
  s.holders = 0;
  s.own_priority = material_priority;
  s.can_trace = 1;
  s.complete = 0;
  return s;
}

/* Where a priority's winding number is summed, at 0 first; -1 if all places are taken by numbers below it, which are left for
 * another run, as are those from `unsummed` on. A place whose sum is back at 0 says as much as none. */
int winding_place(float priority, output float priorities[PROBE_LEVELS], output int windings[PROBE_LEVELS], output int levels,
                  output float unsummed)
{
  int k = 0;
  while (k < levels && priorities[k] != priority)
    k++;
  if (k == levels) {
    if (levels < PROBE_LEVELS)
      levels++;
    else {
      k = 0;
      while (k < levels && windings[k] != 0)
        k++;
      if (k == levels) {
        k = 0;
        for (int other = 1; other < levels; other++)
          k = (priorities[other] > priorities[k]) ? other : k;
        unsummed = max(priorities[k], priority);
        k = (unsummed == priority) ? -1 : k;
      }
    }
    if (k >= 0) {
      priorities[k] = priority;
      windings[k] = 0;
    }
  }
  return k;
}

/* A hit on the shaded object itself, which crosses no other, or on one that shows a cut surface. */
int tells_nothing(int overlaps_itself, int cut)
{
  float self = 0.0;
  getmessage("trace", "hitself", self);
  return (self > 0.0 && !overlaps_itself) || (cut && hit_is_cut());
}

/* The medium that fills the points just off `origin` in the given direction, P's own object left out.
 *
 * The winding number of a closed surface about a point is the sum of the signed crossings along any ray from it
 * (Jacobson, Kavan, Sorkine-Hornung 2013, section 3). Summed per priority it also makes objects of equal priority one
 * medium. The running sum is above zero only if some object holds the point, so a probe may stop at the first sum that
 * decides that the surface's own medium does not win.
 *
 * material_priority is the own one until an object's is asked for, which a surface that meets no other medium never
 * needs; is_own tells that it has been. Where `sole` is a priority, objects of that priority alone may be around,
 * all closed and apart from each other: the nearest surface of theirs decides. Surfaces of an object that overlaps itself
 * count as any other's. `cut`: surfaces of the scene are cut where media cross. */
Surroundings enclosing_medium(point origin, vector direction, float material_priority, int is_own, float sole,
                              int overlaps_itself, int cut, int curves, float wavelength, int scene)
{
  float priorities[PROBE_LEVELS];
  int windings[PROBE_LEVELS];
  int levels = 0, own_is_known = is_own;
  Surroundings s = nothing_around(material_priority);
  float t = 0.0, least = 0.0, unsummed = AIR_PRIORITY; /* this run sums priorities from `least` on, below `unsummed` */
  for (int i = 0; i < PROBE_HITS; i++) {
    if (!trace(origin, direction, "mindist", t)) {
      /* On the CPU a ray leaves its record even if it met nothing. */
      int hit = 0;
      if (i == 0)
        s.can_trace = getmessage("trace", "hit", hit);
      if (unsummed == AIR_PRIORITY || s.medium.priority != AIR_PRIORITY) {
        s.complete = 1;
        break;
      }
      least = unsummed;
      unsummed = AIR_PRIORITY;
      levels = 0;
      t = 0.0;
      continue;
    }
    hit_distance(t);
    if (tells_nothing(overlaps_itself, cut))
      continue;
    int slot = NO_SLOT;
    float priority = hit_priority(slot);
    if (slot == UNREADABLE_SLOT) {
      s.can_trace = 0;
      return s;
    }
    if (priority >= unsummed || priority < least || priority > s.medium.priority || (sole >= 0.0 && priority != sole))
      continue;
    if (!own_is_known) {
      own_is_known = 1;
      s.own_priority = own_priority(material_priority);
    }
    int k = winding_place(priority, priorities, windings, levels, unsummed);
    if (k < 0)
      continue;
    windings[k] += crossing_sign(direction);
    if (windings[k] > 0 && priority < s.medium.priority) {
      s.medium = hit_medium(priority, slot, curves, wavelength, scene);
      if (slot == UNREADABLE_SLOT)
        s.can_trace = 0;
      s.complete = priority <= s.own_priority;
      if (s.complete || !s.can_trace)
        return s;
    }
    if (priority == s.medium.priority)
      s.holders = windings[k];
    if (sole >= 0.0) {
      s.complete = 1;
      return s;
    }
  }
  return s;
}

/* Whether a surface that is taken for valid or not, with that medium outside, is what a probe found. */
int matches_probe(int valid, Medium outer, Surroundings found)
{
  if (!valid || found.medium.priority <= found.own_priority)
    return !valid && found.medium.priority <= found.own_priority;
  return found.medium.priority == outer.priority && abs(found.medium.ior.white - outer.ior.white) < 1e-4 &&
         found.medium.absorbs == outer.absorbs &&
         (!outer.absorbs ||
          (abs(found.medium.transmittance_depth - outer.transmittance_depth) <= 1e-4 * outer.transmittance_depth &&
           length((vector)(found.medium.transmittance - outer.transmittance)) < 1e-3));
}

/* Whether any medium fills the point just off `origin`, P's own object left out; not, if more is in the way than a probe may
 * count. `can_trace` as in Surroundings. */
int is_enclosed(point origin, vector direction, int cut, output int can_trace)
{
  int winding = 0;
  float t = 0.0;
  for (int i = 0; i < PROBE_HITS; i++) {
    if (!trace(origin, direction, "mindist", t)) {
      int hit = 0;
      can_trace = i > 0 || getmessage("trace", "hit", hit);
      return winding > 0;
    }
    float self = 0.0;
    float priority[4];
    hit_distance(t);
    getmessage("trace", "hitself", self);
    if (self == 0.0 && getmessage("trace", OBJECT_PRIORITY, priority) && !(cut && hit_is_cut()))
      winding += crossing_sign(direction);
  }
  return 0;
}
