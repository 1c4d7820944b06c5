"""The parameters and the contract as macros of OSL."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from . import contract, dispersion
from .parameter import LARGEST, PRIORITY_PROPERTY, UNLIMITED_REFLECTIONS, Parameter
from .parameters import NEIGHBOUR_PARAMETERS, SOCKETS

OBJECT = "\\001object:"
"""Before a path of an object's, as OSL spells it."""

CODES = {
    "DISPERSION": contract.DispersionModel,
    "DISTRIBUTION": contract.Distribution,
    "EXTERIOR": contract.Exterior,
    "LIGHT": contract.LightKind,
    "SHADOW": contract.ShadowMode,
    "TANGENT": contract.TangentSource,
    "VIEW": contract.DebugView,
}
"""Enumerations by what stands before their words."""

NUMBERS = (
    "CUT_AIR",
    "CUT_HIDDEN",
    "CUT_SPLITS",
    "DEBUG_ALARM",
    "DEBUG_HIDDEN",
    "EMITTER_RADIANCE",
    "FACTS_ABSORBS",
    "FACTS_CODES",
    "FACTS_HOLDS_NO_OBJECTS",
    "FACTS_OVERLAPS_ITSELF",
    "FACTS_PRIORITY_SHIFT",
    "FLOAT_SPACING",
    "INDEX_MATCHED",
    "INDEX_NEARLY_MATCHED",
    "LEAST_TRANSMITTANCE",
    "MATERIAL_SLOTS",
    "MOST_STRETCH",
    "NOT_ANALYSED",
    "NO_CUTOFF",
    "NO_PRIORITY",
    "NO_SOLE_PRIORITY",
    "PRECISION_LIMIT",
    "PROBE_HITS",
    "RATIO_MARGIN",
    "TOLD_BY_FACE",
)
"""Constants of the contract that the shader takes as they are."""

ATTRIBUTES = (
    "CUT",
    "CUT_BY_VOLUME",
    "CUT_CURVE",
    "CUT_DEPTH",
    "CUT_PRIORITY",
    "CUT_SELLMEIER_B",
    "CUT_SELLMEIER_C",
    "CUT_TINT",
)
"""Names of attributes of faces."""


def osl_contract() -> str:
    """Return all that the shader is to know as lines like ``#define IOR_LIMITS 0.01, 100.0, 1.33``."""
    return "".join(f"#define {name} {value}\n" for name, value in macros())


def macros() -> Iterator[tuple[str, str]]:
    """Yield names and values of all macros."""
    for parameter in SOCKETS:
        yield from _of_parameter(parameter)
    for prefix, codes in CODES.items():
        yield from ((f"{prefix}_{code.name}", str(code.value)) for code in codes)
    yield from _numbered("FIELD_", contract.MEDIUM_FIELDS)
    yield from _numbered("CURVE_", contract.CURVE_FIELDS)
    yield "AIR_AROUND", f"vector{contract.AIR_AROUND}"
    yield from ((name, repr(getattr(contract, name))) for name in NUMBERS)
    yield from ((f"LINE_{line}", repr(getattr(dispersion, f"LINE_{line}"))) for line in "CDF")
    yield from zip(("SHORTEST", "LONGEST"), (repr(float(end)) for end in dispersion.VISIBLE))
    yield "LARGEST", repr(LARGEST)
    yield "UNLIMITED_REFLECTIONS", repr(UNLIMITED_REFLECTIONS)
    yield from ((f"{name}_ATTRIBUTE", f'"{getattr(contract, name)}"') for name in ATTRIBUTES)
    yield from _paths()


def _of_parameter(parameter: Parameter) -> Iterator[tuple[str, str]]:
    name = parameter.keyword.upper()
    if parameter.limits is not None:
        yield f"{name}_LIMITS", ", ".join(_osl(parameter, limit) for limit in parameter.limits)
    if parameter.kind in ("MENU", "INDEX"):
        yield f"{name}_DEFAULT", str([choice.keyword for choice in parameter.choices].index(parameter.default))
    elif parameter.kind != "SHADER":
        yield f"{name}_DEFAULT", _osl(parameter, parameter.default)


def _numbered(prefix: str, words: Iterable[str]) -> Iterator[tuple[str, str]]:
    yield from ((f"{prefix}{word}", str(number)) for number, word in enumerate(words))


def _paths() -> Iterator[tuple[str, str]]:
    """Yield paths by which attributes of objects are read, and those of neighbours' sockets in all slots."""
    yield "OBJECT_PRIORITY", f'"{OBJECT}{PRIORITY_PROPERTY}"'
    yield "OBJECT_FACTS", f'"{OBJECT}{contract.OUTSIDE_PROPERTY}"'
    yield "OBJECT_EXTERIOR_TRANSMITTANCE", f'"{OBJECT}{contract.OUTSIDE_TRANSMITTANCE_PROPERTY}"'
    yield "SECOND_SLOT", f'"{OBJECT}{contract.SECOND_SLOT_PATH}"'
    pieces = contract.socket_path("\n", "\n").replace('"', '\\"').split("\n")
    yield "SOCKET(slot, name)", f'"{OBJECT}{pieces[0]}" slot "{pieces[1]}" name "{pieces[2]}"'
    for name in (*NEIGHBOUR_PARAMETERS, contract.BY_VOLUME_SOCKET):
        yield f"{name.upper().replace(' ', '_')}_SOCKET", f'"{name}"'
    slots = ", ".join(f'SOCKET("{slot}", name)' for slot in range(contract.MATERIAL_SLOTS))
    yield "SOCKETS(name)", f"{{{slots}}}"


def _osl(parameter: Parameter, value: float | tuple[float, ...]) -> str:
    """Spell a value as OSL does."""
    if isinstance(value, tuple):
        return f"{parameter.kind.lower()}{value}"
    return repr(int(value)) if isinstance(value, bool) else repr(value)
