/* What a point lies in, asked of the scene by trace(). */
#pragma once

#include "cut.h"
#include "optics.h"
#include "outside.h"

/* Crossings one probe may count. A ray through a whole forest meets fewer. */
#define PROBE_HITS 1024
/* Priorities that one run of a probe sums at the same time; where more are open it runs again for those it left. */
#define PROBE_LEVELS 64

/* The next float after t, so that the surface just met is left behind and the very next one is not. */
float step_past(float t)
{
  return t + t * 1.2e-7 + 1e-30;
}

/* Whether the surface hit last is cut where media cross. All that it meets is cut with it, so it surrounds nothing that asks. */
int hit_cut()
{
  float told = 0.0;
  return getmessage("trace", CUT_FACE, told) && told != 0.0;
}

/* +1 if the surface hit last was left from its inside, -1 if it was entered from its outside.
 *
 * trace() turns the hit's normal towards the ray, so the side is gone from it, and the winding of the vertices is
 * reversed by a mirroring transform. What keeps the side is the hit's surface parametrisation: Cycles negates dP/du on
 * back faces, so the derivatives of u and v, put back on the triangle's edges, give dP/dx with the side's sign. */
int hit_crossing(vector direction)
{
  float u = 0.0, v = 0.0;
  point q = point(0.0);
  point vertex[3];
  getmessage("trace", "u", u);
  getmessage("trace", "v", v);
  getmessage("trace", "P", q);
  getmessage("trace", "geom:trianglevertices", vertex);
  vector e1 = vertex[1] - vertex[0];
  vector e2 = vertex[2] - vertex[0];
  float side = dot(e1 * Dx(u) + e2 * Dx(v), Dx(q));
  if (side == 0.0) /* a ray without differentials */
    side = -dot(cross(e1, e2), direction);
  return (side < 0.0) ? 1 : -1;
}

/* What lies around a surface of one medium. */
struct Surroundings {
  Medium medium;      /* the winner among the other media */
  int holders;        /* objects of its priority that hold the point */
  float own_priority; /* of the surface's object; the material's while nothing asked for it */
  int traced;         /* 0 where Cycles cannot trace rays from shaders, or they tell less than is needed */
  int complete;       /* 0 where more is in the way than a probe may count */
};

/* The media that fill the point just off P in the given direction, P's own object left out.
 *
 * The winding number of a closed surface about a point is the sum of the signed crossings along any ray from it
 * (Jacobson, Kavan, Sorkine-Hornung 2013, section 3). Summed per priority it also makes objects of equal priority one
 * medium. The running sum is above zero only if some object holds the point, so a probe may stop at the first sum that
 * decides that the surface's own medium does not win.
 *
 * own_priority is the material's until an object's own is asked for, which a surface that meets no other medium never
 * needs; own_is_known tells that it has been. Where `level` is a priority, objects of that priority alone may be around,
 * all closed and apart from each other: the nearest surface of theirs decides. Surfaces of an object that overlaps itself
 * count as any other's. `cut`: surfaces of the scene are cut where media cross. */
Surroundings probe_surroundings(point origin, vector direction, float own_priority, int own_is_known, float level,
                                int overlaps_itself, int cut, int curves, float wavelength, int scene)
{
  float open[PROBE_LEVELS];
  int sum[PROBE_LEVELS];
  int levels = 0;
  int known = own_is_known;
  Surroundings s;
  s.medium = air();
  s.holders = 0;
  s.own_priority = own_priority;
  s.traced = 1;
  s.complete = 0;
  float least = 0.0, unsummed = AIR_PRIORITY; /* priorities of this run: from the first on, below the second */
  float t = 0.0;
  for (int i = 0; i < PROBE_HITS; i++) {
    if (!trace(origin, direction, "mindist", t)) {
      /* On the CPU a ray leaves its record even if it met nothing. */
      int hit = 0;
      if (i == 0)
        s.traced = getmessage("trace", "hit", hit);
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
    float distance = 0.0, self = 0.0;
    getmessage("trace", "hitdist", distance);
    t = step_past(distance);
    getmessage("trace", "hitself", self);
    if ((self > 0.0 && !overlaps_itself) || (cut && hit_cut()))
      continue;
    int slot = NO_SLOT;
    float priority = hit_priority(slot);
    if (slot == UNREADABLE_SLOT) {
      s.traced = 0;
      return s;
    }
    if (priority >= unsummed || priority < least || priority > s.medium.priority || (level >= 0.0 && priority != level))
      continue;
    if (!known) {
      known = 1;
      s.own_priority = shaded_priority(own_priority);
    }
    int k = 0;
    while (k < levels && open[k] != priority)
      k++;
    if (k == levels && levels == PROBE_LEVELS) {
      /* A sum that is back at 0 says as much as none. */
      k = 0;
      while (k < levels && sum[k] != 0)
        k++;
      if (k == levels) {
        k = 0;
        for (int other = 1; other < levels; other++)
          k = (open[other] > open[k]) ? other : k;
        unsummed = max(open[k], priority);
        if (unsummed == priority)
          continue;
      }
      open[k] = priority;
      sum[k] = 0;
    }
    if (k == levels) {
      open[k] = priority;
      sum[k] = 0;
      levels++;
    }
    sum[k] += hit_crossing(direction);
    if (sum[k] > 0 && priority < s.medium.priority) {
      s.medium = hit_medium(priority, slot, curves, wavelength, scene);
      if (slot == UNREADABLE_SLOT)
        s.traced = 0;
      s.complete = priority <= s.own_priority;
      if (s.complete || !s.traced)
        return s;
    }
    if (priority == s.medium.priority)
      s.holders = sum[k];
    if (level >= 0.0) {
      s.complete = 1;
      return s;
    }
  }
  return s;
}

/* Whether a surface that is taken for valid or not, with that medium outside, is what a ray found. */
int agrees(int valid, Medium outer, Surroundings found)
{
  if (!valid || found.medium.priority <= found.own_priority)
    return !valid && found.medium.priority <= found.own_priority;
  return found.medium.priority == outer.priority && abs(found.medium.ior.white - outer.ior.white) < 1e-4 &&
         found.medium.absorbs == outer.absorbs &&
         (!outer.absorbs ||
          (abs(found.medium.transmittance_depth - outer.transmittance_depth) <= 1e-4 * outer.transmittance_depth &&
           length((vector)(found.medium.transmittance - outer.transmittance)) < 1e-3));
}

/* Whether any medium fills the point just off P, P's own object left out; not, if more is in the way than a probe may
 * count. `traced` as in Surroundings. */
int lies_in_a_medium(point origin, vector direction, int cut, output int traced)
{
  int sum = 0;
  float t = 0.0;
  for (int i = 0; i < PROBE_HITS; i++) {
    if (!trace(origin, direction, "mindist", t)) {
      int hit = 0;
      traced = i > 0 || getmessage("trace", "hit", hit);
      return sum > 0;
    }
    float distance = 0.0, self = 0.0;
    float priority[4];
    getmessage("trace", "hitdist", distance);
    t = step_past(distance);
    getmessage("trace", "hitself", self);
    if (self == 0.0 && getmessage("trace", OBJECT_PRIORITY, priority) && !(cut && hit_cut()))
      sum += hit_crossing(direction);
  }
  return 0;
}

/* What is foreign on a way through a medium, objects and a label at its end: distances of the first and the last; below 0
 * there is none. */
struct Strangers {
  float first;
  float last;
};

/* How far a ray from inside a medium runs in it: to the surface where it ends, to a foreign object if those stop it, or
 * to reach. `holders` is the number of objects of its priority around the origin; surfaces of media that the medium
 * wins over do not exist in it. */
float medium_extent(
    point origin, vector direction, Medium m, int holders, float reach, int foreign_stops, output Strangers strangers)
{
  int open = holders;
  float t = 0.0;
  strangers.first = strangers.last = -1.0;
  for (int i = 0; i < PROBE_HITS; i++) {
    if (!trace(origin, direction, "mindist", t, "maxdist", reach))
      break;
    float hit = 0.0;
    getmessage("trace", "hitdist", hit);
    t = step_past(hit);
    int slot = NO_SLOT;
    float priority = hit_priority(slot);
    if (priority >= AIR_PRIORITY) {
      if (strangers.first < 0.0)
        strangers.first = hit;
      strangers.last = hit;
      if (foreign_stops)
        return hit;
    }
    else if (priority <= m.priority) {
      int crossing = hit_crossing(direction);
      int ends = crossing < 0;
      if (priority == m.priority) {
        open -= crossing;
        ends = open <= 0;
      }
      if (ends) {
        if (hit_label()) {
          strangers.last = hit;
          if (strangers.first < 0.0)
            strangers.first = hit;
        }
        return hit;
      }
    }
  }
  return reach;
}

/* Whether a foreign object stands in the surface's own medium straight behind it. */
int holds_foreign(Medium own)
{
  Medium m = own;
  m.priority = shaded_priority(own.priority);
  Strangers strangers;
  medium_extent(P, backfacing() ? Ng : -Ng, m, 1, 1e30, 1, strangers);
  return strangers.first >= 0.0;
}

/* Part of a ray's length within which it began at the surface that is met there. */
#define AT_ORIGIN 1e-4

/* How much of the way that a ray has come was charged where it began: a surface of media looks ahead to the first foreign
 * object, which then let the ray on. Nobody looked ahead where it began at a foreign object or in mid-air. */
float charged_ahead(float travelled)
{
  if (raytype("volume_scatter"))
    return 0.0;
  float before = AT_ORIGIN * travelled;
  point start = P + I * (travelled + before);
  int began_at_medium = 0, began_at_foreign = 0;
  float t = 0.0;
  for (int i = 0; i < PROBE_HITS && trace(start, -I, "mindist", t, "maxdist", travelled + before); i++) {
    float hit = 0.0;
    getmessage("trace", "hitdist", hit);
    t = step_past(hit);
    int slot = NO_SLOT;
    int foreign = hit_priority(slot) >= AIR_PRIORITY;
    if (hit < 2.0 * before) {
      began_at_foreign = began_at_foreign || foreign;
      began_at_medium = began_at_medium || !foreign;
    }
    else if (foreign)
      return (began_at_foreign && !began_at_medium) ? 0.0 : hit - before;
  }
  return 0.0;
}

/* What gives light back what volumes of media that `m` wins over take on a way of that length through `m` from the surface on:
 * a factor.
 *
 * A body takes by its coefficient over each stretch that it holds, which is the sum of the distances of its signed crossings
 * along the whole ray, none of them further than the way's end. So nothing is to be known of the bodies one by one, and those
 * that hold no part of the way cancel out. */
color given_back(vector direction, Medium m, float length, int scene)
{
  color depth = color(0.0);
  float t = 0.0;
  for (int i = 0; i < PROBE_HITS && trace(P, direction, "mindist", t); i++) {
    float hit = 0.0;
    getmessage("trace", "hitdist", hit);
    t = step_past(hit);
    int slot = NO_SLOT;
    float priority = hit_priority(slot);
    if (priority < AIR_PRIORITY && priority > m.priority) {
      int crossing = hit_crossing(direction);
      Medium loser = hit_medium(priority, slot, CURVES_NONE, 0.0, scene);
      if (loser.by_volume)
        depth += crossing * min(hit, length) * volume_coefficients(loser.transmittance, loser.transmittance_depth);
    }
  }
  return exp(depth);
}
