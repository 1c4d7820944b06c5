/* What a homogeneous medium leaves of light. */
#pragma once

#include "bounds.h"

/* Transmittance over a distance (Bouguer 1729, Lambert 1760, Beer 1852), where `transmittance` is left after `depth`.
 * Units of both lengths: scene units. */
color beer_lambert(color transmittance, float depth, float distance)
{
  return (depth > 0.0) ? pow(transmittance, max(distance, 0.0) / depth) : color(1.0);
}

/* Absorption coefficients of each colour, as Cycles' volume of the material has them (addon/nodes/absorption.py). */
color absorption_coefficients(color transmittance, float depth)
{
  return log(max(transmittance, color(LEAST_TRANSMITTANCE))) / -depth;
}
