/* Walking along a ray through all surfaces of the scene, by trace(). A walk ends after PROBE_HITS, whatever it meets. */
#pragma once

#include "neighbour.h"

/* The next float after t, so that the surface just met is left behind and the very next one is not. */
float next_after(float t)
{
  return t + t * 1.2e-7 + 1e-30;
}

/* Distance of the surface hit last; `t` becomes what the next one is further than. */
float hit_distance(output float t)
{
  float distance = 0.0;
  getmessage("trace", "hitdist", distance);
  t = next_after(distance);
  return distance;
}

/* Whether the surface hit last is cut where media cross. All that it meets is cut with it, so it surrounds nothing that asks. */
int hit_is_cut()
{
  float told = 0.0;
  return getmessage("trace", CUT_ATTRIBUTE, told) && told != 0.0;
}

/* +1 if the surface hit last was left from its inside, -1 if it was entered from its outside.
 *
 * trace() turns the hit's normal towards the ray, so the side is gone from it, and the winding of the vertices is
 * reversed by a mirroring transform. What keeps the side is the hit's surface parametrisation: Cycles negates dP/du on
 * back faces, so the derivatives of u and v, put back on the triangle's edges, give dP/dx with the side's sign. */
int crossing_sign(vector direction)
{
  float u = 0.0, v = 0.0;
  point q = point(0.0);
  point vertex[3];
  getmessage("trace", "u", u);
  getmessage("trace", "v", v);
  getmessage("trace", "P", q);
  getmessage("trace", "geom:trianglevertices", vertex);
  vector e1 = vertex[1] - vertex[0];
  vector e2 = vertex[2] - vertex[0];
  float side = dot(e1 * Dx(u) + e2 * Dx(v), Dx(q));
  if (side == 0.0) /* a ray without differentials */
    side = -dot(cross(e1, e2), direction);
  return (side < 0.0) ? 1 : -1;
}

/* Whether the shaded object ends again so near behind the surface that single precision cannot tell both of its sides apart.
 * What lies on the surface itself, as faces that are there twice, ends nothing, nor does the other side of an edge. */
int ends_at_once(vector inward)
{
  float spacing = FLOAT_SPACING * max(abs(P[0]), max(abs(P[1]), abs(P[2])));
  normal across = normal(0.0);
  return trace(P, inward, "mindist", 4.0 * spacing, "maxdist", PRECISION_LIMIT * spacing, "traceset", "__only_local__") &&
         getmessage("trace", "Ng", across) && abs(dot(across, inward)) > 0.9;
}
