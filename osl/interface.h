/* Which media meet at a surface, and whether the surface exists. */
#pragma once

#include "probe.h"

struct Interface {
  int valid;    /* the surface separates two media; otherwise it lies inside a winner and is not there */
  Medium from;  /* the ray comes from it */
  Medium to;    /* on the other side */
  int from_holders; /* objects of that medium's priority around the point */
  int to_holders;
  int traced;   /* 0 where Cycles cannot trace rays from shaders, so nothing of this is known */
};

/* Schmidt and Budge, 2002 (Simple nested dielectrics in ray traced images), without their per-ray interface list: the
 * media around the point are asked of the scene.
 *
 * Both sides of a surface share the other media, seen from outside it. Entering, those are the media just before it,
 * leaving, those just behind it, so of two coincident faces one is valid and one is not whichever is met first. */
Interface resolve_interface(Medium own, int spectral, float wavelength)
{
  /* The way through a medium that absorbs ends where another wins, so its priority counts even alone. */
  int known = absorbs(own);
  float priority = known ? shaded_priority(own.priority) : own.priority;
  int curves = CURVES_NONE;
  if (spectral)
    curves = (own.disperses || wavelength > 0.0) ? CURVES_ALL : CURVES_DISPERSING;
  Surroundings outer = probe_surroundings(P, backfacing() ? -Ng : Ng, priority, known, curves, wavelength);
  Medium inner = own;
  inner.priority = outer.own_priority;
  Interface s;
  s.traced = outer.traced;
  s.valid = inner.priority < outer.medium.priority;
  if (backfacing()) {
    s.from = inner;
    s.to = outer.medium;
    s.from_holders = 1;
    s.to_holders = outer.holders;
  }
  else {
    s.from = outer.medium;
    s.to = inner;
    s.from_holders = outer.holders;
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
