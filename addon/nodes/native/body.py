"""The dielectric in Cycles' own nodes: the second body of the group `Nested Dielectric`, for all devices.

It traces no rays to find out what lies outside a surface: an analysis of the scene has stored it, or the faces themselves
where surfaces are cut. Then a surface is Cycles' own Glass with the ratio of both indices. A surface without either is magenta.

Whatever a material does not use is left out before an engine sees it (:func:`~nested_dielectric.nodes.shader_nodes.lazily`).
Names are those of osl/nested_dielectric.osl, which does the same.
"""

from __future__ import annotations

from functools import cached_property

import bpy

from ...model.contract import INDEX_NEARLY_MATCHED, DispersionModel
from ...model.dispersion import LINE_D, jf_ior
from ...model.parameter import PRIORITY_PROPERTY, UNLIMITED_REFLECTIONS
from ..compatibility import NATIVE_DISPERSION_VERSION
from ..numbers import Number
from ..shader_nodes import Socket, attribute, lazily
from .coefficients import Coefficients
from .debug_number import DebugNumber
from .dispersing import Dispersing
from .glass import Glass, Special
from .light import Light
from .part import NativePart
from .surroundings import Surroundings

_SWITCHES = (
    "Refract Sky",
    "Reflect Sky",
    "Internal Reflections",
    "Caustic Refraction",
    "Caustic Reflection",
    "Caustic Total Reflection",
    "Caustic Internal Reflections",
)
"""Switches that give reflection and refraction different weights where they are off."""

_SMOOTH_CHANGE = 0.6 * INDEX_NEARLY_MATCHED
"""Relative change of index up to which a rough surface shows smooth: facets of 45 degrees bend light by 0.34 degrees there."""

_ROUGHENING = INDEX_NEARLY_MATCHED - _SMOOTH_CHANGE
"""Change over which it gets as rough as it is."""


class NativeBody(NativePart):
    """The native body.

    Its outputs are Surface; Shadow by Volume, which is 1 where the material's volume has to absorb for shadow rays; and those
    that the artist's own nodes may read, by the names of the group's.
    """

    def build(self) -> None:
        coefficients = self.coefficients = Coefficients()
        self.surroundings = Surroundings(coefficients)
        outside = self.call(self.surroundings)
        for name in ("Face", "In Air", "Outer IOR", "Outer Coefficients"):
            self.define(name, outside[name])
        self._define_own(coefficients)
        light = self.call(Light())
        self.define("Light", self.scaled(light["Arrives"], Number(self.tree, light["Fall-Off"])))
        dark = self.node("ShaderNodeBsdfTransparent")
        self.tree.links.new(light["Shadow"], dark.inputs["Color"])
        seen = self.mix(self.path["Is Shadow Ray"], self.add(self.body, self.emission), dark.outputs[0])
        known, exists, shows = (Number(self.tree, outside[name]) for name in ("Known", "Exists", "Shows"))
        alarm = self.node("ShaderNodeBsdfDiffuse")
        alarm.inputs["Color"].default_value = (1.0, 0.0, 1.0, 1.0)
        other = self.mix(known, alarm.outputs[0], self.node("ShaderNodeBsdfTransparent").outputs[0])
        self.add_output("Surface", "SHADER", self.mix(shows, other, seen))
        self.add_output("Shadow by Volume", "FLOAT", light["Shadow by Volume"])
        self.add_output("Surface Exists", "FLOAT", exists)
        self.add_output("Is Entrance", "FLOAT", exists * self.is_entrance)
        self.add_output("Is Exit", "FLOAT", exists * self.is_exit)
        own = attribute(self.tree, "OBJECT", PRIORITY_PROPERTY)
        has_own = Number(self.tree, own.outputs["Alpha"]) > 0.5
        inside = self.choose(has_own, self.raw("Priority"), Number(self.tree, own.outputs["Fac"]))
        self.add_output("Priority Inside", "FLOAT", inside)
        self.add_output("Priority Outside", "FLOAT", outside["Priority Outside"])
        debug_facts = {name: outside[name] for name in ("Known", "Exists", "Told", "Priority Outside")}
        debug_number = self.call(DebugNumber(), **debug_facts, **{"Priority Inside": inside})
        self.add_output("Debug Number", "FLOAT", debug_number["Debug Number"])
        white = self.join((1.0, 1.0, 1.0))
        self.add_output("Arriving Light", "COLOR", self.choose_vector(exists, white, light["Arrives"]))

    def _define_own(self, coefficients: Coefficients) -> None:
        """Define what follows from the material's own numbers and from what lies outside."""
        # A medium of JF's that splits no light has its index as it was typed.
        offset = (
            self.number("Dispersion")
            * jf_ior(0.0, 1.0, LINE_D)
            * self.raw("Dispersion Model").equals(DispersionModel.JF)
            * self.raw("Disperse")
        )
        self.define("Own IOR", self.number("IOR") + offset)
        self.define("Ratio", self.raw("Own IOR") / self.raw("Outer IOR"))
        no_film = self.surely(self.number("Thin Film Thickness") < 1e-9)
        self.define("Film IOR", self.where(no_film, self.number("Thin Film IOR") / self.raw("Outer IOR"), 1.0))
        own = self.call(coefficients, Depth=self.number("Transmittance Depth"))["Coefficients"]
        self.define("Own Coefficients", self.scaled(own, 1.0 - self.raw("By Volume")))
        # Glass gains and loses light between nearly equal indices (osl/closures.h), and a node cannot draw a normal.
        change = abs(self.raw("Ratio") - 1.0)
        differs = change.math("MULTIPLY_ADD", 1.0 / _ROUGHENING, -_SMOOTH_CHANGE / _ROUGHENING)
        differs.socket.node.use_clamp = True
        rough = self.number("Roughness")
        self.define("Shown Roughness", self.where(self.surely(rough < 1e-9), rough * differs, 0.0))

    @cached_property
    def body(self) -> Socket:
        """What is seen of the surface."""
        plain = self.call(Glass())["BSDF"]
        ordinary = lazily(self.tree, "SHADER", self.surely(self.is_plain).socket, self.call(Special())["BSDF"], plain)
        if bpy.app.version < NATIVE_DISPERSION_VERSION:
            return ordinary
        dispersing = self.call(Dispersing())
        splits = self.mix(Number(self.tree, dispersing["Disperses"]), ordinary, dispersing["BSDF"])
        never = self.surely(self.is_surrounded_by_air * (1.0 - self.raw("Disperse")))
        return lazily(self.tree, "SHADER", never.socket, splits, ordinary)

    @cached_property
    def is_plain(self) -> Number:
        """1 where reflection and refraction are alike and isotropic."""
        departures = [
            abs(self.raw("Refraction Scale") - 1.0),
            abs(self.raw("Anisotropy")),
            self.raw("Separate Reflection"),
            self.raw("Polarize"),
            UNLIMITED_REFLECTIONS - self.raw("Max Interior Reflections"),
            *(1.0 - self.raw(name) for name in _SWITCHES),
        ]
        return sum(departures, abs(self.raw("Specular Scale") - 1.0)) < 1e-9

    @cached_property
    def emission(self) -> Socket:
        """The artist's shaders, dimmed by the mean of what media leave of light."""
        everywhere, entrance, leaving = (
            self.socket(f"Emission at {place}") for place in ("Interfaces", "Entrances", "Exits")
        )
        shone = self.add(
            everywhere, self.add(self.mix(self.is_entrance, None, entrance), self.mix(self.is_exit, None, leaving))
        )
        return self.mix(self.dot(self.socket("Light"), self.join((1.0 / 3.0,) * 3)), None, shone)
