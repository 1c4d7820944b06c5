"""What a table of media says of each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .absorption import Term
from .indices import Index

BUBBLE, SOLID, ICE, FLOATING, LIQUID = 0, 10, 20, 25, 30
"""Priorities, of which the lowest wins. A bubble is cut out of whatever it is in. Glass, gems and plastics keep their shape
in every liquid, so a liquid may overlap the vessel that holds it. Ice wins over the drink it floats in but not over the glass
it touches. Oil wins over the water that it floats on: the surface between them is then the oil's own underside.
"""


@dataclass(frozen=True)
class Recipe:
    """One medium.

    :param key: the file's name.
    :param name: the material's name.
    :param tags: words by which artists look for it, in one string with commas.
    :param description: what it is, in a sentence.
    :param source: where its numbers come from; says in plain words what has no published data.
    :param depth: the way through it at which people know its colour, metres.
    :param absorption: what takes its light away; nothing is colourless.
    :param others: further parameters, by keyword.
    """

    key: str
    name: str
    group: str
    tags: str
    description: str
    source: str
    index: Index
    priority: int = SOLID
    depth: float = 0.0
    absorption: tuple[Term, ...] = ()
    disperse: bool = False
    others: tuple[tuple[str, Any], ...] = ()
