"""The way of one flyer, by SciPy's LSODA: nothing is compiled.

Near its balance a balloon's motion is stiff, and LSODA goes on with long steps there. Its steps do
not depend on the times that are kept, which lie between them.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from lightflyer.core.progress import asked_to_end, report
from lightflyer.environment.base import Place
from lightflyer.environment.wind.gridded import hold, parts_at
from lightflyer.mission.path.dynamics import (
    PLACE,
    Inertia,
    Thrown,
    failures_with_inertia,
    loads_with_inertia,
    rate_with_inertia,
)
from lightflyer.mission.path.failure import failures_of
from lightflyer.mission.path.integration import (
    ALTITUDE_SCALE,
    Accuracy,
    Limits,
    Start,
    Track,
    altitude_and_place,
    loads_of_state,
    scale_state,
    steady_rate,
)
from lightflyer.mission.path.motion import Craft
from lightflyer.mission.path.termination import TerminationReason
from lightflyer.program.entry_point import bind, entry_point

_ROUNDING = 1e-13  # relative tolerance: SciPy wants one, the absolute one decides
_AN_HOUR = 3600.0
_SHORTEST = 1e-3  # seconds: how closely the end of data is found

_LOOKS_APART = 300.0  # Longest time between looks at what may fail [s]

_rate, _rate_with_inertia = entry_point(steady_rate), entry_point(rate_with_inertia)
_there = entry_point(altitude_and_place)
_loads, _loads_with_inertia = entry_point(loads_of_state), entry_point(loads_with_inertia)
_scaled = entry_point(scale_state)


class Way(NamedTuple):
    """Where a flyer is at any moment of a flight."""

    times: np.ndarray  # Between which it is smooth, from the release to the end, shape (n,) [s]
    pieces: Sequence[Callable[[np.ndarray], np.ndarray]]  # Scaled states, each between two of them

    def __call__(self, elapsed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Altitudes [m], shape (times,), and unit vectors, shape (times, 3)."""
        states = self.states(elapsed)
        length = np.linalg.norm(states[:, :3], axis=1, keepdims=True)
        return states[:, 3] * ALTITUDE_SCALE, states[:, :3] / length

    def states(self, elapsed: np.ndarray) -> np.ndarray:
        """Scaled states, shape (times, n)."""
        place = np.clip(np.searchsorted(self.times, elapsed) - 1, 0, len(self.pieces) - 1)
        states = np.empty((len(elapsed), len(self.pieces[0](self.times[:1]))))
        for piece in np.unique(place):
            states[place == piece] = self.pieces[piece](elapsed[place == piece]).T
        return states


def follow(
    craft: Craft, start: Start, limits: Limits, elapsed: Any, accuracy: Accuracy
) -> tuple[Track, Way]:
    """Flight of one flyer whose numbers are known; ``elapsed``: times to keep, shape (times,)."""
    laws = _Laws(_rate, _loads, failures_of(craft.setup.flyer))
    return _follow(laws, (craft, start, limits), np.asarray(_scaled(start)), elapsed, accuracy)


def follow_with_inertia(
    craft: Craft,
    start: Start,
    state: np.ndarray,
    limits: Limits,
    elapsed: np.ndarray,
    accuracy: Accuracy,
    inertia: Inertia | None,
) -> Thrown:
    """What :func:`~lightflyer.mission.path.dynamics.track_with_inertia` gives."""
    laws = _Laws(_rate_with_inertia, _loads_with_inertia, failures_with_inertia(craft, inertia))
    given = craft, start, limits, inertia
    track, way = _follow(laws, given, state, elapsed, accuracy)
    states: Any = np.full((len(elapsed), state.size), np.inf)
    flown = elapsed <= track.end_elapsed
    states[flown] = way.states(elapsed[flown])
    end: Any = way.states(way.times[-1:])[0]
    return Thrown(track, states, end)


class _Laws(NamedTuple):
    """What a flight follows: entry points of what is known, then of time and scaled state."""

    rate: Callable[..., Any]
    loads: Callable[..., Any]
    failures: tuple[TerminationReason, ...]  # By the loads


def _follow(
    laws: _Laws, given: tuple[Any, ...], state: np.ndarray, elapsed: Any, accuracy: Accuracy
) -> tuple[Track, Way]:
    """Flight from a scaled state on; ``given``: craft, start, limits and what else is known."""
    rate = _Rate(laws.rate, given, float(elapsed[0]), state)
    last = until = float(elapsed[-1])
    solver = _solver(rate, float(elapsed[0]), state, last, accuracy)
    steps, times, pieces = 0, [float(elapsed[0])], []
    watch = _watch(laws, (rate.craft, *given[1:]), state, last)
    end = watch(lambda _: state, times[0], times[0])
    while solver.t < last and steps < accuracy.steps and end is None:
        if solver.status != "running":  # before something that is not known: closer to it
            if until - solver.t < _SHORTEST:
                break
            middle = 0.5 * (solver.t + until)
            solver = _solver(rate, solver.t, solver.y, middle, accuracy)
        try:
            solver.step()
        except _UnknownError as error:
            until, solver.status = error.elapsed, "failed"
            continue
        if solver.status == "failed":
            until = 0.5 * (solver.t + until)
            continue
        steps += 1
        if last > _AN_HOUR:  # seconds are not worth a line
            report("flying", int(solver.t / _AN_HOUR), int(last / _AN_HOUR), "h")
        between = solver.dense_output()
        end = watch(between, solver.t_old, solver.t)
        times.append(solver.t if end is None else end[0])
        pieces.append(between)
    way = Way(np.array(times), pieces or [lambda at: np.tile(state[:, None], len(at))])
    if end is not None:
        reason = end[1]
    elif solver.t >= last:
        reason = TerminationReason.STILL_FLYING
    else:
        ran_out = steps >= accuracy.steps
        reason = TerminationReason.STEP_LIMIT if ran_out else TerminationReason.NO_DATA
    flown = elapsed <= times[-1]
    altitude, position = np.full(len(elapsed), np.inf), np.full((len(elapsed), 3), np.inf)
    altitude[flown], position[flown] = way(elapsed[flown])
    (end_altitude,), (end_position,) = way(np.array(times[-1:]))
    found: dict[str, Any] = {
        "altitude": altitude,
        "position": position,
        "end_elapsed": np.float64(times[-1]),
        "end_altitude": end_altitude,
        "end_position": end_position,
        "termination": np.int64(reason),
        "steps": np.int64(steps),
    }
    return Track(**found), way


class _Rate:
    """Rate of a scaled state, whose winds from files are the parts around it."""

    def __init__(
        self, rate: Callable[..., Any], given: tuple[Any, ...], elapsed: float, state: np.ndarray
    ):
        self._rate, self._given = rate, given
        self._read(elapsed, state)

    def _read(self, elapsed: float, state: np.ndarray) -> None:
        craft, *others = self._given
        self.craft = parts_at(craft, self._place(elapsed, state))
        self._bound = bind(self._rate, self.craft, *others, example=(elapsed, state))

    def _place(self, elapsed: float, state: np.ndarray) -> Place:
        return _there(self._given[1], state[PLACE], elapsed)[1]  # type: ignore[arg-type]

    def __call__(self, elapsed: float, state: np.ndarray) -> Any:
        found = self._bound(np.float64(elapsed), state)
        if np.isfinite(found).all() or hold(self.craft, self._place(elapsed, state)):
            return found
        self._read(elapsed, state)
        return self._bound(np.float64(elapsed), state)


class _UnknownError(Exception):
    """A rate is not known at some time, such as beyond the data of a wind."""

    def __init__(self, elapsed: float):
        super().__init__(elapsed)
        self.elapsed = elapsed


def _solver(
    rate: Callable[..., Any], start: float, state: np.ndarray, end: float, accuracy: Accuracy
) -> Any:
    """SciPy's integrator of a scaled state between two times [s]."""
    from scipy.integrate import LSODA

    def known_rate(time: float, flown: np.ndarray) -> np.ndarray:
        found: np.ndarray = rate(time, flown)
        if not np.isfinite(found).all():
            raise _UnknownError(time)
        return found

    return LSODA(
        known_rate, start, state, end,
        max_step=accuracy.longest, rtol=_ROUNDING, atol=accuracy.tolerance,
    )  # fmt: skip


_End = tuple[float, TerminationReason]
_Between = Callable[[float], np.ndarray]


def _watch(
    laws: _Laws, given: tuple[Any, ...], state: np.ndarray, last: float
) -> Callable[[_Between, float, float], _End | None]:
    """What says when and how a flight ends in a step, or None where it does not."""
    limits: Limits = given[2]
    load = bind(laws.loads, *given, example=(0.0, state)) if laws.failures else None

    def look(between: _Between, begin: float, end: float) -> _End | None:
        ends = _leaves(between, begin, end, limits)
        if load is not None:
            ends += _fails(load, laws.failures, between, begin, end)
        if asked_to_end() and end < last:
            ends.append((end, TerminationReason.INTERRUPTED))
        return min(ends, default=None)

    return look


def _leaves(between: _Between, start: float, end: float, limits: Limits) -> list[_End]:
    """When and how a flyer leaves its limits in a step."""
    from scipy.optimize import brentq

    found = []
    for bound, sign, reason in (
        (limits.lowest, 1.0, TerminationReason.LOWEST_ALTITUDE),
        (limits.highest, -1.0, TerminationReason.HIGHEST_ALTITUDE),
    ):

        def inside(time: float, bound: Any = bound, sign: float = sign) -> float:
            return float(sign * (between(time)[3] - bound / ALTITUDE_SCALE))

        if inside(end) < 0.0:
            found.append((start if inside(start) <= 0.0 else brentq(inside, start, end), reason))
    return found


def _fails(
    load: Callable[..., Any],
    failures: tuple[TerminationReason, ...],
    between: _Between,
    start: float,
    end: float,
) -> list[_End]:
    """When and by what a flyer fails in a step."""
    from scipy.optimize import brentq

    count = math.ceil((end - start) / _LOOKS_APART)
    times = np.linspace(start, end, 1 + count)[-max(count, 1) :]  # the start was looked at before
    looks = np.array([load(time, between(time)) for time in times])
    found = []
    for number, reason in enumerate(failures):

        def over(time: float, number: int = number) -> float:
            return float(load(np.float64(time), between(time))[number]) - 1.0

        (beyond,) = np.nonzero(looks[:, number] > 1.0)
        if beyond.size:
            first = int(beyond[0])
            last = start if first == 0 else times[first - 1]
            since = last if over(last) >= 0.0 else brentq(over, last, times[first])
            found.append((float(since), reason))
    return found
