"""Arithmetic on sockets."""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from ..model.parameter import LARGEST
from .shader_nodes import Socket, math_node


@dataclass(frozen=True)
class Number:
    """A number in a node tree, whose arithmetic makes Math nodes."""

    tree: bpy.types.NodeTree
    socket: Socket

    def math(self, operation: str, *others: Number | float, last: bool = False) -> Number:
        """Add a Math node of which this is the first operand, or the last if the others come first; return its result."""
        return self._of(operation, *others, self) if last else self._of(operation, self, *others)

    def _of(self, operation: str, *operands: Number | float) -> Number:
        sockets = (each.socket if isinstance(each, Number) else float(each) for each in operands)
        return Number(self.tree, math_node(self.tree, operation, *sockets))

    def __add__(self, other: Number | float) -> Number:
        return self.math("ADD", other)

    def __sub__(self, other: Number | float) -> Number:
        return self.math("SUBTRACT", other)

    def __mul__(self, other: Number | float) -> Number:
        return self.math("MULTIPLY", other)

    def __truediv__(self, other: Number | float) -> Number:
        return self.math("DIVIDE", other)

    def __radd__(self, other: float) -> Number:
        return self._of("ADD", other, self)

    def __rsub__(self, other: float) -> Number:
        return self._of("SUBTRACT", other, self)

    def __rmul__(self, other: float) -> Number:
        return self._of("MULTIPLY", other, self)

    def __rtruediv__(self, other: float) -> Number:
        return self._of("DIVIDE", other, self)

    def __gt__(self, other: Number | float) -> Number:
        return self.math("GREATER_THAN", other)

    def __lt__(self, other: Number | float) -> Number:
        return self.math("LESS_THAN", other)

    def __abs__(self) -> Number:
        return self.math("ABSOLUTE")

    def equals(self, other: Number | float) -> Number:
        """1 for the same whole number, else 0."""
        return self.math("COMPARE", other, 0.5)

    def bounded(self, limits: tuple[float, float, float], number: Number | None = None) -> Number:
        """Keep a number within the first two limits; take the third where `number`, which is itself unless given, is none.

        osl/bounds.h does the same. Minimum and Maximum whose first operand is a constant return it for NaN; no other node tells
        NaN reliably.
        """
        low, high, default = map(float, limits)
        tested = self if number is None else number
        usable = abs(tested.math("MAXIMUM", -LARGEST, last=True)) < LARGEST
        within = self.math("MAXIMUM", low, last=True).math("MINIMUM", high, last=True)
        return within * usable + default * (1.0 - usable)
