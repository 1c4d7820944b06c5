"""The native body's dispersion."""

from __future__ import annotations

from ...model.contract import CUT_CURVE, CUT_SELLMEIER_B, CUT_SELLMEIER_C, CUT_SPLITS, RATIO_MARGIN
from ...model.dispersion import LINE_C, LINE_D, LINE_F, jf_ior
from ...model.enumerations import DISPERSION_MODELS
from ..cut_faces import CUT_WITH_DISPERSION
from ..numbers import Number
from ..shader_nodes import attribute
from .part import NativePart

_F_REACH, _C_REACH = ((line**-2 - LINE_D**-2) / (LINE_F**-2 - LINE_C**-2) for line in (LINE_F, LINE_C))
"""How far an index at these lines is from that at the d line, in its spread between them, by Cauchy's two terms (1836)."""


class Spread(NativePart):
    """The difference of an index at the F line and at the C line, as in osl/dispersion.h."""

    NAME = "Spread"

    def build(self) -> None:
        abbe = self.raw("Abbe").math("MAXIMUM", 0.0, last=True)
        spreads = {
            "ABBE": (self.raw("IOR") - 1.0) / abbe,
            "SELLMEIER": self.sellmeier(LINE_F) - self.sellmeier(LINE_C),
            "JF": self.raw("Dispersion") * (jf_ior(0.0, 1.0, LINE_F) - jf_ior(0.0, 1.0, LINE_C)),
        }
        found = [
            spreads[choice.keyword] * self.raw("Dispersion Model").equals(index)
            for index, choice in enumerate(DISPERSION_MODELS)
        ]
        self.add_output("Spread", "FLOAT", found[0] + found[1] + found[2])

    def sellmeier(self, wavelength: float) -> Number:
        """Return the index at a wavelength in nm by Sellmeier's formula (1872)."""
        square = (wavelength * wavelength * 1e-6,) * 3
        terms = self.vector("DIVIDE", square, self.vector("SUBTRACT", square, self.socket("Sellmeier C")))
        return (1.0 + self.dot(self.socket("Sellmeier B"), terms)).math("MAXIMUM", 0.0).math("SQRT")


class Dispersing(NativePart):
    """Cycles' own dispersion, of the ratio of both indices (Principled).

    That node tints refraction alone, by the root of its colour: so the brightest channel of light that arrives weighs all.
    """

    NAME = "Dispersing"

    def build(self) -> None:
        spread = Spread()
        curve = self.split(
            attribute(self.tree, "GEOMETRY", CUT_CURVE).outputs["Vector"], ("model", "Abbe", "Dispersion")
        )
        starts = curve["model"] > CUT_SPLITS - 0.5
        tells = (self.raw("Face") < 0.0) * (self.raw("Cut") > CUT_WITH_DISPERSION - 0.5)
        sellmeier = {
            name: attribute(self.tree, "GEOMETRY", stored).outputs["Vector"]
            for name, stored in (("Sellmeier B", CUT_SELLMEIER_B), ("Sellmeier C", CUT_SELLMEIER_C))
        }
        given = sellmeier | {"IOR": self.raw("Outer IOR"), "Dispersion Model": curve["model"] - starts * CUT_SPLITS}
        outer = Number(self.tree, self.call(spread, **given | curve)["Spread"]) * tells
        inner = Number(self.tree, self.call(spread)["Spread"])
        left_out = self.is_manifold_walk.math("MAXIMUM", self.is_caustic) * (1.0 - self.raw("Caustic Dispersion"))
        self.add_output("Disperses", "FLOAT", self.raw("Disperse").math("MAXIMUM", starts * tells) * (1.0 - left_out))
        at_f, at_c = (
            (self.raw("Own IOR") + inner * reach) / (self.raw("Outer IOR") + outer * reach)
            for reach in (_F_REACH, _C_REACH)
        )
        ratio = self.choose(abs(self.raw("Ratio") - 1.0) < RATIO_MARGIN, self.raw("Ratio"), 1.0 + RATIO_MARGIN)
        red, green, blue = self.split(self.socket("Light")).values()
        brightest = red.math("MAXIMUM", green).math("MAXIMUM", blue)
        colour = self.scaled(self.socket("Light"), 1.0 / brightest)
        values = {
            "Base Color": self.vector("MULTIPLY", colour, colour),
            "Roughness": self.raw("Shown Roughness"),
            "IOR": ratio,
            "Normal": self.socket("Normal"),
            "Transmission Weight": 1.0,
            "Transmission Dispersion Scale": 1.0,
            "Transmission Dispersion Abbe Number": ((ratio - 1.0) / (at_f - at_c)).math("MAXIMUM", 0.0),
            "Thin Film Thickness": self.number("Thin Film Thickness"),
            "Thin Film IOR": self.raw("Film IOR"),
        }
        found = {kind: self.bsdf("Principled", kind, values) for kind in ("GGX", "MULTI_GGX")}
        shown = self.menu("Distribution", "SHADER", found | {"BECKMANN": found["GGX"]})
        self.add_output("BSDF", "SHADER", self.mix(brightest, None, shown))
