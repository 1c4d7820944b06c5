/* Random numbers for choices that Cycles does not make. */
#pragma once

/* Numbers of one surface that must not depend on one another. */
#define RANDOM_NARROWING 1
#define RANDOM_SLOPE 2 /* and 3 */
#define RANDOM_REFLECTION 4
#define RANDOM_LIGHT_SAMPLE 5 /* and 6 */
#define RANDOM_BSDF_SAMPLE 7  /* and 8 */
#define RANDOM_MASKING 9
#define RANDOM_VISIBLE_NORMAL 10 /* and on, up to four a try */
#define RANDOM_LIGHT_CHOICE 128  /* and on */

/* A number in [0, 1). Paths meet a surface in different points, so a hash of the point is as good as drawn. */
float random(int purpose)
{
  return hashnoise(P, (float)purpose);
}

/* A normally distributed number (Box and Muller 1958). */
float random_gaussian(int purpose)
{
  return sqrt(-2.0 * log(1.0 - random(purpose))) * cos(M_2PI * random(purpose + 1));
}
