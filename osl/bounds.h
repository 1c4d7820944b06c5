/* Numbers that a link or a script may give, bounded to what physics allows.
 *
 * contract.h is made by addon/model/osl_contract.py of what Python knows, too: NAME_LIMITS are least, most and default of a
 * parameter, NAME_DEFAULT is its default. */
#pragma once

#include "contract.h"

/* False for NaN and infinity. A comparison with NaN is false where OSL folds it and true where it is computed, so each
 * half serves one of the two; isfinite() does not fold, nor does all that comes after a choice of statements. */
int is_number(float x)
{
  return (abs(x) < LARGEST) > (x != x);
}

int within(float x, float least, float most, float standard)
{
  return (x >= least) * (x <= most) > (x != x);
}

float bounded(float x, float least, float most, float standard)
{
  return select(standard, clamp(x, least, most), is_number(x));
}

/* What is no number has become one of the ends where it is made an integer. */
int bounded(int x, int least, int most, int standard)
{
  int usable = (x > -2000000000) * (x < 2000000000);
  return usable * max(least, min(x, most)) + (1 - usable) * standard;
}

color bounded(color x, float least, float most, color standard)
{
  return select(standard, clamp(x, color(least), color(most)), is_number(x[0] + x[1] + x[2]));
}

vector bounded(vector x, float least, float most, vector standard)
{
  return select(standard, clamp(x, vector(least), vector(most)), is_number(x[0] + x[1] + x[2]));
}

/* Whether a vector, whatever its length, has a direction. */
int has_direction(vector v)
{
  float square = dot(v, v);
  return square > 0.0 && is_number(square);
}

float max_component(color c)
{
  return max(c[0], max(c[1], c[2]));
}
