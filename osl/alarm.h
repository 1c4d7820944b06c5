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

/* Shows the error closure where the file lacks something, the scene cannot be asked, or its analysis is found wrong; returns
 * whether it does. */
int raises_alarm(int lacks, Interface s, Medium own, ExteriorFacts facts, output closure color bsdf)
{
  int unable = lacks || !s.can_trace;
  int wrong = s.facts_are_wrong || (own.absorbs && !facts.may_hold_objects && spot_check() && holds_foreign(own));
  int raised = unable || wrong;
  if (raised)
    bsdf = error_closure(unable ? 1.0 : ALARM);
  return raised;
}
