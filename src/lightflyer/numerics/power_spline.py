r"""Splines in one variable as sums of powers.

A spline of degree :math:`m` is a polynomial from its first knot on, and from each other knot
:math:`k_j` on a power more:

.. math:: s(x) = \sum_i a_i (x - k_0)^i + \sum_{j > 0} f_j \max(x - k_j, 0)^m

XLA's compiler sees these sums, which vectorise; NumPy looks up the piece in which a value lies.
"""

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from lightflyer.array.namespace import is_jax, xp


class Sums(NamedTuple):
    """A spline as sums of powers."""

    knots: tuple[float, ...]  # Increasing; all but the last point that it goes through
    start: tuple[float, ...]  # :math:`a_i`, at most to the power of the degree
    jumps: tuple[float, ...]  # :math:`f_j`, one for each knot but the first
    degree: int


def spline(sums: Sums, x: Any) -> Any:
    """Value at ``x``, not below the first knot."""
    return _written_out(sums, x) if xp.follows and is_jax(x) else _evaluate(*_pieces(sums), x)


@lru_cache(maxsize=1024)
def _pieces(sums: Sums) -> tuple[np.ndarray, np.ndarray]:
    """Knots, and coefficients in powers of the distance to the knot, shape (powers, knots)."""
    knots = np.array(sums.knots)
    start = np.zeros(sums.degree + 1)
    start[: len(sums.start)] = sums.start
    # of each piece, lowest power of the distance to its left knot first
    pieces = _moved(start, knots - knots[0])
    for knot, jump in zip(knots[1:], sums.jumps, strict=True):
        power = np.eye(sums.degree + 1)[-1] * jump
        pieces += np.where(knots >= knot, _moved(power, knots - knot), 0.0)
    return knots, pieces


def _moved(polynomial: np.ndarray, distances: np.ndarray) -> np.ndarray:
    """Coefficients, in powers of x − d, of a polynomial in x; shape (powers, distances)."""
    moved = np.zeros((polynomial.size, distances.size))
    for power, factor in enumerate(polynomial):
        for kept in range(power + 1):
            moved[kept] += math.comb(power, kept) * factor * distances ** (power - kept)
    return moved


def _evaluate(knots: np.ndarray, pieces: np.ndarray, x: Any) -> Any:
    piece = xp.searchsorted(knots[1:], x, side="right")
    distance = x - xp.asarray(knots)[piece]
    *lower, total = xp.asarray(pieces)[:, piece]
    for factors in reversed(lower):
        total = total * distance
        total += factors
    return total


def _written_out(sums: Sums, x: Any) -> Any:
    knots, start, jumps, degree = sums
    total: Any = start[-1]
    for factor in reversed(start[:-1]):
        total = total * (x - knots[0]) + factor
    for knot, jump in zip(knots[1:], jumps, strict=True):
        beyond = xp.maximum(x - knot, 0.0)
        total = total + jump * math.prod([beyond] * degree)
    return total
