"""The look of a dielectric in EEVEE, which traces no ray through one medium into another.

Whatever stands in a medium has to stay in sight, so surfaces are clear. What lies on both sides is known as it is to Cycles
(:mod:`~nested_dielectric.nodes.native.body`): it makes reflections; the edges, which show the surroundings as they are
refracted; and the colour, which is exact along straight lines.
"""

from __future__ import annotations

from functools import cached_property

from .cut_faces import CUT_WITH_DISPERSION
from .native.coefficients import Coefficients
from .native.part import NativePart
from .native.surroundings import Surroundings
from .numbers import Number
from .shader_nodes import Socket, attribute, plug, view_layer_attribute

LEAST_CONTRAST = 1.1
"""Ratio of two indices that keeps ice in water in sight."""

MOST_OF_AIR = 1.05
WATER = 1.333
"""A body of less index than the first is a bubble. Whose surroundings nobody tells is shown as in a liquid of the second."""

EDGE_SHARPNESS = 1.6
"""How fast clearness gives way to refraction towards edges."""

EDGE_STRENGTH = 3.0
"""Of edges, by how far the ratio of both indices is from 1."""

NOWHERE = -1.0
"""Number of a scene in which no volume absorbs; that of LEFT_TO_SHADER is another."""

MOST_GIVEN_BACK = 3.0
"""Exponent of what a surface may give back of the colour of the medium that it displaces."""


class Preview(NativePart):
    """The shader that EEVEE shows."""

    NAME = "Preview"

    def __init__(self, surroundings: Surroundings, coefficients: Coefficients) -> None:
        self.surroundings = surroundings
        self.coefficients = coefficients
        super().__init__()

    def build(self) -> None:
        # EEVEE shows no volumes, so surfaces absorb, whoever does so in Cycles.
        outside = self.call(self.surroundings, Scene=NOWHERE, Cut=CUT_WITH_DISPERSION)
        for name in ("Outer Coefficients", "In Air"):
            self.define(name, outside[name])
        guess = 1.0 + (WATER - 1.0) * (self.number("IOR") < MOST_OF_AIR)
        self.define(
            "Outer IOR",
            self.choose(Number(self.tree, outside["Known"]), guess, Number(self.tree, outside["Outer IOR"])),
        )
        shown = self.mix(self.reflectance, self.mix(self.veil, self.clear, self.refraction), self.reflection)
        exists = Number(self.tree, outside["Exists"])
        self.add_output("Preview", "SHADER", self.mix(exists, self.node("ShaderNodeBsdfTransparent").outputs[0], shown))

    @cached_property
    def ratio(self) -> Number:
        """The ratio of the index inside to that outside."""
        return self.number("IOR") / self.raw("Outer IOR")

    @cached_property
    def contrast(self) -> Number:
        """The ratio of the larger index to the smaller one, at least so much that the surface can be seen."""
        return self.ratio.math("MAXIMUM", 1.0 / self.ratio).math("MAXIMUM", LEAST_CONTRAST)

    @cached_property
    def reflectance(self) -> Number:
        """The reflectance of a smooth surface (Fresnel 1823).

        It may be total where a ray enters a thinner medium, as a bubble. Where a ray leaves one, the straight way, which no ray
        takes, would show total reflection that is not there.
        """
        node = self.node("ShaderNodeFresnel")
        thinner = 1.0 / self.contrast
        met = self.choose((self.ratio < 1.0).math("MAXIMUM", self.backfacing), self.contrast, thinner)
        plug(self.tree, met.socket, node.inputs["IOR"])
        self.tree.links.new(self.shading_normal, node.inputs["Normal"])
        return Number(self.tree, node.outputs[0])

    @cached_property
    def veil(self) -> Number:
        """How far refraction hides what stands behind: towards edges, and where the surface is rough."""
        facing = abs(self.dot(self.shading_normal, self.geometry["Incoming"])).math("MINIMUM", 1.0)
        edge = (1.0 - facing).math("POWER", EDGE_SHARPNESS)
        strength = ((self.contrast - 1.0) * EDGE_STRENGTH).math("MINIMUM", 1.0)
        veil = strength * edge.math("MAXIMUM", (2.0 * self.number("Roughness")).math("MINIMUM", 1.0))
        return veil.math("MAXIMUM", self.traces)

    @cached_property
    def traces(self) -> Number:
        """1 where EEVEE traces what is refracted, as the artist has switched on in the material and in the scene."""
        scene = Number(self.tree, view_layer_attribute(self.tree, "eevee.use_raytracing").outputs["Fac"])
        material = attribute(self.tree, "OBJECT", "active_material.use_raytrace_refraction").outputs["Fac"]
        return (scene * Number(self.tree, material) > 0.5) * self.is_entrance

    @cached_property
    def exponents(self) -> Socket:
        """Exponents of what the media leave of light, for this surface's share of the way through them.

        The way through a medium is the difference of two distances along the line of sight, from a plane through the middle
        of the object; each surface takes or gives back its own.
        """
        middle = attribute(self.tree, "OBJECT", "data.texspace_location").outputs["Vector"]
        place = self.vector("SUBTRACT", self.node("ShaderNodeTexCoord").outputs["Object"], middle)
        along = self.dot(self.to_world("VECTOR", "OBJECT", place), self.geometry["Incoming"])
        own = self.call(self.coefficients, Depth=self.number("Transmittance Depth"))["Coefficients"]
        inner_less_outer = self.vector("SUBTRACT", own, self.socket("Outer Coefficients"))
        return self.scaled(inner_less_outer, (2.0 * self.backfacing - 1.0) * along)

    @cached_property
    def clear(self) -> Socket:
        """A surface that bends nothing, in the colour of this surface's share of the way."""
        node = self.node("ShaderNodeBsdfTransparent")
        left = self.exponential(self.vector("MINIMUM", self.exponents, (MOST_GIVEN_BACK,) * 3))
        self.tree.links.new(left, node.inputs["Color"])
        return node.outputs[0]

    @cached_property
    def refraction(self) -> Socket:
        """The refracted world; its colour is that of the way through a body that is as deep behind its middle as before it."""
        left = self.exponential(self.vector("MINIMUM", self.scaled(self.exponents, 2.0), (0.0, 0.0, 0.0)))
        return self._lobe("Refraction", Color=left, IOR=self.ratio)

    @cached_property
    def reflection(self) -> Socket:
        """The reflected world."""
        return self._lobe("Anisotropic", Color=(1.0, 1.0, 1.0, 1.0))

    def _lobe(self, kind: str, **values: Socket | Number | tuple[float, ...]) -> Socket:
        """Add a BSDF node as rough as the surface, with its normal."""
        return self.bsdf(kind, "GGX", values | {"Roughness": self.number("Roughness"), "Normal": self.shading_normal})
