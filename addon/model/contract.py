"""What Python and the shader both know, written once: codes, stored names, packed facts, limits that are no parameter's.

:mod:`osl_contract` writes all of it for OSL, as the header ``contract.h``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

from .choice import Choice
from .enumerations import DISPERSION_MODELS, DISTRIBUTIONS, SHADOW_MODES, TANGENTS
from .parameter import GROUP_NAME
from .parameters import BY_KEYWORD


class Exterior(IntEnum):
    """What lies outside a surface, as far as it is told."""

    UNKNOWN = 0
    """The scene is asked."""
    AIR = 1
    MEDIUM = 2
    """The one medium that is named beside."""
    WINNER = 3
    """A medium that wins over the surface's own: the surface does not exist."""
    BY_OBJECT = 5
    """Of a material: the properties of each of its objects tell."""


class DebugView(IntEnum):
    """What a debug view shows of surfaces instead of light."""

    NONE = 0
    MEDIUM = 1
    VALIDITY = 2
    DEPTH = 3
    RAYS = 4
    BODY = 5
    TOLD = 6


class LightKind(IntEnum):
    """Shapes of lights that lobes carry."""

    POINT = 0
    SUN = 1
    SPOT = 2
    AREA = 3
    ELLIPSE = 4


def _numbered(name: str, choices: Sequence[Choice]) -> type[IntEnum]:
    """Return the words of a menu with their places, which are what its socket holds."""
    return IntEnum(name, [choice.keyword for choice in choices], start=0)


DispersionModel = _numbered("DispersionModel", DISPERSION_MODELS)
Distribution = _numbered("Distribution", DISTRIBUTIONS)
ShadowMode = _numbered("ShadowMode", SHADOW_MODES)
TangentSource = _numbered("TangentSource", TANGENTS)

OUTSIDE_PROPERTY = "nd_outside"
"""Custom property of an object: packed facts, and the medium outside as :data:`MEDIUM_FIELDS`."""

OUTSIDE_TRANSMITTANCE_PROPERTY = "nd_outside_transmittance"
"""Another, where the medium outside absorbs: its Transmittance."""

MEDIUM_FIELDS = ("PRIORITY", "IOR", "DEPTH")
"""In which order three numbers tell a medium; the last is the Transmittance Depth, in scene units."""

AIR_AROUND = (0.0, 1.0, 0.0)
"""Medium of these fields where none is told."""

NO_SOLE_PRIORITY = -1.0
"""In place of the only priority that may be around, where there may be more."""

NOT_ANALYSED = -1
"""In place of a scene's number where no analysis holds."""

FACTS_CODES = 8
"""Packed facts hold an :class:`Exterior` below this number, then one bit each of these."""
FACTS_OVERLAPS_ITSELF = 8
FACTS_HOLDS_NO_OBJECTS = 16
FACTS_ABSORBS = 32
FACTS_PRIORITY_SHIFT = 6
"""Place of the sole priority, counted from 1, above those bits."""

HIGHEST_PACKED_PRIORITY = 2.0**17
"""Sole priority up to which single precision keeps packed facts whole."""


@dataclass(frozen=True)
class Facts:
    """What one number tells of an object; the defaults tell nothing."""

    code: Exterior = Exterior.UNKNOWN
    overlaps_itself: bool = False
    may_hold_objects: bool = True
    absorbs: bool = False
    sole_priority: float = NO_SOLE_PRIORITY


def pack_facts(facts: Facts) -> float:
    """Pack facts into one number that single precision keeps; 0 tells nothing. Drop a sole priority that is too high for it."""
    counted = int(facts.sole_priority) + 1 if facts.sole_priority <= HIGHEST_PACKED_PRIORITY else 0
    return float(
        facts.code
        + FACTS_OVERLAPS_ITSELF * facts.overlaps_itself
        + FACTS_HOLDS_NO_OBJECTS * (not facts.may_hold_objects)
        + FACTS_ABSORBS * facts.absorbs
        + (counted << FACTS_PRIORITY_SHIFT)
    )


def unpack_facts(number: float) -> Facts:
    """Read what :func:`pack_facts` has packed. Raise :class:`ValueError` for a code that there is none of."""
    bits = int(number)
    return Facts(
        Exterior(bits % FACTS_CODES),
        bool(bits & FACTS_OVERLAPS_ITSELF),
        not bits & FACTS_HOLDS_NO_OBJECTS,
        bool(bits & FACTS_ABSORBS),
        float((bits >> FACTS_PRIORITY_SHIFT) - 1),
    )


CUT = "nd_cut"
"""Custom property of a scene that shows surfaces which are cut where media cross, and attribute of the faces of those.

A face holds 0 where nothing is told, CUT_AIR, CUT_HIDDEN, or the index of the medium outside, negative where that one's colour
and dispersion are told, too. It is one number for nearly all faces, as a look-up costs most where it waits for memory.
"""

CUT_AIR = 1.0
"""A face in air."""

CUT_LIKE_AIR = 1.0000001
"""A face in a medium that bends light as air does."""

CUT_HIDDEN = 1e6
"""A face inside a winner: the surface does not exist there."""

CUT_PRIORITY, CUT_TINT, CUT_DEPTH, CUT_BY_VOLUME, CUT_CURVE, CUT_SELLMEIER_B, CUT_SELLMEIER_C = (
    f"nd_cut_{name}" for name in ("priority", "tint", "depth", "by_volume", "curve", "sellmeier_b", "sellmeier_c")
)
CUT_ATTRIBUTES = (CUT, CUT_PRIORITY, CUT_TINT, CUT_DEPTH, CUT_BY_VOLUME, CUT_CURVE, CUT_SELLMEIER_B, CUT_SELLMEIER_C)
"""Attributes of faces that are cut. ``CUT_BY_VOLUME`` holds the number of the scene whose volumes absorb for all rays."""

CURVE_FIELDS = ("MODEL", "ABBE", "SPREAD")
"""What the three numbers of ``CUT_CURVE`` are: Dispersion Model, more by ``CUT_SPLITS`` where the medium disperses; Abbe;
Dispersion."""

CUT_SPLITS = len(DispersionModel)

MATERIAL_SLOTS = 8
"""Slots of an object in which neighbours look for its dielectric; a surface that asks shows the alarm for a later one."""

PROBE_HITS = 65536
"""Surfaces that a ray of the shader's may count, over all runs for many priorities; beyond, the surface shows the alarm."""

PROBE_HITS = 65536
"""Surfaces that a ray of the shader's may count, over all runs for many priorities; beyond, the surface shows the alarm."""

SECOND_SLOT_PATH = "material_slots[1].material.pass_index"
"""Path from an object that leads somewhere if it has a second material."""

BY_VOLUME_SOCKET = "Absorbs by Volume"
"""Socket of a material: number of the scene in which its volume absorbs for all rays."""


def socket_path(slot: int | str, name: str) -> str:
    """Return the path of a dielectric's socket from the object whose slot it is in."""
    return f'material_slots[{slot}].material.node_tree.nodes["{GROUP_NAME}"].inputs["{name}"].default_value'


PRECISION_LIMIT = 32.0
"""Least thickness of a medium, in FLOAT_SPACING of its largest coordinate; a surface with less behind it shows the alarm."""

FLOAT_SPACING = 1.2e-7
"""Relative distance between numbers in single precision; up to twice as far as they lie."""

NO_PRIORITY = -1.0
"""What outputs for artists tell of air, and where there is nothing to tell."""

NO_CUTOFF = BY_KEYWORD["energy_cutoff_exponent"].minimum
"""The exponent that gives up nothing."""

EMITTER_RADIANCE = 1e-6
"""So weak that Cycles does not take media for lights, and draws no light samples of them."""

INDEX_MATCHED = 2e-5
"""Below this relative change of index light neither bends nor reflects measurably (F < 1e-10), and the half vector of a rough
lobe is not defined.
"""

INDEX_NEARLY_MATCHED = 1e-2
"""Below this relative change of index rough facets let light through as if none masked another (osl/closures.h).

Cycles' multi-scatter GGX conserves energy from there on.
"""

RATIO_MARGIN = 1e-4
"""A ratio of indices nearer to 1 has no Abbe number: it is moved this far off, which bends no light visibly."""

LEAST_TRANSMITTANCE = 1e-6
"""A volume takes a darker colour for this one."""

MOST_STRETCH = BY_KEYWORD["anisotropy"].maximum
"""Anisotropy that is taken, either way."""

DEBUG_ALARM = -2.0
"""What debug views take for a surface that shows the alarm."""

DEBUG_HIDDEN = -3.0
"""What the debug view of media takes for a surface that does not exist."""

TOLD_BY_FACE = 4.0
"""What the debug view of facts shows, beside an :class:`Exterior`, where the face itself tells."""
