"""Peaks and edges of functions over a coordinate, by looking closer and closer.

Each look evaluates many functions at evenly spaced points and keeps the neighbours of what it
found, so a few looks reach a millionth of the range. A function that is compiled for one number of
points serves all looks, which is why a prediction uses this and not
:mod:`lightflyer.flight.bands`: that gives derivatives too, but takes longer to compile than a
whole prediction takes.
"""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from lightflyer.core.types import Numeric

Function: TypeAlias = Callable[[np.ndarray], np.ndarray]
"""Takes places of shape (n, m), returns values of that shape: one function a column."""


def peak(
    function: Function, low: Numeric, high: Numeric, *, points: int = 301, looks: int = 3
) -> tuple[np.ndarray, np.ndarray]:
    """Largest value of each function in a range, shape (m,); ``low``, ``high`` (m,)."""
    low, high = np.atleast_1d(np.asarray(low, float)), np.atleast_1d(np.asarray(high, float))
    for _ in range(looks):
        places, values = _look(function, low, high, points)
        best = np.argmax(np.where(np.isnan(values), -np.inf, values), axis=0)
        low, high = _row(places, best - 1), _row(places, best + 1)
    return _row(places, best), _row(values, best)


def crossing(
    function: Function, outside: Numeric, inside: Numeric, *, points: int = 301, looks: int = 3
) -> np.ndarray:
    """Find where each function becomes positive on the way from outside to inside, shape (m,)."""
    outside = np.atleast_1d(np.asarray(outside, float))
    inside = np.atleast_1d(np.asarray(inside, float))
    for _ in range(looks):
        places, values = _look(function, outside, inside, points)
        first = np.argmax(values >= 0.0, axis=0)
        outside, inside = _row(places, first - 1), _row(places, first)
    return 0.5 * (outside + inside)


def _look(
    function: Function, start: np.ndarray, stop: np.ndarray, points: int
) -> tuple[np.ndarray, np.ndarray]:
    fractions = np.linspace(0.0, 1.0, points)[:, None]
    places = start + fractions * (stop - start)
    values = function(places)
    return np.broadcast_to(places, values.shape), values


def _row(table: np.ndarray, index: np.ndarray) -> np.ndarray:
    """Entry of each column at an index, which stays within the table."""
    inside = np.clip(index, 0, table.shape[0] - 1)
    found: np.ndarray = table[inside, np.arange(table.shape[1])]
    return found


def bands_of(flies: np.ndarray) -> list[tuple[int, int]]:
    """First and last index of each run of true values; ``flies`` (n,)."""
    framed = np.concatenate([[False], flies, [False]])
    starts = np.flatnonzero(framed[1:-1] & ~framed[:-2])
    ends = np.flatnonzero(framed[1:-1] & ~framed[2:])
    return [(int(start), int(end)) for start, end in zip(starts, ends, strict=True)]
