r"""Splines in one variable as one operation.

A spline of degree :math:`m` is a polynomial from its first knot on, and from each other knot
:math:`k_j` on a power more:

.. math:: s(x) = \sum_i a_i (x - k_0)^i + \sum_{j > 0} f_j \max(x - k_j, 0)^m

Compilers see these sums, which vectorise; NumPy looks up the piece in which a value lies.
"""

import math
from collections.abc import Callable
from functools import lru_cache, partial, reduce
from typing import Any

import numpy as np

from lightflyer.core.checks import is_traced
from lightflyer.program.elementwise import OwnPrimitive, apply_jax

NAME = "spline"  # of the primitive, and of the operation of a program


def spline(
    knots: tuple[float, ...],
    start: tuple[float, ...],
    jumps: tuple[float, ...],
    degree: int,
    x: Any,
) -> Any:
    """Value at ``x``, not below the first knot; ``start``: :math:`a_i`; ``jumps``: :math:`f_j`."""
    parameters = {"knots": knots, "start": start, "jumps": jumps, "degree": degree}
    return _PRIMITIVE(x, **parameters) if is_traced(x) else evaluator(**parameters)(x)


@lru_cache(maxsize=1024)
def evaluator(
    knots: tuple[float, ...], start: tuple[float, ...], jumps: tuple[float, ...], degree: int
) -> Callable[[Any], Any]:
    """The spline as a function of NumPy's numbers and arrays."""
    places = np.array(knots)
    # of each piece, lowest power of the distance to its left knot first
    pieces = _moved(np.array([*start, *[0.0] * (degree + 1 - len(start))]), places - places[0])
    distances = places[:, None] - places[1:]
    for factor, distance in zip(jumps, distances.T, strict=True):
        one = np.zeros(degree + 1)
        one[-1] = factor
        pieces += np.where(distance >= 0.0, _moved(one, distance), 0.0)
    return partial(_evaluate, places, pieces)


def _moved(polynomial: np.ndarray, distances: np.ndarray) -> np.ndarray:
    """Coefficients, in powers of x − d, of a polynomial in x; shape (powers, distances)."""
    return np.stack(
        [
            sum(
                math.comb(power, kept) * factor * distances ** (power - kept)
                for power, factor in enumerate(polynomial)
                if power >= kept
            )
            + np.zeros_like(distances)
            for kept in range(len(polynomial))
        ]
    )


def _evaluate(knots: np.ndarray, pieces: np.ndarray, x: Any) -> Any:
    piece = np.searchsorted(knots[1:], x, side="right")
    distance = x - knots[piece]
    *lower, total = pieces[:, piece]
    for factors in reversed(lower):
        total = total * distance
        total += factors
    return total


def step_count(jumps: tuple[float, ...], degree: int, **_: Any) -> int:
    """How many multiplications, and steps as small, the spline takes."""
    return 2 * degree + 4 * len(jumps)


def written_out(
    apply: Callable[..., Any],
    x: Any,
    *,
    knots: tuple[float, ...],
    start: tuple[float, ...],
    jumps: tuple[float, ...],
    degree: int,
) -> Any:
    """The sums; ``apply(name, one, other)``: does an operation by its name."""
    distance = apply("sub", x, knots[0])
    total: Any = start[-1]
    for factor in reversed(start[:-1]):
        total = apply("add", apply("mul", total, distance), factor)
    for knot, jump in zip(knots[1:], jumps, strict=True):
        beyond = apply("max", apply("sub", x, knot), 0.0)
        power = reduce(partial(apply, "mul"), [beyond] * degree)
        total = apply("add", total, apply("mul", power, jump))
    return total


def _slope(
    _: int,
    x: Any,
    *,
    knots: tuple[float, ...],
    start: tuple[float, ...],
    jumps: tuple[float, ...],
    degree: int,
) -> Any:
    if degree == 1:
        return start[1] + sum(
            jump * (x >= knot) for knot, jump in zip(knots[1:], jumps, strict=True)
        )
    start = tuple(power * factor for power, factor in enumerate(start))[1:]
    return spline(knots, start, tuple(degree * jump for jump in jumps), degree - 1, x)


_PRIMITIVE = OwnPrimitive(NAME, partial(written_out, apply_jax), _slope)
