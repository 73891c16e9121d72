"""What is kept of very many designs: the best ones, a Pareto front, the spread of a number.

A reduction makes a *partial* of each chunk of a study: a dict of small arrays. Partials merge in
any order and grouping to the same numbers, bit by bit, so that chunks may be computed anywhere,
again and in any order. NumPy makes them, or JAX where the designs are computed. JAX's may be
padded, which merging removes.
"""

import abc
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from lightflyer.array.namespace import Array, load_jax, xp

Partial = dict[str, Any]  # Arrays by name

Columns = Mapping[str, Any]
"""Outputs and varied numbers of consecutive designs by name, arrays of one length."""

_NONE = -1  # stands for a design in padding


@dataclass(frozen=True)
class AbstractReduction(abc.ABC):
    """One thing to keep of all designs."""

    @abc.abstractmethod
    def empty(self) -> Partial:
        """The partial of no design."""

    @abc.abstractmethod
    def of_chunk(self, columns: Columns, first: int) -> Partial:
        """The partial of consecutive designs, by NumPy; ``columns`` (n,)."""

    @abc.abstractmethod
    def on_device(self, columns: Columns, first: Any, inside: Any = True) -> Partial:
        """As :meth:`of_chunk`, by JAX: of fixed shapes, for :func:`jax.jit`, in float64."""

    @abc.abstractmethod
    def merge(self, one: Partial, other: Partial) -> Partial:
        """The partial of the designs of two, in NumPy and without padding."""

    def is_whole(self, partial: Partial) -> bool:
        """Whether a partial of :meth:`on_device` holds all that it should."""
        # Where it does not, :meth:`of_chunk` must be used.
        del partial
        return True


@dataclass(frozen=True)
class Best(AbstractReduction):
    """The designs with the largest, or least, values of an output."""

    # The partial holds ``designs`` (their numbers) and ``values``, best first. Of equals the one
    # with the smaller number comes first.

    output: str
    count: int  # How many
    less_is_better: bool = False

    def empty(self) -> Partial:
        return {"designs": np.empty(0, np.int64), "values": np.empty(0)}

    def of_chunk(self, columns: Columns, first: int) -> Partial:
        values = np.asarray(columns[self.output], float)
        candidates = np.flatnonzero(np.isfinite(values))
        if candidates.size > self.count:
            score = self._sign * values[candidates]
            last = candidates.size - self.count
            candidates = candidates[score >= np.partition(score, last)[last]]
        return self._first(first + candidates, values[candidates])

    def on_device(self, columns: Columns, first: Any, inside: Any = True) -> Partial:
        del inside  # others have no value
        values = xp.asarray(columns[self.output])
        known = xp.isfinite(values)
        # of equals the one with the lower index comes first
        score, places = load_jax().lax.top_k(
            xp.where(known, self._sign * values, -np.inf), min(self.count, values.size)
        )
        designs = xp.where(xp.isfinite(score), first + places.astype(xp.int64), _NONE)
        return {"designs": designs, "values": values[places]}

    def merge(self, one: Partial, other: Partial) -> Partial:
        both = _join(one, other)
        return self._first(both["designs"], both["values"])

    @property
    def _sign(self) -> float:
        return -1.0 if self.less_is_better else 1.0

    def _first(self, designs: np.ndarray, values: np.ndarray) -> Partial:
        order = np.lexsort((designs, -self._sign * values))[: self.count]
        return {"designs": designs[order], "values": values[order]}


@dataclass(frozen=True)
class Front(AbstractReduction):
    """The designs that no other beats in both of two numbers.

    The partial holds ``designs``, ``gain`` and ``cost``, cheapest first; of designs equal in both
    that with the smallest number.


    Examples
    --------
    >>> front = Front("payload", "altitude")
    >>> front.of_chunk({"payload": [1.0, 3.0, 2.0], "altitude": [50.0, 60.0, 70.0]}, first=0)
    {'designs': array([0, 1]), 'gain': array([1., 3.]), 'cost': array([50., 60.])}
    """

    gain: str  #: Outputs or varied numbers. More is better of the gain, less of the cost
    cost: str  #: Outputs or varied numbers. More is better of the gain, less of the cost
    less_gain_is_better: bool = False  #: The reverse
    more_cost_is_better: bool = False  #: The reverse
    capacity: int = 4096  #: Most designs of a front that :meth:`on_device` returns

    def empty(self) -> Partial:
        return {"designs": np.empty(0, np.int64), "gain": np.empty(0), "cost": np.empty(0)}

    def of_chunk(self, columns: Columns, first: int) -> Partial:
        gain, cost = (np.asarray(columns[name], float) for name in (self.gain, self.cost))
        known = np.flatnonzero(np.isfinite(gain) & np.isfinite(cost))
        return self._unbeaten(first + known, gain[known], cost[known])

    def on_device(self, columns: Columns, first: Any, inside: Any = True) -> Partial:
        del inside  # others have no value
        gain, cost = (xp.asarray(columns[name]) for name in (self.gain, self.cost))
        worth, price = self._signs
        known = xp.isfinite(gain) & xp.isfinite(cost)
        places = xp.arange(gain.size, dtype=xp.int64)
        price_, loss, places = load_jax().lax.sort(
            (
                xp.where(known, price * cost, np.inf),
                xp.where(known, -worth * gain, np.inf),
                places,
            ),
            num_keys=3,
        )
        before = xp.concatenate([xp.full(1, np.inf), load_jax().lax.cummin(loss)[:-1]])
        unbeaten = loss < before
        size = min(self.capacity, gain.size)
        (kept,) = xp.nonzero(unbeaten, size=size, fill_value=0)
        found = xp.count_nonzero(unbeaten)
        designs = xp.where(xp.arange(size) < found, first + places[kept], _NONE)
        return {
            "designs": designs,
            "gain": -worth * loss[kept],
            "cost": price * price_[kept],
            "left_out": xp.maximum(found - size, 0),
        }

    def is_whole(self, partial: Partial) -> bool:
        """False where the front is above the capacity."""
        return int(partial.get("left_out", 0)) == 0

    def merge(self, one: Partial, other: Partial) -> Partial:
        both = _join(one, other)
        return self._unbeaten(both["designs"], both["gain"], both["cost"])

    @property
    def _signs(self) -> tuple[float, float]:
        """What gain and cost are multiplied by so that more gain and less cost are better."""
        return (-1.0 if self.less_gain_is_better else 1.0), (
            -1.0 if self.more_cost_is_better else 1.0
        )

    def _unbeaten(self, designs: np.ndarray, gain: np.ndarray, cost: np.ndarray) -> Partial:
        worth, price = self._signs
        left = _perhaps_unbeaten(worth * gain, price * cost)
        designs, gain, cost = designs[left], gain[left], cost[left]
        order = np.lexsort((designs, -worth * gain, price * cost))
        score = worth * gain[order]
        before = np.concatenate([[-np.inf], np.maximum.accumulate(score)[:-1]])[: score.size]
        kept = order[score > before]
        return {"designs": designs[kept], "gain": gain[kept], "cost": cost[kept]}


_STEPS = 256  # of cost


def _perhaps_unbeaten(score: np.ndarray, price: np.ndarray) -> np.ndarray:
    """Places of designs that none of a cheaper step of cost beats: few, to be sorted."""
    span = np.ptp(price) if price.size > _STEPS else 0.0
    if not 0.0 < span < np.inf:
        return np.arange(price.size)
    step = ((price - price.min()) * (_STEPS / span)).astype(np.int64)  # never falls with the cost
    best = np.full(step.max() + 1, -np.inf)
    np.maximum.at(best, step, score)
    cheaper = np.concatenate([[-np.inf], np.maximum.accumulate(best)[:-1]])
    return np.flatnonzero(score > cheaper[step])


_MANTISSA_BITS = 52  # of a float64
_EXPONENT_BIAS = 1023
_KEPT_BITS = 9
_LOWEST_EXPONENT, _HIGHEST_EXPONENT = -64, 64

RESOLUTION = 2.0**-_KEPT_BITS  # Relative width of the widest cells of :class:`Spread`

_SHIFT = _MANTISSA_BITS - _KEPT_BITS
_FIRST = (_EXPONENT_BIAS + _LOWEST_EXPONENT) << _KEPT_BITS
_CELLS = (_HIGHEST_EXPONENT - _LOWEST_EXPONENT) << _KEPT_BITS


@dataclass(frozen=True)
class Spread(AbstractReduction):
    r"""How the values of an output are distributed: for :func:`quantiles` and :func:`histogram`."""

    # Numbers are counted in the cells that their first bits name: sign, exponent and nine bits of
    # the mantissa. No range has to be known before, and the same number falls into the same cell on
    # every machine. Cells are at most :data:`RESOLUTION` wide, relative to their numbers, from
    # :math:`2^{-64}` to :math:`2^{64}`. One cell holds what is smaller, one of each sign what is
    # larger.
    #
    # The partial holds ``counts`` of the cells, the ``least`` and ``largest`` value (infinite
    # without any), and ``missing``, the number of designs without a value.

    output: str

    def empty(self) -> Partial:
        return {
            "counts": np.zeros(2 * _CELLS + 3, np.int64),
            "least": np.asarray(np.inf),
            "largest": np.asarray(-np.inf),
            "missing": np.asarray(0),
        }

    def of_chunk(self, columns: Columns, first: int) -> Partial:
        del first
        values = np.asarray(columns[self.output], float)
        known = values[np.isfinite(values)]
        cells = np.clip((np.abs(known).view(np.int64) >> _SHIFT) - _FIRST + 1, 0, _CELLS + 1)
        signed = np.where(known < 0.0, -cells, cells) + _CELLS + 1
        return {
            "counts": np.bincount(signed, minlength=2 * _CELLS + 3),
            "least": np.min(known, initial=np.inf),
            "largest": np.max(known, initial=-np.inf),
            "missing": np.asarray(values.size - known.size),
        }

    def on_device(self, columns: Columns, first: Any, inside: Any = True) -> Partial:
        del first
        values = xp.asarray(columns[self.output])
        known = xp.isfinite(values)
        bits = load_jax().lax.bitcast_convert_type(xp.abs(values), xp.int64)
        cells = xp.clip((bits >> _SHIFT) - _FIRST + 1, 0, _CELLS + 1)
        signed = xp.where(values < 0.0, -cells, cells) + _CELLS + 1
        counts: Array = xp.zeros(2 * _CELLS + 3, xp.int64).at[signed].add(known)
        return {
            "counts": counts,
            "least": xp.min(values, where=known, initial=np.inf),
            "largest": xp.max(values, where=known, initial=-np.inf),
            "missing": xp.count_nonzero(~known & inside),
        }

    def merge(self, one: Partial, other: Partial) -> Partial:
        return {
            "counts": np.asarray(one["counts"]) + np.asarray(other["counts"]),
            "least": np.minimum(one["least"], other["least"]),
            "largest": np.maximum(one["largest"], other["largest"]),
            "missing": np.asarray(one["missing"]) + np.asarray(other["missing"]),
        }


def _ends() -> tuple[np.ndarray, np.ndarray]:
    """Ends of the cells of :class:`Spread`, nearer to zero and farther from it."""
    bits = (np.arange(_CELLS + 1, dtype=np.int64) + _FIRST) << _SHIFT
    near = bits.view(float)
    low, high = np.concatenate([[0.0], near]), np.concatenate([near, [np.inf]])
    return np.concatenate([-low[:0:-1], low]), np.concatenate([-high[:0:-1], high])


def _middles(spread: Partial) -> np.ndarray:
    """What stands for the values in each cell."""
    near, far = _ends()
    middle = np.where(np.isinf(far), far, 0.5 * (near + far))
    middle[_CELLS + 1] = 0.0
    least, largest = float(spread["least"]), float(spread["largest"])
    return np.clip(middle, least, largest) if least <= largest else middle


def quantiles(spread: Partial, shares: Any) -> np.ndarray:
    """Values that a share of the designs with a value do not exceed, shape (n,)."""
    shares = np.asarray(shares, float)
    sums = np.cumsum(np.asarray(spread["counts"]))
    if sums[-1] == 0:
        return np.full(shares.shape, np.nan)
    rank = np.clip(np.ceil(shares * sums[-1]), 1, sums[-1])
    found = _middles(spread)[np.searchsorted(sums, rank)]
    exact = np.where(rank == sums[-1], spread["largest"], found)
    return np.where(rank == 1, spread["least"], exact)


def histogram(spread: Partial, edges: Any) -> np.ndarray:
    """Number of designs between edges, shape (n,); ``edges`` (n + 1,)."""
    counts = np.asarray(spread["counts"])
    filled = np.flatnonzero(counts)
    found, _ = np.histogram(
        _middles(spread)[filled], bins=np.asarray(edges), weights=counts[filled]
    )
    return np.rint(found).astype(np.int64)


def _join(one: Partial, other: Partial) -> Partial:
    """The rows of two partials but for padding."""
    both = {
        name: np.concatenate([np.asarray(one[name]), np.asarray(other[name])])
        for name in one
        if np.ndim(one[name]) == 1
    }
    kept = both["designs"] != _NONE
    return {name: column[kept] for name, column in both.items()}
