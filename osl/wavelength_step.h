/* The step by which white light gets a wavelength. */
#pragma once

#include "weights.h"

/* Every wavelength enters a denser medium, so none is reflected totally, and reflectances follow from the indices'
 * slopes: white light may be reflected as a whole. */
int reflects_white(Interface s)
{
  return s.from.ior.nearly_linear && s.to.ior.nearly_linear &&
         eta_at(s.from.ior, s.to.ior, inverse_square_offset(SHORTEST)) > 1.0 &&
         eta_at(s.from.ior, s.to.ior, inverse_square_offset(LONGEST)) > 1.0;
}

/* Colour of white light that a denser dispersing medium reflects, as a factor on the reflectance at `eta`, the
 * channels' largest. Indices are near linear in the offset, so a channel reflects as at its mean. */
color reflected_white(Interface s, float cos_i, vector mean_offsets, output float eta)
{
  color etas = color(eta_at(s.from.ior, s.to.ior, mean_offsets[0]), eta_at(s.from.ior, s.to.ior, mean_offsets[1]),
                     eta_at(s.from.ior, s.to.ior, mean_offsets[2]));
  eta = max_component(etas);
  float most = max(fresnel_dielectric(cos_i, eta), 1e-12);
  return color(fresnel_dielectric(cos_i, etas[0]), fresnel_dielectric(cos_i, etas[1]), fresnel_dielectric(cos_i, etas[2])) /
         most;
}

/* Takes the step to a wavelength where it is due: what it makes of reflection and refraction, as factors, and the closure of
 * the portal.
 *
 * White light that refracts where a medium splits it steps back through a portal and meets the surface again with a
 * wavelength, counted in the path's portals: as many as the row of its table. What is reflected on the way into a
 * denser medium stays white and does not step back. `at.eta` becomes that of white light's reflection.
 * `table`, `table_means` and `weight` are the shader's Table, TableMeans and Weight. */
void step_to_wavelength(Interface s, PathSpectrum path, int table, vector table_means, color weight, output Incidence at,
                        output Weights factor, output closure color portal)
{
  if (at.disperses && !at.is_walk && (path.portals == 0 || at.after_portal)) {
    int takes_portal = path.portals == 0 || (at.after_portal && path.portals <= table);
    float enters = 1.0;
    if (reflects_white(s)) {
      float white_eta;
      vector means = bounded(table_means * 1e-6, inverse_square_offset(LONGEST), inverse_square_offset(SHORTEST), vector(0.0));
      color white = reflected_white(s, at.cos_i, means, white_eta);
      /* Cycles picks closures by their weights: this makes the portal's what enters, not all, and is taken back behind it. */
      enters = max(1.0 - fresnel_dielectric(at.cos_i, white_eta), 0.05);
      factor.reflected = at.after_portal ? color(0.0) : white;
      if (!at.after_portal)
        at.eta = white_eta;
    }
    else if (takes_portal)
      factor.reflected = color(0.0);
    factor.transmitted = takes_portal ? color(0.0) : color(1.0 / enters);
    if (takes_portal)
      portal = ((path.portals == 0) ? weight * enters : color(1.0)) * ray_portal_bsdf(P + I * step_back(), -I);
  }
}

/* Colours what a walk of Cycles' sees of light that the surface splits where it enters: a walk takes no step. */
void colour_walk(Interface s, Incidence at, color weight, output closure color surface)
{
  if (at.disperses && at.is_walk && s.to.disperses && !s.from.disperses)
    surface = surface * weight;
}
