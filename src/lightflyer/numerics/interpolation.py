r"""Interpolation: splines and sums of powers over knots, and local cubics over rectangular grids.

Splines in one variable as sums of powers.

A spline of degree :math:`m` is a polynomial from its first knot on, and from each other knot
:math:`k_j` on a power more:

.. math:: s(x) = \sum_i a_i (x - k_0)^i + \sum_{j > 0} f_j \max(x - k_j, 0)^m

XLA's compiler sees these sums, which vectorise; NumPy looks up the piece in which a value lies.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from lightflyer.array.memory import kept
from lightflyer.array.namespace import Array, Numeric, is_jax, xp
from lightflyer.array.records import Module, field


class Spline(Module):
    """Piecewise cubic."""

    is_table: ClassVar[bool] = True  # Its arrays are nodes, not elements

    nodes: Any  # shape (n,); increasing abscissae
    # shape (4, n - 1); of each piece, in powers of the distance to its left node, highest first
    coefficients: Any

    @classmethod
    def through(cls, nodes: ArrayLike, values: ArrayLike) -> "Spline":
        """Twice continuously differentiable cubic through points ("not-a-knot" ends)."""
        from scipy.interpolate import CubicSpline  # half a second that most uses can spare

        spline = CubicSpline(nodes, values)
        return cls(nodes=np.asarray(spline.x), coefficients=np.asarray(spline.c))

    @classmethod
    def hermite(cls, nodes: np.ndarray, values: np.ndarray, slopes: np.ndarray) -> "Spline":
        """Once continuously differentiable cubic through points with known slopes."""
        width = np.diff(nodes)
        secant = np.diff(values) / width
        left, right = slopes[:-1], slopes[1:]
        cubic = (left + right - 2.0 * secant) / width**2
        quadratic = (3.0 * secant - 2.0 * left - right) / width
        return cls(nodes=nodes, coefficients=np.stack([cubic, quadratic, left, values[:-1]]))

    def __call__(self, x: Any) -> Array:
        """Value at ``x``, any shape; the outer pieces continue beyond the table.

        Axes of values that are vectors come last.
        """
        nodes, coefficients = xp.asarray(self.nodes), xp.asarray(self.coefficients)
        piece = xp.clip(xp.searchsorted(nodes, x, side="right") - 1, 0, nodes.size - 2)
        cubic, quadratic, linear, constant = coefficients[:, piece]
        distance = x - nodes[piece]
        distance = distance.reshape(distance.shape + (1,) * (coefficients.ndim - 2))
        return constant + distance * (linear + distance * (quadratic + distance * cubic))


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
        for lower in range(power + 1):
            moved[lower] += math.comb(power, lower) * factor * distances ** (power - lower)
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


@dataclass(frozen=True)
class Curves:
    """Several cubic splines with the same knots, level at both ends and beyond."""

    knots: tuple[float, ...]
    # Value and half the second derivative at the first knot, one for each curve
    constants: tuple[float, ...]
    squares: tuple[float, ...]
    # A sixth of the jumps of the third derivative at all knots but the last, for each curve
    cubes: tuple[tuple[float, ...], ...]

    @classmethod
    def through(cls, knots: np.ndarray, values: np.ndarray) -> "Curves":
        """Splines with two continuous derivatives, and none at the ends; ``knots`` (n,)."""
        width, secant = np.diff(knots), np.diff(values, axis=0) / np.diff(knots)[:, None]
        matrix = np.diag(np.concatenate([[width[0]], width[:-1] + width[1:], [width[-1]]]) / 3.0)
        matrix += np.diag(width / 6.0, 1) + np.diag(width / 6.0, -1)
        level = np.zeros((1, values.shape[1]))
        curvature = np.linalg.solve(matrix, np.diff(secant, axis=0, prepend=level, append=level))
        third = np.diff(curvature, axis=0) / width[:, None]
        jumps = np.diff(third, axis=0, prepend=level) / 6.0
        return cls(
            tuple(knots.tolist()),
            tuple(values[0].tolist()),
            tuple((0.5 * curvature[0]).tolist()),
            tuple(tuple(column) for column in jumps.T.tolist()),
        )

    @kept
    def __call__(self, x: Numeric) -> list[Array]:
        """Values of all curves at ``x``, any shape."""
        inside = xp.clip(x, self.knots[0], self.knots[-1])
        curves = zip(self.constants, self.squares, self.cubes, strict=True)
        return [
            spline(Sums(self.knots[:-1], (constant, 0.0, square, cubes[0]), cubes[1:], 3), inside)
            for constant, square, cubes in curves
        ]


_ORDER = 4  # coefficients of a cubic, and nodes that one piece looks at
MOST_UNEVEN = 3.0  # ratio of neighbouring widths up to which a parabola is trusted


class Axis(Module):
    """Nodes along one dimension of a table, and the cubic Hermite pieces between them."""

    is_table: ClassVar[bool] = True  # Its arrays are nodes, not elements

    # The slope at a node is that of the parabola through it and its two neighbours; at an end of
    # the axis, of the parabola through the last three nodes. Three nodes make one parabola, two a
    # line, one a constant. Where widths are uneven, see :func:`share_of_next`.

    nodes: Any  # shape (n,)
    # shape (pieces,); first of the nodes that a piece looks at; on an axis with a period, the next
    # after the last is the first again
    first: Any
    # shape (pieces, window, 4); weight of each of these nodes, in powers of the position within the
    # piece, 0 to 1
    powers: Any
    period: float | None = field(static=True)

    def __init__(self, nodes: ArrayLike, period: float | None = None):
        nodes = np.asarray(nodes, float)
        reach = nodes
        if period is not None:
            reach = np.concatenate([nodes[-1:] - period, nodes, nodes[:2] + period])
        window = min(_ORDER, reach.size)
        pieces = np.arange(max(reach.size - 1, 1))
        first = np.clip(pieces - 1, 0, reach.size - window)
        powers = np.array([_piece(reach, int(piece), window) for piece in pieces])
        if period is not None:
            own = slice(1, nodes.size + 1)
            first, powers = (first[own] - 1) % nodes.size, powers[own]
        self.nodes, self.first, self.powers, self.period = nodes, first, powers, period

    def weights(self, x: Any) -> tuple[Array, Array]:
        """Nodes that count at a position, and by how much; returns ``index``, ``weight``."""
        nodes, powers = xp.asarray(self.nodes), xp.asarray(self.powers)
        if self.period is not None:
            x = nodes[0] + xp.mod(x - nodes[0], self.period)
        pieces, window = powers.shape[:2]
        piece = xp.clip(xp.searchsorted(nodes, x, side="right") - 1, 0, pieces - 1)
        following = nodes[(piece + 1) % nodes.size]
        if self.period is not None:
            following = xp.where(piece + 1 < nodes.size, following, nodes[0] + self.period)
        width = following - nodes[piece] if nodes.size > 1 else 1.0
        along = (x - nodes[piece]) / width
        power = xp.stack([along**0, along, along**2, along**3], axis=-1)
        weight = xp.sum(powers[piece] * power[..., None, :], axis=-1)
        first = xp.asarray(self.first)[piece].astype(int)
        return (first[..., None] + xp.arange(window)) % nodes.size, weight


def _piece(nodes: np.ndarray, piece: int, window: int) -> np.ndarray:
    """Weights of the nodes around a piece in powers of the position, shape (window, 4)."""
    powers = np.zeros((window, _ORDER))
    if window == 1:
        powers[0, 0] = 1.0
        return powers
    start = int(np.clip(piece - 1, 0, nodes.size - window))
    left, right = np.eye(window)[[piece - start, piece + 1 - start]]
    near, width = nodes[start : start + window], nodes[piece + 1] - nodes[piece]
    slope_left, slope_right = (width * _slope(near, piece - start + end) for end in (0, 1))
    powers[:, 0] = left
    powers[:, 1] = slope_left
    powers[:, 2] = 3.0 * (right - left) - 2.0 * slope_left - slope_right
    powers[:, 3] = 2.0 * (left - right) + slope_left + slope_right
    return powers


def _slope(nodes: np.ndarray, at: int) -> np.ndarray:
    """Weights of the nodes in the derivative at one of them, of the parabola around it."""
    width = np.diff(nodes)
    secants = np.diff(np.eye(nodes.size), axis=0) / width[:, None]
    if width.size == 1:
        return secants[0]
    inner = int(np.clip(at, 1, width.size - 1))
    after = share_of_next(*width[inner - 1 : inner + 1])
    slope = (1.0 - after) * secants[inner - 1] + after * secants[inner]
    return slope if inner == at else 2.0 * secants[0 if at == 0 else -1] - slope


def share_of_next(before: Any, after: Any) -> Any:
    """Share of the secant after a node in the slope there; ``before``, ``after``: the widths.

    That of the parabola through three nodes, which rests on the narrower width. A step between
    nodes that almost coincide would swing the curve over the wide one beside it, by as much as the
    widths differ: beyond a ratio of 3 its share falls with the square of their ratio.
    """
    ratio = before / after
    uneven = np.maximum(ratio, 1.0 / ratio)
    narrow = uneven / (1.0 + uneven)
    limit = MOST_UNEVEN / (1.0 + MOST_UNEVEN) * (MOST_UNEVEN / uneven) ** 2
    narrow = np.where(uneven > MOST_UNEVEN, limit, narrow)
    return np.where(ratio > 1.0, narrow, 1.0 - narrow)


def interpolate(table: Any, axes: Sequence[Axis], position: Sequence[Any]) -> Array:
    """Value of a table between its nodes, once continuously differentiable, shape (..., ...)."""
    found = [axis.weights(x) for axis, x in zip(axes, xp.broadcast_arrays(*position), strict=True)]
    spread = []
    for number, (index, _) in enumerate(found):
        shape = [1] * len(found)
        shape[number] = index.shape[-1]
        spread.append(index.reshape(*index.shape[:-1], *shape))
    values = xp.asarray(table)[tuple(spread)]
    for _, weight in found:
        leading = weight.ndim - 1
        shape = [*weight.shape, *[1] * (values.ndim - weight.ndim)]
        values = xp.sum(weight.reshape(shape) * values, axis=leading)
    return values
