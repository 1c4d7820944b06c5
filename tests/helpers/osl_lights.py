"""Functions of the shader's headers about lights, and what geometry has them return."""

from __future__ import annotations

import numpy as np
from osl_measure import Draw, Function, dot, normalized

from nested_dielectric.model.contract import LightKind
from nested_dielectric.model.shader_source import OSL_FOLDER

FEW = "a few roundings of the formula"

FAR = 1e30
"""Distance of what is infinitely far."""

ROUND = (LightKind.POINT, LightKind.SUN, LightKind.SPOT)


def across(v: np.ndarray) -> np.ndarray:
    """Return unit vectors across others, by the axis that the shader takes."""
    x_is_near = np.abs(v[:, :1]) >= 0.9
    return normalized(np.cross(v, np.where(x_is_near, (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))))


def cap(sine: np.ndarray) -> np.ndarray:
    """Return the solid angle of a cone by the sine of its half angle: 2 pi (1 - cos), without cancellation."""
    return 4.0 * np.pi * np.sin(0.5 * np.arcsin(sine)) ** 2


def half_sine(kind, centre, size) -> np.ndarray:
    """Return the sine of the half angle that a round light fills, at most 1."""
    away = np.maximum(np.linalg.norm(centre, axis=1), 1e-12)
    return np.minimum(np.where(kind == LightKind.SUN, size, size / away), 1.0)


def shade(kind, direction, distance, axis, edge_x, edge_y, size, aperture, blend):
    """Return the pdf per solid angle (Pharr, Jakob and Humphreys 2023, section 12.4) and the radiance of a light of a strength
    of 1, as Cycles has it: 1 / (pi A) of areas, 1 / (4 pi^2 r^2) of balls, 1 / (pi sin^2) of suns. Cycles' spread (Blender's
    manual) is what slats leave, so normalized that the flux stays; a spot's edge is a smooth step.
    """
    area = np.linalg.norm(edge_x, axis=1) * np.linalg.norm(edge_y, axis=1)
    area *= np.where(kind == LightKind.ELLIPSE, np.pi / 4.0, 1.0)
    cosine = -dot(direction, axis)
    faces = (cosine > 1e-6) & (area > 0.0)
    slant = np.sqrt(np.maximum(1.0 - cosine**2, 0.0)) / cosine
    spread = np.maximum(aperture, 1e-3)
    slats = np.maximum(np.tan(spread) - slant, 0.0) / (np.tan(spread) - spread)
    flat = faces / (np.pi * area) * np.where(spread < 0.5 * np.pi - 1e-6, slats, 1.0)
    ball = 1.0 / (np.where(kind == LightKind.SUN, np.pi, 4.0 * np.pi**2) * size**2)
    t = np.clip((cosine - aperture) / np.maximum((1.0 - aperture) * blend, 1e-6), 0.0, 1.0)
    ball = np.where(kind == LightKind.SPOT, ball * t * t * (3.0 - 2.0 * t), ball)
    return np.where(np.isin(kind, ROUND), ball, flat), faces * distance**2 / (cosine * area)


def sampled(kind, centre, axis, edge_x, edge_y, size, aperture, blend, r1, r2):
    """Return the direction to a point of a light, its distance, its pdf and radiance: of areas even over the area, of balls
    even over the cone that they fill.
    """
    angle = 2.0 * np.pi * r2
    ellipse = kind == LightKind.ELLIPSE
    a = np.where(ellipse, 0.5 * np.sqrt(r1) * np.cos(angle), r1 - 0.5)
    b = np.where(ellipse, 0.5 * np.sqrt(r1) * np.sin(angle), r2 - 0.5)
    place = centre + a[:, None] * edge_x + b[:, None] * edge_y
    sine = half_sine(kind, centre, size)
    rise = r1 * 2.0 * np.sin(0.5 * np.arcsin(sine)) ** 2
    aside = np.sqrt(rise * (2.0 - rise))
    middle = normalized(centre)
    t = across(middle)
    turned = np.cos(angle)[:, None] * t + np.sin(angle)[:, None] * np.cross(middle, t)
    in_cone = (1.0 - rise)[:, None] * middle + aside[:, None] * turned
    is_round = np.isin(kind, ROUND)
    direction = np.where(is_round[:, None], in_cone, normalized(place))
    distance = np.where(is_round, nearest(kind, centre, size), np.linalg.norm(place, axis=1))
    radiance, pdf = shade(kind, direction, distance, axis, edge_x, edge_y, size, aperture, blend)
    return direction, distance, np.where(is_round, 1.0 / cap(sine), pdf), radiance


def nearest(kind, centre, size) -> np.ndarray:
    """Return the distance of a round light."""
    return np.where(kind == LightKind.SUN, FAR, np.linalg.norm(centre, axis=1) - size)


def intersected(kind, centre, axis, edge_x, edge_y, size, aperture, blend, direction):
    """Return the distance, pdf and radiance of the light in a direction, nothing where it is not there."""
    cosine = dot(direction, axis)
    distance = dot(centre, axis) / cosine
    place = distance[:, None] * direction - centre
    a = dot(place, edge_x) / dot(edge_x, edge_x)
    b = dot(place, edge_y) / dot(edge_y, edge_y)
    within = np.where(kind == LightKind.ELLIPSE, a**2 + b**2 < 0.25, np.maximum(np.abs(a), np.abs(b)) < 0.5)
    within &= (distance > 0.0) & (np.abs(cosine) >= 1e-6)
    sine = half_sine(kind, centre, size)
    off = np.linalg.norm(np.cross(normalized(centre), direction), axis=1)
    is_round = np.isin(kind, ROUND)
    met = np.where(is_round, (dot(direction, centre) > 0.0) & (off < sine), within)
    distance = np.where(is_round, nearest(kind, centre, size), distance)
    radiance, pdf = shade(kind, direction, distance, axis, edge_x, edge_y, size, aperture, blend)
    pdf = np.where(is_round, 1.0 / cap(sine), pdf)
    met &= radiance > 0.0
    return np.where(met, distance, 0.0), np.where(met, pdf, 0.0), np.where(met, radiance, 0.0)


def lights(d: Draw) -> dict[str, np.ndarray]:
    """Lights of all kinds, from a hair's breadth to a hall's width, near and far; none edge-on, where a rounding or two are all
    there is of it.
    """
    axis = d.direction()
    x = d.across(axis)
    kind = d.choice(*LightKind)
    away = np.where(kind == LightKind.SUN, 1.0, d.logarithmic(1e-2, 1e4))
    aperture = np.where(
        kind == LightKind.SPOT, d.linear(-1.0, 0.999), d.either(d.linear(0.06, 1.5), d.choice(np.pi / 2))
    )
    large = np.where(kind == LightKind.SUN, d.logarithmic(1e-4, 1.0), away * d.logarithmic(1e-4, 2.0))
    return {
        "kind": kind,
        "centre": away[:, None]
        * d.around(axis, d.either(-d.linear(0.02, 1.0), -d.linear(0.02, 1.0), d.linear(0.02, 1.0))),
        "axis": axis,
        "edge_x": (away * d.logarithmic(1e-3, 10.0))[:, None] * x,
        "edge_y": (away * d.logarithmic(1e-3, 10.0))[:, None] * np.cross(axis, x),
        "size": np.maximum(large, 1e-4),
        "aperture": aperture,
        "blend": d.linear(0.0, 1.0),
    }


def towards(d: Draw) -> dict[str, np.ndarray]:
    """Lights, and directions of which most meet them."""
    light = lights(d)
    drawn = sampled(**light, r1=d.linear(0.0, 1.0), r2=d.linear(0.0, 1.0))[0]
    return light | {"direction": d.either(np.nan_to_num(drawn), np.nan_to_num(drawn), d.direction())}


LIGHT = "Light light = {(int)kind, centre, axis, edge_x, edge_y, size, aperture, blend};\n"

SAMPLE = """
r[0] = s.direction[0]; r[1] = s.direction[1]; r[2] = s.direction[2];
r[3] = s.distance; r[4] = s.pdf; r[5] = s.radiance;
"""


def turned(w, angles):
    """Return vectors turned about X, then Y, then Z, as products of matrices (Diebel 2006)."""
    (ca, cb, cc), (sa, sb, sc) = np.cos(angles).T, np.sin(angles).T
    nil, one = np.zeros(len(w)), np.ones(len(w))
    about_x = np.array([[one, nil, nil], [nil, ca, -sa], [nil, sa, ca]])
    about_y = np.array([[cb, nil, sb], [nil, one, nil], [-sb, nil, cb]])
    about_z = np.array([[cc, -sc, nil], [sc, cc, nil], [nil, nil, one]])
    return [np.einsum("ijn,jkn,kln,nl->ni", about_z, about_y, about_x, w)]


def light_script() -> str:
    """Return the functions of the shader that keeps one light, without the shader."""
    text = (OSL_FOLDER / "light.osl").read_text(encoding="utf-8")
    return text[text.index("vector rotate_euler_xyz") : text.index("/* Draws one light")]


FUNCTIONS = (
    Function(
        "perpendicular",
        "light.h",
        lambda d: {"w": d.direction()},
        "vector t = perpendicular(w); r[0] = t[0]; r[1] = t[1]; r[2] = t[2];",
        lambda w: [across(w)],
        4.0,
        FEW,
    ),
    Function(
        "cone_solid_angle",
        "light.h",
        lambda d: {"sine": d.logarithmic(1e-10, 1.0)},
        "r[0] = cone_solid_angle(sine * sine);",
        lambda sine: [cap(sine)],
        4.0,
        FEW,
    ),
    Function(
        "sin2_theta_max",
        "light.h",
        lights,
        LIGHT + "r[0] = sin2_theta_max(light); r[1] = round_distance(light); r[2] = is_flat(light);",
        lambda kind, centre, size, **_: [
            half_sine(kind, centre, size) ** 2,
            nearest(kind, centre, size),
            ~np.isin(kind, ROUND) * 1.0,
        ],
        4.0,
        FEW,
        codes=("kind",),
        covers=("round_distance", "is_flat"),
    ),
    Function(
        "light_sample",
        "light.h",
        lambda d: lights(d) | {"r1": d.linear(0.0, 1.0 - 2.0**-24), "r2": d.linear(0.0, 1.0 - 2.0**-24)},
        LIGHT + "LightSample s = light_sample(light, r1, r2);" + SAMPLE,
        sampled,
        8.0,
        FEW,
        codes=("kind",),
        covers=("light_eval",),
    ),
    Function(
        "light_intersect",
        "light.h",
        towards,
        LIGHT + "LightSample s = light_intersect(light, direction);"
        "r[0] = (s.radiance > 0.0) ? s.distance : 0.0; r[1] = (s.radiance > 0.0) ? s.pdf : 0.0; r[2] = s.radiance;",
        intersected,
        8.0,
        FEW,
        codes=("kind",),
    ),
    Function(
        "rotate_euler_xyz",
        "light.osl",
        lambda d: {"w": d.direction(), "angles": d.vector(*[d.linear(-np.pi, np.pi) for _ in range(3)])},
        "vector t = rotate_euler_xyz(w, angles); r[0] = t[0]; r[1] = t[1]; r[2] = t[2];",
        turned,
        8.0,
        FEW,
        more=("bounds.h", light_script()),
    ),
    Function(
        "lattice_point",
        "direct_light.h",
        lambda d: {"k": d.choice(*range(8)), "r1": d.linear(0.0, 1.0), "r2": d.linear(0.0, 1.0)},
        "vector p = lattice_point((int)k, 8, r1, r2);"
        "r[0] = cos(M_2PI * p[0]); r[1] = sin(M_2PI * p[0]); r[2] = cos(M_2PI * p[1]); r[3] = sin(M_2PI * p[1]);"
        "r[4] = min(p[0], p[1]) >= 0.0 && max(p[0], p[1]) <= 1.0;",
        lambda k, r1, r2: [
            np.stack([np.cos(2 * np.pi * (r1 + k / 8)), np.sin(2 * np.pi * (r1 + k / 8))], axis=1),
            np.stack([np.cos(2 * np.pi * (r2 + k * 0.618034)), np.sin(2 * np.pi * (r2 + k * 0.618034))], axis=1),
            np.ones(len(k)),
        ],
        64.0,
        "numbers up to 6, of which only the part behind the point is left",
        codes=("k",),
    ),
)
