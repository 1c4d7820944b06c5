/* What shows instead of a surface that would be wrong. */
#pragma once

#include "extent.h"
#include "interface.h"
#include "spectrum.h"

/* Not an emitter: Cycles would take every glass for a light and spend light samples on it. */
closure color error_closure(float strength)
{
  return color(strength, 0.0, strength) * diffuse(N);
}

/* OSL of a Blender newer than the last whose closures take the index of the ray's side (5.2 has 1.15). */
int newest_osl()
{
  int version = 0;
  getattribute("osl:version", version);
  return version >= 11600;
}

/* Whether the file is not whole: its spectral tables are gone, or what tells how this Cycles' closures take an index. */
int lacks_files(PathSpectrum path, int front_ior)
{
  return lacks_table(path) || (!front_ior && newest_osl());
}

/* Whether the surface's medium is too thin here, or too far from the origin. Twice is no edge. */
int is_too_thin()
{
  vector inward = backfacing() ? Ng : -Ng;
  return ends_at_once(inward) && ends_at_once(tilted(inward));
}

/* Shows the error closure where the file lacks something, the scene cannot be asked, its analysis is found wrong, or single
 * precision does not hold the surface; returns whether it does. */
int raises_alarm(int lacks, Interface s, Medium own, ExteriorFacts facts, output closure color bsdf)
{
  int unable = lacks || !s.can_trace;
  int checked = spot_check();
  int wrong = s.facts_are_wrong || (checked && is_too_thin()) ||
              (own.absorbs && !facts.may_hold_objects && checked && holds_foreign(own));
  int raised = unable || wrong;
  if (raised)
    bsdf = error_closure(unable ? 1.0 : ALARM);
  return raised;
}
