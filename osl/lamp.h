/* A lamp as a surface sees it: drawing a point of it, and meeting it. */
#pragma once

#define LAMP_POINT 0
#define LAMP_SUN 1
#define LAMP_SPOT 2
#define LAMP_AREA 3
#define LAMP_ELLIPSE 4

/* Lamps are no smaller: to single precision a point has no radiance. */
#define LEAST_RADIUS 1e-4

struct Lamp {
  int kind;
  vector centre; /* from the surface; of a sun, its direction */
  vector axis;   /* that it shines along */
  vector edge_x; /* of an area lamp */
  vector edge_y;
  vector shape; /* radius, or sine of a sun's half angle; cosine of a spot's half angle, or half spread; spot blend */
};

/* A direction to a lamp, and the lamp there. */
struct LampPoint {
  vector way;
  float range;
  float density;  /* with which lamp_point() draws it, per solid angle */
  float radiance; /* of a lamp with a strength of 1; 0 if the lamp is not there */
};

/* A unit vector across another. */
vector perpendicular(vector v)
{
  return normalize(cross(v, (abs(v[0]) < 0.9) ? vector(1, 0, 0) : vector(0, 1, 0)));
}

/* Solid angle of a cone with that squared sine of its half angle. */
float cone(float sin2)
{
  return M_2PI * sin2 / (1.0 + sqrt(max(1.0 - sin2, 0.0)));
}

/* Squared sine of the half angle that a round lamp fills. */
float round_size(Lamp lamp)
{
  float sine = (lamp.kind == LAMP_SUN) ? lamp.shape[0] : lamp.shape[0] / max(length(lamp.centre), 1e-12);
  return min(sine * sine, 1.0);
}

/* Completes a point from its direction and distance. Radiometry is Cycles': a point lamp of W watts has a radiance of
 * W / (4 pi^2 r^2), an area lamp of W / (pi A), and a sun its strength over its projected solid angle. */
void lamp_light(Lamp lamp, output LampPoint p)
{
  p.radiance = 0.0;
  p.density = 0.0;
  if (lamp.kind == LAMP_AREA || lamp.kind == LAMP_ELLIPSE) {
    float area = length(lamp.edge_x) * length(lamp.edge_y) * ((lamp.kind == LAMP_ELLIPSE) ? M_PI / 4.0 : 1.0);
    float cosine = -dot(p.way, lamp.axis);
    if (cosine > 1e-6 && area > 0.0) {
      p.density = p.range * p.range / (cosine * area);
      p.radiance = 1.0 / (M_PI * area);
      float half_spread = max(lamp.shape[1], 1e-3);
      if (half_spread < 0.5 * M_PI - 1e-6) { /* slats hide what is seen at a slant */
        float slant = sqrt(max(1.0 - cosine * cosine, 0.0)) / cosine;
        float whole = (half_spread > 0.05) ? tan(half_spread) - half_spread : pow(half_spread, 3.0) / 3.0;
        p.radiance *= max(tan(half_spread) - slant, 0.0) / whole;
      }
    }
    return;
  }
  p.density = 1.0 / cone(round_size(lamp));
  if (lamp.kind == LAMP_SUN)
    p.radiance = 1.0 / (M_PI * lamp.shape[0] * lamp.shape[0]);
  else
    p.radiance = 1.0 / (4.0 * M_PI * M_PI * lamp.shape[0] * lamp.shape[0]);
  if (lamp.kind == LAMP_SPOT)
    p.radiance *= smoothstep(0.0, max((1.0 - lamp.shape[1]) * lamp.shape[2], 1e-6), -dot(p.way, lamp.axis) - lamp.shape[1]);
}

/* Draws a point of a lamp by two numbers in [0, 1). */
LampPoint lamp_point(Lamp lamp, float r1, float r2)
{
  LampPoint p;
  if (lamp.kind == LAMP_AREA || lamp.kind == LAMP_ELLIPSE) {
    float a = r1 - 0.5, b = r2 - 0.5;
    if (lamp.kind == LAMP_ELLIPSE) {
      a = 0.5 * sqrt(r1) * cos(M_2PI * r2);
      b = 0.5 * sqrt(r1) * sin(M_2PI * r2);
    }
    p.way = lamp.centre + a * lamp.edge_x + b * lamp.edge_y;
    p.range = max(length(p.way), 1e-12);
    p.way /= p.range;
  }
  else {
    vector middle = normalize(lamp.centre);
    float sin2 = round_size(lamp);
    float rise = r1 * cone(sin2) / M_2PI; /* 1 - cos */
    float aside = sqrt(max(rise * (2.0 - rise), 0.0));
    vector t = perpendicular(middle);
    p.way = middle * (1.0 - rise) + aside * (t * cos(M_2PI * r2) + cross(middle, t) * sin(M_2PI * r2));
    p.range = (lamp.kind == LAMP_SUN) ? 1e30 : length(lamp.centre) - lamp.shape[0];
  }
  lamp_light(lamp, p);
  return p;
}

/* The lamp in a direction. */
LampPoint lamp_met(Lamp lamp, vector way)
{
  LampPoint p;
  p.way = way;
  p.range = 1e30;
  p.density = p.radiance = 0.0;
  if (lamp.kind == LAMP_AREA || lamp.kind == LAMP_ELLIPSE) {
    float cosine = dot(way, lamp.axis);
    if (abs(cosine) < 1e-6)
      return p;
    p.range = dot(lamp.centre, lamp.axis) / cosine;
    vector place = p.range * way - lamp.centre;
    float a = dot(place, lamp.edge_x) / max(dot(lamp.edge_x, lamp.edge_x), 1e-20);
    float b = dot(place, lamp.edge_y) / max(dot(lamp.edge_y, lamp.edge_y), 1e-20);
    int inside = (lamp.kind == LAMP_ELLIPSE) ? a * a + b * b < 0.25 : max(abs(a), abs(b)) < 0.5;
    if (p.range > 0.0 && inside)
      lamp_light(lamp, p);
    return p;
  }
  vector aside = cross(normalize(lamp.centre), way);
  if (dot(way, lamp.centre) > 0.0 && dot(aside, aside) < round_size(lamp)) {
    p.range = (lamp.kind == LAMP_SUN) ? 1e30 : length(lamp.centre) - lamp.shape[0];
    lamp_light(lamp, p);
  }
  return p;
}
