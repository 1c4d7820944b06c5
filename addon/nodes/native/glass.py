"""The native body's BSDFs."""

from __future__ import annotations

from ...model.parameters import BY_NAME
from ..numbers import Number
from ..shader_nodes import Socket, lazily
from .part import NativePart
from .roughness import Stretched, Tangents
from .weights import Weights


class Glass(NativePart):
    """Cycles' own Glass, where reflection and refraction are alike and isotropic."""

    NAME = "Glass"

    def build(self) -> None:
        values = {
            "Color": self.socket("Light"),
            "Roughness": self.socket("Shown Roughness"),
            "IOR": self.socket("Ratio"),
            "Normal": self.socket("Normal"),
            "Thin Film Thickness": self.number("Thin Film Thickness"),
            "Thin Film IOR": self.socket("Film IOR"),
        }
        found = {
            choice.keyword: self.bsdf("Glass", choice.keyword, values) for choice in BY_NAME["Distribution"].choices
        }
        self.add_output("BSDF", "SHADER", self.menu("Distribution", "SHADER", found))


class Special(NativePart):
    """Glass as far as reflection and refraction have the same weight, and the rest of each by itself.

    The rest takes the reflectance of the surface as a whole, which is exact where it is smooth.
    """

    NAME = "Special"

    def build(self) -> None:
        weights = self.call(Weights())
        reflected, refracted = (Number(self.tree, weights[name]) for name in ("Reflected", "Refracted"))
        alike = reflected.math("MINIMUM", refracted) * (1.0 - self.raw("Separate Reflection"))
        for name, socket in self.call(Tangents()).items():
            self.define(name, socket)
        self.stretched = Stretched()
        rough, anisotropy = self.stretch(self.raw("Shown Roughness"), self.number("Anisotropy"))
        shared = {"Normal": self.socket("Normal"), "Tangent": self.socket("Along")}
        glass = shared | {
            "Color": self.scaled(self.socket("Light"), alike),
            "Roughness": rough,
            "Anisotropy": anisotropy,
            "IOR": self.socket("Ratio"),
            "Thin Film Thickness": self.number("Thin Film Thickness"),
            "Thin Film IOR": self.socket("Film IOR"),
        }
        kinds = [choice.keyword for choice in BY_NAME["Distribution"].choices]
        both = self.menu("Distribution", "SHADER", {kind: self.bsdf("Glass", kind, glass) for kind in kinds})
        whole = self.fresnel(normal=True)
        mirror = shared | {"Color": self.scaled(self.socket("Light"), (reflected - alike) * whole)}
        refraction = {
            "Color": self.scaled(self.socket("Light"), (refracted - alike) * (1.0 - whole)),
            "Roughness": self.raw("Shown Roughness"),
            "IOR": self.socket("Ratio"),
            "Normal": self.socket("Normal"),
        }
        lens = {kind: self.bsdf("Refraction", kind.removeprefix("MULTI_"), refraction) for kind in kinds}
        rest = self.add(self.mirror(mirror, rough, anisotropy), self.menu("Distribution", "SHADER", lens))
        self.add_output("BSDF", "SHADER", self.add(both, rest))

    def stretch(self, roughness: Number, anisotropy: Number) -> tuple[Number, Number]:
        """Return roughness and anisotropy as Cycles takes them."""
        found = self.call(self.stretched, Alpha=roughness, Stretch=anisotropy)
        return Number(self.tree, found["Roughness"]), Number(self.tree, found["Anisotropy"])

    def mirror(self, values: dict[str, Socket], rough: Number, anisotropy: Number) -> Socket:
        """Return reflection alone, as rough as refraction is, or with a roughness of its own."""
        apart = self.raw("Separate Reflection")
        own_rough, own_anisotropy = self.stretch(
            self.number("Reflection Roughness"), self.number("Reflection Anisotropy")
        )
        values = values | {
            "Roughness": self.choose(apart, rough, own_rough),
            "Anisotropy": self.choose(apart, anisotropy, own_anisotropy),
        }
        kinds = [choice.keyword for choice in BY_NAME["Distribution"].choices]
        found = {kind: self.bsdf("Anisotropic", kind, values) for kind in kinds}
        separate = self.menu("Reflection Distribution", "SHADER", found)
        return lazily(self.tree, "SHADER", apart.socket, self.menu("Distribution", "SHADER", found), separate)
