/* Whether lobes reach the sky, and whether the artist wants it there. */
#pragma once

#include "weights.h"

/* Whether light that is refracted out of all media comes from the sky. */
int refracts_sky(Incidence at)
{
  return at.exits && !at.is_tir && !trace(P, refracted_direction(at.n, at.eta));
}

/* Leaves out what lobes would show of the sky: of a smooth surface, as rays tell. */
void leave_out_sky(Incidence at, int refract_sky, int reflect_sky, output Weights weight)
{
  if (!refract_sky && max_component(weight.transmitted) > 0.0 && refracts_sky(at))
    weight.transmitted = color(0.0);
  if (!reflect_sky && !at.inside && max_component(weight.reflected) > 0.0 && !trace(P, reflect(-I, at.n)))
    weight.reflected = color(0.0);
}
