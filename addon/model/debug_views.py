"""Debug views: what they show of a surface, as a number and as a colour with words; pure.

The shader and the native body make the number of a view, :mod:`nodes.debug_view` its colour, and legends the words beside it.
"""

from __future__ import annotations

import colorsys
import math
from dataclasses import dataclass

from .choice import Choice
from .contract import TOLD_BY_FACE, DebugView, Exterior

Colour = tuple[float, float, float]
"""Red, green and blue that a picture holds: linear, in the scene's own space."""

VIEWS = (
    Choice("NONE", "None", "Media as they are"),
    Choice(
        "MEDIUM", "Medium", "The medium behind each surface by its priority; surfaces that do not exist are not there"
    ),
    Choice(
        "VALIDITY", "Validity", "Surfaces that exist, and those inside a winner, which do not; all of them let through"
    ),
    Choice("DEPTH", "Depth", "How many media hold the point just inside the surface, its own among them"),
    Choice(
        "RAYS",
        "Rays",
        "How many rays the shader sends to find out what lies outside the surface, apart from spot checks",
    ),
    Choice("BODY", "Body", "Which of both bodies renders the surface: the shader or Cycles' own nodes"),
    Choice("TOLD", "Told", "What is told of the surface's exterior, and so need not be asked"),
)
"""By the places that :class:`~nested_dielectric.model.contract.DebugView` numbers."""


@dataclass(frozen=True)
class Step:
    """One row of a legend: a colour and what it means."""

    colour: Colour
    words: str


GREY: Colour = (0.125, 0.125, 0.125)
GREEN: Colour = (0.125, 0.75, 0.25)
RED: Colour = (0.875, 0.0625, 0.0625)
BLUE: Colour = (0.125, 0.375, 0.875)
YELLOW: Colour = (0.875, 0.75, 0.125)
CYAN: Colour = (0.125, 0.75, 0.75)
MAGENTA: Colour = (1.0, 0.0, 1.0)

_RISING: tuple[Colour, ...] = (
    (0.0625, 0.125, 0.625),
    (0.0625, 0.375, 0.75),
    (0.0625, 0.625, 0.5),
    (0.25, 0.75, 0.125),
    (0.75, 0.75, 0.0625),
    (0.875, 0.5, 0.0625),
    (0.875, 0.1875, 0.0625),
    (1.0, 1.0, 1.0),
)
"""From few to many."""

MOST_DEPTH = len(_RISING)
"""Media from which on depths look alike."""

ALARM = Step(MAGENTA, "Alarm: not told, or wrongly")

AIR = Step(GREY, "Air")

STEPS: dict[DebugView, tuple[Step, ...]] = {
    DebugView.MEDIUM: (AIR,),
    DebugView.VALIDITY: (Step(RED, "Does not exist"), Step(GREEN, "Exists")),
    DebugView.DEPTH: (
        Step(GREY, "Not known: told, or cut"),
        *(Step(colour, f"{1 + place}") for place, colour in enumerate(_RISING[:-1])),
        Step(_RISING[-1], f"{MOST_DEPTH} or more"),
    ),
    DebugView.RAYS: (
        Step(GREY, "None: told"),
        *(
            Step(colour, f"{2**place} to {2 ** (place + 1) - 1}" if place else "1")
            for place, colour in enumerate(_RISING[:-1])
        ),
        Step(_RISING[-1], f"{2**7} or more"),
    ),
    DebugView.BODY: (Step(BLUE, "The shader (OSL)"), Step(YELLOW, "Cycles' own nodes")),
    DebugView.TOLD: (
        Step(RED, "Nothing: asks the scene"),
        Step(CYAN, "Air outside"),
        Step(GREEN, "One medium outside"),
        Step(GREY, "A winner: does not exist"),
        Step(YELLOW, "By the face: cut"),
    ),
}
"""Rows of each view's legend; media have rows of their own, by their priorities."""

assert len(STEPS[DebugView.TOLD]) == TOLD_BY_FACE + 1 and Exterior.WINNER < TOLD_BY_FACE

HUES = 89
"""Priorities after which colours repeat."""

HUE_STEP = 55
"""Of those hues between one priority and the next: both are Fibonacci numbers, so that near priorities look different."""

FIRST_HUE, HUE_RANGE = 0.9, 0.85
"""What the hues begin at and how far they go, in parts of the circle: magenta is the alarm's."""

SATURATION, VALUE = 0.9375, 0.75

OPACITY = {0: 0.5, 1: 0.25}
"""How much of what is behind a surface its colour covers in the view of validity: of one that does not exist, and that does."""


def medium_colour(priority: float) -> Colour:
    """Return the colour of the media of a priority, which count as one."""
    place = priority % HUES * HUE_STEP % HUES / HUES
    return colorsys.hsv_to_rgb((FIRST_HUE + HUE_RANGE * place) % 1.0, SATURATION, VALUE)


def step_of(view: DebugView, number: float) -> int:
    """Return the row of :data:`STEPS` that shows a number of a view, other than a priority."""
    if view == DebugView.RAYS and number > 0:
        number = 1 + math.floor(math.log2(number))
    return min(max(int(number), 0), len(STEPS[view]) - 1)
