/* Facts: what an analysis of the scene (addon/analysis) has told of a surface's exterior, and when they are checked. */
#pragma once

#include "medium.h"

/* One in so many surfaces that the analysis tells of is asked all the same. Where the scene answers otherwise the surface
 * is so many times as bright as a white one, or few samples would hide it. */
#define SPOT_CHECKS 512.0
#define ALARM 64.0

struct ExteriorFacts {
  int code;            /* EXTERIOR_... */
  float sole_priority; /* the only one that may be around, whose nearest surface decides; below 0 there are more */
  int overlaps_itself;
  int may_hold_objects; /* foreign objects may stand in the medium or in those that it touches */
  int scene;            /* number of the one whose analysis holds, NOT_ANALYSED of none */
  int gives_back;       /* volumes of media that lose absorb where ways end at this surface */
  Medium medium;        /* of EXTERIOR_MEDIUM */
};

/* What the object's own custom properties tell. The first number is packed (pack_facts() in addon/model/contract.py); an
 * object without the properties reads zeros, which tell nothing. */
ExteriorFacts read_object_facts(int gives_back, int scene)
{
  float object[4] = {EXTERIOR_UNKNOWN, 0.0, 1.0, 0.0}; /* packed facts, then the medium's fields */
  float transmittance[4] = {1.0, 1.0, 1.0, 1.0};
  getattribute(OBJECT_FACTS, object);
  int bits = (int)object[0];
  if (bits & FACTS_ABSORBS)
    getattribute(OBJECT_EXTERIOR_TRANSMITTANCE, transmittance);
  ExteriorFacts facts;
  facts.code = bits & (FACTS_CODES - 1);
  facts.overlaps_itself = (bits & FACTS_OVERLAPS_ITSELF) != 0;
  facts.may_hold_objects = (bits & FACTS_HOLDS_NO_OBJECTS) == 0;
  facts.gives_back = gives_back;
  facts.scene = scene;
  facts.sole_priority = (bits >> FACTS_PRIORITY_SHIFT) - 1;
  facts.medium = plain_medium(object[1 + FIELD_PRIORITY], object[1 + FIELD_IOR],
                              color(transmittance[0], transmittance[1], transmittance[2]), object[1 + FIELD_DEPTH]);
  return facts;
}

/* What the material's sockets tell of all of its objects, or each object tells of itself; `holds`: the analysis does on this
 * frame. `medium`: AIR_AROUND or other fields. */
ExteriorFacts read_facts(int code, float sole_priority, int overlaps_itself, int may_hold_objects, vector medium,
                         color transmittance, int gives_back, int scene, int holds)
{
  ExteriorFacts facts;
  facts.code = bounded(code, EXTERIOR_UNKNOWN, EXTERIOR_BY_OBJECT, EXTERIOR_UNKNOWN);
  facts.sole_priority = select(NO_SOLE_PRIORITY, sole_priority, is_number(sole_priority));
  facts.overlaps_itself = overlaps_itself;
  facts.may_hold_objects = may_hold_objects;
  facts.gives_back = gives_back;
  facts.scene = scene;
  facts.medium = plain_medium(medium[FIELD_PRIORITY], medium[FIELD_IOR], transmittance, medium[FIELD_DEPTH]);
  if (code == EXTERIOR_BY_OBJECT)
    facts = read_object_facts(gives_back, scene);
  if (!holds) {
    facts.code = EXTERIOR_UNKNOWN;
    facts.sole_priority = NO_SOLE_PRIORITY;
    facts.may_hold_objects = 1;
  }
  return facts;
}

/* True for one point in SPOT_CHECKS of every face. */
int spot_check()
{
  float place = 9973.0 * u + 7919.0 * v;
  return place - floor(place) < 1.0 / SPOT_CHECKS;
}

/* Another direction to the same side. */
vector tilted(vector direction)
{
  return normalize(direction + 0.37 * normalize(dPdu) + 0.21 * normalize(cross(direction, dPdu)));
}
