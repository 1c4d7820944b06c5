"""Functions of the shader's headers about rough surfaces and polarised light, and what theory has them return."""

from __future__ import annotations

import math

import numpy as np
from osl_interfaces import amplitudes, reflectance, refracted, usual
from osl_lights import across
from osl_measure import Draw, Function, dot, normalized

from nested_dielectric.model.contract import Distribution, TangentSource

FEW = "a few roundings of the formula"

BECKMANN = Distribution.BECKMANN

MOST_STRETCH = 0.99


def alphas(roughness, anisotropy):
    """Return alpha along and across: their product is roughness^4 as far as neither is above 1."""
    stretch = 1.0 - np.minimum(np.abs(anisotropy), MOST_STRETCH)
    narrow, wide = roughness**2 * stretch, np.minimum(roughness**2 / stretch, 1.0)
    turned = anisotropy < 0.0
    return np.where(turned, wide, narrow), np.where(turned, narrow, wide)


def blurred(roughness, anisotropy, axis, blur, N):
    """Return both alphas where the lobe gets round towards the poles of its tangents."""
    x, y = alphas(np.minimum(roughness, 1.0), anisotropy)
    round_ = np.where(
        (anisotropy != 0.0) & (blur > 0.0), np.abs(dot(axis, N)) ** (1.0 / np.maximum(blur, 1e-30) - 1.0), 0.0
    )
    return [each + round_ * (np.sqrt(x * y) - each) for each in (x, y)]


def density(distribution, alpha_x, alpha_y, h):
    """Return D of microfacets' normals (Walter et al. 2007, equations 25 and 33; stretched as in Heitz 2014, section 5.3)."""
    tan_x, tan_y = h[:, 0] / h[:, 2], h[:, 1] / h[:, 2]
    slope2 = (tan_x / alpha_x) ** 2 + (tan_y / alpha_y) ** 2
    shape = np.where(distribution == BECKMANN, np.exp(-slope2), (1.0 + slope2) ** -2.0)
    return np.where(h[:, 2] ** 2 < 1e-12, 0.0, shape / (np.pi * alpha_x * alpha_y * h[:, 2] ** 4))


def shadowing(distribution, a2):
    """Return Lambda of alpha^2 tan^2: GGX's (Heitz 2014, equation 72), Beckmann's as Walter et al. (2007) fit it."""
    a = 1.0 / np.sqrt(a2)
    fit = np.where(a < 1.6, (1.0 - 1.259 * a + 0.396 * a**2) / (3.535 * a + 2.181 * a**2), 0.0)
    return np.where(distribution == BECKMANN, fit, a2 / (2.0 * (np.sqrt(1.0 + a2) + 1.0)))


def exact_shadowing(distribution, a2):
    """Return Lambda of Beckmann's slopes without a fit (Heitz 2014, equation 68)."""
    a = 1.0 / np.sqrt(a2)
    erf = np.array([math.erf(each) for each in a])
    return 0.5 * (erf - 1.0) + np.exp(-(a**2)) / (2.0 * a * np.sqrt(np.pi))


def seen(distribution, alpha_x, alpha_y, w):
    """Return Smith's G1 of a direction in the lobe's frame."""
    a2 = ((alpha_x * w[:, 0]) ** 2 + (alpha_y * w[:, 1]) ** 2) / w[:, 2] ** 2
    return np.where(np.abs(w[:, 2]) > 1e-4, 1.0 / (1.0 + shadowing(distribution, a2)), 0.0)


def scattered(distribution, alpha_x, alpha_y, refracts, eta, x, y, z, I, direction):  # noqa: E741
    """Return f cos and the pdf of a direction (Walter et al. 2007, equations 13 to 17, 20, 21), the normal of microfacets
    from Snell's law in the frame x, y, z; both media's n^2 left out. ``eta``: index of the light's side over the viewer's.
    """
    out = np.stack([dot(I, each) for each in (x, y, z)], axis=1)
    light = np.stack([dot(direction, each) for each in (x, y, z)], axis=1)
    through = refracts > 0.0
    half = np.where(through[:, None], -(out + eta[:, None] * light), out + light)
    half = normalized(half)
    half = np.where(half[:, 2:] < 0.0, -half, half)
    to_viewer, to_light = dot(half, out), dot(half, light)
    per_reflected = 1.0 / (4.0 * np.abs(to_viewer))
    per_refracted = eta**2 * np.abs(to_light) / (to_viewer + eta * to_light) ** 2
    jacobian = np.where(through, per_refracted, per_reflected)
    pdf = density(distribution, alpha_x, alpha_y, half) * half[:, 2] * jacobian
    f = reflectance(np.minimum(to_viewer, 1.0), eta)
    a2 = [((alpha_x * w[:, 0]) ** 2 + (alpha_y * w[:, 1]) ** 2) / w[:, 2] ** 2 for w in (out, light)]
    g = 1.0 / (1.0 + shadowing(distribution, a2[0]) + shadowing(distribution, a2[1]))
    value = np.where(through, 1.0 - f, f) * g * pdf * to_viewer / (out[:, 2] * half[:, 2])
    there = (out[:, 2] > 1e-6) & (to_viewer > 0.0)
    there &= np.where(through, (light[:, 2] < -1e-6) & (to_light < 0.0), light[:, 2] > 1e-6)
    return np.where(there, value, 0.0), np.where(there, pdf, 0.0)


def drawn(distribution, alpha_x, alpha_y, refracts, eta, x, y, z, I, r1, r2):  # noqa: E741
    """Return the direction that two numbers draw: by a normal, distributed as D (Walter et al. 2007, equations 28 and 35)."""
    tangent = np.where(distribution == BECKMANN, np.sqrt(-np.log1p(-r1)), np.sqrt(r1 / (1.0 - r1)))
    angle = 2.0 * np.pi * r2
    # The slopes of a surface are those of its normals, negated.
    slopes = -tangent * alpha_x * np.cos(angle), -tangent * alpha_y * np.sin(angle)
    h = normalized(slopes[0][:, None] * x + slopes[1][:, None] * y + z)
    mirrored = 2.0 * dot(I, h)[:, None] * h - I
    out = np.where(refracts[:, None] > 0.0, refracted(-I, h, eta), mirrored)
    return [np.where(dot(I, h)[:, None] > 0.0, out, 0.0)]


def lobes(d: Draw) -> dict[str, np.ndarray]:
    """Rough surfaces of all kinds, and viewers above them; where indices are within a hundredth of one another, roundings of
    directions turn the normal between them by more than narrow lobes are wide.
    """
    z = d.direction()
    x = d.across(z)
    return {
        "distribution": d.choice(*Distribution),
        "alpha_x": d.logarithmic(1e-3, 1.0),
        "alpha_y": d.logarithmic(1e-3, 1.0),
        "refracts": d.choice(0.0, 1.0),
        "eta": usual(d),
        "x": x,
        "y": np.cross(z, x),
        "z": z,
        "I": d.around(z, d.linear(0.02, 1.0)),
    }


def lit(d: Draw) -> dict[str, np.ndarray]:
    """Rough surfaces with lights where their lobes are, and anywhere."""
    lobe = lobes(d)
    direction = drawn(**lobe, r1=d.linear(0.0, 0.9999), r2=d.linear(0.0, 1.0))[0]
    anywhere = d.direction()
    missing = np.linalg.norm(direction, axis=1) == 0.0
    direction[missing] = anywhere[missing]
    return lobe | {"direction": d.either(direction, direction, direction, anywhere)}


BSDF = """
MicrofacetBsdf s;
s.lobe.distribution = (int)distribution; s.lobe.alpha_x = alpha_x; s.lobe.alpha_y = alpha_y;
s.refracts = (int)refracts; s.x = x; s.y = y; s.z = z; s.eta = eta;
"""


def frame(n, along, alpha_x, alpha_y):
    """Return a lobe's frame by Gram and Schmidt, and its alphas, none below a thousandth."""
    x = along - dot(along, n)[:, None] * n
    square = dot(x, x)
    x = np.where(square[:, None] < 1e-12, across(n), x / np.sqrt(np.maximum(square, 1e-30))[:, None])
    return x, np.cross(n, x), np.maximum(alpha_x, 1e-3), np.maximum(alpha_y, 1e-3)


def framed(I, N, P, eta, tangent, source):  # noqa: E741
    """Return the axis of a surface's tangents and the tangent: the artist's, around the object's Z, along refracted light."""
    given = np.linalg.norm(tangent, axis=1) > 0.0
    by_artist = np.where(
        given[:, None], tangent / np.maximum(np.linalg.norm(tangent, axis=1), 1e-30)[:, None], (0, 0, 1.0)
    )
    out = refracted(-I, N, eta)
    by_light = np.where(dot(out, out)[:, None] > 0.0, out, -I)
    from_light = (source == TangentSource.REFRACTION)[:, None]
    axis = np.where(from_light, by_light, by_artist)
    along = np.where(from_light | given[:, None], axis, np.cross(axis, P))
    along = along - dot(along, N)[:, None] * N
    return axis, normalized(along)


def tangents(d: Draw) -> dict[str, np.ndarray]:
    """Surfaces whose normals are off all axes that tangents are made from."""
    n = d.direction()
    return {
        "I": d.around(n, d.linear(0.1, 0.9)),
        "N": n,
        "P": d.logarithmic(1e-2, 1e2)[:, None] * d.around(n, d.linear(-0.9, 0.9)),
        "eta": usual(d),
        "tangent": d.either(
            np.zeros((d.count, 3)), d.logarithmic(1e-3, 1e3)[:, None] * d.around(n, d.linear(-0.9, 0.9))
        ),
        "source": d.choice(*TangentSource),
    }


def filtered(I, n, axis, cos_i, eta):  # noqa: E741
    """Return what a filter makes of reflectance and transmittance: by Malus (1809) of the parts in and across the plane."""
    across_plane, within_plane = (part**2 for part in amplitudes(cos_i, eta))
    whole = 0.5 * (across_plane + within_plane)
    seen_axis, seen_normal = (w - dot(w, I)[:, None] * I for w in (axis, n))
    square = (dot(seen_axis, seen_normal) ** 2) / (dot(seen_axis, seen_axis) * dot(seen_normal, seen_normal))
    part = square * within_plane + (1.0 - square) * across_plane
    return part / np.maximum(whole, 1e-12), (1.0 - part) / np.maximum(1.0 - whole, 1e-12)


def filters(d: Draw) -> dict[str, np.ndarray]:
    """Surfaces and filters that are seen along neither."""
    view = d.direction()
    return {
        "I": view,
        "n": d.around(view, d.linear(0.05, 0.95)),
        "axis": d.around(view, d.linear(-0.9, 0.9)),
        "cos_i": d.linear(0.05, 1.0),
        "eta": d.either(d.linear(0.3, 0.95), d.linear(1.05, 3.0)),
    }


CONTROLS = """
LobeControls common = {(int)kind, roughness, anisotropy};
LobeControls got = direct_controls((int)separate, common, (int)other_kind, other_roughness, other_anisotropy);
if (reflects > 0.0)
  got = reflection_controls((int)separate, common, (int)other_kind, other_roughness, other_anisotropy);
r[0] = got.distribution; r[1] = got.roughness; r[2] = got.anisotropy;
"""


def controls(kind, roughness, anisotropy, other_kind, other_roughness, other_anisotropy, separate, reflects):
    """Return a lobe's controls: another's unless it is separate, within limits."""
    rough = np.where(np.isfinite(other_roughness), np.clip(other_roughness, 0.0, 1.0), 0.0)
    stretch = np.where(np.isfinite(other_anisotropy), np.clip(other_anisotropy, -MOST_STRETCH, MOST_STRETCH), 0.0)
    own = separate > 0.0
    return np.where(own, other_kind, kind), np.where(own, rough, roughness), np.where(own, stretch, anisotropy)


FUNCTIONS = (
    Function(
        "anisotropic_alpha",
        "lobe.h",
        lambda d: {
            "roughness": d.either(d.linear(0.0, 1.0), d.logarithmic(1e-6, 1.0)),
            "anisotropy": d.linear(-0.99, 0.99),
        },
        "anisotropic_alpha(roughness, anisotropy, r[0], r[1]);",
        lambda roughness, anisotropy: alphas(roughness, anisotropy),
        4.0,
        FEW,
    ),
    Function(
        "make_lobe",
        "lobe.h",
        lambda d: {
            "roughness": d.linear(0.0, 1.5),
            "anisotropy": d.either(d.linear(-0.99, 0.99), d.choice(0.0)),
            "axis": d.direction(),
            "blur": d.linear(0.0, 1.0),
            "N": d.direction(),
        },
        "LobeControls controls = {0, roughness, anisotropy}; ShadingFrame frame = {N, axis, vector(0.0), blur};"
        "Lobe a = make_lobe(controls, frame); Lobe z = make_separate_lobe(1, a, controls, frame);"
        "Lobe same = make_separate_lobe(0, a, controls, frame);"
        "r[0] = a.alpha_x; r[1] = a.alpha_y; r[2] = z.alpha_x == a.alpha_x && same.alpha_y == a.alpha_y;",
        lambda **inputs: [*blurred(**inputs), np.ones(len(inputs["blur"]))],
        64.0,
        "OSL's power is an approximation, and the narrower width a difference",
        terms=lambda **inputs: [*[sum(blurred(**inputs))] * 2, 1.0],
        covers=("make_separate_lobe",),
    ),
    Function(
        "reflection_controls",
        "lobe.h",
        lambda d: {
            "kind": d.choice(*Distribution),
            "roughness": d.linear(0.0, 1.0),
            "anisotropy": d.linear(-0.99, 0.99),
            "other_kind": d.choice(*Distribution),
            "other_roughness": d.either(d.linear(-1.0, 2.0), d.choice(np.nan, np.inf)),
            "other_anisotropy": d.either(d.linear(-2.0, 2.0), d.choice(np.nan, -np.inf)),
            "separate": d.choice(0.0, 1.0),
            "reflects": d.choice(0.0, 1.0),
        },
        CONTROLS,
        controls,
        1.0,
        "a choice",
        codes=("kind", "other_kind", "separate", "reflects", "other_roughness", "other_anisotropy"),
        covers=("direct_controls",),
    ),
    Function(
        "shading_frame",
        "lobe.h",
        tangents,
        "ShadingFrame f = shading_frame(N, eta, 1, tangent, (int)source, 0.5);"
        "r[0] = f.axis[0]; r[1] = f.axis[1]; r[2] = f.axis[2]; r[3] = f.along[0]; r[4] = f.along[1]; r[5] = f.along[2];",
        framed,
        16.0,
        FEW,
        codes=("source",),
        covers=("tangent_axis", "shading_tangent"),
    ),
    Function(
        "smith_lambda",
        "lobe.h",
        lambda d: {"distribution": d.choice(*Distribution), "a2": d.logarithmic(1e-8, 1e8)},
        "r[0] = smith_lambda((int)distribution, a2);",
        lambda distribution, a2: [shadowing(distribution, a2)],
        8.0,
        "it is added to 1, next to which it is right",
        codes=("distribution",),
        terms=lambda distribution, a2: [1.0 + shadowing(distribution, a2)],
    ),
    Function(
        "smith_lambda",
        "lobe.h",
        lambda d: {"distribution": d.choice(BECKMANN), "a2": d.logarithmic(1e-2, 1e8)},
        "r[0] = smith_lambda((int)distribution, a2);",
        lambda distribution, a2: [exact_shadowing(distribution, a2)],
        0.006 * 2.0**24,
        "the fit of Walter et al. (2007) is within 0.4 % of 1 + Lambda",
        codes=("distribution",),
        terms=lambda distribution, a2: [1.0 + exact_shadowing(distribution, a2)],
        domain="Beckmann's, against the exact one",
    ),
    Function(
        "smith_g1",
        "lobe.h",
        lambda d: (
            {name: values for name, values in lobes(d).items() if name not in ("refracts", "eta", "y", "I")}
            | {"w": d.direction()}
        ),
        "Lobe lobe; lobe.distribution = (int)distribution; lobe.alpha_x = alpha_x; lobe.alpha_y = alpha_y;"
        "r[0] = smith_g1(lobe, x, (normal)z, w);",
        lambda distribution, alpha_x, alpha_y, x, z, w: [
            seen(distribution, alpha_x, alpha_y, np.stack([dot(w, x), dot(w, np.cross(z, x)), dot(w, z)], axis=1))
        ],
        8.0,
        FEW,
        codes=("distribution",),
        covers=("alpha2_tan2_theta",),
    ),
    Function(
        "microfacet_ndf",
        "microfacet.h",
        lambda d: (
            {name: values for name, values in lobes(d).items() if name in ("distribution", "alpha_x", "alpha_y")}
            | {
                "h": d.either(
                    d.direction(), d.around(np.tile((0.0, 0.0, 1.0), (d.count, 1)), 1.0 - d.logarithmic(1e-8, 1.0))
                )
            }
        ),
        "Lobe lobe; lobe.distribution = (int)distribution; lobe.alpha_x = alpha_x; lobe.alpha_y = alpha_y;"
        "r[0] = microfacet_ndf(lobe, h);",
        lambda distribution, alpha_x, alpha_y, h: [density(distribution, alpha_x, alpha_y, h)],
        64.0,
        "OSL's exponential is an approximation, of slopes whose roundings it multiplies; below 1e-6 nothing shows",
        codes=("distribution",),
        terms=lambda **inputs: [1e-6 + density(**inputs)],
    ),
    Function(
        "make_bsdf",
        "microfacet.h",
        lambda d: {
            "n": d.direction(),
            "along": d.direction(),
            "alpha_x": d.linear(0.0, 1.0),
            "alpha_y": d.logarithmic(1e-5, 1.0),
        },
        "Lobe lobe = {0, alpha_x, alpha_y}; ShadingFrame frame = {n, vector(0.0), along, 0.0};"
        "MicrofacetBsdf s = make_bsdf(lobe, 1, frame, 1.5);"
        "r[0] = s.x[0]; r[1] = s.x[1]; r[2] = s.x[2]; r[3] = s.y[0]; r[4] = s.y[1]; r[5] = s.y[2];"
        "r[6] = s.lobe.alpha_x; r[7] = s.lobe.alpha_y;",
        frame,
        8.0,
        FEW,
    ),
    Function(
        "bsdf_eval",
        "microfacet.h",
        lit,
        BSDF + "r[0] = bsdf_eval(s, direction, r[1]);",
        scattered,
        64.0,
        "narrow lobes are steep, Fresnel's factor is ill-conditioned near a ratio of 1; below 1e-6 nothing shows",
        codes=("distribution", "refracts"),
        terms=lambda **inputs: [1e-6 + each for each in scattered(**inputs)],
    ),
    Function(
        "bsdf_sample",
        "microfacet.h",
        lambda d: lobes(d) | {"r1": d.linear(0.0, 1.0 - 2.0**-24), "r2": d.linear(0.0, 1.0)},
        BSDF + "vector out = bsdf_sample(s, r1, r2); r[0] = out[0]; r[1] = out[1]; r[2] = out[2];",
        drawn,
        64.0,
        FEW,
        codes=("distribution", "refracts"),
    ),
    Function(
        "polarizer_factors",
        "polarizer.h",
        filters,
        "vector f = polarizer_factors(axis, (normal)n, cos_i, eta); r[0] = f[0]; r[1] = f[1];",
        filtered,
        64.0,
        "near Brewster's angle little is left, and next to total reflection 1 - F",
        terms=lambda **inputs: [
            1.0 + filtered(**inputs)[0],
            1.0 / np.maximum(1.0 - reflectance(inputs["cos_i"], inputs["eta"]), 1e-3),
        ],
    ),
)
