/* Closed forms of light at an interface and in a medium. */
#pragma once

/* Reflectance of unpolarised light at a smooth interface (Fresnel 1823); 1 where it is reflected totally.
 * cos_i: cosine between the ray and the normal, in [0, 1]; eta: n2 / n1, from the ray's side to the other. */
float fresnel_dielectric(float cos_i, float eta)
{
  float g2 = eta * eta - 1.0 + cos_i * cos_i;
  if (g2 <= 0.0)
    return 1.0;
  float g = sqrt(g2);
  float a = (g - cos_i) / (g + cos_i);
  float b = (cos_i * (g + cos_i) - 1.0) / (cos_i * (g - cos_i) + 1.0);
  return 0.5 * a * a * (1.0 + b * b);
}

/* Reflectance of light that is polarised across (x) and in (y) the plane of incidence (Fresnel 1823). */
vector fresnel_polarised(float cos_i, float eta)
{
  float g2 = eta * eta - 1.0 + cos_i * cos_i;
  if (g2 <= 0.0)
    return vector(1.0, 1.0, 0.0);
  float g = sqrt(g2);
  float across = (cos_i - g) / (cos_i + g);
  float within = (eta * eta * cos_i - g) / (eta * eta * cos_i + g);
  return vector(across * across, within * within, 0.0);
}

/* What an ideal filter that lets light through along `filter` makes of a surface's reflectance (x) and transmittance
 * (y), as factors; light that comes to the surface is unpolarised, and the exposure makes up for the half that the
 * filter takes (Malus 1809). */
vector polarised(vector filter, normal n, float cos_i, float eta)
{
  vector crossed = filter - I * dot(filter, I);
  vector plane = n - I * dot(n, I);
  float within = dot(crossed, plane);
  within *= within / max(dot(crossed, crossed) * dot(plane, plane), 1e-20);
  vector reflectances = fresnel_polarised(cos_i, eta);
  float f = 0.5 * (reflectances[0] + reflectances[1]);
  float filtered = mix(reflectances[0], reflectances[1], min(within, 1.0));
  return vector(filtered / max(f, 1e-12), (1.0 - filtered) / max(1.0 - f, 1e-12), 0.0);
}

/* Reflectance at normal incidence. */
float fresnel_normal(float eta)
{
  float r = (eta - 1.0) / (eta + 1.0);
  return r * r;
}

/* What a medium leaves of light after a distance (Bouguer 1729, Lambert 1760, Beer 1852), where
 * transmittance is left after `depth`. Units of both lengths: scene units. */
color beer_lambert(color transmittance, float depth, float distance)
{
  return (depth > 0.0) ? pow(transmittance, max(distance, 0.0) / depth) : color(1.0);
}

/* What a volume absorbs of each colour per length, as addon/node_group.py has it. */
color volume_coefficients(color transmittance, float depth)
{
  return log(max(transmittance, color(1e-6))) / -depth;
}

/* Roughness along and across the tangent, from the artist's roughness and anisotropy in [-1, 1]. The product of both is
 * that of the isotropic lobe: alpha = roughness^2. */
void anisotropic_alpha(float roughness, float anisotropy, output float alpha_x, output float alpha_y)
{
  float alpha = roughness * roughness;
  float stretch = 1.0 - min(abs(anisotropy), 0.99);
  alpha_x = (anisotropy < 0.0) ? min(alpha / stretch, 1.0) : alpha * stretch;
  alpha_y = (anisotropy < 0.0) ? alpha * stretch : min(alpha / stretch, 1.0);
}
