"""Why a mission ended."""

import math
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple, Protocol

import numpy as np

from lightflyer.array.namespace import Array, Numeric, by_numpy, xp
from lightflyer.array.records import Module, field
from lightflyer.core.progress import asked_to_end
from lightflyer.environment.base import Place
from lightflyer.numerics.rootfind import Reason
from lightflyer.statics.grid_refinement import crossing


class TerminationReason(Reason):
    """Why a mission ended."""

    STILL_FLYING = 0, "is still aloft at the end of its time"
    LOWEST_ALTITUDE = 1, "reached the lowest altitude"
    HIGHEST_ALTITUDE = 2, "reached the highest altitude"
    NO_DATA = 3, "met a place or a time without data"
    STEP_LIMIT = 4, "reached the limit of steps"
    TOO_HOT = 5, "got hotter than its film withstands"
    TORN = 6, "tore: a layer's tension passed its strength"
    INTERRUPTED = 7, "was interrupted"


ALTITUDE_SCALE = 100e3  # Altitude that counts as much as one radian along the ground [m]

TOLERANCE = 1e-8
"""Error of an interval, of the position in radians and of the altitude in
:data:`ALTITUDE_SCALE`."""

LONGEST_STEP = 3600.0
"""Longest interval [s]: a short day must not lie between two of its moments, which are ten minutes
apart."""

NODES = 10  # Moments of an interval
_SLOPES = [1, 5, 9]  # Nodes at which slopes are taken, for a parabola through them
_STEPS_AN_HOUR = 200  # at most, on average
_FEWEST_STEPS = 2000
_SECONDS_AN_HOUR = 3600.0
_EVENT_TOLERANCE = 1e-10  # of altitudes in ALTITUDE_SCALE, and of loads over what is borne

_NEARLY_FAILS = 0.95  # load over what is borne, from which on it is looked at closely
_SETTLED = 0.5  # of the tolerance: what further steps of Newton's method would change
_BEFORE = 0.1  # of the last coefficient but one, that the last is where it happens to be small
_MEANS = 0.3  # of the error of an interval: a change that leaves it what it is
_SLOW = 0.3  # of a change over the one before, from which on slopes are computed anew
_FAR = 0.03  # Change of altitude that a step of Newton's method does not exceed, 3 km
_PATIENCE = 12  # steps of Newton's method after which the first interval of a window is divided
_QUICK = 4  # steps up to which a window may grow
_WORSE = 0.7  # of a change over the one before, from which on a third of these are enough
_STEP = 1e-7  # of the differences that slopes are taken by
_GOES_ON = 1800.0  # seconds for which the first guess goes on with the last rate
_CAREFUL = 0.8  # of the longest interval that an error lets expect
_STILL = 0.7  # Share of members still flying below which the others leave the arrays
_TINY, _MOST_TINY = 10.0, 100
"""Length over the shortest up to which an interval is tiny, and steps through tiny ones after which
there is no way on."""

_PARTS = 3  # into which an interval is divided
_MOMENTS = 500  # intervals of all windows together, for arrays that stay in the processor's cache
_FEWEST, _MOST = 2, 48  # intervals of a window


class Start(Module):
    """Where and when a flyer is released; of many flyers numbers have an axis."""

    altitude: Numeric  # [m]
    place: Place
    # Over ground, to the east, north and up [m/s], shape (..., 3); None for at rest in the air
    velocity: Numeric | None = None


class Track(Module):
    """A trajectory; of many flyers fields have an axis in front."""

    altitude: Array  #: shape (times,); [m]; infinite after the end
    position: Array  #: shape (times, 3); unit vector in the planet's frame; infinite after the end
    end_elapsed: Array  #: Time since the release at the end [s]
    end_altitude: Array  #: Altitude at the end [m]
    end_position: Array  #: shape (3,)
    termination: Array  #: A :class:`~lightflyer.mission.path.integration.TerminationReason`
    steps: Array  #: Intervals of the integration, those that were divided included


class Limits(Module):
    """Altitudes between which a mission goes on."""

    lowest: Numeric  # [m]
    highest: Numeric  # [m]

    def inside(self, altitude: Array) -> Array:
        """The nearest altitude that the environment knows [m]."""
        return xp.clip(altitude, self.lowest, self.highest)


class Accuracy(Module):
    """How a trajectory is integrated."""

    steps: int = field(static=True)  # Limit of their number
    # Error of an interval; see :data:`TOLERANCE`
    tolerance: float = field(static=True, default=TOLERANCE)
    # Interval that is not exceeded; see :data:`LONGEST_STEP`
    longest: float = field(static=True, default=LONGEST_STEP)

    @classmethod
    def for_duration(
        cls, duration: float, tolerance: float = TOLERANCE, longest: float = LONGEST_STEP
    ) -> "Accuracy":
        """For a mission of some duration."""
        steps = duration / _SECONDS_AN_HOUR * _STEPS_AN_HOUR + 2.0 * duration / longest
        return cls(max(_FEWEST_STEPS, math.ceil(steps)), tolerance, longest)


class Plan(NamedTuple):
    """Between which altitudes flights go on, what times are kept, and how exactly."""

    limits: Limits
    elapsed: np.ndarray  # shape (times,) [s]
    accuracy: Accuracy


class Law(Protocol):
    """What flights follow. Times have the shape (members, n), states (members, n, components)."""

    @property
    def limits(self) -> Limits: ...

    @property
    def failures(self) -> tuple[TerminationReason, ...]: ...

    @property
    def first_step(self) -> float:
        """Length of the first interval [s]."""

    @property
    def shortest(self) -> float:
        """Below, there is something that cannot be integrated [s]."""

    @property
    def coupled(self) -> slice:
        """Components of which Newton's method needs the slopes of rates.

        What others change is followed from step to step.
        """

    def rate(self, elapsed: np.ndarray, states: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rates of scaled states [1/s], NaN where something is not known, and the largest load."""

    def loads(self, elapsed: np.ndarray, states: np.ndarray) -> np.ndarray:
        """Loads over what is borne [1], shape (members, n, failures)."""

    def take(self, rows: np.ndarray) -> "Law":
        """The law of some members."""


class Trajectory(NamedTuple):
    """Where a flyer is at any moment of a flight."""

    times: np.ndarray  # Between which it is smooth, from the release to the end, shape (n,) [s]
    states: Callable[[np.ndarray], np.ndarray]  # Scaled states at times (times,): (times, n)

    def __call__(self, elapsed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Altitudes [m], shape (times,), and unit vectors, shape (times, 3)."""
        states = self.states(elapsed)
        return states[:, 3] * ALTITUDE_SCALE, _directions(states)

    def times_within(self, longest: float) -> np.ndarray:
        """Times of the flight that are apart by no more than some time [s], shape (n,)."""
        end = float(self.times[-1])
        evenly = np.linspace(0.0, end, 1 + math.ceil(end / longest))
        return np.unique([*self.times, *evenly])

    def followed_by(self, later: "Trajectory") -> "Trajectory":
        """One trajectory after another; states are the components that both have."""

        def states(elapsed: np.ndarray) -> np.ndarray:
            before, after = self.states(elapsed), later.states(elapsed)
            shared = min(before.shape[1], after.shape[1])
            first = (elapsed <= self.times[-1])[:, None]
            return np.where(first, before[:, :shared], after[:, :shared])

        return Trajectory(np.append(self.times, later.times[1:]), states)


class Flown(NamedTuple):
    """What was flown."""

    track: Track  # Fields have an axis of members in front
    ends: np.ndarray  # Scaled states at the end, shape (members, components)
    trajectory: Trajectory  # Of the first member


class _Collocation(NamedTuple):
    """Matrices of an interval, with ``n`` nodes."""

    nodes: np.ndarray  # As shares of the interval, shape (n,)
    integrals: np.ndarray  # From rates to their integrals up to each node, shape (n, n)
    series: np.ndarray  # From rates to Legendre coefficients of their integral, shape (n + 1, n)
    slopes: np.ndarray  # From values at the nodes of _SLOPES to all by a parabola, shape (n, 3)
    states: np.ndarray  # From coefficients to the begin and nodes of each part, (parts, 1 + n, ...)
    rates: np.ndarray  # From values at the nodes to those at the nodes of each part, (parts, n, n)


@cache
def _collocation() -> _Collocation:
    """Radau's right nodes, zeros of :math:`P_n - P_{n-1}`, of which 1 is one."""
    legendre, n = np.polynomial.legendre, NODES
    places = np.sort(legendre.legroots([*[0.0] * (n - 1), -1.0, 1.0]).real)
    places[-1] = 1.0
    to_series = np.linalg.inv(legendre.legvander(places, n - 1))
    integrate = np.stack([legendre.legint(row, lbnd=-1) for row in np.eye(n)], axis=1)
    series, powers = 0.5 * integrate @ to_series, places[:, None] ** np.arange(len(_SLOPES))
    shares = np.append(0.0, 0.5 * (places + 1.0))
    at = -1.0 + 2.0 * (np.arange(_PARTS)[:, None] + shares) / _PARTS
    return _Collocation(
        shares[1:],
        legendre.legvander(places, n) @ series,
        series,
        powers @ np.linalg.inv(powers[_SLOPES]),
        legendre.legvander(at, n),
        legendre.legvander(at[:, 1:], n - 1) @ to_series,
    )


def _at(series: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Values (..., k) of polynomials (..., n + 1, k) at shares of their intervals (...)."""
    powers = np.polynomial.legendre.legvander(2.0 * share - 1.0, series.shape[-2] - 1)
    return (powers[..., None, :] @ series)[..., 0, :]


def _numbered(counts: np.ndarray) -> np.ndarray:
    """0, 1, ... up to each of some counts, one after the other."""
    return np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)


class _Flights:
    """Flights on their way; rows of arrays are the members that still fly, and few others.

    ``window`` has the intervals that are solved together, shape (members, intervals). Those of a
    member come one after the other from the first column on, ``count`` of them. What stands in the
    columns behind has no meaning.
    """

    def __init__(self, law: Law, states: np.ndarray, elapsed: np.ndarray, accuracy: Accuracy):
        members, components = states.shape
        inner = NODES, components
        interval = np.dtype([
            ("begin", float), ("end", float), ("state", float, components),  # at the begin
            ("inner", float, inner), ("rate", float, inner),  # states and rates at the nodes
            # of rates in each coupled component, and whether they are known
            ("slope", float, (*inner, len(range(components)[law.coupled]))), ("known", bool),
            ("moved", float), ("steps", int),  # last change by Newton's method, and its steps
            ("error", float),  # of the polynomial; NaN before it is known
            ("load", float),  # the largest at the nodes, over what is borne
        ])  # fmt: skip
        self.law, self.accuracy, self.elapsed = law, accuracy, elapsed
        first, self.last = float(elapsed[0]), float(elapsed[-1])
        self.rows, self.flying = np.arange(members), np.ones(members, bool)
        self.before = np.zeros(members, interval)  # what was flown last
        self.before["begin"], self.before["end"] = first - law.first_step, first
        self.before["inner"], self.before["error"] = states[:, None], np.nan
        width = int(np.clip(_MOMENTS // members, 1, _MOST))
        self.window, self.count = np.zeros((members, width), interval), np.zeros(members, int)
        self.most = np.full(members, _FEWEST)  # intervals of a member's window, at present
        self.until = np.full(members, np.inf)  # a time at which something was not known
        self.creeping = np.zeros(members, int)  # steps since when its intervals are tiny
        # of all members
        self.kept = np.full((members, elapsed.size, components), np.inf)
        self.kept[:, 0] = states
        self.ends, self.end_elapsed = states.copy(), np.full(members, first)
        self.termination = np.full(members, int(TerminationReason.STILL_FLYING))
        self.steps = np.zeros(members, int)
        self.pieces: list[tuple[Any, ...]] = []  # of the first: begin, end, coefficients

    def fly(self, tell: Callable[[float], None]) -> None:
        """Fly to the end; ``tell``: is told the share that has been flown."""
        while self.flying.any():
            left = np.where(self.flying, 1.0 - self.before["end"] / self.last, 0.0)
            tell(1.0 - float(left.sum()) / self.steps.size)
            if asked_to_end():
                self._end(np.flatnonzero(self.flying), TerminationReason.INTERRUPTED)
                return
            self._extend()
            times, rate = self._rates()
            self._leave_unknown(times, rate)
            if self.count.any():
                self._settle(*self._improve(rate))
            # at a pole, say, where a wind comes from all sides at once
            creeps = self.before["end"] - self.before["begin"] < _TINY * self.law.shortest
            self.creeping = np.where(creeps, self.creeping + 1, 0)
            stopped = self.flying & (self.creeping > _MOST_TINY)
            self._end(np.flatnonzero(stopped), TerminationReason.NO_DATA)
            if np.mean(self.flying) < _STILL and self.flying.any():
                rows = np.flatnonzero(self.flying)
                self.law = self.law.take(rows)
                for name in (
                    "rows", "flying", "before", "window", "count", "most", "until", "creeping"
                ):  # fmt: skip
                    setattr(self, name, getattr(self, name)[rows])

    def _extend(self) -> None:
        """Append intervals to the windows."""
        width = self.window.shape[1]
        bound = np.minimum(self.last, self.until)
        while True:
            last = self.window[np.arange(len(self.rows)), np.maximum(self.count - 1, 0)]
            before = np.where(self.count > 0, last, self.before)
            room = self.flying & (self.count < np.minimum(self.most, width))
            chosen = np.flatnonzero(room & (before["end"] < bound))
            if not chosen.size:
                return
            before, new = before[chosen], np.zeros(chosen.size, self.window.dtype)
            share = np.maximum(before["error"] / self.accuracy.tolerance, 1e-30)
            growth = np.clip(_CAREFUL * share ** (-1.0 / NODES), 0.5, 2.0)
            long = np.where(np.isnan(share), 1.0, growth) * (before["end"] - before["begin"])
            end = before["end"] + np.minimum(long, self.accuracy.longest)
            # nothing tiny is left over
            ends = end + 0.01 * long >= bound[chosen]
            new["begin"], new["end"] = before["end"], np.where(ends, bound[chosen], end)
            new["state"], rate = before["inner"][:, -1], before["rate"][:, -1:]
            after = (new["end"] - new["begin"])[:, None] * _collocation().nodes
            after = np.minimum(after, _GOES_ON)[..., None]
            new["rate"], new["inner"] = rate, new["state"][:, None] + after * rate
            new["moved"], new["error"] = np.inf, np.nan
            self.window[chosen, self.count[chosen]] = new
            self.count[chosen] += 1

    @property
    def _active(self) -> np.ndarray:
        """Which columns stand for something, up to the last that does."""
        return np.arange(max(int(self.count.max()), 1)) < self.count[:, None]

    def _rates(self) -> tuple[np.ndarray, np.ndarray]:
        """Moments, shape (members, columns, nodes), and rates there; slopes where they are new."""
        active, members = self._active, len(self.rows)
        window = np.where(active, self.window[:, : active.shape[1]], self.before[:, None])
        width = np.where(active, window["end"] - window["begin"], 0.0)
        begin = np.where(active, window["begin"], window["end"])
        times, states = begin[..., None] + width[..., None] * _collocation().nodes, window["inner"]
        components = states.shape[-1]
        flat = times.reshape(members, -1), states.reshape(members, -1, components)
        new = active & ~window["known"]
        rows = np.flatnonzero(new.any(axis=1))
        if not rows.size:
            return times, self._note_loads(active, *self.law.rate(*flat)).reshape(states.shape)
        if rows.size > _STILL * members:
            rows = np.arange(members)
        # neighbours of the moments that need slopes, one for each coupled component
        columns = np.argsort(~new[rows], axis=1, kind="stable")[:, : new.sum(axis=1).max()]
        at, coupled = (rows[:, None], columns), range(components)[self.law.coupled]
        beside = np.repeat(states[at][:, None, :, _SLOPES], len(coupled), axis=1)
        for number, component in enumerate(coupled):
            beside[:, number, ..., component] += _STEP
        shape = beside.shape
        later = np.broadcast_to(times[at][:, None, :, _SLOPES], shape[:-1]).reshape(rows.size, -1)
        beside = beside.reshape(rows.size, -1, components)
        if rows.size == members:
            both = zip(flat, (later, beside), strict=True)
            found, load = self.law.rate(*(np.concatenate(pair, axis=1) for pair in both))
            rate, moved = np.split(found, [flat[0].shape[1]], axis=1)
        else:
            (rate, load), (moved, _) = self.law.rate(*flat), self.law.take(rows).rate(later, beside)
        rate = self._note_loads(active, rate, load).reshape(states.shape)
        slope = (moved.reshape(shape) - rate[at][:, None, :, _SLOPES]) / _STEP
        slope = np.einsum("ns,mcisk->minkc", _collocation().slopes, np.nan_to_num(slope))
        here = new[at]
        at = np.broadcast_to(rows[:, None], here.shape)[here], columns[here]
        self.window["slope"][at], self.window["known"][at] = slope[here], True
        return times, rate

    def _note_loads(self, active: np.ndarray, rate: np.ndarray, load: np.ndarray) -> np.ndarray:
        """Rates, once the largest load of each interval is noted."""
        nodes = load[:, : active.shape[1] * NODES].reshape(*active.shape, NODES)
        self.window["load"][:, : active.shape[1]] = nodes.max(axis=2)
        return rate

    def _leave_unknown(self, times: np.ndarray, rate: np.ndarray) -> None:
        """Leave out intervals in which something is not known."""
        unknown = self._active[..., None] & ~np.isfinite(rate).all(axis=-1)
        met = np.flatnonzero(unknown.any(axis=(1, 2)))
        first = unknown[met].any(axis=2).argmax(axis=1)
        node = unknown[met, first].argmax(axis=1)
        self.until[met], self.count[met] = times[met, first, node], first
        for member, at in zip(met[first == 0], node[first == 0], strict=True):
            # the next one is as long as all is known
            begin = self.before["end"][member]
            long = times[member, 0, at - 1] - begin if at else 0.25 * (times[member, 0, 0] - begin)
            if long < self.law.shortest:
                self._end(np.array([member]), TerminationReason.NO_DATA)
            self.most[member], self.before["begin"][member] = _FEWEST, begin - long
            self.before["error"][member] = np.nan

    def _improve(self, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A step of Newton's method; coefficients of states, and changes over those before."""
        active, radau, coupled = self._active, _collocation(), self.law.coupled
        window = self.window[:, : active.shape[1]]
        width = np.where(active, window["end"] - window["begin"], 0.0)[..., None, None]
        rate = np.where(active[..., None, None], rate[:, : active.shape[1]], 0.0)
        slope = np.ascontiguousarray(window["slope"])
        shape, number = active.shape, slope.shape[-1]
        size = NODES * number
        # changes of the coupled components, by what they miss and by a change of the begin
        missed = window["state"][:, :, None] + width * (radau.integrals @ rate) - window["inner"]
        through = np.einsum("ij,mujab->muiajb", radau.integrals, slope[..., coupled, :])
        matrix = np.eye(size) - width * through.reshape(*shape, size, size)
        begins = np.broadcast_to(np.tile(np.eye(number), (NODES, 1)), (*shape, size, number))
        right = missed[..., coupled].reshape(*shape, size, 1)
        found = np.linalg.solve(matrix, np.concatenate([right, begins], axis=-1))
        answers = slope @ found.reshape(*shape, NODES, number, 1 + number)  # of the rates
        answers = width * (radau.integrals @ np.moveaxis(answers, -1, 0))
        alone, by_begin = missed + answers[0], np.moveaxis(answers[1:], 0, -1)
        # intervals begin where those before end
        change = np.zeros((*shape, rate.shape[-1]))
        for column in range(1, shape[1]):
            before, last = change[:, column - 1], (slice(None), column - 1, -1)
            follows = (by_begin[last] @ before[:, coupled, None])[..., 0]
            end = window["inner"][last] + alone[last] + before + follows
            change[:, column] = end - window["state"][:, column]
        by_change = (by_begin @ change[:, :, None, coupled, None])[..., 0]
        step = alone + by_change + change[:, :, None]
        step[..., 3] = np.clip(step[..., 3], -_FAR, _FAR)
        rate = rate + (slope @ step[..., coupled, None])[..., 0]
        moved = np.abs(step).max(axis=(2, 3))
        ratio = np.where(window["steps"] > 0, moved / window["moved"], 1.0)
        window["state"] += change
        window["inner"] += step
        window["rate"], window["moved"] = rate, moved
        window["steps"] += 1
        series = width * (radau.series @ rate)
        before_last, last = np.moveaxis(np.abs(series[:, :, -2:]).max(axis=3), -1, 0)
        window["error"] = np.maximum(last, _BEFORE * before_last)
        series[:, :, 0] += window["state"]
        return series, ratio

    def _settle(self, series: np.ndarray, ratio: np.ndarray) -> None:
        """Take what is known well enough, and divide what its polynomials do not follow."""
        active, tolerance = self._active, self.accuracy.tolerance
        columns, window = np.arange(active.shape[1]), self.window[:, : active.shape[1]]
        moved, error = window["moved"], window["error"]
        rest = np.where(ratio < 0.5, moved * ratio, moved)  # what the next step would change
        settled, follows = rest <= _SETTLED * tolerance, error <= tolerance
        taken = np.cumprod(active & settled & follows, axis=1).sum(axis=1)
        taken = np.minimum(taken, self.accuracy.steps - self.steps[self.rows])
        front = window["steps"][:, 0] * np.where(ratio[:, 0] > _WORSE, 3, 1)
        stuck = active[:, 0] & ~settled[:, 0] & (front > _PATIENCE)
        active[stuck, 1:] = False  # what comes after is computed anew
        divided = active & ~follows & (moved <= _MEANS * error)
        divided[:, 0] |= stuck
        divided &= columns >= taken[:, None]
        window["known"] &= (ratio < _SLOW) | (window["steps"] < 2)
        if taken.any():
            self._take(taken, series[:, : taken.max()])
        tiny = divided[:, 0] & ((window["end"] - window["begin"])[:, 0] < self.law.shortest)
        self._end(np.flatnonzero(tiny & self.flying), TerminationReason.NO_DATA)
        self.steps[self.rows] += divided.sum(axis=1)
        # as many at once as few steps settle
        quick = window["steps"][:, 0] <= _QUICK
        most = np.where(quick, np.minimum(2 * self.most, _MOST), np.maximum(self.most // 2, 1))
        self.most = np.where(stuck, _FEWEST, np.where(taken > 0, most, self.most))
        stays = active & (columns >= taken[:, None]) & self.flying[:, None]
        # intervals to the front, each as itself or by its parts
        number = np.where(stays, np.where(divided, _PARTS, 1), 0)
        source, part = np.repeat(np.arange(number.size), number.ravel()), _numbered(number.ravel())
        place, counts = _numbered(number.sum(axis=1)), number.sum(axis=1)
        fits = place < self.window.shape[1]
        source, part, place = source[fits], part[fits], place[fits]
        member, column = np.divmod(source, number.shape[1])
        found = self.window[member, column]
        some = np.flatnonzero(number[member, column] > 1)
        whole, which, radau = found[some], part[some], _collocation()
        edges = np.linspace(whole["begin"], whole["end"], _PARTS + 1)
        parts, order = whole.copy(), np.arange(some.size)
        parts["begin"], parts["end"] = edges[which, order], edges[which + 1, order]
        values = radau.states[which] @ series[member[some], column[some]]
        parts["state"], parts["inner"] = values[:, 0], values[:, 1:]
        parts["rate"] = radau.rates[which] @ whole["rate"]
        parts["slope"] = np.einsum("pij,pj...->pi...", radau.rates[which], whole["slope"])
        parts["moved"], parts["steps"], parts["error"] = np.inf, 0, np.nan
        found[some] = parts
        self.window[member, place] = found
        self.count = np.minimum(counts, self.window.shape[1])

    def _take(self, taken: np.ndarray, series: np.ndarray) -> None:
        """Note where members have flown in the first intervals of their windows."""
        window = self.window[:, : series.shape[1]]
        begin, end, columns = window["begin"], window["end"], np.arange(series.shape[1])
        done, members = columns < taken[:, None], np.flatnonzero(taken)
        when, why = self._meets(window, series, done)
        over = np.isfinite(when)
        stop = np.minimum(end, when[:, None])
        last = np.where(over, np.argmax(done & (end >= when[:, None]), axis=1), taken - 1)
        # states to keep
        row, column = np.nonzero(done & (columns <= last[:, None]))
        low, high = (
            np.searchsorted(self.elapsed, edge[row, column], "right") for edge in (begin, stop)
        )
        count = np.maximum(high - low, 0)
        place = _numbered(count) + np.repeat(low, count)
        at = np.repeat(row, count), np.repeat(column, count)
        share = (self.elapsed[place] - begin[at]) / (end - begin)[at]
        self.kept[self.rows[at[0]], place] = _at(series[at], share)
        if self.rows[0] == 0:
            self.pieces += [
                (begin[0, i], stop[0, i], end[0, i], series[0, i]) for i in column[row == 0]
            ]
        # where they are now
        at = members, last[members]
        self.before[members] = window[at]
        self.steps[self.rows[members]] += last[members] + 1
        passed = members[end[at] >= self.until[members]]
        self.until[passed] = np.inf
        ended = np.flatnonzero(over)
        at = ended, last[ended]
        state = _at(series[at], (when[ended] - begin[at]) / (end - begin)[at])
        self._end(ended, why[ended], when[ended], state)
        self._end(
            np.flatnonzero(self.flying & (self.before["end"] >= self.last)),
            TerminationReason.STILL_FLYING,
        )
        ran_out = self.flying & (self.steps[self.rows] >= self.accuracy.steps)
        self._end(np.flatnonzero(ran_out), TerminationReason.STEP_LIMIT)

    def _meets(
        self, window: np.ndarray, series: np.ndarray, done: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """When flights meet a limit or fail in what is done, infinite where not, and by what."""
        law, members, marks = self.law, len(done), 1 + NODES
        limits = law.limits.lowest / ALTITUDE_SCALE, law.limits.highest / ALTITUDE_SCALE
        reasons = [TerminationReason.LOWEST_ALTITUDE, TerminationReason.HIGHEST_ALTITUDE]
        # loads were computed with the rates, before a last step that hardly changed anything
        may_fail = bool((done & ~(window["load"] < _NEARLY_FAILS)).any())
        reasons += law.failures if may_fail else ()

        def beyond(law: Law, elapsed: np.ndarray, states: np.ndarray) -> list[np.ndarray]:
            found = [limits[0] - states[..., 3], states[..., 3] - limits[1]]
            if may_fail:
                found += [*np.moveaxis(law.loads(elapsed, states) - 1.0, -1, 0)]
            return found

        begin, long = window["begin"], window["end"] - window["begin"]
        times = begin[..., None] + long[..., None] * np.append(0.0, _collocation().nodes)
        states = np.concatenate([window["state"][:, :, None], window["inner"]], axis=2)
        times, states = times.reshape(members, -1), states.reshape(members, times[0].size, -1)
        when, why = np.full(members, np.inf), np.zeros(members, int)
        for number, value in enumerate(beyond(law, times, states)):
            over = (value > 0.0) & np.repeat(done, marks, axis=1)
            met = np.flatnonzero(over.any(axis=1))
            if not met.size:
                continue
            mark = over[met].argmax(axis=1)
            own, at = law.take(met), (met, mark // marks)

            def left(
                elapsed: np.ndarray, number: int = number, own: Law = own, at: Any = at
            ) -> Any:
                share = ((elapsed - begin[at]) / long[at]).T
                return beyond(own, elapsed.T, _at(series[at][:, None], share))[number].T

            until, since = times[met, mark], times[met, np.maximum(mark - 1, 0)]
            at_begin = mark % marks == 0
            found = crossing(left, since, until, ~at_begin, _EVENT_TOLERANCE)
            sooner = found < when[met]
            when[met[sooner]], why[met[sooner]] = found[sooner], int(reasons[number])
        return when, why

    def _end(self, members: np.ndarray, reason: Any, when: Any = None, states: Any = None) -> None:
        """End some flights, where they are unless that is told."""
        rows, before = self.rows[members], self.before[members]
        self.ends[rows] = before["inner"][:, -1] if states is None else states
        self.end_elapsed[rows] = before["end"] if when is None else when
        self.termination[rows] = reason
        self.flying[members], self.count[members] = False, 0


def integrate(
    law: Law,
    states: np.ndarray,
    elapsed: np.ndarray,
    accuracy: Accuracy,
    tell: Callable[[float], None] = lambda _: None,
) -> Flown:
    """Flights from scaled states (members, components) on; ``elapsed``: times to keep, (times,).

    ``tell`` is told the share that has been flown.
    """
    states, elapsed = np.array(states, float), np.asarray(elapsed, float)
    with by_numpy():
        flights = _Flights(law, states, elapsed, accuracy)
        flights.fly(tell)
    ends, kept = flights.ends, flights.kept
    track: dict[str, Any] = {
        "altitude": kept[..., 3] * ALTITUDE_SCALE,
        "position": _directions(kept),
        "end_elapsed": flights.end_elapsed,
        "end_altitude": ends[:, 3] * ALTITUDE_SCALE,
        "end_position": _directions(ends),
        "termination": flights.termination,
        "steps": flights.steps,
    }
    pieces = flights.pieces
    times = np.append(elapsed[0], [stop for _, stop, _, _ in pieces])

    def at_times(at: np.ndarray) -> np.ndarray:
        which = np.searchsorted(times, at) - 1
        known = (which >= 0) & (len(pieces) > 0)
        found = np.tile(states[0], (len(at), 1))
        for piece in np.unique(which[known]):
            begin, _, end, series = pieces[min(piece, len(pieces) - 1)]
            here = known & (which == piece)
            found[here] = _at(series, (at[here] - begin) / (end - begin))
        return found

    return Flown(Track(**track), ends, Trajectory(times, at_times))


def _directions(states: np.ndarray) -> np.ndarray:
    """Unit vectors of scaled states."""
    place = states[..., :3]
    with np.errstate(invalid="ignore"):
        found = place / np.linalg.norm(place, axis=-1, keepdims=True)
    return np.where(np.isfinite(place), found, np.inf)
