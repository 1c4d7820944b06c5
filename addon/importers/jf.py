"""Materials of JF Nested Dielectric, the shader for Arnold: reading its nodes and saying them in our parameters.

Nodes come from Arnold's scene files (.ass) or from JSON. Everything a node holds is either carried over or named in a
note. What it does not name has the default of JF 1.0.5, which is often not ours.

The lobes, in ours:

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
  the borrowed lobe, so highlights of lamps may need another offset.

Reference: JF Nested Dielectric 1.0.5 (2015), its manual and its published interface.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import isfinite, pi, sqrt
from pathlib import Path
from typing import Any

from ..model.parameters import BY_KEYWORD, ParameterError, check_keywords

NODE_TYPE = "jf_nested_dielectric"
"""Arnold's name of the shader; case and underscores do not matter."""


class JfError(ValueError):
    """A file or a value that cannot be read. The text names it and the remedy."""


@dataclass(frozen=True)
class JfNode:
    """A node as its file has it.

    ``parameters`` holds numbers, booleans, strings (words and names of linked nodes) and tuples of these; ``repeated``
    names those that stand there more than once, of which the last counts.
    """

    name: str
    parameters: dict[str, Any]
    repeated: tuple[str, ...] = ()


@dataclass(frozen=True)
class Translation:
    """A node in our words.

    ``keywords`` are for :func:`nested_dielectric.materials.new_material`, ``emission`` has linear RGB by the names of
    Shader sockets, and ``notes`` are pairs of a parameter of the node and what happened to it.
    """

    name: str
    keywords: dict[str, Any]
    emission: dict[str, tuple[float, float, float]]
    notes: tuple[tuple[str, str], ...]


# Words of JF's enumerations, in the order of their numbers.
_LOBES = ("stretched_phong", "cook_torrance", "ward_rayTangent", "ward_userTangent")
_SPECTRA = ("full", "daylight", "bluesky", "sunset", "LED", "flourescent", "sodium")  # spelt as in JF
_GAMUTS = ("sRGB", "AdobeRGB", "WideGamut", "ProPhotoRGB", "ACES")
_SHADOWS = ("black", "transmit_only", "transmit_and_outer_fresnels", "transmit_and_all_fresnels")
_RAY_TYPES = ("Glossy", "Reflected")

_ALIASES = {
    "fluorescent": "flourescent",
    "anisotropicraytangent": "ward_rayTangent",  # these two: builds after 1.0.5
    "anisotropicusertangent": "ward_userTangent",
}

_TRIPLES = ("RGB", "VECTOR")

JF_PARAMETERS: dict[str, tuple[str | tuple[str, ...], Any]] = {
    "mediumPriority": ("INT", 0),
    "mediumIOR": ("FLOAT", 1.33),
    "mediumTransmittance": ("RGB", (1.0, 1.0, 1.0)),
    "mediumTransmittance_scale": ("FLOAT", 1.0),
    "polarize": ("BOOL", False),
    "polarization_angle": ("FLOAT", 0.0),
    "refraction_scale": ("FLOAT", 1.0),
    "btdf": (_LOBES, "cook_torrance"),
    "refraction_roughness_u": ("FLOAT", 0.0),
    "refraction_roughness_v": ("FLOAT", 0.0),
    "indirect_refraction": ("FLOAT", 1.0),
    "direct_refraction": ("FLOAT", 1.0),
    "dr_roughnessOffset": ("FLOAT", 0.05),
    "dr_roughnessDepthMultiplier": ("FLOAT", 1.0),
    "dr_roughnessDepthAdder": ("FLOAT", 0.0),
    "dr_use_refraction_btdf": ("BOOL", True),
    "dr_btdf": (_LOBES, "cook_torrance"),
    "dr_roughness_u": ("FLOAT", 0.0),
    "dr_roughness_v": ("FLOAT", 0.0),
    "dr_second_scale": ("FLOAT", 0.0),
    "dr_second_roughnessMultiplier": ("FLOAT", 2.0),
    "disperse": ("BOOL", False),
    "dispersion": ("FLOAT", 0.03),
    "spectral_distribution": (_SPECTRA, "daylight"),
    "spectral_gamut": (_GAMUTS, "sRGB"),
    "spectral_clamp_negative_colors": ("BOOL", True),
    "spectral_saturation": ("FLOAT", 1.0),
    "specular_scale": ("FLOAT", 1.0),
    "brdf": (_LOBES, "cook_torrance"),
    "direct_specular": ("FLOAT", 1.0),
    "indirect_specular": ("FLOAT", 1.0),
    "specular_roughness_u": ("FLOAT", 0.0),
    "specular_roughness_v": ("FLOAT", 0.0),
    "specular_ray_type": (_RAY_TYPES, "Glossy"),
    "blur_anisotropic_poles": ("FLOAT", 0.0),
    "enable_internal_reflections": ("BOOL", True),
    "russian_roulette_probability": ("FLOAT", 0.5),
    "energy_cutoff_exponent": ("INT", -5),
    "ward_tangent": ("VECTOR", (0.0, 1.0, 0.0)),
    "refract_skydomes": ("BOOL", False),
    "refract_skies": ("BOOL", True),
    "reflect_skydomes": ("BOOL", True),
    "reflect_skies": ("BOOL", True),
    "emission_at_interfaces": ("RGB", (0.0, 0.0, 0.0)),
    "emission_at_exits": ("RGB", (0.0, 0.0, 0.0)),
    "emission_at_entrances": ("RGB", (0.0, 0.0, 0.0)),
    "shadow_mode": (_SHADOWS, "transmit_and_outer_fresnels"),
    "caustic_mode": ("INT", 0),
    "caustic_refractions_direct": ("BOOL", True),
    "caustic_dr_roughness_offset": ("FLOAT", 0.1),
    "caustic_refractions_indirect": ("BOOL", False),
    "caustic_TIR": ("BOOL", False),
    "caustic_internal_speculars": ("BOOL", False),
    "caustic_dispersion": ("BOOL", False),
    "caustic_specular_direct": ("BOOL", False),
    "caustic_specular_indirect": ("BOOL", False),
    "caustic_max_distance": ("FLOAT", -1.0),
    "aov_direct_refraction": ("TEXT", ""),
    "aov_indirect_refraction": ("TEXT", "Refraction"),
    "aov_direct_specular": ("TEXT", "Direct_Specular"),
    "aov_indirect_specular": ("TEXT", "Indirect_Specular"),
}
"""Every parameter of JF 1.0.5: its kind, or its words in the order of their numbers, and its default."""

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
"""Keywords that hold the very value of a parameter."""

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

_CAUSTIC_SWITCHES = tuple(
    name for name, (kind, _) in JF_PARAMETERS.items() if name.startswith("caustic_") and kind == "BOOL"
)

# parameters: distribution, u, v; keywords: distribution, roughness, anisotropy.
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
"""Of a lobe's two alphas, as in osl/optics.h: an anisotropy of 0.99."""


_SHORTEST = 1e-6
"""Transmittance Depth of a medium that lets nothing through."""


def read_nodes(path: Path) -> list[JfNode]:
    """Return the JF nodes of a .ass or .json file.

    :raises JfError: for another ending, text that is not of the format, or a file without such nodes.
    :raises OSError: if the file cannot be read.
    """
    ending = path.suffix.lower()
    if ending not in (".ass", ".json"):
        raise JfError(f"{path}: the ending must be .ass or .json")
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise JfError(f"{path}: this is no text; unpack it if it is compressed") from None
    try:
        nodes = parse_ass(text) if ending == ".ass" else parse_json(text, path.stem)
    except JfError as error:
        raise JfError(f"{path}: {error}") from None
    if not nodes:
        raise JfError(f"{path}: no {NODE_TYPE} node in it; export the materials together with the scene")
    return nodes


# Arnold's scene files


# A string, a comment, a brace, a word, a quote that is never closed. In nodes of others words need not be told apart.
_TOKEN, _FOREIGN = (
    re.compile(rf'"((?:[^"\\]|\\.)*)"|((?<![^\s{{}}"])#[^\n]*)|([{{}}])|({word})|(")', re.DOTALL)
    for word in (r'[^\s{}"]+', r'[^"{}#]+|#')
)

_ARRAY_SIZES = {
    **dict.fromkeys(("BYTE", "INT", "UINT", "BOOL", "FLOAT", "STRING", "NODE", "POINTER", "ENUM"), 1),
    **dict.fromkeys(("POINT2", "VECTOR2"), 2),
    **dict.fromkeys(("RGB", "VECTOR", "POINT"), 3),
    "RGBA": 4,
    "MATRIX": 16,
}

_NUMBER = re.compile(r"[-+]?((\d+\.?\d*|\.\d+)(e[-+]?\d+)?|nan|inf(inity)?)", re.IGNORECASE)

_SWITCHES = {"on": True, "true": True, "off": False, "false": False}


def parse_ass(text: str) -> list[JfNode]:
    """Return the JF nodes of the text of an Arnold scene file.

    A node need not stand on lines of its own. A value is one word, or numbers, or an array; so no parameter may be
    called by a number. Raises :class:`JfError` for a node that is not closed and for a parameter without a value.
    """
    nodes = []
    before, opened, values = "", "", None
    at = 0
    while match := (_FOREIGN if opened and values is None else _TOKEN).search(text, at):
        at = match.end()
        quoted, comment, brace, bare, stray = match.groups()
        if comment is not None:
            continue
        if stray or brace == ("{" if opened else "}"):
            line = text.count("\n", 0, match.start()) + 1
            raise JfError(f"line {line}: {match.group()} is out of place; {_whole(opened)}")
        if brace == "{":
            opened = before or "?"
            values = [] if _is_ours(opened) else None
        elif brace == "}":
            if values is not None:
                nodes.append(_ass_node(opened, values))
            opened, values = "", None
        elif values is not None:
            is_name = bool(values) and values[-1] == "name"
            values.append(re.sub(r"\\(.)", r"\1", quoted) if bare is None else bare if is_name else _bare_value(bare))
        before = bare or ""
    if opened:
        raise JfError(f"the last node has no closing brace; {_whole(opened)}")
    return nodes


def _whole(node_type: str) -> str:
    return f"in {node_type}: is the file whole?" if node_type else "is the file whole?"


def _is_ours(node_type: str) -> bool:
    return node_type.replace("_", "").lower() == NODE_TYPE.replace("_", "")


def _bare_value(word: str) -> Any:
    if word.lower() in _SWITCHES:
        return _SWITCHES[word.lower()]
    if not _NUMBER.fullmatch(word):
        return word
    try:
        return int(word)
    except ValueError:
        return float(word)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _ass_node(node_type: str, values: list[Any]) -> JfNode:
    """A node from what stands between its braces."""
    pairs = []
    at = 0
    while at < len(values):
        parameter = values[at]
        if not isinstance(parameter, str):
            after = f" after {pairs[-1][0]!r}" if pairs else ""
            raise JfError(f"{_name(pairs, node_type)}: {parameter!r}{after} is no name of a parameter; remove it")
        end = _value_end(values, at + 1)
        if end == at + 1 or end > len(values):
            raise JfError(f"{_name(pairs, node_type)}: {parameter}: its value is missing; write it or remove the name")
        if parameter != "declare":  # the value follows, under its own name
            pairs.append((parameter, _value(values[at + 1 : end])))
        at = end
    return _node(pairs, node_type)


def _value_end(values: list[Any], at: int) -> int:
    """Where the value that begins at `at` ends. Beyond the end of `values`: part of it is missing."""
    if values[at - 1] == "declare":  # declare NAME constant [ARRAY] TYPE
        return at + (4 if values[at + 2 : at + 3] == ["ARRAY"] else 3)
    head = values[at : at + 3]
    if len(head) == 3 and all(type(count) is int and count >= 0 for count in head[:2]) and isinstance(head[2], str):
        if head[2] in _ARRAY_SIZES:
            return at + 3 + head[0] * head[1] * _ARRAY_SIZES[head[2]]
        if head[2].startswith("b85"):  # packed
            return at + 4
    end = min(at + 1, len(values))
    while end > at and _is_number(values[end - 1]) and end < len(values) and _is_number(values[end]):
        end += 1
    return end


def _value(values: list[Any]) -> Any:
    if len(values) > 3 and isinstance(values[2], str) and values[:2] == [1, 1]:
        values = values[3:]  # an array of one
    return values[0] if len(values) == 1 else tuple(values)


def _name(pairs: Iterable[tuple[str, Any]], otherwise: str) -> str:
    return str(dict(pairs).get("name") or otherwise)


def _node(pairs: list[tuple[str, Any]], otherwise: str) -> JfNode:
    parameters = dict(pairs)
    names = [name for name, _ in pairs]
    repeated = tuple(name for name in parameters if names.count(name) > 1)
    parameters.pop("name", None)
    return JfNode(_name(pairs, otherwise), parameters, repeated)


# JSON


class _Pairs(list):
    """An object of a JSON file, with all that it repeats."""


def parse_json(text: str, name: str) -> list[JfNode]:
    """Return the nodes of a JSON text: an object of parameters, a list of such objects, or an object that names them.

    :param name: name of a node that has none of its own.
    :raises JfError: for anything else.
    """
    try:
        data = json.loads(text, object_pairs_hook=_Pairs)
    except (ValueError, RecursionError) as error:
        raise JfError(f"this is no JSON ({error})") from None
    nested = [isinstance(value, _Pairs) for _, value in data] if isinstance(data, _Pairs) else []
    if any(nested):
        if not all(nested):
            raise JfError(f"{data[nested.index(False)][0]!r} stands among materials; move it into one of them")
        named = data
    else:
        items = [data] if isinstance(data, _Pairs) else data
        if not isinstance(items, list) or not all(isinstance(item, _Pairs) for item in items):
            raise JfError("an object of parameters, a list of such objects or an object that names them is needed")
        named = [(name, item) for item in items if item]
    return [_node([(key, _json_value(value)) for key, value in pairs], name) for name, pairs in named]


def _json_value(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


# What the values mean here


class _Reader:
    """The values of one node, with JF's defaults, and the notes on it."""

    def __init__(self, node: JfNode) -> None:
        self.name = node.name
        self.notes: list[tuple[str, str]] = []
        self.values = {parameter: default for parameter, (_, default) in JF_PARAMETERS.items()}
        self.given = set(node.parameters)
        if "name" in node.repeated:
            self.note("name", "stands there more than once; the last one is used")
        for parameter, value in node.parameters.items():
            if parameter in node.repeated:
                self.note(parameter, f"stands there more than once; the last value, {_text(value)}, is used")
            if parameter in JF_PARAMETERS:
                self._take(parameter, value)
            elif parameter.partition(".")[0] in JF_PARAMETERS:
                self.note(parameter, "a single component is not carried over")
            else:
                self.note(parameter, f"unknown; {_text(value)} is left out")

    def note(self, parameter: str, text: str) -> None:
        self.notes.append((parameter, text))

    def fail(self, parameter: str, value: Any, needed: str) -> JfError:
        return JfError(f"{self.name}: {parameter}={_text(value)}: {needed} is needed")

    def _take(self, parameter: str, value: Any) -> None:
        kind, default = JF_PARAMETERS[parameter]
        if isinstance(kind, tuple):
            self.values[parameter] = self._word(parameter, value, kind)
        elif kind == "TEXT":
            self.values[parameter] = value
        elif kind == "BOOL" and isinstance(value, str) and value.lower() in _SWITCHES:
            self.values[parameter] = _SWITCHES[value.lower()]
        elif isinstance(value, str) and re.match(r"[^\W\d]|[/|:]", value):
            self.note(parameter, f"the link to {value!r} is not carried over; the default, {_text(default)}, is used")
        elif kind == "BOOL":
            if value not in (True, False):
                raise self.fail(parameter, value, "on or off")
            self.values[parameter] = bool(value)
        elif kind in _TRIPLES:
            if not isinstance(value, tuple) or len(value) != 3:
                raise self.fail(parameter, value, "a list of three numbers")
            self.values[parameter] = tuple(self._number(parameter, component) for component in value)
        else:
            number = self._number(parameter, value)
            if kind == "INT" and number != int(number):
                raise self.fail(parameter, value, "a whole number")
            self.values[parameter] = int(number) if kind == "INT" else number

    def _number(self, parameter: str, value: Any) -> float:
        try:
            if _is_number(value) and isfinite(value):
                return float(value)
        except OverflowError:
            pass
        raise self.fail(parameter, value, "a finite number")

    def _word(self, parameter: str, value: Any, words: tuple[str, ...]) -> str:
        if type(value) is int and 0 <= value < len(words):
            return words[value]
        if isinstance(value, str):
            plain = _plain(value)
            plain = _plain(_ALIASES.get(plain, plain))
            for word in words:
                if _plain(word) == plain:
                    return word
        raise self.fail(parameter, value, f"one of {', '.join(words)}, or a number from 0 to {len(words) - 1},")


def _plain(word: str) -> str:
    return re.sub(r"[\s_-]", "", word).lower()


def _text(value: Any) -> str:
    """A value for a note."""
    if isinstance(value, tuple):
        shown = " ".join(map(_text, value[:8]))
        return shown if len(value) <= 8 else f"{shown} ..."
    return f"{value:g}" if isinstance(value, float) else str(value)


def translate(node: JfNode) -> Translation:
    """Say a node in our parameters.

    :raises JfError: for a value that is none of its parameter's kind. The text names node, parameter and remedy.
    """
    reader = _Reader(node)
    _settle(reader)
    values = reader.values
    keywords = {
        **{keyword: _fitted(reader, name, values[name], keyword) for name, keyword in _CARRIED.items()},
        **{name: words[JF_PARAMETERS[name][0].index(values[name])] for name, words in _WORDS.items()},
        "polarization_angle": _fitted(
            reader, "polarization_angle", values["polarization_angle"] * pi, "polarization_angle"
        ),
        "dispersion_model": "JF",
        "reflect_sky": values["reflect_skies"] or values["reflect_skydomes"],
        **_scales(reader, "refraction_scale", "indirect_refraction", "direct_refraction", "direct_refraction"),
        **_scales(reader, "specular_scale", "indirect_specular", "direct_specular", "direct_reflection"),
        **_lobes(reader),
    }
    lights = {socket: _light(reader, name) for name, socket in _EMISSION.items()}
    emission = {socket: colour for socket, colour in lights.items() if any(colour)}
    try:
        check_keywords(keywords)
    except ParameterError as error:  # the tables above keep to the limits
        raise JfError(f"{node.name}: {error}") from None
    return Translation(node.name, keywords, emission, tuple(reader.notes))


def _settle(reader: _Reader) -> None:
    """Notes on what has no counterpart, and values whose meaning depends on others."""
    values = reader.values
    for name in values:
        if name.startswith("aov") and name in reader.given:
            reader.note(name, "use Blender's passes: Transmission and Glossy, each direct and indirect")
    if values["specular_ray_type"] == "Reflected":
        reader.note("specular_ray_type", "Max Interior Reflections limits reflections inside media, apart from others")
    if values["reflect_skies"] != values["reflect_skydomes"]:
        on, off = sorted(("reflect_skies", "reflect_skydomes"), key=values.get, reverse=True)
        reader.note(off, f"off, but {on} is on: Blender's world is both, and is reflected")
    mode = values["caustic_mode"]
    if mode == 1:
        reader.note("caustic_mode", "photons; here the switches for caustics hold for the paths that Cycles traces")
    elif mode != 0:
        reader.note("caustic_mode", f"{mode} is no caustics at all; all switches for caustics are off")
        values.update(dict.fromkeys(_CAUSTIC_SWITCHES, False))
    if values["mediumTransmittance_scale"] == 0.0:
        reader.note("mediumTransmittance_scale", f"0 -> {_SHORTEST:g}: black in JF, no absorption here")
        values["mediumTransmittance_scale"] = _SHORTEST
    if values["caustic_max_distance"] == 0.0:
        reader.note("caustic_max_distance", "0 -> -1, no fall-off, which 0 means in JF")
        values["caustic_max_distance"] = -1.0


def _fitted(reader: _Reader, parameter: str, value: Any, keyword: str) -> Any:
    """A value within the limits of a keyword, with a note if it was not."""
    if isinstance(value, (bool, str)):
        return value
    limits = BY_KEYWORD[keyword]
    low, high = limits.minimum, limits.maximum

    def clamped(number: float) -> float:
        number = number if low is None else max(number, type(number)(low))
        return number if high is None else min(number, type(number)(high))

    fitted = tuple(map(clamped, value)) if isinstance(value, tuple) else clamped(value)
    if fitted != value:
        reader.note(parameter, f"{_text(value)} -> {_text(fitted)}, the limit of {limits.name}")
    return fitted


def _scales(reader: _Reader, scale: str, indirect: str, direct: str, direct_keyword: str) -> dict[str, float]:
    """Scales of what rays see, and of lamps in proportion to it."""
    values = reader.values
    common = values[scale] * values[indirect]
    ratio = 1.0
    if values[indirect] != 0.0:
        ratio = values[direct] / values[indirect]
    elif values[direct] != 0.0 and values[scale] != 0.0:
        reader.note(direct, f"{_text(values[direct])} is lost: lamps are scaled with rays here, and {indirect} is 0")
    fitted = min(max(ratio, 0.0), 1.0)
    if fitted != ratio:
        reader.note(direct, f"{_text(ratio)} of {indirect} -> {_text(fitted)}: lamps are scaled with rays here")
    return {scale: _fitted(reader, scale, common, scale), direct_keyword: fitted}


def _light(reader: _Reader, parameter: str) -> tuple[float, float, float]:
    colour = reader.values[parameter]
    fitted = tuple(max(component, 0.0) for component in colour)
    if fitted != colour:
        reader.note(parameter, f"{_text(colour)} -> {_text(fitted)}: light cannot be negative")
    return fitted


# Lobes


def _lobes(reader: _Reader) -> dict[str, Any]:
    values = reader.values
    refraction = _lobe(reader, _REFRACTION)
    reflection = _lobe(reader, _REFLECTION)
    direct = _lobe(reader, _DIRECT)
    keywords = {**refraction, **reflection, **direct}
    keywords["separate_reflection"] = list(refraction.values()) != list(reflection.values())
    keywords["separate_direct_lobe"] = not values["dr_use_refraction_btdf"]
    used = [_REFRACTION, _REFLECTION]
    if keywords["separate_direct_lobe"]:
        used.append(_DIRECT)
    keywords.update(_tangent(reader, used, keywords))
    return keywords


def _lobe(reader: _Reader, lobe: tuple[tuple[str, str, str], tuple[str, str, str]]) -> dict[str, Any]:
    """Keywords of one lobe. The module says how wide JF's lobes are and where u and v lie."""
    (distribution, *roughness), (distribution_keyword, roughness_keyword, anisotropy_keyword) = lobe
    word = reader.values[distribution]
    u, v = (reader.values[name] for name in roughness)
    if word == "stretched_phong":
        reader.note(distribution, f"{word} -> Beckmann, as wide")
    if not word.startswith("ward"):
        if v != u and roughness[1] in reader.given:
            reader.note(roughness[1], f"{_text(v)} is without effect: {word} is round, and takes {roughness[0]}")
        v = u
    widths = []
    for name, value in zip(roughness, (u, v)):
        limit = min(max(value, 0.0), 2.0 if lobe is _REFLECTION else 1.0)
        if limit != value:
            reader.note(name, f"{_text(value)} -> {_text(limit)}, the limit of {BY_KEYWORD[roughness_keyword].name}")
        widths.append(limit / 2.0 if lobe is _REFLECTION else limit * limit)
    narrowest = max(widths) * _LEAST_RATIO
    if min(widths) < narrowest:
        name = roughness[widths.index(min(widths))]
        reader.note(name, f"{_text(reader.values[name])} is too small beside the other; the lobe is as long as can be")
    along, across = widths if lobe is _REFLECTION and word == "ward_userTangent" else reversed(widths)
    rough, stretch = roughness_and_anisotropy(max(along, narrowest), max(across, narrowest))
    return {distribution_keyword: "BECKMANN", roughness_keyword: rough, anisotropy_keyword: stretch}


def roughness_and_anisotropy(alpha_x: float, alpha_y: float) -> tuple[float, float]:
    """Return the roughness and anisotropy of which osl/optics.h makes these alphas, along and across the tangent.

    The smaller must be at least 1e-4 of the larger, or both 0.
    """
    if alpha_x == alpha_y:
        return sqrt(alpha_x), 0.0
    stretch = 1.0 - sqrt(min(alpha_x, alpha_y) / max(alpha_x, alpha_y))
    anisotropy = min(stretch, BY_KEYWORD["anisotropy"].maximum)
    return (alpha_x * alpha_y) ** 0.25, anisotropy if alpha_x < alpha_y else -anisotropy


def _tangent(reader: _Reader, lobes: list[tuple], keywords: dict[str, Any]) -> dict[str, Any]:
    """What anisotropy refers to: one tangent for all lobes here, one for each in JF."""
    ward = {names[0]: made for names, made in lobes if reader.values[names[0]].startswith("ward")}
    stretched = [name for name, made in ward.items() if keywords[made[2]] != 0.0]
    chosen = reader.values[(stretched or [*ward, "btdf"])[0]]
    for name in stretched[1:]:
        if reader.values[name] != chosen:
            reader.note(name, f"{reader.values[name]} -> {chosen}: all lobes share a tangent here")
    if chosen != "ward_userTangent":
        if "ward_tangent" in reader.given:
            reader.note(
                "ward_tangent", f"{_text(reader.values['ward_tangent'])} is without effect: no lobe refers to it"
            )
        return {"tangent_from": "REFRACTION" if chosen == "ward_rayTangent" else "TANGENT"}
    tangent = reader.values["ward_tangent"]
    reader.note(
        "ward_tangent", f"{_text(tangent)} is kept; turn it if the scene's Y axis, up in Arnold, is Blender's Z"
    )
    return {"tangent_from": "TANGENT", "tangent": tangent}


def report(translations: Iterable[Translation]) -> Iterator[str]:
    """Yield every note as a line, ``NODE: parameter: what happened``."""
    for translation in translations:
        for parameter, text in translation.notes:
            yield f"{translation.name}: {parameter}: {text}"
