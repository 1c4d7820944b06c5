"""Light on its way to a surface of the native body."""

from __future__ import annotations

from functools import cached_property

import bpy

from ...model.contract import Exterior
from ..names import CENTRE
from ..numbers import Number
from ..shader_nodes import Socket, lazily, view_layer_attribute
from .part import NativePart

LARGEST_EXPONENT = 60.0
"""Largest exponent of what a shadow ray is given back; single precision takes a little more."""


class Light(NativePart):
    """What becomes of light on its way to the surface, and of shadow rays there."""

    NAME = "Light"

    def build(self) -> None:
        self.add_output("Arrives", "VECTOR", self.unless_clear(self.path_transmittance))
        self.add_output("Fall-Off", "FLOAT", self.fall_off)
        self.add_output("Shadow", "VECTOR", self.shadow)
        self.add_output("Shadow by Volume", "FLOAT", 1.0 - self.surfaces_absorb_shadows)

    def unless_clear(self, left: Socket) -> Socket:
        """Return what is left of light; white, with nothing computed, where no medium has a colour."""
        return lazily(self.tree, "VECTOR", self.clear.socket, left, (1.0, 1.0, 1.0))

    @cached_property
    def clear(self) -> Number:
        """1 where neither side has a colour, nor can have one."""
        red, green, blue = self.split(self.socket("Transmittance"), node="Color").values()
        white = red.math("MINIMUM", green).math("MINIMUM", blue) > 1.0 - 1e-9
        white = white.math("MAXIMUM", 1.0 - (self.raw("Transmittance Depth") > 0.0))
        return self.surely(white * self.is_surrounded_by_air)

    @cached_property
    def path_transmittance(self) -> Socket:
        """What media leave of light on its way here; volumes absorb of rays from the camera and from diffuse surfaces."""
        straight = self.path["Is Camera Ray"].math("MAXIMUM", self.path["Is Diffuse Ray"])
        length = self.path["Ray Length"] * (straight - 1.0)
        crossed = self.choose_vector(
            self.backfacing, self.socket("Outer Coefficients"), self.socket("Own Coefficients")
        )
        return self.exponential(self.scaled(crossed, length))

    @cached_property
    def surfaces_absorb_shadows(self) -> Number:
        """1 where surfaces take from shadow rays what media absorb, as nothing foreign stands in the media."""
        by_object = self.raw("Outside").equals(Exterior.BY_OBJECT)
        known = self.raw("Holds") * (1.0 - self.raw("Foreign Objects")) * (1.0 - by_object)
        return known * (Number(self.tree, self.centre.outputs["Alpha"]) > 0.5)

    @cached_property
    def centre(self) -> bpy.types.ShaderNodeAttribute:
        """The point that the ways of shadow rays are measured from."""
        return view_layer_attribute(self.tree, f'["{CENTRE}"]')

    @cached_property
    def shadow_transmittance(self) -> Socket:
        """What media leave of a shadow ray at this surface.

        Such a ray measures every hit from its own origin, so no surface knows how far it went in the medium that it leaves.
        But that is the difference of two distances along the ray, from a plane that all surfaces have in common: one charges
        the way to where the ray comes out, the other gives back the way to where it went in.
        """
        offset = self.vector("SUBTRACT", self.geometry["Position"], self.centre.outputs["Color"])
        distance = self.dot(offset, self.geometry["Incoming"])
        inner_less_outer = self.vector("SUBTRACT", self.socket("Own Coefficients"), self.socket("Outer Coefficients"))
        side = (2.0 * self.backfacing - 1.0) * distance * self.surfaces_absorb_shadows
        exponents = self.vector("MINIMUM", self.scaled(inner_less_outer, side), (LARGEST_EXPONENT,) * 3)
        return self.exponential(exponents)

    @cached_property
    def shadow(self) -> Socket:
        """What the surface leaves of a shadow ray, by Shadow Mode."""
        reflected = self.fresnel(normal=False)
        modes = {
            "BLACK": 0.0,
            "TRANSMISSION": 1.0,
            "OUTSIDE_FRESNEL": (1.0 - reflected * self.is_entrance).socket,
            "ALL_FRESNEL": (1.0 - reflected).socket,
        }
        return self.scaled(
            self.unless_clear(self.shadow_transmittance), Number(self.tree, self.menu("Shadow Mode", "FLOAT", modes))
        )

    @cached_property
    def fall_off(self) -> Number:
        """What is left of light on its way to a diffuse surface further off than the artist wants."""
        most = self.number("Caustic Max Distance")
        near = (1.0 - self.path["Ray Length"] / most).math("MAXIMUM", 0.0)
        fades = self.is_caustic * self.path["Is Diffuse Ray"] * (1.0 - (most < 0.0))
        return self.where(self.surely(most < 0.0), self.choose(fades, 1.0, near), 1.0)
