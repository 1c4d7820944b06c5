/* How light meets a surface that exists: the state that all lobes share. */
#pragma once

#include "fresnel.h"
#include "spectrum.h"

struct Incidence {
  normal n;              /* of the lobes, towards the viewer */
  float cos_i;           /* between the normal and the viewer, in [0, 1] */
  float eta;             /* n2 / n1, from the ray's side to the other */
  int is_tir;            /* all of the light is reflected: Snell's law (1621) has no other direction */
  int inside;            /* the ray comes through a medium */
  int enters;            /* from air */
  int exits;             /* into air */
  int is_walk;           /* a manifold walk of Cycles' own, off the path */
  int on_caustic;        /* the path leads to a diffuse surface's light, and is no walk */
  int disperses;         /* the path has a wavelength that the surface splits, or may get one */
  int after_portal;      /* it has just got one at this very surface */
  int splits_by_closure; /* where paths have no wavelength: Cycles' closures may split the light */
};

/* Finds how the ray meets the surface. `artist_normal`: zero for the geometry's, which straight shadow rays meet alone. */
void meet_surface(Interface s, PathSpectrum path, vector artist_normal, int caustic_dispersion, output Incidence at)
{
  int shadow = raytype("shadow");
  at.is_walk = path.is_manifold_walk;
  at.on_caustic = !at.is_walk && raytype("diffuse_ancestor");
  at.disperses = splits_light(s, path, at.on_caustic, caustic_dispersion);
  at.after_portal = at.disperses && !shadow && is_after_portal(path);
  at.splits_by_closure =
      !path.possible && (s.from.disperses || s.to.disperses) && (caustic_dispersion || !(at.is_walk || at.on_caustic));
  at.n = (has_direction(artist_normal) && !shadow) ? normalize(artist_normal) : N;
  at.cos_i = clamp(dot(I, at.n), 0.0, 1.0);
  at.eta = relative_ior(s, path, at.disperses);
  at.is_tir = at.eta * at.eta + at.cos_i * at.cos_i < 1.0;
  at.inside = s.from.priority != AIR_PRIORITY;
  at.enters = s.from.priority == AIR_PRIORITY;
  at.exits = s.to.priority == AIR_PRIORITY;
}
