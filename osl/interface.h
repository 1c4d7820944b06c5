/* Which media meet at a surface, and whether the surface exists. */
#pragma once

#include "probe.h"

struct Interface {
  int valid;    /* the surface separates two media; otherwise it lies inside a winner and is not there */
  Medium from;  /* medium the ray comes from */
  Medium to;    /* medium on the other side */
  int from_holders; /* objects of that medium's priority around the point */
  int to_holders;
};

/* Schmidt and Budge, 2002 (Simple nested dielectrics in ray traced images), without their per-ray interface list: the
 * media around the point are asked of the scene.
 *
 * Both sides of a surface share the other media, seen from outside it. Entering, those are the media just before it, leaving, those
 * just behind it, so of two coincident faces one is valid and one is not whichever is met first. */
Interface resolve_interface(Medium own)
{
  normal outward = backfacing() ? -Ng : Ng;
  int holders = 0;
  Medium outer = probe_medium(P, outward, own.priority, holders);
  Interface s;
  s.valid = own.priority < outer.priority;
  if (backfacing()) {
    s.from = own;
    s.to = outer;
    s.from_holders = 1;
    s.to_holders = holders;
  }
  else {
    s.from = outer;
    s.to = own;
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
