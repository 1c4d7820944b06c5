/* Lobes of rough surfaces: how wide they are, along which direction, and how their microfacets mask each other. */
#pragma once

#include "fresnel.h"

/* A rough surface's lobe as the artist gives it. */
struct LobeControls {
  int distribution;
  float roughness; /* alpha is its square */
  float anisotropy;
};

/* Controls of the lobe of reflection, which has refraction's unless the artist separates it. */
LobeControls reflection_controls(int separate, LobeControls refraction_lobe, int distribution, float roughness,
                                 float anisotropy)
{
  LobeControls lobe = {separate ? distribution : refraction_lobe.distribution,
                       separate ? bounded(roughness, REFLECTION_ROUGHNESS_LIMITS) : refraction_lobe.roughness,
                       separate ? bounded(anisotropy, REFLECTION_ANISOTROPY_LIMITS) : refraction_lobe.anisotropy};
  return lobe;
}

/* Controls of the lobe of direct refraction, in the same way. */
LobeControls direct_controls(int separate, LobeControls refraction_lobe, int distribution, float roughness, float anisotropy)
{
  LobeControls lobe = {separate ? distribution : refraction_lobe.distribution,
                       separate ? bounded(roughness, DIRECT_ROUGHNESS_LIMITS) : refraction_lobe.roughness,
                       separate ? bounded(anisotropy, DIRECT_ANISOTROPY_LIMITS) : refraction_lobe.anisotropy};
  return lobe;
}

struct Lobe {
  int distribution;
  float alpha_x; /* along the tangent */
  float alpha_y; /* across it */
};

/* The direction that a surface's tangents are made from: where the normal points along it they have a pole. */
vector tangent_axis(vector tangent, int source, vector refracted)
{
  if (source == TANGENT_REFRACTION)
    return (dot(refracted, refracted) > 0.0) ? refracted : -I;
  return has_direction(tangent) ? normalize(tangent) : normalize(transform("object", "world", vector(0.0, 0.0, 1.0)));
}

/* The artist's tangent, the way of the refracted light along the surface, or a circle around the object's Z axis. */
vector shading_tangent(vector tangent, int source, vector axis)
{
  vector along = axis;
  if (source == TANGENT_TANGENT && !has_direction(tangent))
    along = cross(axis, P - transform("object", "world", point(0.0)));
  along -= N * dot(along, N);
  return (dot(along, along) > 1e-12) ? normalize(along) : normalize(dPdu);
}

/* How a surface's lobes lie; its tangents matter where one is anisotropic. */
struct ShadingFrame {
  normal n;
  vector axis;  /* that tangents are made from */
  vector along; /* tangent */
  float blur;   /* of the poles where n points along the axis */
};

ShadingFrame shading_frame(normal n, float eta, int is_anisotropic, vector tangent, int source, float blur)
{
  ShadingFrame f = {n, vector(0.0), vector(0.0), bounded(blur, BLUR_ANISOTROPIC_POLES_LIMITS)};
  if (is_anisotropic) {
    f.axis = tangent_axis(tangent, source, refracted_direction(n, eta));
    f.along = shading_tangent(tangent, source, f.axis);
  }
  return f;
}

/* Alpha along and across the tangent, from the artist's roughness and anisotropy in [-1, 1]. The product of both is that of
 * the isotropic lobe: alpha = roughness^2. */
void anisotropic_alpha(float roughness, float anisotropy, output float alpha_x, output float alpha_y)
{
  float alpha = roughness * roughness;
  float stretch = 1.0 - min(abs(anisotropy), MOST_STRETCH);
  alpha_x = (anisotropy < 0.0) ? min(alpha / stretch, 1.0) : alpha * stretch;
  alpha_y = (anisotropy < 0.0) ? alpha * stretch : min(alpha / stretch, 1.0);
}

/* The lobe gets round where the normal points along the tangents' axis. */
Lobe make_lobe(LobeControls controls, ShadingFrame frame)
{
  Lobe lobe;
  lobe.distribution = controls.distribution;
  anisotropic_alpha(min(controls.roughness, 1.0), controls.anisotropy, lobe.alpha_x, lobe.alpha_y);
  if (controls.anisotropy != 0.0 && frame.blur > 0.0) {
    float mean = sqrt(lobe.alpha_x * lobe.alpha_y);
    float pole = pow(abs(dot(frame.axis, N)), 1.0 / frame.blur - 1.0);
    lobe.alpha_x = mix(lobe.alpha_x, mean, pole);
    lobe.alpha_y = mix(lobe.alpha_y, mean, pole);
  }
  return lobe;
}

/* A lobe of its own where the artist separates it from another, or else that one. */
Lobe make_separate_lobe(int separate, Lobe common, LobeControls controls, ShadingFrame frame)
{
  Lobe lobe = common;
  if (separate)
    lobe = make_lobe(controls, frame);
  return lobe;
}

/* Smith's masking function Lambda (Heitz 2014, equations 68, 69, 72), where `a2` is alpha^2 tan^2 theta. */
float smith_lambda(int distribution, float a2)
{
  if (distribution != DISTRIBUTION_BECKMANN)
    return 0.5 * (sqrt(1.0 + a2) - 1.0);
  if (a2 < 0.39)
    return 0.0;
  float a = 1.0 / sqrt(a2);
  return (1.0 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a);
}

/* Squared product of a lobe's width and the tangent of a direction's angle. */
float alpha2_tan2_theta(Lobe lobe, vector w)
{
  return (lobe.alpha_x * lobe.alpha_x * w[0] * w[0] + lobe.alpha_y * lobe.alpha_y * w[1] * w[1]) / (w[2] * w[2]);
}

/* Smith's G1: part of a lobe's microfacets around a normal that a direction sees. */
float smith_g1(Lobe lobe, vector x, normal n, vector w)
{
  vector local = vector(dot(w, x), dot(w, cross(n, x)), dot(w, n));
  return (abs(local[2]) > 1e-4) ? 1.0 / (1.0 + smith_lambda(lobe.distribution, alpha2_tan2_theta(lobe, local))) : 0.0;
}
