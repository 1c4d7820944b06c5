/* The wavelength of a path, and where white light gets one. */
#pragma once

#include "interface.h"

/* What Cycles calls the time where it samples none: in the viewport, and without motion blur. */
#define STILL_TIME 0.5

/* Below all wavelengths (nm): the image of spectral tables is missing, whose colour Cycles then reads. */
#define MISSING_TABLE 1e2

/* What a path knows of its wavelength at this surface. */
struct PathSpectrum {
  int possible;     /* paths of this render may have a wavelength: Cycles samples time */
  float wavelength; /* nm; 0 while the path is white */
  int portals;      /* rows of the image of tables, counted from 1, that the path's wavelength is from; 0 while it is white */
  int is_manifold_walk; /* Cycles' own through shadow caustics, which evaluates surfaces off the path */
};

PathSpectrum path_spectrum(int spectral, float table_wavelength)
{
  /* No other ray is diffuse without having been reflected or let through. */
  int walk = raytype("diffuse") && !raytype("reflection") && !raytype("refraction") && !raytype("shadow");
  PathSpectrum p = {spectral && time != STILL_TIME, 0.0, 0, walk};
  if (p.possible) {
    /* The look-up is slow; a ray that comes straight from the camera went through none. */
    if (!raytype("camera") || raytype("transparent"))
      getattribute("path:portal_depth", p.portals);
    p.is_manifold_walk = walk && p.portals == 0;
    if (p.portals > 0 || p.is_manifold_walk)
      p.wavelength = table_wavelength;
  }
  return p;
}

int lacks_table(PathSpectrum path)
{
  return path.wavelength > 0.0 && path.wavelength < MISSING_TABLE;
}

/* Length of the step back that a path takes to become monochromatic: far enough for Cycles to meet the same face again,
 * which it does beyond 3.2e-5, and for single precision. */
float step_back()
{
  return 5e-5 + 2e-6 * max(abs(P[0]), max(abs(P[1]), abs(P[2])));
}

/* The path has just come through the portal of this very surface. */
int is_after_portal(PathSpectrum path)
{
  float travelled = 0.0;
  if (path.portals == 0 || !raytype("transparent"))
    return 0;
  getattribute("path:ray_length", travelled);
  return abs(travelled - step_back()) < 0.5 * step_back();
}

/* Whether light that has stepped back meets nodes that are mixed in, `masks` of them, a second time. A sum of constants folds
 * where a choice would not. */
int asks_again(PathSpectrum path, int masks)
{
  return masks > 0 && path.possible && is_after_portal(path);
}

/* Which media's dispersion the surface needs. The product of 0 or 1 with CURVES_DISPERSING or CURVES_ALL folds where a choice
 * would not. Where paths have no wavelength, closures may split light (front_ior: Blender 5.3 on) at the surfaces of media that
 * do. */
int needed_curves(PathSpectrum path, int front_ior, int disperses)
{
  return (front_ior || path.possible) * (CURVES_DISPERSING + (disperses || path.wavelength > 0.0));
}

/* Whether light may get a wavelength here; `caustic_dispersion`: on the way to a diffuse surface, too. */
int splits_light(Interface s, PathSpectrum path, int caustic, int caustic_dispersion)
{
  return path.possible && (s.from.disperses || s.to.disperses) &&
         (caustic_dispersion || !(path.is_manifold_walk || (caustic && path.portals == 0)));
}

/* The ratio of both indices. A walk through media that split no light stays white. */
float relative_ior(Interface s, PathSpectrum path, int disperses)
{
  return (path.possible && path.is_manifold_walk && !disperses) ? eta_at(s.from.ior, s.to.ior, 0.0) :
                                                                  s.to.ior.at_path / s.from.ior.at_path;
}
