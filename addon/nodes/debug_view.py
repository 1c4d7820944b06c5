"""What camera rays see of media while a debug view is on: a flat colour, or the number itself.

A scene's custom property says which view is on, and a view layer's own has precedence: Cycles reads both as a constant, and
folds everything here away while it is 0.
"""

from __future__ import annotations

from functools import reduce

import bpy

from ..model.contract import DEBUG_ALARM, DEBUG_HIDDEN, DebugView
from ..model.debug_views import ALARM, FIRST_HUE, HUE_RANGE, HUE_STEP, HUES, OPACITY, SATURATION, STEPS, VALUE, Step
from .names import DEBUG_GROUP
from .numbers import Number
from .parts import Part
from .shader_nodes import Socket

_WEAK = 2.0**-20
"""Strength of the emission, whose colour is the inverse times what shows: Cycles takes media for lights where it is above a
half. A power of two keeps every number to the last bit.
"""

_ROUNDING = 1e-4
"""Less than the binary logarithms of two numbers of rays differ by, and more than they are off."""


class DebugPicture(Part):
    """The picture of a view, and whether it shows.

    Inputs: Debug View, the code of the view, negative where numbers are to show in the place of colours; Look Through, how many
    surfaces are let through first; Debug Number, what the body that renders tells of the surface.
    """

    def __init__(self) -> None:
        super().__init__(DEBUG_GROUP, dict.fromkeys(("Debug View", "Look Through", "Debug Number"), "FLOAT"))
        self.view = abs(self.raw("Debug View"))
        self.number = self.raw("Debug Number")
        path = self.node("ShaderNodeLightPath")
        camera, passed = (Number(self.tree, path.outputs[name]) for name in ("Is Camera Ray", "Transparent Depth"))
        as_number = self.raw("Debug View") < 0.0
        validity = self.view.equals(DebugView.VALIDITY)
        hidden = self.number.equals(DEBUG_HIDDEN)
        shown = (passed > self.raw("Look Through") - 0.5) * (1.0 - hidden)
        veil = self.choose(self.number > 0.5, OPACITY[0], OPACITY[1])
        strength = shown * (1.0 - validity * (1.0 - as_number) * (1.0 - veil))
        number = self.choose(validity, self.number, 1.0 - self.number)
        colour = self.choose_vector(as_number, self.colour, self.join((number, number, number)))
        glow = self.node("ShaderNodeEmission")
        glow.inputs["Strength"].default_value = _WEAK
        self.tree.links.new(self.scaled(colour, strength * (1.0 / _WEAK)), glow.inputs["Color"])
        behind = 1.0 - strength * (1.0 - validity * as_number)
        clear = self.node("ShaderNodeBsdfTransparent")
        self.tree.links.new(self.join((behind, behind, behind)), clear.inputs["Color"])
        self.add_output("Surface", "SHADER", self.add(glow.outputs[0], clear.outputs[0]))
        self.add_output("Shows", "FLOAT", (self.view > 0.5) * camera)

    @property
    def colour(self) -> Socket:
        """The colour of the number: of the ramp's row, or of the priority."""
        rows, starts = _rows()
        alarm = self.number.equals(DEBUG_ALARM)
        places = [self.view.equals(view) * (self._step(view) + starts[view]) for view in STEPS]
        row = self.choose(alarm, reduce(Number.__add__, places), len(rows) - 1)
        ramp = self.node("ShaderNodeValToRGB")
        _set_stops(ramp.color_ramp, rows)
        self.tree.links.new(((row + 0.5) / len(rows)).socket, ramp.inputs[0])
        place = (self.number.math("FLOORED_MODULO", HUES) * HUE_STEP).math("FLOORED_MODULO", HUES) / HUES
        hue = (FIRST_HUE + place * HUE_RANGE).math("FRACT")
        medium = self.node("ShaderNodeCombineColor")
        medium.mode = "HSV"
        for value, socket in zip((hue.socket, SATURATION, VALUE), medium.inputs):
            if isinstance(value, float):
                socket.default_value = value
            else:
                self.tree.links.new(value, socket)
        is_medium = self.view.equals(DebugView.MEDIUM) * (self.number > -0.5)
        return self.choose_vector(is_medium, ramp.outputs["Color"], medium.outputs[0])

    def _step(self, view: DebugView) -> Number:
        """Return the row of the number among those of a view, as :func:`~nested_dielectric.model.debug_views.step_of` does."""
        step = self.number
        if view == DebugView.RAYS:
            power = self.number.math("MAXIMUM", 1.0).math("LOGARITHM", 2.0) + (1.0 + _ROUNDING)
            step = power.math("FLOOR") * (self.number > 0.5)
        return step.math("MAXIMUM", 0.0).math("MINIMUM", len(STEPS[view]) - 1)


def _rows() -> tuple[list[Step], dict[DebugView, int]]:
    """Return the steps of all views and then the alarm, and where those of each view begin."""
    rows: list[Step] = []
    starts = {}
    for view, steps in STEPS.items():
        starts[view] = len(rows)
        rows += steps
    return [*rows, ALARM], starts


def _set_stops(ramp: bpy.types.ColorRamp, rows: list[Step]) -> None:
    """Give a ramp a stripe of even width for each row."""
    ramp.interpolation = "CONSTANT"
    while len(ramp.elements) < len(rows):
        ramp.elements.new(1.0)
    for place, (element, row) in enumerate(zip(ramp.elements, rows)):
        element.position = place / len(rows)
        element.color = (*row.colour, 1.0)
