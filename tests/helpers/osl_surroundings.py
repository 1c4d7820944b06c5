"""Functions of the shader's headers about what lies around a surface, and what they are to return."""

from __future__ import annotations

import numpy as np
from osl_interfaces import FEW
from osl_measure import Draw, Function
from osl_media import CHOICE
from osl_values import BACKFACING

from nested_dielectric.model.contract import HIGHEST_PACKED_PRIORITY, Exterior, Facts, pack_facts

AIR = 1e9
"""Priority of air."""

# Facts


def facts(d: Draw) -> dict[str, np.ndarray]:
    """Packed facts of all kinds, and media to go with them."""
    sole = d.either(d.choice(-1.0, 0.0, 1.0, HIGHEST_PACKED_PRIORITY), np.floor(d.linear(0.0, 1001.0)))
    code, flags = d.choice(*Exterior), d.choice(*range(8)).astype(int)
    packed = [
        pack_facts(Facts(Exterior(int(each)), bool(flag & 1), bool(flag & 2), bool(flag & 4), priority))
        for each, flag, priority in zip(code, flags, sole)
    ]
    tint = np.stack([d.linear(0.0, 1.0), d.linear(0.0, 1.0), d.linear(0.0, 1.0), np.ones(d.count)], axis=1)
    return {
        "facts": np.stack([packed, np.floor(d.linear(0.0, 1000.0)), d.linear(1.0, 3.0), d.linear(0.0, 10.0)], axis=1),
        "tint": tint,
        "code": code,
        "flags": flags,
        "sole": sole,
    }


READ = """
ExteriorFacts got = read_facts(EXTERIOR_BY_OBJECT, NO_SOLE_PRIORITY, 0, 1, AIR_AROUND, color(1.0), 1, 3, 1);
ExteriorFacts stale = read_facts(EXTERIOR_AIR, 7.0, 0, 0, AIR_AROUND, color(1.0), 1, 3, 0);
r[0] = got.code; r[1] = got.overlaps_itself; r[2] = got.may_hold_objects; r[3] = got.medium.transmittance[0];
r[4] = got.sole_priority; r[5] = got.medium.priority; r[6] = got.medium.ior.white; r[7] = got.medium.transmittance_depth;
r[8] = stale.code == EXTERIOR_UNKNOWN && stale.sole_priority == NO_SOLE_PRIORITY && stale.may_hold_objects;
"""


def told(facts, tint, code, flags, sole):
    """Return what was packed, read again."""
    flags = flags.astype(int)
    tinted = np.where(flags & 4, tint[:, 0], 1.0)
    return [code, flags & 1, (flags & 2) > 0, tinted, sole, facts[:, 1], facts[:, 2], facts[:, 3], np.ones(len(code))]


# Probes

WINDINGS = """
/* Sums of many crossings by places and one by one: how many below `unsummed` differ. */
float wrong_sums(int seed, int count, int levels_there, output float summed)
{
  float priorities[PROBE_LEVELS];
  int windings[PROBE_LEVELS];
  int sums[256];
  int levels = 0, state = seed, wrong = 0;
  float unsummed = AIR_PRIORITY;
  for (int i = 0; i < 256; i++)
    sums[i] = 0;
  for (int i = 0; i < count; i++) {
    state = (75 * state + 74) % 65537;
    int p = state % levels_there;
    int sign = (state / 256) % 2 ? 1 : -1;
    sums[p] += sign;
    if (p >= unsummed)
      continue;
    int k = winding_place(p, priorities, windings, levels, unsummed);
    if (k >= 0)
      windings[k] += sign;
  }
  for (int p = 0; p < levels_there && p < unsummed; p++) {
    int found = 0;
    for (int k = 0; k < levels; k++)
      found += (priorities[k] == p) ? windings[k] : 0;
    wrong += found != sums[p];
  }
  summed = min(unsummed, (float)levels_there);
  return wrong;
}
"""

MATCHES = """
Medium outer = plain_medium(1.0, ior, color(tint), depth);
Surroundings found = nothing_around(own);
r[0] = matches_probe(1, outer, found);
found.medium = plain_medium(priority, ior + other_ior, color(tint + other_tint), depth + other_depth);
r[1] = matches_probe((int)valid, outer, found);
"""


def probes(d: Draw) -> dict[str, np.ndarray]:
    """Two media that are the same but for some of their numbers."""
    return {
        "priority": d.choice(0.0, 1.0, 2.0),
        "own": d.choice(0.0, 2.0, 1.0),
        "valid": d.choice(0.0, 1.0),
        "ior": d.linear(1.0, 2.0),
        "other_ior": d.either(d.choice(0.0, 0.0, 0.2), d.choice(0.0)),
        "tint": d.choice(0.5, 0.25, 1.0),
        "other_tint": d.choice(0.0, 0.0, -0.125),
        "depth": d.linear(0.5, 2.0),
        "other_depth": d.choice(0.0, 0.0, 0.25),
    }


def same(priority, own, valid, other_ior, tint, other_tint, other_depth, **_):
    """Return whether a probe confirms a surface: one that wins over it makes it none, and one outside is the same medium."""
    hidden = priority <= own
    absorbs = tint < 1.0
    alike = (priority == 1.0) & (other_ior == 0.0) & (absorbs == (tint + other_tint < 1.0))
    alike &= ~absorbs | ((other_tint == 0.0) & (other_depth == 0.0))
    return [np.zeros(len(own)), np.where(valid > 0.0, np.where(hidden, 0.0, alike), hidden)]


FUNCTIONS = (
    Function(
        "read_facts",
        "exterior.h",
        facts,
        READ,
        told,
        1.0,
        "packed and read again to the last bit",
        codes=("facts", "tint", "code", "flags", "sole"),
        more=(
            "contract.h",
            '#undef OBJECT_FACTS\n#define OBJECT_FACTS "facts"',
            '#undef OBJECT_EXTERIOR_TRANSMITTANCE\n#define OBJECT_EXTERIOR_TRANSMITTANCE "tint"',
        ),
        covers=("read_object_facts",),
    ),
    Function(
        "tilted",
        "exterior.h",
        lambda d: {"w": d.direction()},
        "vector away = normalize(cross(dPdu, w)); vector other = tilted(away);"
        "r[0] = length(other); r[1] = dot(other, away); r[2] = dot(other, normalize(dPdu));",
        lambda w: [np.ones(len(w)), *[np.full(len(w), part / np.sqrt(1 + 0.37**2 + 0.21**2)) for part in (1, 0.37)]],
        8.0,
        FEW,
    ),
    Function(
        "next_after",
        "crossing.h",
        lambda d: {"t": d.either(d.logarithmic(1e-20, 1e20), d.choice(0.0))},
        "float next = next_after(t); r[0] = next > t; r[1] = next;",
        lambda t: [np.ones(len(t)), t],
        4.0,
        "the next number or the one after it",
        terms=lambda t: [1.0, t + 1e-20],
    ),
    Function(
        "add_foreign_hit",
        "extent.h",
        lambda d: {"one": d.logarithmic(1e-6, 1e6), "other": d.logarithmic(1e-6, 1e6)},
        "ForeignHits f; f.first = f.last = -1.0; add_foreign_hit(f, one); r[0] = f.first; r[1] = f.last;"
        "add_foreign_hit(f, other); r[2] = f.first; r[3] = f.last;",
        lambda one, other: [one, one, one, other],
        0.0,
        CHOICE,
    ),
    Function(
        "is_entrance",
        "interface.h",
        lambda d: {"valid": d.choice(0.0, 1.0), "p1": d.choice(0.0, 1.0, AIR), "p2": d.choice(AIR, 0.0, 1.0)},
        "Interface s; s.valid = (int)valid; s.from = air(); s.to = air(); s.from.priority = p1; s.to.priority = p2;"
        "r[0] = is_entrance(s); r[1] = is_exit(s);",
        lambda valid, p1, p2: [(valid > 0.0) & (p1 == AIR), (valid > 0.0) & (p2 == AIR)],
        0.0,
        CHOICE,
        codes=("valid", "p1", "p2"),
        covers=("is_exit",),
    ),
    Function(
        "winding_place",
        "probe.h",
        lambda d: {
            "seed": np.arange(d.count) + 1.0,
            "crossings": d.choice(0, 1, 50, 300),
            "levels": d.choice(1, 3, 60, 66, 200),
        },
        "r[0] = wrong_sums((int)seed, (int)crossings, (int)levels, r[1]); r[1] = (levels <= PROBE_LEVELS) ? r[1] : levels;",
        lambda seed, crossings, levels: [np.zeros(len(seed)), levels],
        0.0,
        "sums of whole numbers",
        codes=("seed", "crossings", "levels"),
        functions=WINDINGS,
    ),
    Function(
        "matches_probe",
        "probe.h",
        probes,
        MATCHES,
        same,
        0.0,
        CHOICE,
        codes=("priority", "own", "valid", "ior", "other_ior", "tint", "other_tint", "depth", "other_depth"),
        covers=("nothing_around",),
    ),
    Function(
        "exterior_priority",
        "interface.h",
        lambda d: {
            "valid": d.choice(0.0, 1.0),
            "back": d.choice(0.0, 1.0),
            "p1": d.choice(0.0, 1.0, AIR),
            "p2": d.choice(AIR, 0.0, 1.0),
        },
        "Interface s; s.valid = (int)valid; s.from = air(); s.to = air(); s.from.priority = p1; s.to.priority = p2;"
        "r[0] = exterior_priority(s);",
        lambda valid, back, p1, p2: [
            np.where((valid > 0.0) & (np.where(back > 0.0, p2, p1) < AIR), np.where(back > 0.0, p2, p1), -1.0)
        ],
        0.0,
        CHOICE,
        codes=("valid", "back", "p1", "p2"),
        more=("contract.h", BACKFACING),
    ),
)
