"""The native body's absorption coefficients."""

from __future__ import annotations

from math import e

from .part import NativePart

BLACK_COEFFICIENT = 1e4
"""Coefficient of a colour of which nothing is left after Transmittance Depth, times that depth."""


class Coefficients(NativePart):
    """Absorption coefficients of a medium, of three colours per length (Beer 1852); 0 without a depth."""

    NAME = "Coefficients"

    def build(self) -> None:
        found = []
        for left in self.split(self.socket("Transmittance"), node="Color").values():
            decay = left.math("MAXIMUM", 1e-38, last=True).math("MINIMUM", 1.0, last=True).math("LOGARITHM", e) * -1.0
            found.append(decay + (left < 1e-37) * BLACK_COEFFICIENT)
        self.add_output(
            "Coefficients",
            "VECTOR",
            self.scaled(self.join(found), 1.0 / self.raw("Depth").math("MAXIMUM", 0.0, last=True)),
        )
