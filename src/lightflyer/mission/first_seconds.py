"""The first seconds after a release from a rocket or an aircraft, or in air too thin for balance.

Flights keep their inertia until all move as they do in balance; from there on they are in balance.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from lightflyer.core.errors import ParameterError
from lightflyer.core.progress import report
from lightflyer.environment.base import Place
from lightflyer.environment.wind.gridded import parts_at
from lightflyer.mission.by_parts import left_their_part, unflown
from lightflyer.mission.fleet import BATCH, Flights, each, one_of, pays_alone, take, work_of
from lightflyer.mission.path.dynamics import (
    PLACE,
    Inertia,
    Thrown,
    feel,
    is_balanced,
    state_at_release,
    track_with_inertia,
)
from lightflyer.mission.path.integration import ALTITUDE_SCALE, Accuracy, Limits, Start, Track
from lightflyer.mission.path.motion import INERTIA, Craft, in_balance
from lightflyer.mission.path.position import latitude_and_longitude
from lightflyer.mission.path.single import Way, follow_with_inertia
from lightflyer.mission.path.termination import TerminationReason
from lightflyer.program.entry_point import entry_point
from lightflyer.pytree import tree
from lightflyer.pytree.lazy_jax import jax

_FIRST = 5.0  # seconds after which is first looked whether all are in balance; then twice as many
_LOOKS = 65  # moments of these seconds that are kept
_STEPS = 200_000  # of a flight between two looks, at most
_FLYING = int(TerminationReason.STILL_FLYING)
_ENDS = "end_elapsed", "end_altitude", "end_position", "termination"

_Course = tuple[Limits, Any, Accuracy]  # With the times to keep [s], shape (n,)

_places = entry_point(latitude_and_longitude)


class Felt(NamedTuple):
    """What a flyer with inertia feels, shape (n,)."""

    ground: np.ndarray  # Velocity over ground, to the east, north and up [m/s], shape (n, 3)
    speed: np.ndarray  # Through the air [m/s]
    density: np.ndarray  # Of the gas [kg/m³]
    heat_capacity: np.ndarray  # Of the gas at constant pressure [J/(kg K)]
    acceleration: np.ndarray  # [m/s²]


@dataclass(frozen=True)
class Beginning:
    """Flights from the release until all are in balance, and what is to be flown from then on."""

    flights: Flights  # That begin where those of the release are in balance
    elapsed: np.ndarray  # Times to keep from then on, which begin with that moment [s], shape (n,)
    kept: np.ndarray  # All times to keep [s], shape (times,)
    tracks: Track | None = None  # Of all flights until then; None where they begin in balance
    way: Way | None = None  # Of the first flight until then, and what it feels on it
    felt: Callable[[np.ndarray], Felt] | None = None

    @property
    def until(self) -> float:
        """Time since the release from which all are in balance [s]."""
        return float(self.elapsed[0])

    def join(self, later: Track) -> Track:
        """Tracks from the release on; ``later``: from the moment on when all are in balance."""
        if self.tracks is None:
            return later
        count = len(later.end_altitude)  # fewer where a user ended it early
        found = tree.map_leaves(lambda leaf: np.array(leaf[:count]), self.tracks)
        flying = np.flatnonzero(found.termination == _FLYING)
        late = np.flatnonzero(self.kept > self.until)
        for name in ("altitude", "position"):
            getattr(found, name)[np.ix_(flying, late)] = getattr(later, name)[flying, 1:]
        for name in _ENDS:
            getattr(found, name)[flying] = getattr(later, name)[flying]
        return found

    def whole(self, later: Way | None = None) -> Way:
        """Way of the first flight from the release on; ``later``: from that moment on."""
        if self.way is None:
            assert later is not None
            return later
        if later is None or self.way.times[-1] < self.until:
            return self.way
        pieces = [*self.way.pieces, *later.pieces]
        return Way(np.append(self.way.times, later.times[1:]), pieces)


def begin(
    flights: Flights,
    limits: Limits,
    elapsed: np.ndarray,
    accuracy: Accuracy,
    inertia: Inertia | None = None,
) -> Beginning:
    """Fly until all flights are in balance, or, with ``inertia``, to the end."""
    craft, start = one_of(flights, 0)
    thrown = start.velocity is not None
    at_release = parts_at(craft, start.place), start
    if inertia is None and not thrown and _stays_in_balance(*at_release):
        return Beginning(flights, elapsed, elapsed)
    if thrown and craft.setup.flyer.floats:
        raise ParameterError(
            f"{craft.setup.flyer.describe()}: the gas that moves with a balloon is left out, so "
            "that it takes no velocity of a release"
        )
    near = replace(flights, setup=parts_at(flights.setup, start.place))
    released, alive = np.asarray(flights.starts.place.time), np.ones(flights.count, bool)
    states, tracks, first = np.asarray(_release(near, inertia)), unflown(flights, elapsed), []
    steps = accuracy if inertia is not None else replace(accuracy, steps=_STEPS)
    until, last, settled, spent = 0.0, float(elapsed[-1]), False, 0
    while until < last and not settled:
        since, until = until, last if inertia is not None else min(2.0 * until or _FIRST, last)
        report("flying with inertia", int(until), int(last), "s")
        looks = elapsed if inertia is not None else np.linspace(since, until, _LOOKS)
        now, spent = _throw_all(near, states, (limits, looks, steps), inertia, spent)
        if np.any(left_their_part(near.setup, now.track, released)):
            raise ParameterError(
                "with inertia a flight stays in the part of the wind's file around its release, "
                f"which it leaves within {until / 3600.0:.1f} h; shorten it, or take what it needs "
                "into memory: GriddedWind(xarray.open_dataset(file).sel(...))"
            )
        if alive[0]:
            first.append((looks, now))
        _keep(tracks, now, alive, elapsed, looks)
        states = np.where(alive[:, None], now.end, states)
        alive &= now.track.termination == _FLYING
        if until < last:
            settled = bool(np.all(_balanced(near, states, limits, until) | ~alive))
    place = Place(*_places(tracks.end_position), released)
    later = replace(flights, starts=Start(tracks.end_altitude, place))
    knots, spline = _spline_of_first(first)
    way = Way(knots, [lambda at: spline(at).T[PLACE]] * (len(knots) - 1))

    def felt(at: np.ndarray) -> Felt:
        given = one_of(near, 0)[0], start, limits, at, spline(at), inertia
        return Felt(*map(np.asarray, _feel(*given)))

    rest = np.append(until, elapsed[elapsed > until])
    return Beginning(later, rest, elapsed, tracks, way, felt)


@entry_point
def _stays_in_balance(craft: Craft, start: Start) -> Any:
    return in_balance(craft, craft.surroundings(start.altitude, start.place, 0.0))[2] < INERTIA


@entry_point
def _release(flights: Flights, inertia: Inertia | None) -> Any:
    return each(flights, lambda craft, start: state_at_release(craft, start, inertia))


@entry_point
def _balanced(flights: Flights, states: Any, limits: Limits, elapsed: Any) -> Any:
    return each(
        flights,
        lambda craft, start, state: is_balanced(craft, start, limits, elapsed, state),
        states,
    )


@partial(entry_point, way="xla")
def _throw(flights: Flights, states: Any, course: _Course, inertia: Inertia | None) -> Any:
    def one(craft: Craft, start: Start, state: Any) -> Thrown:
        return track_with_inertia(craft, start, state, *course, inertia)

    return each(flights, one, states)


@entry_point
def _feel(
    craft: Craft, start: Start, limits: Limits, elapsed: Any, states: Any, inertia: Inertia | None
) -> Any:
    return jax.vmap(lambda at, state: feel(craft, start, limits, at, state, inertia))(
        elapsed, states
    )


def _throw_all(
    flights: Flights, states: np.ndarray, course: _Course, inertia: Inertia | None, spent: int
) -> tuple[Thrown, int]:
    """Few one by one, more compiled and together, as in :func:`~.fleet.fly_all`.

    ``spent``: steps of single flights until now; returns those with the new ones, too.
    """
    count, alone, tracks = flights.count, list[Thrown](), list[Track]()
    while not alone or (len(alone) < count and pays_alone(count - 1, tracks, spent)):
        row = len(alone)
        craft, start = one_of(flights, row)
        alone.append(follow_with_inertia(craft, start, states[row], *course, inertia))
        tracks.append(alone[row].track)
    parts = [tree.map_leaves(lambda *rows: np.stack(rows), *alone)]
    size = max(min(BATCH, count - 1), 1)  # whichever were alone: of one size it compiles once
    for first in range(len(alone), count, size):
        rows = np.minimum(np.arange(first, first + size), count - 1)
        parts.append(_throw(take(flights, rows), states[rows], course, inertia))
    found: Thrown = tree.map_leaves(lambda *leaves: np.concatenate(leaves)[:count], *parts)
    return found, spent + work_of(tracks)


def _keep(
    tracks: Track, thrown: Thrown, alive: np.ndarray, elapsed: np.ndarray, looks: np.ndarray
) -> None:
    """Write down where flights are at the times to keep among some looks, and how they end."""
    from scipy.interpolate import CubicSpline

    now = np.flatnonzero((elapsed >= looks[0]) & (elapsed <= looks[-1]))
    known = np.isfinite(thrown.states).all(axis=-1, keepdims=True)
    states = np.where(known, thrown.states, thrown.end[:, None])
    flown = CubicSpline(looks, states[..., PLACE], axis=1)(elapsed[now])
    ended = elapsed[now] > thrown.track.end_elapsed[:, None]
    position = flown[..., :3] / np.linalg.norm(flown[..., :3], axis=-1, keepdims=True)
    rows = np.ix_(alive, now)
    tracks.altitude[rows] = np.where(ended, np.inf, flown[..., 3] * ALTITUDE_SCALE)[alive]
    tracks.position[rows] = np.where(ended[..., None], np.inf, position)[alive]
    for name in _ENDS:
        getattr(tracks, name)[alive] = getattr(thrown.track, name)[alive]
    tracks.steps[alive] += thrown.track.steps[alive]


def _spline_of_first(parts: list[tuple[np.ndarray, Thrown]]) -> tuple[np.ndarray, Any]:
    """Moments of the first flight, and its scaled states over time."""
    from scipy.interpolate import CubicSpline

    before = [looks < thrown.track.end_elapsed[0] for looks, thrown in parts]
    times = [looks[some] for some, (looks, _) in zip(before, parts, strict=True)]
    states = [thrown.states[0, some] for some, (_, thrown) in zip(before, parts, strict=True)]
    _, final = parts[-1]
    knots = np.append(np.concatenate(times), final.track.end_elapsed[0])
    return knots, CubicSpline(knots, np.vstack([*states, final.end[:1]]))
