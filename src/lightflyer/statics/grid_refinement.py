"""Edges of bands and optima of many functions at once, between the points of a table.

A look takes several places at once: the one where a parabola through what is known expects an
optimum or an edge, and others on both sides, closer and closer to it. What reads a table takes
arrays of NumPy or of JAX: :mod:`lightflyer.statics.bands` is the same search with derivatives.
"""

from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from lightflyer.array.namespace import Numeric

Function: TypeAlias = Callable[[np.ndarray], np.ndarray]
"""Takes places of shape (n, ...), returns values of that shape: one function a column."""

Known: TypeAlias = tuple[np.ndarray, ...]
"""Places at which values are known, and those values."""

EDGE_TOLERANCE = 1e-10  # Of lift over weight at an edge; about a micrometre of altitude
POINTS = 9  # Places of a look at few functions: there a call costs more than a place
FLAT = 3e-7  # second difference at a smooth optimum, over its value, that a parabola follows

_FEWER_POINTS = 3
_LOOK = 600  # places of a look whose cost is about that of the call
_CLOSER = 0.125  # distance of a place from the one that is expected, over that of the next place
_STEEP = 0.02  # of a range: how closely an optimum at an end or beside a jump is looked for
_APART = 1e-6  # of a range: places that are closer tell nothing of a slope
_MOST_LOOKS = 10
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


def rows_around(table: np.ndarray, places: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Rows from one beyond the first end to one beyond the last, which are neighbours in a table.

    ``table``, ``places`` (n, m), ``ends`` (2, ..., m); the result (4, ..., m) is NaN beyond the
    table.
    """
    rows = np.stack([sum(row < end for row in places) for end in ends])
    step = np.sign(rows[1] - rows[0])
    rows = np.stack([rows[0] - step, *rows, rows[1] + step])
    known = table[np.clip(rows, 0, len(table) - 1), np.arange(table.shape[1])]
    return np.where((rows >= 0) & (rows < len(table)), known, np.nan)


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


class _Three(NamedTuple):
    """Places and values of the best known place of each column and its neighbours, shape (3, m)."""

    places: np.ndarray
    values: np.ndarray

    @classmethod
    def among(cls, places: np.ndarray, values: np.ndarray) -> "_Three":
        """The best of some places, shape (n, m), in any order; an end is its own neighbour."""
        best = first_largest(np.where(np.isnan(values), -np.inf, values))
        here, apart = at(places, best), _APART * np.ptp(places, axis=0)
        lower, higher = places < here - apart, places > here + apart
        before = np.where(lower, places, -np.inf).argmax(axis=0)
        after = np.where(higher, places, np.inf).argmin(axis=0)
        before, after = (
            np.where(beside.any(axis=0), row, best)
            for beside, row in ((lower, before), (higher, after))
        )
        chosen = np.stack([before, best, after])
        return cls(*(np.take_along_axis(table, chosen, axis=0) for table in (places, values)))

    @property
    def width(self) -> np.ndarray:
        """What is left of the range, shape (m,)."""
        return self.places[2] - self.places[0]

    @property
    def vertex(self) -> np.ndarray:
        """Place and height of a parabola through them, and its second difference, shape (3, m)."""
        # those of the best place, and zero, where there is none: at an end and beside a jump
        (a, b, c), (low, high, last) = self
        with np.errstate(invalid="ignore", divide="ignore"):
            rise, fall = (high - low) / (b - a), (last - high) / (c - b)
            bend = (fall - rise) / (c - a)
            place = 0.5 * (a + b - rise / bend)
            height = low + (place - a) * (rise + bend * (place - b))
            found = np.stack([place, height, 0.5 * bend * (c - a) ** 2])
        sensible = np.isfinite(found).all(axis=0) & (bend < 0.0)
        return np.where(sensible, found, [b, high, np.zeros_like(b)])


def peak(
    function: Function,
    low: Numeric,
    high: Numeric,
    points: int = POINTS,
    flat: float = FLAT,
    known: Known = (),
    *,
    leaves_out: bool = False,
) -> tuple[np.ndarray, np.ndarray]:
    """Place and height of the largest value of each function in a range; ``low``, ``high`` (m,)."""
    # ``known``: places in it, its ends included, and values there, both (n, m); else a first look
    # takes ``points`` places. ``leaves_out``: columns that are finished may be given NaN.
    low, high = np.broadcast_arrays(*np.atleast_1d(low, high))
    if not known:
        places = np.linspace(low, high, points)
        known = places, function(places)
    three, narrow = _Three.among(*np.broadcast_arrays(*known)), _STEEP * (high - low)
    slow = np.zeros(three.width.shape, bool)
    for _ in range(_MOST_LOOKS):
        place, _, bend = three.vertex
        (before, _, after), level = three.places, three.values[1]
        rough = (bend == 0.0) & (three.width > narrow)
        sought = np.isfinite(level) & (rough | (-bend > flat * np.abs(level)))
        if not np.any(sought):
            break
        count = sought.sum() if leaves_out else sought.size
        even = _evenly(before, after, max(_points(count), _FEWER_POINTS))
        looked = np.where(rough | slow, even, _around(place, before, after, len(even)))
        looked = np.where(sought | (not leaves_out), looked, np.nan)
        pairs = zip(three, (looked, function(looked)), strict=True)
        closer = _Three.among(*map(np.concatenate, pairs))
        closer = _Three(*(np.where(sought, *pair) for pair in zip(closer, three, strict=True)))
        slow, three = closer.width > 0.5 * three.width, closer
    place, height, _ = three.vertex
    return place, height


def _points(columns: int) -> int:
    """Places at which a look takes each of some functions."""
    fitting = (points for points in (POINTS, _FEWER_POINTS) if points * columns <= _LOOK)
    return next(fitting, 1)


def _around(middle: np.ndarray, low: np.ndarray, high: np.ndarray, points: int) -> np.ndarray:
    """A place and others on both sides, closer and closer to it, shape (points, ...)."""
    share = (_CLOSER ** np.arange(1, 1 + points // 2)).reshape(-1, *[1] * middle.ndim)
    below, above = (middle + share * (end - middle) for end in (low, high))
    return np.concatenate([below, middle[None], above[::-1]])


def _evenly(low: np.ndarray, high: np.ndarray, points: int) -> np.ndarray:
    """Places that divide a range evenly, without its ends, shape (points, ...)."""
    return np.linspace(low, high, points + 2)[1:-1]


def crossing(
    function: Function,
    outside: Numeric,
    inside: Numeric,
    wanted: np.ndarray | bool = True,
    tolerance: float = EDGE_TOLERANCE,
    known: Known = (),
    *,
    leaves_out: bool = False,
) -> np.ndarray:
    """Where each function becomes positive on the way from outside to inside, shape (m,)."""
    # ``known``: four places from outside to inside, between the middle ones of which the edge is,
    # and values there, both (4, m); NaN where there is no first or last one. Columns that are not
    # wanted give the place inside, and so do those that jump over zero. ``leaves_out``: as above.
    outside, inside = np.broadcast_arrays(*np.atleast_1d(outside, inside))
    if not known:
        ends, nothing = np.stack([outside, inside]), np.full((1, *inside.shape), np.nan)
        known = tuple(np.concatenate([nothing, row, nothing]) for row in (ends, function(ends)))
    places, values = known
    found, sought = inside, wanted & (values[2] > 0.0)
    narrow, level = tolerance * np.abs(inside - outside), np.full(inside.shape, np.inf)
    slow = np.zeros(inside.shape, bool)
    for _ in range(_MOST_STEPS):
        if not np.any(sought):
            break
        guess = _root_between(places, values)
        expects, before, after = ~(np.isnan(guess) | slow), places[1], places[2]
        points = _points(sought.sum() if leaves_out else sought.size)
        looked = np.where(
            expects, _around(guess, before, after, points), _evenly(before, after, points)
        )
        looked = np.where(sought | (not leaves_out), looked, np.nan)
        pairs = zip((places, values), (looked, function(looked)), strict=True)
        places, values = (np.concatenate([row[:2], look, row[2:]]) for row, look in pairs)
        first = 2 + (values[2:-1] >= 0.0).argmax(axis=0)
        rows = first + np.arange(-2, 2).reshape(-1, *[1] * first.ndim)
        places, values = (np.take_along_axis(row, rows, axis=0) for row in (places, values))
        sizes, width = np.nan_to_num(np.abs(values[1:3]), nan=np.inf), np.abs(places[2] - places[1])
        last, level = level, sizes.min(axis=0)
        met = level <= tolerance
        stays = np.where(slow, level > 0.75 * last, width > 0.5 * np.abs(after - before))
        slow = stays & (level > 0.25 * last)
        found = np.where(
            sought, np.where(met, at(places[1:3], sizes.argmin(axis=0)), places[2]), found
        )
        sought = sought & ~met & (width > narrow)
    return found


def _root_between(places: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Where a curve through four places, shape (4, m), is zero between the middle ones, or NaN."""
    # the inverse polynomial, by Neville, of the highest degree along whose places the values rise;
    # a line through the last two where nothing is known outside
    low, below, above, high = values
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        slopes = np.diff(values, axis=0) / np.diff(places, axis=0)
        first, line, last = places[:-1] - values[:-1] / slopes
        left = np.where(low < below, (above * first - low * line) / (above - low), np.nan)
        right = np.where(above < high, (high * line - below * last) / (high - below), np.nan)
        both = (high * left - low * right) / (high - low)
        guess = np.full(line.shape, np.nan)
        for one in (last, line, left, right, both):
            guess = np.where((one - places[1]) * (one - places[2]) < 0.0, one, guess)
    return guess
