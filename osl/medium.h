/* A medium and how to read the one that another object is made of.
 *
 * Priorities order media: where several fill the same point the lowest number wins.
 * Air fills what no medium claims, so its priority is above every number an artist can give. */
#pragma once

#include "dispersion.h"

#define AIR_PRIORITY 1e9

/* Whether an object's own priority counts: a whole number that the artist may give. Whatever else is stored there leaves
 * the material's in force, as in own_priority() of addon/media.py. */
int is_priority(float own[4])
{
  float p = own[0];
  return (own[3] > 0.0) * (own[1] == p) * (own[2] == p) * (floor(p) == p) * within(p, PRIORITY_LIMITS);
}

/* Material slots an object's dielectric is looked for in when the face that was hit has another material. */
#define MATERIAL_SLOTS 8

struct Medium {
  float priority;
  Index ior;
  int disperses;
  color transmittance;       /* colour that is left after transmittance_depth */
  float transmittance_depth; /* scene units */
  int absorbs;   /* for surfaces to charge */
  int by_volume; /* it absorbs, but Cycles' volumes charge all of it */
};

Medium air()
{
  /* OSL does not initialise a struct within a struct by a list. */
  Medium m;
  m.priority = AIR_PRIORITY;
  m.ior.at_path = m.ior.white = 1.0;
  m.ior.slope = 0.0;
  m.ior.regular = 1;
  m.disperses = 0;
  m.transmittance = color(1.0);
  m.transmittance_depth = 1.0;
  m.absorbs = 0;
  m.by_volume = 0;
  return m;
}

void tint(output Medium m, color transmittance, float transmittance_depth)
{
  m.transmittance = bounded(transmittance, TRANSMITTANCE_LIMITS);
  m.transmittance_depth = bounded(transmittance_depth, TRANSMITTANCE_DEPTH_LIMITS);
  m.absorbs = min(m.transmittance[0], min(m.transmittance[1], m.transmittance[2])) < 1.0 && m.transmittance_depth > 0.0;
}

/* Cycles evaluates these RNA paths on the evaluated object, so a neighbour's keyframed or driven socket is read as it
 * is at the rendered frame and nothing of the extension is needed. The fourth component tells a value (1) from a
 * missing path (0). */
#define OBJECT_PRIORITY "\001object:nd_priority"
#define SOCKET(slot, name) \
  "\001object:material_slots[" slot "].material.node_tree.nodes[\"Nested Dielectric\"].inputs[\"" name "\"].default_value"
#define SOCKETS(name) \
  { SOCKET("0", name), SOCKET("1", name), SOCKET("2", name), SOCKET("3", name), \
    SOCKET("4", name), SOCKET("5", name), SOCKET("6", name), SOCKET("7", name) }

/* The priority of the object that is shaded: its own value, or else its material's. */
float shaded_priority(float material_priority)
{
  float own[4] = {0.0, 0.0, 0.0, 0.0};
  getattribute(OBJECT_PRIORITY, own);
  return is_priority(own) ? own[0] : material_priority;
}

/* Any material in the second slot: an object without one needs no look at the face that was hit, and what its material
 * exports is that of the first slot alone, if the scene was analysed (see _requests in addon/node_group.py). */
#define SECOND_SLOT "\001object:material_slots[1].material.pass_index"
#define NO_SLOT -1
/* The object has got a second slot since the analysis: what is in it cannot be read. */
#define UNREADABLE_SLOT -2

/* The medium that was hit last by trace() is made of the nested dielectric of the face that was hit. A face with
 * another material, such as a label on a bottle, closes the object's surface all the same: it counts as the first
 * dielectric of the object. Returns that slot's priority, or AIR_PRIORITY if the object has no nested dielectric. */
float hit_slot(output int slot)
{
  string priorities[MATERIAL_SLOTS] = SOCKETS("Priority");
  float value[4];
  float index = 0.0;
  if (getmessage("trace", SECOND_SLOT, value) && value[3] > 0.0) {
    getmessage("trace", "material_index", index);
    if (!getmessage("trace", priorities[1], value)) {
      slot = UNREADABLE_SLOT;
      return AIR_PRIORITY;
    }
  }
  for (int i = -1; i < MATERIAL_SLOTS; i++) {
    slot = (i < 0) ? min((int)index, MATERIAL_SLOTS - 1) : i;
    if (getmessage("trace", priorities[slot], value) && value[3] > 0.0)
      return bounded(value[0], PRIORITY_LIMITS);
  }
  slot = NO_SLOT;
  return AIR_PRIORITY;
}

/* Priority of the medium that was hit last by trace(); AIR_PRIORITY if the object is foreign. The object's own
 * value, where it has one, overrides the material's; the slot is then not looked for yet and NO_SLOT. */
float hit_priority(output int slot)
{
  float value[4];
  slot = NO_SLOT;
  if (!getmessage("trace", OBJECT_PRIORITY, value))
    return AIR_PRIORITY; /* no material on it asks for the property: not a medium */
  return is_priority(value) ? value[0] : hit_slot(slot);
}

/* Whether the face that was hit last, of a medium, has a material that is none, such as a label. */
int hit_label()
{
  string priorities[MATERIAL_SLOTS] = SOCKETS("Priority");
  float value[4];
  float index = 0.0;
  if (!getmessage("trace", SECOND_SLOT, value) || value[3] == 0.0)
    return 0;
  getmessage("trace", "material_index", index);
  return !getmessage("trace", priorities[min((int)index, MATERIAL_SLOTS - 1)], value) || value[3] == 0.0;
}

/* Which media's dispersion a surface needs. */
#define CURVES_NONE 0       /* no light is split: only what moves the index of white light */
#define CURVES_DISPERSING 1 /* white light that may be split: only of media that split it */
#define CURVES_ALL 2        /* light with a wavelength, or about to get one */

/* How the medium's index changes with the wavelength. What a material does not use is not exported (see _requests in
 * addon/node_group.py) and keeps its default here. */
DispersionCurve hit_dispersion(int slot, int curves)
{
  string starts[MATERIAL_SLOTS] = SOCKETS("Disperse");
  string models[MATERIAL_SLOTS] = SOCKETS("Dispersion Model");
  string numbers[MATERIAL_SLOTS] = SOCKETS("Abbe");
  string strengths[MATERIAL_SLOTS] = SOCKETS("Sellmeier B");
  string resonances[MATERIAL_SLOTS] = SOCKETS("Sellmeier C");
  string spreads[MATERIAL_SLOTS] = SOCKETS("Dispersion");
  DispersionCurve d = {0, DISPERSION_ABBE, 0.0, vector(0.0), vector(0.0), 0.0};
  float value[4];
  if (getmessage("trace", starts[slot], value))
    d.disperses = value[0] > 0.0;
  if (!d.disperses && curves != CURVES_ALL)
    return d;
  if (getmessage("trace", models[slot], value))
    d.model = bounded((int)value[0], DISPERSION_MODEL_LIMITS);
  if (d.model == DISPERSION_JF && getmessage("trace", spreads[slot], value))
    d.spread = bounded(value[0], DISPERSION_LIMITS);
  if (curves == CURVES_NONE)
    return d;
  if (d.model == DISPERSION_ABBE && getmessage("trace", numbers[slot], value))
    d.abbe = bounded(value[0], ABBE_LIMITS);
  if (d.model == DISPERSION_SELLMEIER && getmessage("trace", strengths[slot], value)) {
    d.sellmeier_b = bounded(vector(value[0], value[1], value[2]), SELLMEIER_B_LIMITS);
    getmessage("trace", resonances[slot], value);
    d.sellmeier_c = bounded(vector(value[0], value[1], value[2]), SELLMEIER_C_LIMITS);
  }
  return d;
}

/* All of the medium that was hit last, of which hit_priority() told the priority and the slot. */
Medium hit_medium(float priority, output int slot, int curves, float wavelength, int scene)
{
  string iors[MATERIAL_SLOTS] = SOCKETS("IOR");
  string transmittances[MATERIAL_SLOTS] = SOCKETS("Transmittance");
  string depths[MATERIAL_SLOTS] = SOCKETS("Transmittance Depth");
  Medium m = air();
  m.priority = priority;
  if (slot == NO_SLOT)
    hit_slot(slot);
  if (slot >= 0) {
    float value[4];
    getmessage("trace", iors[slot], value);
    DispersionCurve d = hit_dispersion(slot, curves);
    float ior = bounded(value[0], IOR_LIMITS);
    m.ior = medium_index(ior, d, curves == CURVES_ALL || (curves != CURVES_NONE && d.disperses), wavelength);
    m.disperses = d.disperses;
    if (getmessage("trace", transmittances[slot], value)) {
      color left = color(value[0], value[1], value[2]);
      getmessage("trace", depths[slot], value);
      tint(m, left, value[0]);
      if (m.absorbs && getmessage("trace", SOCKET("0", "Absorbs by Volume"), value) && value[0] == scene) {
        m.absorbs = 0;
        m.by_volume = 1;
      }
    }
  }
  return m;
}
