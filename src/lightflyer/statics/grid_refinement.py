"""Edges of bands and optima of many functions at once, between the points of a table.

An optimum is found by looking closer and closer between the neighbours of the largest value, an
edge by false position between a place outside and one inside. What reads a table takes arrays of
NumPy or of JAX: :mod:`lightflyer.statics.bands` is the same search with derivatives.
"""

from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from lightflyer.core.types import Numeric

Function: TypeAlias = Callable[[np.ndarray], np.ndarray]
"""Takes places of shape (n, ...), returns values of that shape: one function a column."""

EDGE_TOLERANCE = 1e-10  # Of lift over weight at an edge; about a micrometre of altitude
POINTS = 9  # Places that a look for an optimum takes; nine narrow the search four times

_MOST_LOOKS = 10
FLAT = 3e-7  # second difference at a smooth optimum, over its value, that a parabola follows
_MOST_STEPS = 60


def at(table: Any, index: Any) -> Any:
    """Entry of each column, shape (...); ``table`` (n, ...), ``index`` (...)."""
    return table.__array_namespace__().take_along_axis(table, index[None], axis=0)[0]


def first_largest(table: Any) -> Any:
    """Index of the largest entry of each column, in 32 bits in either of JAX's precisions."""
    # Inside a caller's own single-precision ``jit`` JAX cannot lower an argmax of double precision.
    xp, rows = table.__array_namespace__(), _rows(table.shape[0], table.ndim)
    return xp.min(xp.where(table == xp.max(table, axis=0), rows, rows[-1]), axis=0)


def best_of(values: Any) -> tuple[Any, Any, Any]:
    """Index of the largest value of each column, and of its neighbours in the table."""
    xp = values.__array_namespace__()
    best = first_largest(xp.where(xp.isnan(values), -xp.inf, values))
    return best, xp.maximum(best - 1, 0), xp.minimum(best + 1, values.shape[0] - 1)


def with_point(grid: Any, values: Any, point: Any, value: Any) -> tuple[Any, Any]:
    """Insert one more place and value into each column; ``grid`` (n,), ``values`` (n, ...)."""
    xp = values.__array_namespace__()
    columns = xp.broadcast_to(grid.reshape(-1, *[1] * point.ndim), values.shape)
    place = xp.sum(columns < point, axis=0, dtype=np.int32)
    rows = _rows(grid.size + 1, values.ndim)

    def inserted(table: Any, entry: Any) -> Any:
        before = xp.concatenate([table, table[-1:]])
        after = xp.concatenate([table[:1], table])
        return xp.where(rows < place, before, xp.where(rows == place, entry, after))

    return inserted(columns, point), inserted(values, value)


class Brackets(NamedTuple):
    """Where a band begins and ends in a table: its lower and its upper edge, shape (2, ...)."""

    outside: Any
    inside: Any
    exists: Any
    is_open: Any  # The table ends there, not the band


def band_count(flies: Any) -> Any:
    """Number of bands in each column, shape (...)."""
    return _begins(flies).sum(axis=0)


def band_brackets(places: Any, flies: Any, number: int) -> Brackets:
    """Find the band of the given number, counted from one; all arrays (n, ...)."""
    xp, last = places.__array_namespace__(), places.shape[0] - 1
    member = flies & (xp.cumsum(_begins(flies), axis=0, dtype=np.int32) == number)
    first, final = first_largest(member), last - first_largest(member[::-1])
    exists = xp.any(member, axis=0)
    outside = at(places, xp.maximum(first - 1, 0)), at(places, xp.minimum(final + 1, last))
    is_open = xp.stack([first == 0, final == last])
    inside = xp.stack([at(places, first), at(places, final)])
    return Brackets(xp.stack(outside), inside, xp.stack([exists, exists]), is_open & exists)


def _begins(flies: Any) -> Any:
    xp = flies.__array_namespace__()
    return flies & ~xp.concatenate([xp.zeros_like(flies[:1]), flies[:-1]])


def _rows(count: int, dimensions: int) -> np.ndarray:
    return np.arange(count, dtype=np.int32).reshape(-1, *[1] * (dimensions - 1))


def peak(
    function: Function, low: Numeric, high: Numeric, points: int = POINTS, flat: float = FLAT
) -> tuple[np.ndarray, np.ndarray]:
    """Place and height of the largest value of each function in a range; ``low``, ``high`` (m,)."""
    low, high = np.broadcast_arrays(*np.atleast_1d(low, high))
    for _ in range(_MOST_LOOKS):
        places = np.linspace(low, high, points)
        values = function(places)
        places = np.broadcast_to(places, values.shape)
        best, before, after = best_of(values)
        way, gain, bend = _vertex(values, best)
        low, high = at(places, before), at(places, after)
        if not np.any(-bend > flat * np.abs(at(values, best))):
            break
    return at(places, best) + way * (places[1] - places[0]), at(values, best) + gain


def _vertex(values: np.ndarray, best: np.ndarray) -> tuple[np.ndarray, ...]:
    """Vertex of the parabola through the best of each column and its neighbours."""
    # Its way from the best, over the distance of two places, and what it is higher; and the second
    # difference. All are zero at an end of the range.
    middle = np.clip(best, 1, values.shape[0] - 2)
    left, most, right = (at(values, middle + step) for step in (-1, 0, 1))
    with np.errstate(invalid="ignore", divide="ignore"):
        bend, slope = left - 2.0 * most + right, 0.5 * (right - left)
        way = -slope / bend
        found = np.stack([way, 0.5 * slope * way, bend])
    sensible = (best == middle) & np.isfinite(found).all(axis=0) & (bend < 0.0)
    return tuple(np.where(sensible, found, 0.0))


def crossing(
    function: Function,
    outside: Numeric,
    inside: Numeric,
    wanted: np.ndarray | bool = True,
    tolerance: float = EDGE_TOLERANCE,
    known: tuple[np.ndarray, ...] = (),
) -> np.ndarray:
    """Where each function becomes positive on the way from outside to inside, shape (m,)."""
    # ``known``: values outside and inside.
    #
    # False position, in which the end that stays counts half the next time (Illinois). Columns
    # that are not wanted give the place inside.
    ends = np.stack(np.broadcast_arrays(*np.atleast_1d(outside, inside)))
    below, above = known or function(ends)
    (outside, inside), found = ends, ends[1]
    sought = wanted & (above > 0.0)
    last = np.zeros(found.shape)
    for _ in range(_MOST_STEPS):
        if not np.any(sought):
            break
        with np.errstate(invalid="ignore", divide="ignore"):
            way = below / (below - above)
        way = np.where((way > 0.0) & (way < 1.0), way, 0.5)
        found = np.where(sought, outside + way * (inside - outside), found)
        value = function(found[None])[0]
        sought = sought & ~(np.abs(value) <= tolerance)
        side = np.where(value >= 0.0, 1.0, -1.0)
        halved = np.where(side == last, 0.5, 1.0)
        enters, last = side > 0.0, side
        outside, inside = np.where(enters, outside, found), np.where(enters, found, inside)
        below, above = (
            np.where(enters, halved * below, value),
            np.where(enters, value, halved * above),
        )
    return np.where(sought, inside, found)  # where the function jumps over zero
