"""Lobes of JF's reflection and refraction, translated into our parameters.

* JF's refraction squares its roughness, averages it over the two media (air counts as 0) and scales it by n - 1,
  because it borrows a lobe of reflection. Where light goes out into air that is as wide as a refracting microsurface
  with alpha = roughness^2, so our roughness is the same number.
* JF's reflection does not square and is not scaled, but averaged as well: against air alpha = roughness / 2.
* ``cook_torrance`` is Beckmann's distribution in Arnold, not GGX. ``stretched_phong`` has the exponent whose lobe is as
  wide as Beckmann's of the same alpha, and the Ward lobes are made of Gaussian slopes as Beckmann's is; so all become
  ``BECKMANN``. The first two are round and take the roughness u alone.
* The roughness u of the Ward lobes lies across the tangent and v along it, but for reflection with user tangents, where
  JF has them the other way round.
* The numbers of direct refraction are carried over as they are typed. JF applies them to alpha, not to its root, and to
  the borrowed lobe, so highlights of lights may need another offset.
"""

from __future__ import annotations

from math import sqrt
from typing import Any

from ..model.parameters import BY_KEYWORD
from .jf_values import NodeValues, text_of

# Of each lobe the parameters: distribution, u, v; and the keywords: distribution, roughness, anisotropy.
_REFRACTION = ("btdf", "refraction_roughness_u", "refraction_roughness_v"), ("distribution", "roughness", "anisotropy")

_REFLECTION = (
    ("brdf", "specular_roughness_u", "specular_roughness_v"),
    ("reflection_distribution", "reflection_roughness", "reflection_anisotropy"),
)

_DIRECT = (
    ("dr_btdf", "dr_roughness_u", "dr_roughness_v"),
    ("direct_distribution", "direct_roughness", "direct_anisotropy"),
)

_LEAST_RATIO = 1e-4
"""Least ratio of a lobe's two alphas, as in osl/lobe.h: an anisotropy of 0.99."""


def lobe_keywords(source: NodeValues) -> dict[str, Any]:
    """Return the keywords of all lobes of a node, and of the tangent that they share."""
    values = source.values
    refraction = _lobe(source, _REFRACTION)
    reflection = _lobe(source, _REFLECTION)
    direct = _lobe(source, _DIRECT)
    keywords = {**refraction, **reflection, **direct}
    keywords["separate_reflection"] = list(refraction.values()) != list(reflection.values())
    keywords["separate_direct_lobe"] = not values["dr_use_refraction_btdf"]
    used = [_REFRACTION, _REFLECTION]
    if keywords["separate_direct_lobe"]:
        used.append(_DIRECT)
    keywords.update(_tangent(source, used, keywords))
    return keywords


def _lobe(source: NodeValues, lobe: tuple[tuple[str, str, str], tuple[str, str, str]]) -> dict[str, Any]:
    """Return the keywords of one lobe: how wide JF's lobes are and where u and v lie stands at the top of this module."""
    (distribution, *roughness), (distribution_keyword, roughness_keyword, anisotropy_keyword) = lobe
    word = source.values[distribution]
    u, v = (source.values[name] for name in roughness)
    if word == "stretched_phong":
        source.note(distribution, f"{word} -> Beckmann, as wide")
    if not word.startswith("ward"):
        if v != u and roughness[1] in source.given:
            source.note(roughness[1], f"{text_of(v)} is without effect: {word} is round, and takes {roughness[0]}")
        v = u
    widths = []
    for name, value in zip(roughness, (u, v)):
        limit = min(max(value, 0.0), 2.0 if lobe is _REFLECTION else 1.0)
        if limit != value:
            source.note(
                name, f"{text_of(value)} -> {text_of(limit)}, the limit of {BY_KEYWORD[roughness_keyword].name}"
            )
        widths.append(limit / 2.0 if lobe is _REFLECTION else limit * limit)
    narrowest = max(widths) * _LEAST_RATIO
    if min(widths) < narrowest:
        name = roughness[widths.index(min(widths))]
        source.note(
            name, f"{text_of(source.values[name])} is too small beside the other; the lobe is as long as can be"
        )
    along, across = widths if lobe is _REFLECTION and word == "ward_userTangent" else reversed(widths)
    rough, stretch = roughness_and_anisotropy(max(along, narrowest), max(across, narrowest))
    return {distribution_keyword: "BECKMANN", roughness_keyword: rough, anisotropy_keyword: stretch}


def roughness_and_anisotropy(alpha_x: float, alpha_y: float) -> tuple[float, float]:
    """Return the roughness and anisotropy of which osl/lobe.h makes these alphas, along and across the tangent.

    The smaller must be at least 1e-4 of the larger, or both 0.
    """
    if alpha_x == alpha_y:
        return sqrt(alpha_x), 0.0
    stretch = 1.0 - sqrt(min(alpha_x, alpha_y) / max(alpha_x, alpha_y))
    anisotropy = min(stretch, BY_KEYWORD["anisotropy"].maximum)
    return (alpha_x * alpha_y) ** 0.25, anisotropy if alpha_x < alpha_y else -anisotropy


def _tangent(source: NodeValues, lobes: list[tuple], keywords: dict[str, Any]) -> dict[str, Any]:
    """Return the keywords of the tangent that anisotropy refers to: one for all lobes here, one for each in JF.

    :param lobes: those in use, as parameters and keywords; keywords: those that have been made of them.
    """
    ward = {names[0]: made for names, made in lobes if source.values[names[0]].startswith("ward")}
    stretched = [name for name, made in ward.items() if keywords[made[2]] != 0.0]
    chosen = source.values[(stretched or [*ward, "btdf"])[0]]
    for name in stretched[1:]:
        if source.values[name] != chosen:
            source.note(name, f"{source.values[name]} -> {chosen}: all lobes share a tangent here")
    if chosen != "ward_userTangent":
        if "ward_tangent" in source.given:
            source.note(
                "ward_tangent", f"{text_of(source.values['ward_tangent'])} is without effect: no lobe refers to it"
            )
        return {"tangent_from": "REFRACTION" if chosen == "ward_rayTangent" else "TANGENT"}
    tangent = source.values["ward_tangent"]
    source.note(
        "ward_tangent", f"{text_of(tangent)} is kept; turn it if the scene's Y axis, up in Arnold, is Blender's Z"
    )
    return {"tangent_from": "TANGENT", "tangent": tangent}
