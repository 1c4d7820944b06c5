"""Kinds of findings: how bad each is, and what the picture would show. Their keys are an interface of pipelines."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Severity(StrEnum):
    """How bad a finding is, the worst first."""

    WRONG = "wrong picture"
    SLOW = "slow"
    NOTE = "note"


@dataclass(frozen=True)
class Kind:
    """A kind of finding.

    :param key: its name in JSON, in lower case with hyphens.
    :param shows: what the picture would show, as a sentence without a full stop.
    """

    key: str
    severity: Severity
    shows: str


KINDS: dict[str, Kind] = {}
"""All kinds by their keys."""


def _kind(key: str, severity: Severity, shows: str) -> Kind:
    KINDS[key] = kind = Kind(key, severity, shows)
    return kind


_WRONG, _SLOW, _NOTE = Severity

# Meshes.
NO_FACES = _kind("no-faces", _WRONG, "Nothing: the object is not there")
NOT_FINITE = _kind("not-finite", _WRONG, "Nothing, or black, where the mesh has no place")
OPEN_MESH = _kind("open-mesh", _WRONG, "Dark or clear patches: rays leave the medium without meeting its surface")
MIXED_NORMALS = _kind("mixed-normals", _WRONG, "Dark patches: some faces take the inside for the outside")
INWARD_NORMALS = _kind("inward-normals", _WRONG, "A dark, bent picture: the inside is taken for the outside")
SELF_OVERLAP = _kind("self-overlap", _SLOW, "The right picture, for which rays ask where the surface crosses itself")
SEVERAL_MEDIA = _kind("several-media", _WRONG, "One of its media everywhere, or seams between them")
METABALL_FAMILY = _kind("metaball-family", _WRONG, "The medium of another metaball")
NO_INSIDE = _kind("no-inside", _WRONG, "A thin surface without an inside, or nothing")

# Places.
EQUAL_PRIORITIES = _kind("equal-priorities", _WRONG, "Either of both media where they overlap, as if they were one")
DUPLICATE = _kind("duplicate", _WRONG, "Dark specks: every surface is there twice")
GAP = _kind("gap", _WRONG, "A silvery film of air between both, from total reflection")
THIN_OVERLAP = _kind("thin-overlap", _WRONG, "Specks where rounding takes one surface for the other")
COINCIDENT = _kind("coincident", _WRONG, "Specks or dark patches where faces lie in the same place")
FOREIGN_COINCIDENT = _kind("foreign-coincident", _WRONG, "Specks or dark patches where faces lie in the same place")
FOREIGN_INSIDE = _kind("foreign-inside", _NOTE, "The object as it looks inside the medium")
FOREIGN_ACROSS = _kind("foreign-across", _NOTE, "The object through the surface, bent where the medium begins")
CAMERA_INSIDE = _kind("camera-inside", _NOTE, "All as it is seen from inside the medium")
LIGHT_INSIDE = _kind("light-inside", _NOTE, "Light that leaves through the medium's surface")

# Limits.
SLOT_LIMIT = _kind("slot-limit", _WRONG, "Neighbours as if the medium were not there")
RAY_LIMIT = _kind("ray-limit", _WRONG, "Magenta where a ray meets more than the shader counts")
PRECISION = _kind("precision", _WRONG, "Specks or magenta: positions are too coarse to tell both sides of a surface")
THIN_WALL = _kind("thin-wall", _WRONG, "Specks where a wall is thinner than rounding allows")
FEW_BOUNCES = _kind("few-bounces", _WRONG, "Dark parts where paths end before they get through")

# Materials.
NODES = _kind("nodes", _WRONG, "Neighbours that take the medium for another one, or do not see it")
VALUE_LIMIT = _kind("value-limit", _WRONG, "The nearest value within the limits")
UNMASKED_MIX = _kind("unmasked-mix", _WRONG, "The other shader on surfaces that are not there")
BAD_PRIORITY = _kind("bad-priority", _WRONG, "Another priority than the one that seems to be set")
VERSION = _kind("version", _WRONG, "Whatever the other version makes of it")
SPECTRAL_TABLE = _kind("spectral-table", _WRONG, "Colours of the table from before")
TINT_STRENGTH = _kind("tint-strength", _NOTE, "Black, or no colour at all: the depth does not fit the object")

# Tint, volumes and lights.
TINTED_LABEL = _kind("tinted-label", _WRONG, "Light below the label without the medium's colour")
TINT_IN_PART = _kind("tint-in-part", _WRONG, "Light from inside the medium without all of its colour")
VOLUME_IN_WINNER = _kind("volume-in-winner", _WRONG, "The volume where another medium is")
LOST_LIGHT = _kind("lost-light", _WRONG, "Less light than the light gives")
LINKED_LOBES = _kind("linked-lobes", _WRONG, "Less light than the light gives")
LIGHTS_CHANGED = _kind("lights-changed", _WRONG, "Light of lights as they were")
PORTAL = _kind("portal", _WRONG, "Light of a single colour behind the portal")
VECTOR_PASS = _kind("vector-pass", _WRONG, "An empty Vector pass")

# Settings and scenes.
SETTINGS = _kind("settings", _WRONG, "No nested media, or magenta where they are")
MUST_ASK = _kind("must-ask", _WRONG, "Magenta: what renders cannot ask what lies outside")
NATIVE_LIMIT = _kind("native-limit", _WRONG, "What Cycles' own nodes make of it")
NO_COLOURS = _kind("no-colours", _WRONG, "Dispersing media without their own colours")
SCENES_ASK = _kind("scenes-ask", _SLOW, "The right picture, for which rays ask what media are told in another scene")
SCENES_DISAGREE = _kind("scenes-disagree", _WRONG, "Media as another scene needs them")
