"""How far functions of the shader's headers are from the same in double precision."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from osl_values import NO_NUMBER, evaluate

ROUNDING = 2.0**-24
"""Largest relative error of one rounding to single precision."""

STEP = 2.0**-22
"""Relative change of an input by which its influence is measured: so few roundings that what lies within them of a jump, such
as the angle of total reflection, counts as on either side.
"""

SMALLEST = 2.0**-126
"""Single precision has fewer digits below."""

SQUARE = 64
"""Inputs are as many as a square of so many pixels has."""

Values = Sequence[np.ndarray]
"""What a function returns: (n,) numbers, and (n, 3) vectors, which have one size as a whole."""


@dataclass(frozen=True)
class Function:
    """One function of a header, what it is called with, and what it has to return.

    :param name: as in the header.
    :param header: the file that it stands in; ``more`` headers, or lines of OSL, go before it.
    :param draw: inputs over the whole domain.
    :param statements: put what it returns into ``r[0]``, ``r[1]`` and on.
    :param reference: the same in double precision, of the inputs as single precision has them.
    :param bound: largest error that is taken, in roundings (see :func:`roundings`), and ``because`` of what.
    :param codes: inputs that are no measured numbers.
    :param terms: sizes of the largest numbers that the result is a sum of, where they are not its own.
    :param covers: functions that are called on the way and have no row of their own.
    :param domain: in words, where a function is measured over more than one.
    :param functions: of OSL, that the statements call.
    """

    name: str
    header: str
    draw: Callable[[Draw], Mapping[str, np.ndarray]]
    statements: str
    reference: Callable[..., Values]
    bound: float
    because: str
    codes: tuple[str, ...] = ()
    terms: Callable[..., Values] | None = None
    covers: tuple[str, ...] = ()
    more: tuple[str, ...] = ()
    domain: str = ""
    functions: str = ""


@dataclass(frozen=True)
class Errors:
    """The worst errors of a function.

    :param relative: of the result's size; of the largest of all terms where the function has such.
    :param roundings: see :func:`roundings`.
    :param worst: the inputs of the latter.
    """

    relative: float
    roundings: float
    worst: Mapping[str, np.ndarray] = field(default_factory=dict)


class Draw:
    """Draws inputs that fill their ranges evenly, ends included; each is in an order of its own (McKay, Beckman and Conover
    1979, Latin hypercubes).
    """

    def __init__(self, seed: str) -> None:
        self._generator = np.random.default_rng(zlib.crc32(seed.encode()))
        self.count = SQUARE * SQUARE

    def linear(self, low: float, high: float) -> np.ndarray:
        """Return (n,) numbers that are evenly spread, each end twice."""
        places = (np.arange(self.count) + self._generator.random(self.count)) / self.count
        places[:2], places[-2:] = 0.0, 1.0
        return self._generator.permutation(low + places * (high - low))

    def logarithmic(self, low: float, high: float) -> np.ndarray:
        """Return (n,) positive numbers whose logarithms are evenly spread."""
        return np.clip(np.exp(self.linear(np.log(low), np.log(high))), low, high)

    def signed(self, low: float, high: float) -> np.ndarray:
        """Return (n,) numbers of either sign, by their size as :meth:`logarithmic`."""
        return self.logarithmic(low, high) * self.choice(-1.0, 1.0)

    def either(self, *drawn: np.ndarray) -> np.ndarray:
        """Return inputs of which each is one of those that are given, from anyone in turn."""
        turn = self.choice(*range(len(drawn))).astype(np.intp)
        return np.stack(drawn)[turn, np.arange(self.count)]

    def choice(self, *values: float) -> np.ndarray:
        """Return (n,) numbers of a few, all as often."""
        return self._generator.permutation(np.resize(np.array(values, dtype=np.float64), self.count))

    def cosine(self) -> np.ndarray:
        """Return (n,) cosines: evenly spread, and close to either end."""
        near = self.logarithmic(1e-6, 1.0)
        return self.either(self.linear(0.0, 1.0), near, 1.0 - near)

    def vector(self, *components: np.ndarray) -> np.ndarray:
        """Return (n, 3) vectors of three components."""
        return np.stack(components, axis=1)

    def direction(self) -> np.ndarray:
        """Return (n, 3) unit vectors, evenly spread over the sphere (Archimedes)."""
        z, angle = self.linear(-1.0, 1.0), self.linear(0.0, 2.0 * np.pi)
        aside = np.sqrt(np.maximum(1.0 - z * z, 0.0))
        return np.stack([aside * np.cos(angle), aside * np.sin(angle), z], axis=1)

    def across(self, axis: np.ndarray) -> np.ndarray:
        """Return (n, 3) unit vectors across others."""
        found = np.cross(axis, self.direction())
        along = np.linalg.norm(found, axis=1) < 1e-6
        found[along] = np.cross(axis[along], (0.3, 0.9, 0.1))
        return normalized(found)

    def around(self, axis: np.ndarray, cosine: np.ndarray) -> np.ndarray:
        """Return (n, 3) unit vectors that have such cosines with others."""
        aside = np.sqrt(np.maximum(1.0 - cosine * cosine, 0.0))
        return cosine[:, None] * axis + aside[:, None] * self.across(axis)


def normalized(v: np.ndarray) -> np.ndarray:
    """Return (n, 3) vectors with a length of 1."""
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def dot(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return the products of (n, 3) vectors."""
    return np.einsum("nx,nx->n", u, v)


def measured(function: Function) -> Errors:
    """Evaluate a function in single precision and in double, and compare."""
    drawn = function.draw(Draw(function.name))
    inputs = {name: np.asarray(values, np.float32).astype(np.float64) for name, values in drawn.items()}
    with np.errstate(all="ignore"):
        want = [np.asarray(value, dtype=np.float64) for value in function.reference(**inputs)]
        influence = _influence(function, inputs, want)
        terms = want if function.terms is None else function.terms(**inputs)
    columns = sum(1 if value.ndim == 1 else value.shape[1] for value in want)
    headers = (*function.more, *([function.header] if function.header.endswith(".h") else []))
    got = evaluate(headers, function.statements, inputs, columns, function.functions)
    relative, units = [], []
    column = 0
    for value, changes, term in zip(want, influence, terms):
        width = 1 if value.ndim == 1 else value.shape[1]
        part = got[:, column] if value.ndim == 1 else got[:, column : column + width]
        column += width
        error = _sizes(part - value)
        error[_sizes(part == np.float32(NO_NUMBER)) > 0] = np.inf
        size = np.maximum(_sizes(np.broadcast_to(term, value.shape)), SMALLEST)
        relative.append(error / size)
        units.append(roundings(error, size, changes))
    worst = int(np.max(units, axis=0).argmax())
    return Errors(
        float(np.max(relative)),
        float(np.max(units)),
        {name: values[worst] for name, values in inputs.items()}
        | {"got": got[worst], "want": [w[worst] for w in want]},
    )


def roundings(error: np.ndarray, size: np.ndarray, influence: np.ndarray) -> np.ndarray:
    """Return errors in units of what one rounding of each input and of the result would change (Higham 2002, 1.5 and 1.6).

    So a function is not blamed for what no arithmetic of that precision could know better.
    """
    return error / (ROUNDING * (size + influence))


def _influence(function: Function, inputs: Mapping[str, np.ndarray], want: Values) -> list[np.ndarray]:
    """Return by how much the results change with all inputs, by their own sizes; a list of (n,)."""
    totals = [np.zeros(len(value)) for value in want]
    for name, values in inputs.items():
        if name in function.codes:
            continue
        size = _sizes(values)
        for component in range(1 if values.ndim == 1 else values.shape[1]):
            largest = [np.zeros(len(value)) for value in want]
            for sign in (-1.0, 1.0):
                moved = values.copy()
                part = moved if values.ndim == 1 else moved[:, component]
                part += sign * STEP * size
                changed = function.reference(**(inputs | {name: moved}))
                for most, after, before in zip(largest, changed, want):
                    np.maximum(most, np.nan_to_num(_sizes(after - before) / STEP, nan=np.inf), out=most)
            for total, most in zip(totals, largest):
                total += most
    return totals


def _sizes(values: np.ndarray) -> np.ndarray:
    """Return the sizes of numbers or of vectors, (n,)."""
    return np.abs(values) if values.ndim == 1 else np.linalg.norm(values, axis=1)
