/* Which media meet at a surface, and whether the surface exists. */
#pragma once

#include "probe.h"

struct Interface {
  int valid;    /* the surface separates two media; otherwise it lies inside a winner and is not there */
  Medium from;  /* the ray comes from it */
  Medium to;    /* on the other side */
  int from_holders; /* objects of that medium's priority around the point */
  int to_holders;
  int traced;   /* 0 where Cycles cannot trace rays from shaders */
  int mistold;  /* a spot check finds the analysis wrong */
};

/* Schmidt and Budge, 2002 (Simple nested dielectrics in ray traced images), without their per-ray interface list: what
 * is around the point is known from an analysis of the scene, or the scene is asked.
 *
 * Both sides of a surface share the other media, seen from outside it. Entering, those are the media just before it,
 * leaving, those just behind it, so of two coincident faces one is valid and one is not whichever is met first.
 *
 * `always_air`: the analysis tells so of all objects of the material, which leaves out most of this; looks_ahead: the
 * extent of the media matters; `cut`: surfaces of the scene are cut where media cross; `wants_priority`:
 * that of the medium outside matters; `curves`: see CURVES_NONE. */
Interface resolve_interface(Medium own, Outside told, int cut, int wants_priority, int always_air, int looks_ahead,
                            int curves, float wavelength)
{
  vector away = backfacing() ? -Ng : Ng;
  Medium inner = own;
  Medium outer = air();
  int outer_holders = 0;
  Interface s;
  s.valid = 1;
  s.traced = 1;
  s.mistold = 0;
  /* The way through a medium that is charged ends where another wins, so its priority counts even alone. */
  int known = told.gives_back || (own.absorbs && looks_ahead); /* what may be constant stands first, or nothing folds away */
  if (known)
    inner.priority = shaded_priority(own.priority);
  int exists = 1;
  if (always_air) {
    int traced = 1;
    if (spot_check())
      s.mistold = (lies_in_a_medium(P, away, cut, traced) && lies_in_a_medium(P, askew(away), cut, traced)) || !traced;
  }
  else if (cut && cut_outside(known || wants_priority, curves, wavelength, told.scene, outer, exists)) {
    s.valid = exists;
    outer_holders = 1;
  }
  else {
    int outside = told.outside;
    /* Split light needs the medium's whole curve, and a look ahead all that holds the point. */
    if (outside == OUTSIDE_MEDIUM && (curves == CURVES_ALL || (looks_ahead && told.medium.absorbs) ||
                                      (told.gives_back && raytype("shadow"))))
      outside = OUTSIDE_UNKNOWN;
    if (outside == OUTSIDE_MEDIUM)
      outer = told.medium;
    if (outside == OUTSIDE_WINNER)
      s.valid = 0;
    /* What a single priority decides is checked, too. */
    int unknown = outside < OUTSIDE_AIR || outside > OUTSIDE_WINNER;
    int checks = ((!unknown || told.level >= 0.0) && spot_check()) ? 2 : 0;
    for (int i = unknown ? 0 : 1; i <= checks; i++) {
      Surroundings found = probe_surroundings(P, (i < 2) ? away : askew(away), inner.priority, known, i ? -1.0 : told.level,
                                              told.overlaps_itself, cut, curves, wavelength, told.scene);
      if (i == 0) {
        s.traced = found.traced;
        inner.priority = found.own_priority;
        outer = found.medium;
        outer_holders = found.holders;
        s.valid = inner.priority < outer.priority;
      }
      else if (found.traced && (!found.complete || agrees(s.valid, outer, found)))
        checks = 0;
      else
        s.mistold = i == 2 || !found.traced; /* twice is no rounding */
    }
  }
  if (backfacing()) {
    s.from = inner;
    s.to = outer;
    s.from_holders = 1;
    s.to_holders = outer_holders;
  }
  else {
    s.from = outer;
    s.to = inner;
    s.from_holders = outer_holders;
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
