/* Reading the medium that the object hit last by trace() is made of.
 *
 * Cycles evaluates paths of RNA on the evaluated object, so a neighbour's keyframed or driven socket is read as it is at
 * the rendered frame and nothing of the extension is needed. The fourth component tells a value (1) from a missing path
 * (0). What a material does not use is not exported (addon/nodes/requests.py) and keeps its default here. */
#pragma once

#include "medium.h"

#define NO_SLOT -1
/* The object has got a second slot since the analysis, or its dielectric stands beyond MATERIAL_SLOTS: it cannot be read. */
#define UNREADABLE_SLOT -2

/* Priority of the material's that fills the object. That is the nested dielectric of the face that was hit. A face with
 * another material, such as a label on a bottle, closes the object's surface all the same: it counts as the first
 * dielectric of the object. AIR_PRIORITY if the object has no nested dielectric.
 *
 * SECOND_SLOT: an object without any material there needs no look at the face that was hit, and what its material exports
 * is that of the first slot alone, if the scene was analysed. */
float hit_material_priority(output int slot)
{
  string priorities[MATERIAL_SLOTS] = SOCKETS(PRIORITY_SOCKET);
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
  slot = NO_SLOT + (UNREADABLE_SLOT - NO_SLOT) * (index >= MATERIAL_SLOTS);
  return AIR_PRIORITY;
}

/* Whether the shaded face has its material from a slot in which neighbours do not look. */
int stands_beyond_slots()
{
  float index = 0.0;
  getattribute("material_index", index);
  return index >= MATERIAL_SLOTS;
}

/* Priority of the medium; AIR_PRIORITY if the object is foreign. The object's own value, where it has one, overrides the
 * material's; the slot is then not looked for yet and NO_SLOT. */
float hit_priority(output int slot)
{
  float value[4];
  slot = NO_SLOT;
  if (!getmessage("trace", OBJECT_PRIORITY, value))
    return AIR_PRIORITY; /* no material on it asks for the property: not a medium */
  return is_priority(value) ? value[0] : hit_material_priority(slot);
}

/* Whether the face, of a medium, has a material that is none, such as a label. */
int hit_is_label()
{
  string priorities[MATERIAL_SLOTS] = SOCKETS(PRIORITY_SOCKET);
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

/* How the medium's index changes with the wavelength. */
DispersionCurve hit_dispersion(int slot, int curves)
{
  string starts[MATERIAL_SLOTS] = SOCKETS(DISPERSE_SOCKET);
  string models[MATERIAL_SLOTS] = SOCKETS(DISPERSION_MODEL_SOCKET);
  string numbers[MATERIAL_SLOTS] = SOCKETS(ABBE_SOCKET);
  string strengths[MATERIAL_SLOTS] = SOCKETS(SELLMEIER_B_SOCKET);
  string resonances[MATERIAL_SLOTS] = SOCKETS(SELLMEIER_C_SOCKET);
  string spreads[MATERIAL_SLOTS] = SOCKETS(DISPERSION_SOCKET);
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

/* All of the medium, of which hit_priority() told the priority and the slot. `scene`: the number of the one that is
 * rendered, whose volumes may absorb for all rays. */
Medium hit_medium(float priority, output int slot, int curves, float wavelength, int scene)
{
  string iors[MATERIAL_SLOTS] = SOCKETS(IOR_SOCKET);
  string transmittances[MATERIAL_SLOTS] = SOCKETS(TRANSMITTANCE_SOCKET);
  string depths[MATERIAL_SLOTS] = SOCKETS(TRANSMITTANCE_DEPTH_SOCKET);
  Medium m = air();
  m.priority = priority;
  if (slot == NO_SLOT)
    hit_material_priority(slot);
  if (slot >= 0) {
    float value[4];
    getmessage("trace", iors[slot], value);
    DispersionCurve d = hit_dispersion(slot, curves);
    float ior = bounded(value[0], IOR_LIMITS);
    m.ior = dispersive_ior(ior, d, curves == CURVES_ALL || (curves != CURVES_NONE && d.disperses), wavelength);
    m.disperses = d.disperses;
    if (getmessage("trace", transmittances[slot], value)) {
      color transmittance = color(value[0], value[1], value[2]);
      getmessage("trace", depths[slot], value);
      set_absorption(m, transmittance, value[0]);
      if (m.absorbs && getmessage("trace", SOCKET("0", ABSORBS_BY_VOLUME_SOCKET), value) && value[0] == scene) {
        m.absorbs = 0;
        m.by_volume = 1;
      }
    }
  }
  return m;
}
