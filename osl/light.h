/* A light as a surface sees it: evaluating it in a direction, drawing a point of it, and meeting it. */
#pragma once

#include "bounds.h"

/* Lights are no smaller: to single precision a point has no radiance. */
#define LEAST_RADIUS 1e-4

/* Further than all that a ray may meet. */
#define INFINITE_DISTANCE 1e30

struct Light {
  int kind;
  vector centre; /* from the surface; of a sun, its direction */
  vector axis;   /* that it shines along */
  vector edge_x; /* of an area light */
  vector edge_y;
  float size;     /* radius, or sine of a sun's half angle */
  float aperture; /* cosine of a spot's half angle, or half of an area light's spread (radians) */
  float blend;    /* of a spot */
};

/* A direction to a light, and the light there. */
struct LightSample {
  vector direction;
  float distance;
  float pdf;      /* with which light_sample() draws it, per solid angle */
  float radiance; /* of a light with a strength of 1; 0 if the light is not there */
};

/* A unit vector across another. */
vector perpendicular(vector v)
{
  return normalize(cross(v, (abs(v[0]) < 0.9) ? vector(1, 0, 0) : vector(0, 1, 0)));
}

int is_flat(Light light)
{
  return light.kind == LIGHT_AREA || light.kind == LIGHT_ELLIPSE;
}

/* Solid angle of a cone with that squared sine of its half angle. */
float cone_solid_angle(float sin2)
{
  return M_2PI * sin2 / (1.0 + sqrt(max(1.0 - sin2, 0.0)));
}

/* Squared sine of the half angle that a round light fills. */
float sin2_theta_max(Light light)
{
  float sine = (light.kind == LIGHT_SUN) ? light.size : light.size / max(length(light.centre), 1e-12);
  return min(sine * sine, 1.0);
}

float round_distance(Light light)
{
  return (light.kind == LIGHT_SUN) ? INFINITE_DISTANCE : length(light.centre) - light.size;
}

/* Completes a sample from its direction and distance. Radiometry is Cycles': a point light of W watts has a radiance of
 * W / (4 pi^2 r^2), an area light of W / (pi A), and a sun its strength over its projected solid angle. */
void light_eval(Light light, output LightSample s)
{
  s.radiance = 0.0;
  s.pdf = 0.0;
  if (is_flat(light)) {
    float area = length(light.edge_x) * length(light.edge_y) * ((light.kind == LIGHT_ELLIPSE) ? M_PI / 4.0 : 1.0);
    float cosine = -dot(s.direction, light.axis);
    if (cosine > 1e-6 && area > 0.0) {
      s.pdf = s.distance * s.distance / (cosine * area);
      s.radiance = 1.0 / (M_PI * area);
      float half_spread = max(light.aperture, 1e-3);
      if (half_spread < 0.5 * M_PI - 1e-6) { /* slats hide what is seen at a slant */
        float slant = sqrt(max(1.0 - cosine * cosine, 0.0)) / cosine;
        float whole = (half_spread > 0.05) ? tan(half_spread) - half_spread : pow(half_spread, 3.0) / 3.0;
        s.radiance *= max(tan(half_spread) - slant, 0.0) / whole;
      }
    }
    return;
  }
  s.pdf = 1.0 / cone_solid_angle(sin2_theta_max(light));
  if (light.kind == LIGHT_SUN)
    s.radiance = 1.0 / (M_PI * light.size * light.size);
  else
    s.radiance = 1.0 / (4.0 * M_PI * M_PI * light.size * light.size);
  if (light.kind == LIGHT_SPOT)
    s.radiance *=
        smoothstep(0.0, max((1.0 - light.aperture) * light.blend, 1e-6), -dot(s.direction, light.axis) - light.aperture);
}

/* Draws a point of a light by two numbers in [0, 1). */
LightSample light_sample(Light light, float r1, float r2)
{
  LightSample s;
  if (is_flat(light)) {
    float a = r1 - 0.5, b = r2 - 0.5;
    if (light.kind == LIGHT_ELLIPSE) {
      a = 0.5 * sqrt(r1) * cos(M_2PI * r2);
      b = 0.5 * sqrt(r1) * sin(M_2PI * r2);
    }
    s.direction = light.centre + a * light.edge_x + b * light.edge_y;
    s.distance = max(length(s.direction), 1e-12);
    s.direction /= s.distance;
  }
  else {
    vector middle = normalize(light.centre);
    float rise = r1 * cone_solid_angle(sin2_theta_max(light)) / M_2PI; /* 1 - cos */
    float aside = sqrt(max(rise * (2.0 - rise), 0.0));
    vector t = perpendicular(middle);
    s.direction = middle * (1.0 - rise) + aside * (t * cos(M_2PI * r2) + cross(middle, t) * sin(M_2PI * r2));
    s.distance = round_distance(light);
  }
  light_eval(light, s);
  return s;
}

/* The light in a direction. */
LightSample light_intersect(Light light, vector direction)
{
  LightSample s;
  s.direction = direction;
  s.distance = INFINITE_DISTANCE;
  s.pdf = s.radiance = 0.0;
  if (is_flat(light)) {
    float cosine = dot(direction, light.axis);
    if (abs(cosine) < 1e-6)
      return s;
    s.distance = dot(light.centre, light.axis) / cosine;
    vector place = s.distance * direction - light.centre;
    float a = dot(place, light.edge_x) / max(dot(light.edge_x, light.edge_x), 1e-20);
    float b = dot(place, light.edge_y) / max(dot(light.edge_y, light.edge_y), 1e-20);
    int inside = (light.kind == LIGHT_ELLIPSE) ? a * a + b * b < 0.25 : max(abs(a), abs(b)) < 0.5;
    if (s.distance > 0.0 && inside)
      light_eval(light, s);
    return s;
  }
  vector aside = cross(normalize(light.centre), direction);
  if (dot(direction, light.centre) > 0.0 && dot(aside, aside) < sin2_theta_max(light)) {
    s.distance = round_distance(light);
    light_eval(light, s);
  }
  return s;
}
