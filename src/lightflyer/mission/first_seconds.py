"""The first seconds after a release from a rocket or an aircraft, or in air too thin for balance.

Flights keep their inertia until all move as they do in balance; from there on they are in balance.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import by_numpy
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.core.progress import report
from lightflyer.environment.base import Place
from lightflyer.mission.fleet import Flights, note, one_of, unflown
from lightflyer.mission.path.dynamics import Inertia, Moving
from lightflyer.mission.path.integration import Accuracy, Limits, Start, Track, Way, integrate
from lightflyer.mission.path.motion import INERTIA, Craft, in_balance
from lightflyer.mission.path.position import latitude_and_longitude
from lightflyer.mission.path.termination import TerminationReason

_FIRST = 5.0  # seconds after which is first looked whether all are in balance; then twice as many
_STEPS = 200_000  # of a flight between two looks, at most
_BATCH = 64  # Flights that are integrated together: a state's slopes are many numbers
_FLYING = int(TerminationReason.STILL_FLYING)

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
        rest = tree.map_leaves(lambda leaf: leaf[flying], later)
        note(found, flying, self.kept, self.elapsed, rest)
        return found

    def whole(self, later: Way | None = None) -> Way:
        """Way of the first flight from the release on; ``later``: from that moment on."""
        if self.way is None:
            assert later is not None
            return later
        if later is None or self.way.times[-1] < self.until:
            return self.way
        return self.way.followed_by(later)


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
    if inertia is None and not thrown and np.all(_stays_in_balance(craft, start)):
        return Beginning(flights, elapsed, elapsed)
    if thrown and craft.setup.flyer.floats:
        raise ParameterError(
            f"{craft.setup.flyer.describe()}: the gas that moves with a balloon is left out, so "
            "that it takes no velocity of a release"
        )
    starts = tree.map_leaves(lambda leaf: np.asarray(leaf)[:, None], flights.starts)
    law = Moving(flights.craft, starts.place.time, limits, inertia)
    first = Moving(craft, starts.place.time[:1], limits, inertia)
    steps = accuracy if inertia is not None else replace(accuracy, steps=_STEPS)
    with by_numpy():
        states = law.at_release(starts)[:, 0]
    tracks, alive, way = unflown(flights, elapsed), np.ones(flights.count, bool), None
    until, last, settled = 0.0, float(elapsed[-1]), False
    while until < last and not settled:
        since, until = until, last if inertia is not None else min(2.0 * until or _FIRST, last)
        report("flying with inertia", int(until), int(last), "s")
        times = np.union1d([since, until], elapsed[(elapsed > since) & (elapsed < until)])
        rows = np.flatnonzero(alive)
        for some in np.array_split(rows, -(-rows.size // _BATCH)):
            found = integrate(law.take(some), states[some], times, steps)
            note(tracks, some, elapsed, times, found.track)
            states[some] = found.ends
            if some[0] == 0:
                way = found.way if way is None else way.followed_by(found.way)
        alive &= tracks.termination == _FLYING
        if until < last:
            with by_numpy():
                settled = bool(np.all(law.is_balanced(until, states[:, None])[:, 0] | ~alive))
    place = Place(*_places(tracks.end_position), np.asarray(flights.starts.place.time))
    later = replace(flights, starts=Start(tracks.end_altitude, place))

    def felt(at: np.ndarray) -> Felt:
        assert way is not None
        with by_numpy():
            return Felt(*(part[0] for part in first.feel(at, way.states(at)[None])))

    rest = np.append(until, elapsed[elapsed > until])
    return Beginning(later, rest, elapsed, tracks, way, felt)


@entry_point
def _stays_in_balance(craft: Craft, start: Start) -> Any:
    return in_balance(craft, craft.surroundings(start.altitude, start.place, 0.0))[2] < INERTIA
