/* Which media meet at a surface, and whether the surface exists. */
#pragma once

#include "cut_face.h"
#include "probe.h"

struct Interface {
  int valid;        /* the surface separates two media; otherwise it lies inside a winner and is not there */
  Medium from;      /* the ray comes from it */
  Medium to;        /* on the other side */
  int from_holders; /* objects of that medium's priority around the point */
  int to_holders;
  int can_trace;       /* 0 where Cycles cannot trace rays from shaders, or they do not tell enough */
  int facts_are_wrong; /* a spot check finds so */
};

/* Whether a spot check finds a medium where the analysis tells of air. Twice is no rounding. */
int air_is_wrong(vector away, int cut)
{
  int can_trace = 1;
  return (is_enclosed(P, away, cut, can_trace) && is_enclosed(P, tilted(away), cut, can_trace)) || !can_trace;
}

/* The code of what may be known: split light needs the medium's whole curve, and a look ahead all that holds the point. */
int usable_code(ExteriorFacts facts, int needs_extent, int curves)
{
  return (facts.code == EXTERIOR_MEDIUM &&
          (curves == CURVES_ALL || (needs_extent && facts.medium.absorbs) || (facts.gives_back && raytype("shadow")))) ?
             EXTERIOR_UNKNOWN :
             facts.code;
}

/* The exterior as the analysis knows it or as the scene answers, and spot checks of what it knows. What a single priority
 * decides is checked, too. `inner`, the surface's own medium, gets its object's priority where that is asked for. */
void find_exterior(ExteriorFacts facts, int cut, int own_is_known, int needs_extent, int curves, float wavelength, vector away,
                   output Medium inner, output Medium outer, output int holders, output Interface s)
{
  int code = usable_code(facts, needs_extent, curves);
  if (code == EXTERIOR_MEDIUM)
    outer = facts.medium;
  if (code == EXTERIOR_WINNER)
    s.valid = 0;
  int unknown = code < EXTERIOR_AIR || code > EXTERIOR_WINNER;
  int checked = spot_check();
  int checks = (checked && (!unknown || facts.sole_priority >= 0.0)) ? 2 : 0;
  if (checked && unknown)
    s.facts_are_wrong = stands_beyond_slots();
  for (int i = unknown ? 0 : 1; i <= checks; i++) {
    Surroundings found = enclosing_medium(P, (i < 2) ? away : tilted(away), inner.priority, own_is_known,
                                          i ? NO_SOLE_PRIORITY : facts.sole_priority, facts.overlaps_itself, cut, curves,
                                          wavelength, facts.scene);
    if (i == 0) {
      s.can_trace = found.can_trace && found.complete;
      inner.priority = found.own_priority;
      outer = found.medium;
      holders = found.holders;
      s.valid = inner.priority < outer.priority;
    }
    else if (found.can_trace && (!found.complete || matches_probe(s.valid, outer, found)))
      checks = 0;
    else
      s.facts_are_wrong = i == 2 || !found.can_trace; /* twice is no rounding */
  }
}

/* Schmidt and Budge, 2002 (Simple nested dielectrics in ray traced images), without their per-ray interface list: what
 * is around the point is known from an analysis of the scene, or the scene is asked.
 *
 * Both sides of a surface share the other media, seen from outside it. Entering, those are the media just before it,
 * leaving, those just behind it, so of two coincident faces one is valid and one is not whichever is met first.
 *
 * `known_air`: the analysis tells so of all objects of the material, which leaves out most of this; needs_extent: that of
 * the media matters; `cut`: surfaces of the scene are cut where media cross; `wants_priority`: that of the medium outside
 * matters; `curves`: see CURVES_NONE. */
Interface resolve_interface(Medium own, ExteriorFacts facts, int cut, int wants_priority, int known_air, int needs_extent,
                            int curves, float wavelength)
{
  vector away = backfacing() ? -Ng : Ng;
  Medium inner = own;
  Medium outer = air();
  int holders = 0;
  Interface s;
  s.valid = 1;
  s.can_trace = 1;
  s.facts_are_wrong = 0;
  /* The way through a medium that is charged ends where another wins, so its priority counts even alone. What may be
   * constant stands first, or nothing folds away. */
  int own_is_known = facts.gives_back || (own.absorbs && needs_extent);
  if (own_is_known)
    inner.priority = own_priority(own.priority);
  int exists = 1;
  if (known_air) {
    if (spot_check())
      s.facts_are_wrong = air_is_wrong(away, cut);
  }
  else if (cut && cut_exterior(own_is_known || wants_priority, curves, wavelength, facts.scene, outer, exists)) {
    s.valid = exists;
    holders = 1;
  }
  else
    find_exterior(facts, cut, own_is_known, needs_extent, curves, wavelength, away, inner, outer, holders, s);
  if (backfacing()) {
    s.from = inner;
    s.to = outer;
    s.from_holders = 1;
    s.to_holders = holders;
  }
  else {
    s.from = outer;
    s.to = inner;
    s.from_holders = holders;
    s.to_holders = 1;
  }
  return s;
}

int is_entrance(Interface s)
{
  return s.valid && s.from.priority == AIR_PRIORITY;
}

int is_exit(Interface s)
{
  return s.valid && s.to.priority == AIR_PRIORITY;
}

/* For artists' nodes: the priority of the medium that touches the object. */
float exterior_priority(Interface s)
{
  float outside = backfacing() ? s.to.priority : s.from.priority;
  return (s.valid && outside < AIR_PRIORITY) ? outside : NO_PRIORITY;
}
