/* What debug views show of a surface, as one number. Nothing of it is left while none is on. */
#pragma once

#include "interface.h"

/* Surfaces that a view counts along a ray. */
#define DEBUG_HITS 4096

/* Media that hold the point just inside the surface, its own among them: the sum of signed crossings of all others along a
 * ray outwards. */
float count_holders(vector away, int overlaps_itself, int cut)
{
  int winding = 1;
  float t = 0.0;
  for (int i = 0; i < DEBUG_HITS && trace(P, away, "mindist", t); i++) {
    float priority[4];
    hit_distance(t);
    if (!tells_nothing(overlaps_itself, cut) && getmessage("trace", OBJECT_PRIORITY, priority))
      winding += crossing_sign(away);
  }
  return winding;
}

/* Rays that the last probe took. Its last ray has left its record, and the same surfaces are met again until there. */
float count_rays(vector away)
{
  int hit = 0;
  if (!getmessage("trace", "hit", hit))
    return 0.0;
  float last = LARGEST, t = 0.0;
  if (hit)
    getmessage("trace", "hitdist", last);
  int rays = 1;
  while (rays < DEBUG_HITS && trace(P, away, "mindist", t) && hit_distance(t) < last)
    rays++;
  return rays;
}

/* What is told of the surface's exterior: EXTERIOR_UNKNOWN to EXTERIOR_WINNER, TOLD_BY_FACE. */
float told_by(ExteriorFacts facts, int cut)
{
  float face = 0.0;
  if (cut && facts.code != EXTERIOR_AIR)
    getattribute(CUT_ATTRIBUTE, face);
  if (face != 0.0)
    return TOLD_BY_FACE;
  return (facts.code <= EXTERIOR_WINNER) ? facts.code : EXTERIOR_UNKNOWN;
}

/* The number of a view (addon/model/debug_views.py says what each means), right after the interface is found: the record of its
 * last ray is read. */
float debug_number(int view, Interface s, Medium own, ExteriorFacts facts, int cut)
{
  vector away = backfacing() ? -Ng : Ng;
  float told = told_by(facts, cut);
  if (!s.can_trace || s.facts_are_wrong)
    return DEBUG_ALARM;
  if (view == VIEW_MEDIUM && !s.valid)
    return DEBUG_HIDDEN;
  if (view == VIEW_MEDIUM)
    return backfacing() ? exterior_priority(s) : own_priority(own.priority);
  if (view == VIEW_VALIDITY)
    return s.valid;
  if (view == VIEW_DEPTH && told != TOLD_BY_FACE)
    return count_holders(away, facts.overlaps_itself, cut);
  if (view == VIEW_DEPTH)
    return s.valid && exterior_priority(s) == NO_PRIORITY;
  if (view == VIEW_RAYS)
    return (told != EXTERIOR_UNKNOWN && spot_check()) ? 0.0 : count_rays(away);
  return (view == VIEW_TOLD) ? told : 0.0;
}
