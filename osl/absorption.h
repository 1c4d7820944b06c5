/* What media absorb of a path's light: on the way to the surface and, as far as only this surface can tell, beyond it. */
#pragma once

#include "extent.h"
#include "incidence.h"

/* Transmittance of the ways on both sides of the surface: of the reflected (0) and the refracted lobe (1) to a foreign object
 * inside the medium, where the ray may end. The way to a dielectric is charged there, less what was charged ahead.
 *
 * A shadow ray goes straight on, and may end at a foreign object that shines. ahead[0] is its way in the medium just left:
 * such a ray measures every hit from its own origin, so the stretch is traced back. */
void transmittance_ahead(Interface s, Incidence at, ExteriorFacts facts, int shadow, output color ahead[2])
{
  vector reflected = shadow ? I : reflect(-I, at.n);
  vector refracted = shadow ? -I : refracted_direction(at.n, at.eta);
  vector directions[2] = {reflected, refracted};
  for (int side = 0; side < 2; side++) {
    Medium m = s.from;
    int holders = s.from_holders;
    if (side == 1) {
      m = s.to;
      holders = s.to_holders;
    }
    int back = shadow && side == 0;
    int gives_back = facts.gives_back && m.priority != AIR_PRIORITY;
    if ((gives_back || m.absorbs) && (back || facts.may_hold_objects) && dot(directions[side], directions[side]) > 0.0) {
      float reach = 1e30;
      if (back)
        getattribute("path:ray_length", reach);
      ForeignHits foreign;
      float extent = distance_to_exit(P, directions[side], m, holders, reach, !back, foreign);
      if (back && extent < reach && facts.may_hold_objects && foreign.last >= 0.0)
        extent = foreign.last; /* the rest was charged where the ray came into the medium */
      if (back || foreign.first >= 0.0) {
        if (m.absorbs)
          ahead[side] = beer_lambert(m.transmittance, m.transmittance_depth, extent);
        if (gives_back)
          ahead[side] *= given_back(directions[side], m, extent, facts.scene);
      }
    }
  }
}

/* What the surface itself lets through to a straight shadow ray, by the artist's Shadow Mode. */
float shadow_fresnel(Incidence at, int mode)
{
  if (mode == SHADOW_BLACK)
    return 0.0;
  if (mode == SHADOW_ALL_FRESNEL || (mode == SHADOW_OUTSIDE_FRESNEL && at.enters))
    return 1.0 - fresnel_dielectric(at.cos_i, at.eta);
  return 1.0;
}

/* Rays from the camera and from foreign objects may end on another foreign object without meeting a medium's surface,
 * so their absorption is the material's volume's. */
int is_charged_by_volume()
{
  return raytype("camera") || raytype("diffuse");
}

/* Transmittance of the way here through the medium that the ray crossed, less what was charged ahead, and with what volumes
 * of losers took there given back; 1 for walks, which evaluate surfaces off the path. */
color transmittance_behind(Interface s, Incidence at, ExteriorFacts facts)
{
  color transmittance = color(1.0);
  int charges = s.from.absorbs && !is_charged_by_volume();
  if (charges || (facts.gives_back && at.inside && !at.is_walk)) {
    float travelled = 0.0;
    getattribute("path:ray_length", travelled);
    if (facts.gives_back)
      transmittance = given_back(I, s.from, travelled, facts.scene);
    if (facts.may_hold_objects && !is_charged_by_volume() && (charges || transmittance != color(1.0))) {
      float before = charged_ahead(travelled);
      travelled -= before;
      if (facts.gives_back && before > 0.0)
        transmittance = given_back(I, s.from, travelled, facts.scene);
    }
    if (charges)
      transmittance *= beer_lambert(s.from.transmittance, s.from.transmittance_depth, travelled);
  }
  return transmittance;
}

/* What is left of light on its way to a diffuse surface further off than the artist wants: the ray from there comes
 * straight to this surface. */
float caustic_fall_off(Incidence at, float most)
{
  if (!at.on_caustic || most < 0.0 || !raytype("diffuse"))
    return 1.0;
  float length = 0.0;
  getattribute("path:ray_length", length);
  return (length < most) ? 1.0 - length / most : 0.0;
}
