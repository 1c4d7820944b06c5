"""Factors on what a surface of the native body reflects and refracts."""

from __future__ import annotations

from functools import cached_property

from ...model.parameter import UNLIMITED_REFLECTIONS
from ..numbers import Number
from ..shader_nodes import Socket, plug
from .part import NativePart

FAR = 1e30
"""Length of a ray that ends nowhere, in scene units."""


class Weights(NativePart):
    """Factors on reflection and on refraction, by the switches, the scales and the polarizing filter."""

    NAME = "Weights"

    def build(self) -> None:
        reflected, refracted = self.polarizer_factors
        self.add_output("Reflected", "FLOAT", reflected * self.reflected)
        self.add_output("Refracted", "FLOAT", refracted * self.refracted)

    @cached_property
    def is_total_reflection(self) -> Number:
        """1 where nothing is refracted."""
        return 1.0 - (self.fresnel(normal=True) < 1.0)

    @cached_property
    def comes_from_medium(self) -> Number:
        """1 where the ray comes from a medium."""
        return (1.0 - self.raw("In Air")).math("MAXIMUM", self.backfacing)

    @cached_property
    def reflected(self) -> Number:
        """Factor on reflection, but for the filter."""
        weak = self.comes_from_medium * (1.0 - self.is_total_reflection)
        off = weak * (1.0 - self.raw("Internal Reflections") * self.unless_caustic("Caustic Internal Reflections"))
        most = self.number("Max Interior Reflections")
        deep = (
            self.comes_from_medium * (most < UNLIMITED_REFLECTIONS - 0.5) * (1.0 - (self.path["Glossy Depth"] < most))
        )
        left = self.number("Specular Scale") * (1.0 - off.math("MAXIMUM", deep))
        left = left * (1.0 - self.is_total_reflection * (1.0 - self.unless_caustic("Caustic Total Reflection")))
        outside = 1.0 - self.comes_from_medium
        left = left * (1.0 - outside * (1.0 - self.unless_caustic("Caustic Reflection")))
        return left * self.world_factor(
            "Reflect Sky", outside, self.vector("REFLECT", self.ray_direction, self.shading_normal)
        )

    @cached_property
    def refracted(self) -> Number:
        """Factor on refraction, but for the filter."""
        left = self.number("Refraction Scale") * self.unless_caustic("Caustic Refraction")
        return left * self.world_factor(
            "Refract Sky", self.is_exit * (1.0 - self.is_total_reflection), self.refracted_direction
        )

    def unless_caustic(self, name: str) -> Number:
        """Return 0 where a switch leaves out light on its way to a diffuse surface."""
        return 1.0 - self.is_caustic * (1.0 - self.raw(name))

    def world_factor(self, name: str, looks: Number, direction: Socket) -> Number:
        """Return 0 where a switch leaves out the world that a ray meets; `looks` is 0 where the switch does not matter."""
        node = self.node("ShaderNodeRaycast")
        for socket, value in (
            ("Position", self.geometry["Position"]),
            ("Direction", direction),
            ("Length", (looks * FAR).socket),
        ):
            plug(self.tree, value, node.inputs[socket])
        met = Number(self.tree, node.outputs["Is Hit"]).math("MAXIMUM", 1.0 - looks)
        return self.where(self.surely(self.raw(name)), self.choose(self.raw(name), met, 1.0), 1.0)

    @cached_property
    def polarizer_factors(self) -> tuple[Number, Number]:
        """Factors of a filter before the camera on reflection and refraction, as in osl/fresnel.h."""
        angle = self.number("Polarization Angle")
        vertical = self.join((angle.math("SINE"), angle.math("COSINE"), 0.0))
        towards = self.geometry["Incoming"]
        filtered = self.across(self.to_world("VECTOR", "CAMERA", vertical), towards)
        plane = self.across(self.shading_normal, towards)
        within = self.dot(filtered, plane)
        within = within * within / (self.dot(filtered, filtered) * self.dot(plane, plane)).math("MAXIMUM", 1e-20)
        cosine = self.dot(towards, self.shading_normal).math("MAXIMUM", 0.0).math("MINIMUM", 1.0)
        square = self.eta * self.eta
        g = (square - 1.0 + cosine * cosine).math("MAXIMUM", 0.0).math("SQRT")
        rs = (cosine - g) / (cosine + g)
        rp = (square * cosine - g) / (square * cosine + g)
        rs, rp = rs * rs, rp * rp
        whole = 0.5 * (rs + rp)
        left = self.choose(within.math("MINIMUM", 1.0), rs, rp)
        filters = self.path["Is Camera Ray"] * self.raw("Polarize")
        none = self.surely(1.0 - self.raw("Polarize"))
        factors = (left / whole.math("MAXIMUM", 1e-12), (1.0 - left) / (1.0 - whole).math("MAXIMUM", 1e-12))
        return tuple(self.where(none, self.choose(filters, 1.0, factor), 1.0) for factor in factors)
