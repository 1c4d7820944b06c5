"""Roughness of the native body, as Cycles takes it."""

from __future__ import annotations

from ...model.contract import MOST_STRETCH
from .part import NativePart


class Tangents(NativePart):
    """The tangent that anisotropy refers to (Along), and the axis that it goes around (Axis), as in osl/lobe.h."""

    NAME = "Tangents"

    def build(self) -> None:
        given = self.socket("Tangent")
        has_tangent = self.length(given) > 0.0
        z = self.vector("NORMALIZE", self.to_world("VECTOR", "OBJECT", (0.0, 0.0, 1.0)))
        own = self.choose_vector(has_tangent, z, self.vector("NORMALIZE", given))
        bent = self.length(self.refracted_direction) > 0.0
        refraction = self.choose_vector(bent, self.ray_direction, self.refracted_direction)
        origin = self.to_world("POINT", "OBJECT", (0.0, 0.0, 0.0))
        around = self.vector("CROSS_PRODUCT", own, self.vector("SUBTRACT", self.geometry["Position"], origin))
        around = self.choose_vector(has_tangent, around, own)
        self.add_output(
            "Axis", "VECTOR", self.menu("Tangent From", "VECTOR", {"TANGENT": own, "REFRACTION": refraction})
        )
        chosen = self.menu("Tangent From", "VECTOR", {"TANGENT": around, "REFRACTION": refraction})
        along = self.across(chosen, self.geometry["Normal"])
        usable = self.length(along) > 1e-6
        self.add_output(
            "Along", "VECTOR", self.choose_vector(usable, self.geometry["Tangent"], self.vector("NORMALIZE", along))
        )


class Stretched(NativePart):
    """Roughness and anisotropy as Cycles takes them, made round where the normal points along the tangents' axis."""

    NAME = "Stretched"

    def build(self) -> None:
        alpha = self.raw("Alpha") * self.raw("Alpha")
        stretch = 1.0 - abs(self.raw("Stretch")).math("MINIMUM", MOST_STRETCH)
        least = alpha * stretch
        most = (alpha / stretch).math("MINIMUM", 1.0)
        blur = self.number("Blur Anisotropic Poles")
        pole = abs(self.dot(self.socket("Axis"), self.geometry["Normal"])).math("POWER", 1.0 / blur - 1.0) * (
            blur > 0.0
        )
        mean = (least * most).math("SQRT")
        least, most = self.choose(pole, least, mean), self.choose(pole, most, mean)
        self.add_output("Roughness", "FLOAT", (least * most).math("POWER", 0.25))
        ratio = (least / most.math("MAXIMUM", 1e-20)).math("SQRT")
        self.add_output("Anisotropy", "FLOAT", (1.0 - ratio) * self.raw("Stretch").math("SIGN"))
