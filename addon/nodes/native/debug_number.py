"""What debug views show of a surface of the native body, as the shader's osl/debug_view.h does."""

from __future__ import annotations

from functools import reduce

from ...model.contract import DEBUG_ALARM, DEBUG_HIDDEN, NO_PRIORITY, DebugView
from ..numbers import Number
from .part import NativePart


class DebugNumber(NativePart):
    """The number of the view that is on. No rays are sent; how many media hold the point is known in air alone."""

    NAME = "Debug Number"

    def build(self) -> None:
        exists = self.raw("Exists")
        behind = self.choose(self.backfacing, self.raw("Priority Inside"), self.raw("Priority Outside"))
        in_air = exists * self.raw("Priority Outside").equals(NO_PRIORITY)
        numbers = {
            DebugView.MEDIUM: self.choose(exists, DEBUG_HIDDEN, behind),
            DebugView.VALIDITY: exists,
            DebugView.DEPTH: in_air,
            DebugView.BODY: 1.0,
            DebugView.TOLD: self.raw("Told"),
        }
        view = abs(self.raw("Debug View"))
        number = reduce(Number.__add__, (view.equals(each) * value for each, value in numbers.items()))
        self.add_output("Debug Number", "FLOAT", self.choose(self.raw("Known"), DEBUG_ALARM, number))
