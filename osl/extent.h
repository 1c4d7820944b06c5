/* How far a ray runs in a medium, and what lies on its way. */
#pragma once

#include "crossing.h"
#include "transmittance.h"

/* What is foreign on a way through a medium, objects and a label at its end: distances of the first and the last; below 0
 * there is none. */
struct ForeignHits {
  float first;
  float last;
};

void add_foreign_hit(output ForeignHits foreign, float distance)
{
  if (foreign.first < 0.0)
    foreign.first = distance;
  foreign.last = distance;
}

/* Distance that a ray from inside a medium runs in it: to the surface where it ends, to a foreign object if those stop it,
 * or to reach. `holders` is the number of objects of its priority around the origin; surfaces of media that the medium
 * wins over do not exist in it. */
float distance_to_exit(point origin, vector direction, Medium m, int holders, float reach, int foreign_stops,
                       output ForeignHits foreign)
{
  int winding = holders;
  float t = 0.0;
  foreign.first = foreign.last = -1.0;
  for (int i = 0; i < PROBE_HITS; i++) {
    if (!trace(origin, direction, "mindist", t, "maxdist", reach))
      break;
    float distance = hit_distance(t);
    int slot = NO_SLOT;
    float priority = hit_priority(slot);
    if (priority >= AIR_PRIORITY) {
      add_foreign_hit(foreign, distance);
      if (foreign_stops)
        return distance;
    }
    else if (priority <= m.priority) {
      int sign = crossing_sign(direction);
      int ends = sign < 0;
      if (priority == m.priority) {
        winding -= sign;
        ends = winding <= 0;
      }
      if (ends) {
        if (hit_is_label())
          add_foreign_hit(foreign, distance);
        return distance;
      }
    }
  }
  return reach;
}

/* Whether a foreign object stands in the surface's own medium straight behind it. */
int holds_foreign(Medium own)
{
  Medium m = own;
  m.priority = own_priority(own.priority);
  ForeignHits foreign;
  distance_to_exit(P, backfacing() ? Ng : -Ng, m, 1, 1e30, 1, foreign);
  return foreign.first >= 0.0;
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
    float distance = hit_distance(t);
    int slot = NO_SLOT;
    int foreign = hit_priority(slot) >= AIR_PRIORITY;
    if (distance < 2.0 * before) {
      began_at_foreign = began_at_foreign || foreign;
      began_at_medium = began_at_medium || !foreign;
    }
    else if (foreign)
      return (began_at_foreign && !began_at_medium) ? 0.0 : distance - before;
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
  color optical_depth = color(0.0);
  float t = 0.0;
  for (int i = 0; i < PROBE_HITS && trace(P, direction, "mindist", t); i++) {
    float distance = hit_distance(t);
    int slot = NO_SLOT;
    float priority = hit_priority(slot);
    if (priority < AIR_PRIORITY && priority > m.priority) {
      int sign = crossing_sign(direction);
      Medium loser = hit_medium(priority, slot, CURVES_NONE, 0.0, scene);
      if (loser.by_volume)
        optical_depth += sign * min(distance, length) * absorption_coefficients(loser.transmittance, loser.transmittance_depth);
    }
  }
  return exp(optical_depth);
}
