"""Many flights at once: flyers within their uncertainties, other winds, other releases."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from itertools import takewhile
from typing import Any, NamedTuple

import numpy as np

from lightflyer.compute.scheduler import processors
from lightflyer.core.errors import ParameterError
from lightflyer.core.precision import float64
from lightflyer.core.progress import asked_to_end, report
from lightflyer.core.quantity import Checked, Distance, Duration, Fraction, Multiple, Speed
from lightflyer.core.types import Numeric
from lightflyer.design.design import AbstractDesign
from lightflyer.design.setup import Setup
from lightflyer.environment.base import AbstractEnvironment, Place
from lightflyer.environment.planet import EARTH_PLANET
from lightflyer.mission.kept import Keep, keep_nothing
from lightflyer.mission.path.attitude import AbstractAttitudeRule
from lightflyer.mission.path.integration import Accuracy, Limits, Start, Track, track
from lightflyer.mission.path.motion import Craft, planet_of
from lightflyer.mission.path.position import directions, latitude_and_longitude, unit_vector
from lightflyer.mission.path.single import follow
from lightflyer.mission.path.waves import Tides, Waves, draw_waves
from lightflyer.mission.path.wind_error import WindError, draw_wind_errors
from lightflyer.numerics.spline import Spline
from lightflyer.program.entry_point import entry_point
from lightflyer.pytree import tree
from lightflyer.pytree.lazy_jax import Array, jax, jnp
from lightflyer.pytree.module import Module, field
from lightflyer.uncertainty.inputs import draw, uncertain_inputs

BATCH = 256
"""Flights that are integrated together: a step costs each of them what the slowest needs."""

MEMBERS = 200  # of an ensemble, unless it says otherwise
FEW = 4  # Flights up to which each is followed by itself, whatever that takes
COMPILATION, BEGINNING = 80_000, 30
"""Steps of single flights that take as long as XLA's compiler, and as what comes before the first
step of one of them."""
_A_DAY = 86_400.0
_WIND, _RELEASE, _DRAG, _WAVES = (
    1,
    2,
    3,
    4,
)  # added to the seed, so that one does not follow the other
_places, _unit_vector = entry_point(latitude_and_longitude), entry_point(unit_vector)
_ANOTHER = 7  # any number of flights that no table of a flyer happens to have as its length


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


class Errors(NamedTuple):
    """What differs from flight to flight beside the flyer, as :class:`Craft` takes it."""

    wind_error: WindError | None
    waves: Waves | None
    drag: Array | None


class Flights(Module):
    """Flights that are computed together."""

    setup: Setup  # Numbers that are the same in all flights; None in place of the others
    varied: Setup  # The others, each with a leading axis
    starts: Start  # Numbers have a leading axis
    errors: "Errors"  # Fields have a leading axis
    rule: AbstractAttitudeRule
    together: bool = field(static=True, default=False)  # Whether members are one swarm

    @property
    def count(self) -> int:
        return len(self.starts.altitude)


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
    setup, varied = _separate(design, ensemble, len(delays))
    radius = float(planet_of(design.setup.environment).radius)
    starts = _starts(start, ensemble, delays, radius)
    met = ensemble
    if ensemble is not None and ensemble.together and air_seed is not None:
        met = replace(ensemble, seed=air_seed)
    errors = Errors(
        _wind_errors(met, len(delays)),
        _waves(met, len(delays), design.setup.environment),
        _drags(ensemble, len(delays)),
    )
    together = ensemble is not None and ensemble.together
    return Flights(setup, varied, starts, errors, rule, together)


def _separate(
    design: AbstractDesign, ensemble: Ensemble | None, launches: int
) -> tuple[Setup, Setup]:
    """Setup without the numbers that differ from flight to flight, and those alone."""
    inputs = None if ensemble is None else uncertain_inputs(design)
    if ensemble is None or inputs is None:
        return design.setup, tree.map_leaves(lambda _: None, design.setup)
    stated = inputs.values[None]
    drawn = draw(inputs, ensemble.members, ensemble.seed)
    samples = np.concatenate([stated, drawn, np.repeat(stated, launches, axis=0)])
    with float64():
        shapes = [
            jax.eval_shape(inputs.build, jax.ShapeDtypeStruct(shape, float))
            for shape in ((inputs.values.size,), (inputs.values.size, _ANOTHER))
        ]
        moved = tree.map_leaves(lambda one, many: one.shape != many.shape, *shapes)
        _, constant = tree.partition(inputs.build(inputs.values), moved)

        def moving(values: Any) -> Setup:
            found, _ = tree.partition(inputs.build(values), moved)
            return tree.map_leaves(jnp.asarray, found)

        return constant, tree.map_leaves(np.asarray, jax.vmap(moving)(samples))


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
        lambda part: _among_others(np.repeat(part, times, axis=0), launches), drawn
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
    return np.exp(_among_others(float(ensemble.drag) * normal, launches))


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


def each(flights: Flights, function: Callable[..., Any], *more: Any) -> Any:
    """A function of craft, start and ``more`` of each flight; results have a leading axis."""

    def one(varied: Setup, start: Start, errors: Errors, *rest: Any) -> Any:
        craft = Craft(tree.combine(varied, flights.setup), flights.rule, *errors)
        return function(craft, start, *rest)

    return jax.vmap(one)(flights.varied, flights.starts, flights.errors, *more)


def _integrate(flights: Flights, limits: Limits, elapsed: Any, accuracy: Accuracy) -> Track:
    found: Track = each(
        flights, lambda craft, start: track(craft, start, limits, elapsed, accuracy)
    )
    return found


_tracks = entry_point(_integrate, way="xla")  # thousands of steps one after the other


def fly_all(
    flights: Flights,
    limits: Limits,
    elapsed: np.ndarray,
    accuracy: Accuracy,
    first: Track | None = None,
    size: int | None = None,
    keep: Keep = keep_nothing,
) -> Track:
    """Trajectories of flights; ``elapsed``: times to keep, shape (times,)."""
    # Fewer than there are flights where a user asks for an early end. ``first``: that of the first
    # flight, where it is known. Few are followed one by one, more are compiled and integrated
    # together, ``size`` of them at once. ``keep``: has those of an interrupted call.
    count, known = flights.count, [] if first is None else [first]
    others = count - len(known)

    def follow_one(row: int) -> Track:
        return follow(*one_of(flights, row), limits, elapsed, accuracy)[0]

    while len(known) < count and pays_alone(others, known) and not asked_to_end():
        row = len(known)
        known.append(keep(row, partial(follow_one, row)))
    alone = len(known)
    tracks: list[Track | None] = []
    if known:
        tracks.append(tree.map_leaves(lambda *rows: np.stack(rows), *known))
    size = size or min(BATCH, count - alone)
    starts = range(alone, count, max(size, 1))

    def fly_some(start: int) -> Track:
        rows = np.minimum(np.arange(start, start + size), count - 1)  # filled up with the last
        tracks = _tracks(take(flights, rows), limits, elapsed, accuracy)
        return tree.map_leaves(lambda leaf: leaf[: count - start], tracks)

    def compute(start: int) -> Track | None:
        return None if asked_to_end() else keep(start, partial(fly_some, start))

    if starts:
        report("compiling what flies many at once")
        tracks.append(compute(alone))
    with ThreadPoolExecutor(processors()) as pool:
        for start, some in zip(starts[1:], pool.map(compute, starts[1:]), strict=True):
            report("flying", start, count, "flights")
            tracks.append(some)
    flown = [*takewhile(lambda some: some is not None, tracks)]
    report("flying", count, count, "flights")
    return tree.map_leaves(lambda *parts: np.concatenate(parts), *flown)


def pays_alone(count: int, known: list[Track], spent: int = 0) -> bool:
    """Whether flights are followed one by one, by what those that are known took.

    ``spent``: steps of single flights that were taken for the same before.
    """
    if count <= FEW:
        return True
    return bool(known) and spent + count * work_of(known) / len(known) <= COMPILATION


def work_of(tracks: list[Track]) -> int:
    """Steps of single flights that some took, or that take as long."""
    return sum(BEGINNING + int(track.steps) for track in tracks)


def one_of(flights: Flights, row: int) -> tuple[Craft, Start]:
    """Who flies one of the flights, and from where."""
    parts = flights.varied, flights.starts, flights.errors
    varied, start, errors = tree.map_leaves(lambda leaf: np.asarray(leaf)[row], parts)
    return Craft(tree.combine(varied, flights.setup), flights.rule, *errors), start


def take(flights: Flights, rows: Any) -> Flights:
    """Some of the flights."""
    parts = flights.varied, flights.starts, flights.errors
    varied, starts, errors = tree.map_leaves(lambda leaf: np.asarray(leaf)[rows], parts)
    return replace(flights, varied=varied, starts=starts, errors=errors)


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
    path = tree.map_leaves(
        lambda leaf: np.broadcast_to(leaf, (flights.count, *leaf.shape)),
        Spline.through(elapsed, np.asarray(middle)),
    )
    assert flights.errors.waves is not None
    waves = replace(flights.errors.waves, middle=path)
    return replace(flights, errors=flights.errors._replace(waves=waves))
