/* What a path brings to the viewer of the light that leaves a surface. */
#pragma once

#include "absorption.h"

/* Adds the light that an artist's port shines with. */
void add_port(int shines, closure color port, output closure color surface)
{
  if (shines)
    surface += port;
}

/* Takes from all what the medium on the way to the viewer absorbs (`behind`), and what fades with the distance of a diffuse
 * surface, from `caustic_distance` on all (scene units; below 0 nothing). A step back to the surface has no way of its own. */
void attenuate(Interface s, Incidence at, ExteriorFacts facts, color behind, float caustic_distance,
               output closure color surface)
{
  if (!at.after_portal) {
    if (facts.gives_back || s.from.absorbs || caustic_distance >= 0.0)
      surface = surface * (behind * caustic_fall_off(at, caustic_distance));
  }
}
