"""Translating nodes of JF Nested Dielectric into our parameters.

Everything a node holds is either carried over or named in a note. What it does not name has the default of JF 1.0.5, which is
often not ours.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import pi
from typing import Any

from ..model.parameter import ParameterError
from ..model.parameters import check_keywords
from .jf_lobes import lobe_keywords
from .jf_parameters import JF_PARAMETERS, JfError
from .jf_reader import JfNode
from .jf_values import NodeValues, text_of, within_limits


@dataclass(frozen=True)
class Translation:
    """A node in our parameters.

    :param keywords: for :func:`nested_dielectric.scene.new_materials.new_material`.
    :param emission: linear RGB by the names of Shader sockets.
    :param notes: pairs of a parameter of the node and what happened to it.
    """

    name: str
    keywords: dict[str, Any]
    emission: dict[str, tuple[float, float, float]]
    notes: tuple[tuple[str, str], ...]


_CARRIED = {
    "mediumPriority": "priority",
    "mediumIOR": "ior",
    "mediumTransmittance": "transmittance",
    "mediumTransmittance_scale": "transmittance_depth",
    "polarize": "polarize",
    "dr_roughnessOffset": "direct_roughness_offset",
    "dr_roughnessDepthMultiplier": "direct_roughness_depth_multiplier",
    "dr_roughnessDepthAdder": "direct_roughness_depth_adder",
    "dr_second_scale": "direct_second_scale",
    "dr_second_roughnessMultiplier": "direct_second_roughness_multiplier",
    "disperse": "disperse",
    "dispersion": "dispersion",
    "spectral_clamp_negative_colors": "clamp_negative",
    "spectral_saturation": "spectral_saturation",
    "blur_anisotropic_poles": "blur_anisotropic_poles",
    "enable_internal_reflections": "internal_reflections",
    "russian_roulette_probability": "reflection_probability",
    "energy_cutoff_exponent": "energy_cutoff_exponent",
    "refract_skydomes": "direct_world",
    "refract_skies": "refract_sky",
    "caustic_refractions_direct": "caustic_direct_refraction",
    "caustic_dr_roughness_offset": "caustic_roughness_offset",
    "caustic_refractions_indirect": "caustic_refraction",
    "caustic_TIR": "caustic_total_reflection",
    "caustic_internal_speculars": "caustic_internal_reflections",
    "caustic_dispersion": "caustic_dispersion",
    "caustic_specular_direct": "caustic_direct_reflection",
    "caustic_specular_indirect": "caustic_reflection",
    "caustic_max_distance": "caustic_max_distance",
}
"""Keywords that hold the very value of a parameter, by the parameter."""

_WORDS = {
    "spectral_distribution": ("FULL", "DAYLIGHT", "BLUE_SKY", "SUNSET", "LED", "FLUORESCENT", "SODIUM"),
    "spectral_gamut": ("REC709", "ADOBE_RGB", "WIDE_GAMUT", "PROPHOTO", "ACES_AP0"),
    "shadow_mode": ("BLACK", "TRANSMISSION", "OUTSIDE_FRESNEL", "ALL_FRESNEL"),
}
"""Our words for those of enumerations that have the same name as the keyword."""

_EMISSION = {
    "emission_at_interfaces": "Emission at Interfaces",
    "emission_at_exits": "Emission at Exits",
    "emission_at_entrances": "Emission at Entrances",
}
"""Shader sockets that emit, by the parameter."""

_CAUSTIC_SWITCHES = tuple(
    name for name, (kind, _) in JF_PARAMETERS.items() if name.startswith("caustic_") and kind == "BOOL"
)

_SHORTEST = 1e-6
"""Transmittance Depth of a medium that lets nothing through."""


def translate(node: JfNode) -> Translation:
    """Translate a node into our parameters.

    :raises JfError: for a value that is none of its parameter's kind. The text names node, parameter and remedy.
    """
    source = NodeValues(node)
    _adjust(source)
    values = source.values
    keywords = {
        **{keyword: within_limits(source, name, values[name], keyword) for name, keyword in _CARRIED.items()},
        **{name: words[JF_PARAMETERS[name][0].index(values[name])] for name, words in _WORDS.items()},
        "polarization_angle": within_limits(
            source, "polarization_angle", values["polarization_angle"] * pi, "polarization_angle"
        ),
        "dispersion_model": "JF",
        "reflect_sky": values["reflect_skies"] or values["reflect_skydomes"],
        **_scales(source, "refraction_scale", "indirect_refraction", "direct_refraction", "direct_refraction"),
        **_scales(source, "specular_scale", "indirect_specular", "direct_specular", "direct_reflection"),
        **lobe_keywords(source),
    }
    lights = {socket: _light(source, name) for name, socket in _EMISSION.items()}
    emission = {socket: colour for socket, colour in lights.items() if any(colour)}
    try:
        check_keywords(keywords)
    except ParameterError as error:  # the tables above keep to the limits
        raise JfError(f"{node.name}: {error}") from None
    return Translation(node.name, keywords, emission, tuple(source.notes))


def _adjust(source: NodeValues) -> None:
    """Note what has no counterpart, and change values whose meaning depends on others."""
    values = source.values
    for name in values:
        if name.startswith("aov") and name in source.given:
            source.note(name, "use Blender's passes: Transmission and Glossy, each direct and indirect")
    if values["specular_ray_type"] == "Reflected":
        source.note("specular_ray_type", "Max Interior Reflections limits reflections inside media, apart from others")
    if values["reflect_skies"] != values["reflect_skydomes"]:
        on, off = sorted(("reflect_skies", "reflect_skydomes"), key=values.get, reverse=True)
        source.note(off, f"off, but {on} is on: Blender's world is both, and is reflected")
    mode = values["caustic_mode"]
    if mode == 1:
        source.note("caustic_mode", "photons; here the switches for caustics hold for the paths that Cycles traces")
    elif mode != 0:
        source.note("caustic_mode", f"{mode} is no caustics at all; all switches for caustics are off")
        values.update(dict.fromkeys(_CAUSTIC_SWITCHES, False))
    if values["mediumTransmittance_scale"] == 0.0:
        source.note("mediumTransmittance_scale", f"0 -> {_SHORTEST:g}: black in JF, no absorption here")
        values["mediumTransmittance_scale"] = _SHORTEST
    if values["caustic_max_distance"] == 0.0:
        source.note("caustic_max_distance", "0 -> -1, no fall-off, which 0 means in JF")
        values["caustic_max_distance"] = -1.0


def _scales(source: NodeValues, scale: str, indirect: str, direct: str, direct_keyword: str) -> dict[str, float]:
    """Return the scales of what rays see, and of lights in proportion to it."""
    values = source.values
    common = values[scale] * values[indirect]
    ratio = 1.0
    if values[indirect] != 0.0:
        ratio = values[direct] / values[indirect]
    elif values[direct] != 0.0 and values[scale] != 0.0:
        source.note(direct, f"{text_of(values[direct])} is lost: lights are scaled with rays here, and {indirect} is 0")
    fitted = min(max(ratio, 0.0), 1.0)
    if fitted != ratio:
        source.note(direct, f"{text_of(ratio)} of {indirect} -> {text_of(fitted)}: lights are scaled with rays here")
    return {scale: within_limits(source, scale, common, scale), direct_keyword: fitted}


def _light(source: NodeValues, parameter: str) -> tuple[float, float, float]:
    """Return the linear RGB of an emission, which cannot be negative."""
    colour = source.values[parameter]
    fitted = tuple(max(component, 0.0) for component in colour)
    if fitted != colour:
        source.note(parameter, f"{text_of(colour)} -> {text_of(fitted)}: light cannot be negative")
    return fitted


def report(translations: Iterable[Translation]) -> Iterator[str]:
    """Yield every note as a line, ``NODE: parameter: what happened``."""
    for translation in translations:
        for parameter, text in translation.notes:
            yield f"{translation.name}: {parameter}: {text}"
