r"""Splines in one variable as one operation.

A spline of degree :math:`m` is a polynomial from its first knot on, and from each other knot
:math:`k_j` on a power more:

.. math:: s(x) = \sum_i a_i (x - k_0)^i + \sum_{j > 0} f_j \max(x - k_j, 0)^m

Compilers see these sums, which vectorise; NumPy looks up the piece in which a value lies.
"""

import math
from collections.abc import Callable
from functools import lru_cache, partial, reduce
from typing import Any, NamedTuple

import numpy as np

from lightflyer.core.checks import is_traced
from lightflyer.program.elementwise import OwnPrimitive, apply_jax

NAME = "spline"  # of the primitive, and of the operation of a program


class Sums(NamedTuple):
    """A spline as sums of powers."""

    knots: tuple[float, ...]  # Increasing; all but the last point that it goes through
    start: tuple[float, ...]  # :math:`a_i`, at most to the power of the degree
    jumps: tuple[float, ...]  # :math:`f_j`, one for each knot but the first
    degree: int

    @property
    def slope(self) -> "Sums":
        """The derivative, of a degree from two on."""
        start = tuple(power * factor for power, factor in enumerate(self.start))[1:]
        jumps = tuple(self.degree * jump for jump in self.jumps)
        return Sums(self.knots, start, jumps, self.degree - 1)


def spline(sums: Sums, x: Any) -> Any:
    """Value at ``x``, not below the first knot."""
    return _PRIMITIVE(x, sums=sums) if is_traced(x) else evaluator(sums)(x)


@lru_cache(maxsize=1024)
def evaluator(sums: Sums) -> Callable[[Any], Any]:
    """The spline as a function of NumPy's numbers and arrays."""
    knots = np.array(sums.knots)
    start = np.zeros(sums.degree + 1)
    start[: len(sums.start)] = sums.start
    # of each piece, lowest power of the distance to its left knot first
    pieces = _moved(start, knots - knots[0])
    for knot, jump in zip(knots[1:], sums.jumps, strict=True):
        power = np.eye(sums.degree + 1)[-1] * jump
        pieces += np.where(knots >= knot, _moved(power, knots - knot), 0.0)
    return partial(_evaluate, knots, pieces)


def _moved(polynomial: np.ndarray, distances: np.ndarray) -> np.ndarray:
    """Coefficients, in powers of x − d, of a polynomial in x; shape (powers, distances)."""
    moved = np.zeros((polynomial.size, distances.size))
    for power, factor in enumerate(polynomial):
        for kept in range(power + 1):
            moved[kept] += math.comb(power, kept) * factor * distances ** (power - kept)
    return moved


def _evaluate(knots: np.ndarray, pieces: np.ndarray, x: Any) -> Any:
    piece = np.searchsorted(knots[1:], x, side="right")
    distance = x - knots[piece]
    *lower, total = pieces[:, piece]
    for factors in reversed(lower):
        total = total * distance
        total += factors
    return total


def step_count(sums: Sums) -> int:
    """How many multiplications, and steps as small, the spline takes."""
    _, _, jumps, degree = sums
    return 2 * degree + 4 * len(jumps)


def written_out(apply: Callable[..., Any], x: Any, *, sums: Sums) -> Any:
    """The sums; ``apply(name, one, other)``: does an operation by its name."""
    knots, start, jumps, degree = sums
    distance = apply("sub", x, knots[0])
    total: Any = start[-1]
    for factor in reversed(start[:-1]):
        total = apply("add", apply("mul", total, distance), factor)
    for knot, jump in zip(knots[1:], jumps, strict=True):
        beyond = apply("max", apply("sub", x, knot), 0.0)
        power = reduce(partial(apply, "mul"), [beyond] * degree)
        total = apply("add", total, apply("mul", power, jump))
    return total


def _slope(_: int, x: Any, *, sums: Sums) -> Any:
    if sums.degree > 1:
        return spline(sums.slope, x)
    beyond = zip(sums.knots[1:], sums.jumps, strict=True)
    return sums.start[1] + sum(jump * (x >= knot) for knot, jump in beyond)


_PRIMITIVE = OwnPrimitive(NAME, partial(written_out, apply_jax), _slope)
