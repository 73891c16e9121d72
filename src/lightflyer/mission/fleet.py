"""Many flights at once: flyers within their uncertainties, other winds, other releases."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from itertools import takewhile
from typing import Any

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Array, Numeric
from lightflyer.array.records import Module, field
from lightflyer.compute.scheduler import processors
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.core.progress import asked_to_end, report
from lightflyer.core.quantity import Checked, Distance, Duration, Fraction, Multiple, Speed
from lightflyer.design.design import AbstractDesign
from lightflyer.design.setup import Setup
from lightflyer.environment.base import AbstractEnvironment, Place
from lightflyer.environment.planet import EARTH_PLANET
from lightflyer.mission.kept import Keep, keep_nothing
from lightflyer.mission.path.attitude import AbstractAttitudeRule
from lightflyer.mission.path.dynamics import Balanced, follow, scale
from lightflyer.mission.path.integration import Accuracy, Limits, Start, Track, integrate
from lightflyer.mission.path.motion import Craft, planet_of
from lightflyer.mission.path.position import directions, latitude_and_longitude, unit_vector
from lightflyer.mission.path.termination import TerminationReason
from lightflyer.mission.path.waves import Tides, Waves, draw_waves
from lightflyer.mission.path.wind_error import WindError, draw_wind_errors
from lightflyer.numerics.spline import Spline
from lightflyer.uncertainty.inputs import draw, uncertain_inputs

BATCH = 1024
"""Flights that are integrated together, whose arrays stay in the processor's cache."""

MEMBERS = 200  # of an ensemble, unless it says otherwise
_A_DAY = 86_400.0
_WIND, _RELEASE, _DRAG, _WAVES = 1, 2, 3, 4
"""Added to the seed, so that one does not follow the other."""

_places, _unit_vector = entry_point(latitude_and_longitude), entry_point(unit_vector)


class Ensemble(Checked):
    """What is varied at random from flight to flight, beside the design's own uncertainties.

    Attributes
    ----------
    members : int
    seed : int
    together : bool
        Whether members are a swarm that is released at once, which meets one error of the wind and
        the same waves; otherwise each meets its own, as does one flyer on any day.
    wind, vertical_wind : array
        Standard uncertainty of each horizontal component of the wind, and of the vertical one
        [m/s].
    wind_correlation_time : array
        Time over which an error of the wind stays what it is [s].
    waves : array, optional
        Gravity waves and tides over their climatology [1]; zero for still air. By default 1 over
        the Earth, and none elsewhere, where their climatology is not known.
    drag : array
        Relative standard uncertainty of the drag [1]; by default that of the law of a disk, whose
        largest part is its warmth.
    altitude, distance, time, velocity : array
        Standard uncertainty of the release: of its altitude [m], of its place northward and
        eastward [m], of its time [s], and of each component of its velocity [m/s].
    """

    members: int = field(static=True, default=MEMBERS)
    seed: int = field(static=True, default=0)
    together: bool = field(static=True, default=False)
    wind: Speed = 0.0
    vertical_wind: Speed = 0.0
    wind_correlation_time: Duration = _A_DAY
    waves: Multiple | None = None
    drag: Fraction = 0.02
    altitude: Distance = 0.0
    distance: Distance = 0.0
    time: Numeric = 0.0
    velocity: Speed = 0.0

    def __check_init__(self) -> None:
        members: Any = self.members
        if not isinstance(members, int | np.integer):
            raise ParameterError(f"members = {members} must be a whole number")

    def waves_over(self, environment: AbstractEnvironment) -> float:
        """Size of the waves in some air, over their climatology."""
        known = planet_of(environment).name == EARTH_PLANET.name
        if self.waves is None:
            return float(known)
        scale = float(self.waves)
        if scale > 0.0 and not known:
            raise ParameterError(
                f"waves = {scale:g}: their climatology is the Earth's; over "
                f"{planet_of(environment).name} leave waves out"
            )
        return scale


class Flights(Module):
    """Flights that are computed together."""

    craft: Craft  # Numbers that differ from flight to flight have the shape (flights, 1, ...)
    starts: Start  # Numbers have the shape (flights, ...)
    together: bool = field(static=True, default=False)  # Whether members are one swarm

    @property
    def count(self) -> int:
        return len(self.starts.altitude)

    @property
    def varied(self) -> list[Array]:
        """Numbers of the craft that differ from flight to flight."""
        shape = self.count, 1
        return [leaf for leaf in tree.leaves(self.craft) if np.shape(leaf)[:2] == shape]


def flights_of(
    design: AbstractDesign,
    rule: AbstractAttitudeRule,
    start: Start,
    ensemble: Ensemble | None = None,
    delays: Sequence[float] = (),
    *,
    air_seed: int | None = None,
) -> Flights:
    """The flyer as it is stated, the members of an ensemble, and further launches.

    ``air_seed``: of the air that members meet together, unless it is the ensemble's.
    """
    radius = float(planet_of(design.setup.environment).radius)
    met = ensemble
    if ensemble is not None and ensemble.together and air_seed is not None:
        met = replace(ensemble, seed=air_seed)
    craft = Craft(
        _setups(design, ensemble, len(delays)),
        rule,
        _wind_errors(met, len(delays)),
        _waves(met, len(delays), design.setup.environment),
        _drags(ensemble, len(delays)),
    )
    together = ensemble is not None and ensemble.together
    return Flights(craft, _starts(start, ensemble, delays, radius), together)


def _setups(design: AbstractDesign, ensemble: Ensemble | None, launches: int) -> Setup:
    """The setup, whose uncertain numbers differ from flight to flight."""
    inputs = None if ensemble is None else uncertain_inputs(design)
    if ensemble is None or inputs is None:
        return design.setup
    stated = inputs.values[None]
    drawn = draw(inputs, ensemble.members, ensemble.seed)
    found: Setup = inputs.setup_of(
        np.concatenate([stated, drawn, np.repeat(stated, launches, axis=0)])
    )
    return found


def _wind_errors(ensemble: Ensemble | None, launches: int) -> WindError | None:
    """Errors of the members' wind, none in the other flights."""
    if ensemble is None or not (np.any(ensemble.wind) or np.any(ensemble.vertical_wind)):
        return None
    errors = draw_wind_errors(
        1 if ensemble.together else ensemble.members,
        float(ensemble.wind),
        float(ensemble.vertical_wind),
        float(ensemble.wind_correlation_time),
        ensemble.seed + _WIND,
    )
    return _of_members(errors, ensemble, launches)


def _of_members(drawn: Any, ensemble: Ensemble, launches: int) -> Any:
    """What members meet, one by one or all the same, and the other flights do not."""
    times = ensemble.members if ensemble.together else 1
    return tree.map_leaves(
        lambda part: _among_others(np.repeat(part, times, axis=0), launches)[:, None], drawn
    )


def _waves(
    ensemble: Ensemble | None, launches: int, environment: AbstractEnvironment
) -> Waves | None:
    """Waves of the members' air, none in the other flights."""
    scale = 0.0 if ensemble is None else ensemble.waves_over(environment)
    if ensemble is None or scale == 0.0:
        return None
    count = 1 if ensemble.together else ensemble.members
    waves = draw_waves(count, scale, ensemble.seed + _WAVES, tides_of(environment))
    found: Waves = _of_members(waves, ensemble, launches)
    return found


def tides_of(environment: AbstractEnvironment) -> Tides:
    """What an environment has of the tides itself."""
    parts = (getattr(environment, name, None) for name in ("wind", "atmosphere"))
    return Tides(*(bool(getattr(part, "has_tides", False)) for part in parts))


def _drags(ensemble: Ensemble | None, launches: int) -> Any:
    """The members' drag over that of the law, 1 in the other flights."""
    if ensemble is None or not np.any(ensemble.drag):
        return None
    normal = np.random.default_rng(ensemble.seed + _DRAG).standard_normal(ensemble.members)
    return np.exp(_among_others(float(ensemble.drag) * normal, launches))[:, None]


def _among_others(members: np.ndarray, launches: int) -> np.ndarray:
    """Values of the members, with zeros for the flyer as it is stated and for the launches."""
    return np.pad(members, [(1, launches)] + [(0, 0)] * (members.ndim - 1))


def _starts(
    start: Start, ensemble: Ensemble | None, delays: Sequence[float], radius: float
) -> Start:
    """Releases within their uncertainties, on a planet of some radius [m], and the later ones."""
    normal, kicks, moving = np.empty((0, 4)), np.empty((0, 3)), start.velocity
    if ensemble is not None:
        if moving is None and np.any(ensemble.velocity):
            raise ParameterError(
                "a velocity that is uncertain needs one of the release; add [mission.release]"
            )
        generator = np.random.default_rng(ensemble.seed + _RELEASE)
        spread = np.array(
            [
                float(ensemble.distance) / radius,
                float(ensemble.distance) / radius,
                float(ensemble.altitude),
                float(ensemble.time),
            ]
        )
        normal = spread * generator.standard_normal((ensemble.members, 4))
        kicks = float(ensemble.velocity) * generator.standard_normal((ensemble.members, 3))
    north, east, higher, later = _among_others(normal, len(delays)).T
    later[later.size - len(delays) :] = delays
    place = _move(start.place, north, east)
    altitude, time = float(start.altitude), float(start.place.time)
    if moving is not None:
        moving = np.asarray(moving) + _among_others(kicks, len(delays))
    return Start(altitude + higher, Place(*place, time + later), moving)


@entry_point
def _move(place: Place, north: Any, east: Any) -> tuple[Array, Array]:
    """Latitudes and longitudes some angles to the north and east of a place."""
    to_east, to_north = directions(place.latitude, place.longitude)
    here = unit_vector(place.latitude, place.longitude)
    return latitude_and_longitude(here + north[:, None] * to_north + east[:, None] * to_east)


def fly_all(
    flights: Flights,
    limits: Limits,
    elapsed: np.ndarray,
    accuracy: Accuracy,
    first: Track | None = None,
    keep: Keep = keep_nothing,
) -> Track:
    """Trajectories of flights; ``elapsed``: times to keep, shape (times,)."""
    if flights.together and flights.craft.waves is not None:
        guide, _ = follow(*guide_of(flights), limits, elapsed, accuracy)
        flights = around_guide(flights, guide, elapsed)
    # Fewer than there are flights where a user asks for an early end. ``first``: that of the first
    # flight, where it is known. ``keep``: has those of an interrupted call.
    count, alone = flights.count, int(first is not None)
    states, law = scale(flights.starts), law_of(flights, limits)

    flown = {}  # of each batch, in flights

    def fly_some(begin: int) -> Track:
        rows = np.arange(begin, min(begin + BATCH, count))

        def tell(share: float) -> None:
            flown[begin] = share * rows.size
            report("flying", alone + int(sum([*flown.values()])), count, "flights")

        return integrate(law.take(rows), states[rows], elapsed, accuracy, tell).track

    def compute(begin: int) -> Track | None:
        return None if asked_to_end() else keep(begin, partial(fly_some, begin))

    def whole(track: Track | None) -> bool:
        return track is not None and not np.any(
            np.equal(track.termination, TerminationReason.INTERRUPTED)
        )

    begins = range(alone, count, BATCH)
    tracks = [] if first is None else [tree.map_leaves(lambda leaf: np.asarray(leaf)[None], first)]
    workers = min(processors(), len(begins))
    with ThreadPoolExecutor(workers) if workers > 1 else nullcontext() as pool:
        found = map(compute, begins) if pool is None else pool.map(compute, begins)
        for begin, some in zip(begins, takewhile(whole, found), strict=False):
            tracks.append(some)
            flown[begin] = min(BATCH, count - begin)
    tracks = tracks or [unflown(take(flights, np.arange(0)), elapsed)]
    return tree.map_leaves(lambda *parts: np.concatenate(parts), *tracks)


def unflown(flights: Flights, elapsed: np.ndarray) -> Track:
    """Tracks of flights that have not begun."""
    count, starts = flights.count, flights.starts
    known: dict[str, Any] = {
        "altitude": np.full((count, elapsed.size), np.inf),
        "position": np.full((count, elapsed.size, 3), np.inf),
        "end_elapsed": np.zeros(count),
        "end_altitude": np.array(starts.altitude),
        "end_position": np.array(_unit_vector(starts.place.latitude, starts.place.longitude)),
        "termination": np.full(count, int(TerminationReason.STILL_FLYING)),
        "steps": np.zeros(count, int),
    }
    known["altitude"][:, 0], known["position"][:, 0] = known["end_altitude"], known["end_position"]
    return Track(**known)


def note(
    tracks: Track, rows: np.ndarray, elapsed: np.ndarray, times: np.ndarray, found: Track
) -> None:
    """Write down where some flights are from one time to another, and how they end.

    ``elapsed``: times of the tracks; ``times``: those of what was found, among which they are.
    """
    now = np.flatnonzero((elapsed > times[0]) & (elapsed <= times[-1]))
    kept = np.searchsorted(times, elapsed[now])
    for name in ("altitude", "position"):
        getattr(tracks, name)[np.ix_(rows, now)] = getattr(found, name)[:, kept]
    for name in ("end_elapsed", "end_altitude", "end_position", "termination"):
        getattr(tracks, name)[rows] = getattr(found, name)
    tracks.steps[rows] += found.steps


def law_of(flights: Flights, limits: Limits) -> Balanced:
    """What flights in balance follow."""
    return Balanced(flights.craft, np.reshape(flights.starts.place.time, (-1, 1)), limits)


def take(flights: Flights, rows: np.ndarray) -> Flights:
    """Some of the flights."""
    craft = tree.take_rows(flights.craft, (flights.count, 1), rows)
    starts = tree.map_leaves(lambda leaf: np.asarray(leaf)[rows], flights.starts)
    return replace(flights, craft=craft, starts=starts)


def one_of(flights: Flights, row: int) -> tuple[Craft, Start]:
    """Who flies one of the flights, and from where; the craft's numbers have the shape (1, 1)."""
    one = take(flights, np.array([row]))
    return one.craft, tree.map_leaves(lambda leaf: leaf[0], one.starts)


def guide_of(flights: Flights) -> tuple[Craft, Start]:
    """The flyer as it is stated, in the weather of the swarm; it meets waves as they are drawn."""
    craft, start = one_of(flights, 0)
    member, _ = one_of(flights, 1)
    return replace(craft, wind_error=member.wind_error, waves=member.waves), start


def around_guide(flights: Flights, guide: Track, elapsed: np.ndarray) -> Flights:
    """The flights of a swarm, in waves whose phases follow from the distance to its guide."""
    last = int(np.flatnonzero(np.isfinite(guide.altitude))[-1])
    latitude, longitude = _places(np.asarray(guide.position)[: last + 1])
    turned = np.unwrap(longitude)
    # after its end a flight goes on along the parallel, as it did at last
    rate = (turned[last] - turned[last - 1]) / (elapsed[last] - elapsed[last - 1]) if last else 0.0
    at = np.minimum(np.arange(elapsed.size), last)
    middle = _unit_vector(latitude[at], turned[at] + rate * (elapsed - elapsed[at]))
    assert flights.craft.waves is not None
    waves = replace(flights.craft.waves, middle=Spline.through(elapsed, np.asarray(middle)))
    return replace(flights, craft=replace(flights.craft, waves=waves))
