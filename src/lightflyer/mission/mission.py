"""A mission: where a flyer goes, how long it stays up, and what ends it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import lightflyer
from lightflyer.array import tree
from lightflyer.config.designs import as_design
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import Duration, Quantity, quantity_of, require_record
from lightflyer.design.design import AbstractDesign
from lightflyer.design.setup import Setup
from lightflyer.environment.base import AbstractEnvironment, Place
from lightflyer.environment.wind.beyond import with_end_of_data
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel
from lightflyer.mission.areas import Circle
from lightflyer.mission.first_seconds import begin
from lightflyer.mission.fleet import BATCH, Ensemble, Flights, flights_of, fly_all, one_of
from lightflyer.mission.kept import Keep, describe_work, keep_in, keep_nothing
from lightflyer.mission.path.attitude import AbstractAttitudeRule, Own
from lightflyer.mission.path.dynamics import Inertia, follow
from lightflyer.mission.path.integration import (
    LONGEST_STEP,
    TOLERANCE,
    Accuracy,
    Limits,
    Start,
    Track,
)
from lightflyer.mission.path.moments import (
    VARIABLES,
    Course,
    Variable,
    moments,
    node_variables,
)
from lightflyer.mission.path.motion import Craft, planet_of
from lightflyer.mission.path.position import latitude_and_longitude
from lightflyer.mission.path.release import (
    Release,
    limits_of,
    require_at_rest,
    require_release_inside,
    require_rule,
)
from lightflyer.mission.path.termination import TerminationReason
from lightflyer.mission.report.assumptions import assumptions_of, describe_object
from lightflyer.mission.report.dataset import Several, add_several, add_survival, dataset_of
from lightflyer.mission.report.departure import add_departure, since
from lightflyer.mission.report.diagnostics import diagnose_flight, termination_text
from lightflyer.mission.report.events import add_events, close_look, events_of
from lightflyer.mission.report.landing import HIGHEST_GROUND, Landing, add_landing
from lightflyer.mission.report.station import add_station, stay_of
from lightflyer.mission.telemetry import Receiver, add_telemetry
from lightflyer.numerics.rootfind import SolverStatus
from lightflyer.statics.balance import ENERGY_TOLERANCE, require_converged

if TYPE_CHECKING:
    import xarray as xr

MOST_TIMES = 1440  # Times that are kept where nobody asks for a spacing
MOST_TIMES_OF_ENSEMBLE = 288  # The same beside an ensemble, each of whose members keeps its track

_places = entry_point(latitude_and_longitude)
_DURATION = quantity_of(Duration) or Quantity()
_DELAY = Quantity("s")
_ROUNDING = 1e-9
_SINKING = 1e-2  # more slowly a flyer stays where it is [m/s]
_SHORTEST = 60.0  # seconds between times that are kept where nobody asks for a spacing


def fly(
    what: Any,
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
    *,
    release: Release,
    duration: Any,
    attitude: AbstractAttitudeRule | None = None,
    every: Any = None,
    ensemble: Ensemble | None = None,
    launches: Sequence[float] = (),
    lowest: Any = None,
    highest: Any = None,
    station: Circle | None = None,
    landing: Landing | None = None,
    receivers: Sequence[Receiver] = (),
    inertia: Inertia | None = None,
    tolerance: float = TOLERANCE,
    folder: str | Path | None = None,
) -> "xr.Dataset":
    """Fly a mission: a trajectory in time, altitude, latitude and longitude.

    The flyer is in thermal equilibrium at each moment, and moves through the air at the velocity
    at which drag balances lift and weight. It goes with the wind. Released with a velocity, or in
    air too thin for that balance, it has inertia until it comes to it.

    Parameters
    ----------
    what : AbstractFlyer, Setup, FlyerFile, path of a flyer file, or AbstractDesign
    environment, model : optional
        Where ``what`` is a flyer. The sun moves if the environment has a sky, such as
        ``Earth(sky=...)``; otherwise the light stays what the environment states.
    release : Release
    duration : float
        [s], or a text such as ``"36 h"``.
    attitude : AbstractAttitudeRule, optional
        How the flyer lies; by default as it states itself.
    every : float, optional
        Time between the moments that are kept [s].
    ensemble : Ensemble, optional
        Flights within every ± of the design, and within those of wind and release.
    launches : sequence of float, optional
        Further releases of the same flyer, so many seconds after the first.
    lowest, highest : float, optional
        Altitudes at which the mission ends [m]; by default the ends of the environment.
    station : Circle, optional
        A place near which the flyer is to stay; the result says for how long it does.
    landing : Landing, optional
        Of how many flyers, and below which flight levels, where flights may reach the ground.
    receivers : sequence of Receiver, optional
        On the ground; the result says when each sees the flyer, and what margin and data the link
        of the payload then has.
    inertia : Inertia, optional
        Integrate velocity and temperature of all flights to the end, as a check that both follow
        at once.
    tolerance : float
        Error of a step of the integration.
    folder : path, optional
        Keeps the flights of ensemble and launches. The same call continues where it was
        interrupted.

    Returns
    -------
    xarray.Dataset
        Over ``elapsed``, the time since the release. The attributes name what ended the mission,
        what is assumed and warnings; see the documentation's page on missions.

    Raises
    ------
    ParameterError
        If the release is not within the environment, or the model is not for the flyer.
    ConfigurationError
        If this kind of flyer has no law of drag.
    OutputError
        If the folder holds flights of another mission, or something else.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> flown = lf.fly(
    ...     lf.Disk(film, radius=0.005), lf.Earth(), lf.FreeMolecular(), duration="6 h",
    ...     release=lf.Release("75 km", latitude=45.0, longitude=0.0, time="2026-06-21T12:00Z"),
    ... )
    >>> flown.attrs["end"]
    'is still aloft at the end of its time'
    """
    rule = require_record("attitude", (AbstractAttitudeRule,), attitude or Own())
    mission = _Mission(as_design(what, environment, model), rule, release)
    if station is not None:
        require_record("station", (Circle,), station)
    limits = limits_of(mission.setup.environment, lowest, highest)
    require_release_inside(release, limits)
    ends_at_ground = _ends_at_ground(limits, landing)
    # raises where the data of winds or ground do not reach
    remarks = require_rule(mission.craft, mission.start)
    launches = [float(_DELAY.number("launches", delay)) for delay in launches]
    several = ensemble is not None or len(launches) > 0
    elapsed = times_of(duration, every, several=several)
    plan = _Plan(limits, elapsed, Accuracy.for_duration(float(elapsed[-1]), tolerance))
    flights = flights_of(mission.design, mission.rule, mission.start, ensemble, launches)
    keep: Keep = keep_nothing
    if folder is not None and several:
        keep = keep_in(Path(folder), _describe(mission, plan, flights, ensemble))
    released = float(release.time)
    begun = begin(flights, *plan.course, inertia)
    if begun.tracks is not None and begun.elapsed.size == 1:
        tracks, way = begun.tracks, begun.whole()
    else:
        rest = limits, begun.elapsed, plan.accuracy
        start = mission.start if begun.tracks is None else one_of(begun.flights, 0)[1]
        balanced, later = follow(mission.craft, start, *rest)
        tracks, way = begun.join(fly_all(begun.flights, *rest, balanced, keep)), begun.whole(later)
    first = _rows(tracks, 0)
    craft = mission.craft
    closely = close_look(craft, way, released)
    dataset = _fly(mission, craft, plan, first)
    ending = with_end_of_data(mission.setup.environment)
    last = np.maximum(plan.elapsed[-1] - np.array([_SHORTEST, 0.0]), 0.0)
    rise = float(np.diff(way(last)[0])[0] / np.diff(last)[0])
    if int(first.termination) == TerminationReason.STILL_FLYING and abs(rise) > _SINKING:
        dataset.attrs["end"] += f", {'rising' if rise > 0.0 else 'sinking'} at {abs(rise):.2g} m/s"
    add_events(dataset, events_of(craft, way, *closely, ending))
    settled = closely if inertia is not None else since(begun.until, *closely)
    told = [*mission.design.warnings, *remarks, *diagnose_flight(craft, *settled)]
    if begun.felt is not None:
        told += add_departure(dataset, craft, begun, released)
    flown = len(tracks.end_altitude)
    whole = flown == flights.count  # unless a user ended it early
    if not whole:
        goes_on = "" if folder is None else ", the same call goes on"
        told.append(
            f"interrupted: {flown - 1} of {flights.count - 1} further flights were flown{goes_on}"
        )
    dataset.attrs["warnings"] = "\n".join(dict.fromkeys(told))
    times = np.asarray(flights.starts.place.time)
    if ensemble is not None and flown > 1:
        rows = slice(1, min(flown, 1 + ensemble.members))
        members = Several("ensemble_", "member", {}, _rows(tracks, rows), times[rows])
        add_several(dataset, members)
        add_survival(dataset, members)
    if len(launches) > 0 and whole:
        add_several(dataset, _launch(tracks, launches, times))
    dataset.attrs |= _record(mission, ensemble, inertia)
    if ends_at_ground:
        add_landing(dataset, craft, *closely, landing or Landing())
    if station is not None:
        radius = float(planet_of(mission.setup.environment).radius)
        add_station(dataset, station, stay_of(way, station, radius))
    add_telemetry(dataset, way, receivers, mission.setup.budget)
    return dataset


def trajectory(
    flyer: AbstractFlyer,
    environment: AbstractEnvironment,
    model: AbstractForceModel,
    release: Release,
    elapsed: Any,
    *,
    attitude: AbstractAttitudeRule | None = None,
    tolerance: float = TOLERANCE,
    longest_step: float = LONGEST_STEP,
) -> Track:
    """Way of one flyer as plain arrays.

    Parameters
    ----------
    flyer, environment, model, release, attitude, tolerance
        As for :func:`fly`.
    elapsed : array, shape (times,)
        Times since the release to keep [s], increasing from zero.
    longest_step : float
        Of the integration [s].

    Returns
    -------
    Track

    Notes
    -----
    By NumPy, and not differentiable by JAX: a difference of two flights tells how they depend on a
    number.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> release = lf.Release(75e3, latitude=45.0, longitude=0.0, time=0.0)
    >>> disk = lf.Disk(film, radius=0.01)
    >>> way = lf.mission.trajectory(disk, lf.Earth(), lf.FreeMolecular(), release, [0.0, 3600.0])
    >>> print(f"{way.end_altitude / 1e3:.1f} km")
    84.8 km
    """
    require_at_rest(release, "a trajectory")
    limits = limits_of(environment, None, None)
    times = np.asarray(elapsed, float)
    accuracy = Accuracy.for_duration(float(times[-1]), tolerance, longest_step)
    craft = Craft(Setup(flyer, environment, model), attitude or Own())
    found, _ = follow(craft, release.start(), limits, times, accuracy)
    return found


@dataclass(frozen=True)
class _Mission:
    """Who flies, how it lies, and from where."""

    design: AbstractDesign
    rule: AbstractAttitudeRule
    release: Release

    @property
    def setup(self) -> Setup:
        return self.design.setup

    @property
    def craft(self) -> Craft:
        return Craft(self.setup, self.rule)

    @property
    def start(self) -> Start:
        return self.release.start()


@dataclass(frozen=True)
class _Plan:
    """How far, and how exactly."""

    limits: Limits
    elapsed: np.ndarray
    accuracy: Accuracy

    @property
    def course(self) -> tuple[Limits, np.ndarray, Accuracy]:
        return self.limits, self.elapsed, self.accuracy


def times_of(duration: Any, every: Any = None, *, several: bool = False) -> np.ndarray:
    """Times that a mission keeps [s], shape (times,); from zero to the duration, evenly spaced."""
    length = _seconds("duration", duration)
    if every is None:
        spacing = max(_SHORTEST, length / (MOST_TIMES_OF_ENSEMBLE if several else MOST_TIMES))
    else:
        spacing = _seconds("every", every)
    return np.linspace(0.0, length, 1 + max(1, math.ceil(length / spacing - _ROUNDING)))


def _ends_at_ground(limits: Limits, landing: Landing | None) -> bool:
    lowest = float(limits.lowest)
    if landing is not None and lowest > HIGHEST_GROUND:
        raise ParameterError(
            f"landing has no effect: the mission ends at {lowest / 1e3:g} km, above any ground; "
            "lower its lowest altitude"
        )
    return lowest <= HIGHEST_GROUND


def _seconds(name: str, value: Any) -> float:
    number = float(_DURATION.number(name, value))
    _DURATION.check(name, number)
    return number


def _describe(
    mission: _Mission, plan: _Plan, flights: Flights, ensemble: Ensemble | None
) -> dict[str, str]:
    """Everything that decides the flights beside the first, in words that can be compared."""
    parts = {
        "release": mission.start,
        "ensemble": ensemble,
        "attitude": mission.rule,
        "altitudes": plan.limits,
        "times": plan.elapsed,
        "flights": [flights.starts, flights.varied],
    }
    return describe_work(mission.design, parts) | {"accuracy, batch": f"{plan.accuracy}, {BATCH}"}


def _launch(tracks: Track, launches: Sequence[float], times: np.ndarray) -> Several:
    """The release itself, and the later ones."""
    count = len(tracks.end_altitude)
    rows = [0, *range(count - len(launches), count)]
    delays = np.array([0.0, *launches])
    labels = {"launch_delay": (delays, Variable("s", "delay of the release"))}
    return Several("launch_", "launch", labels, _rows(tracks, rows), times[rows])


def _rows(tracks: Track, rows: Any) -> Track:
    return tree.map_leaves(lambda leaf: leaf[rows], tracks)


def _fly(mission: _Mission, craft: Craft, plan: _Plan, track: Track) -> "xr.Dataset":
    """The flight over time, with what the flyer is like at each moment."""
    released = float(mission.release.time)
    known = np.isfinite(track.altitude)
    course = Course(
        plan.elapsed,
        np.where(known, track.altitude, track.end_altitude),
        np.where(known[:, None], track.position, track.end_position),
        released,
    )
    values = moments(craft, course)
    residual = values.pop("residual")[known]
    missed = residual > ENERGY_TOLERANCE
    status = np.where(missed, int(SolverStatus.TOLERANCE_MISSED), int(SolverStatus.CONVERGED))
    require_converged("heat balance along the way", status, residual)
    found = {name: np.where(known, value, np.nan) for name, value in values.items()}
    variables = VARIABLES | node_variables(mission.setup.flyer.nodes)
    dataset = dataset_of(plan.elapsed, released, track, found, variables)
    dataset.attrs["end"] = _end(mission.setup.environment, released, track)
    return dataset


def _end(environment: AbstractEnvironment, released: float, track: Track) -> str:
    """Why the flight ended, in words."""
    latitude, longitude = _places(track.end_position)
    place = Place(latitude, longitude, released + float(track.end_elapsed))
    end = TerminationReason(int(track.termination))
    return termination_text(end, environment, float(track.end_altitude), place)


def _record(
    mission: _Mission, ensemble: Ensemble | None, inertia: Inertia | None
) -> dict[str, Any]:
    """What decides the results, for the dataset's attributes."""
    setup = mission.setup
    highest = setup.flyer.highest_temperature
    stated: dict[str, Any] = {}
    if highest is not None:
        stated["highest_temperature_k"] = float(highest)
    ending = with_end_of_data(setup.environment)
    if ending is not None:
        told = (text.removeprefix("wind: ") for text in ending.beyond.describe())
        stated["other_wind"] = "; ".join(told)
    return stated | {
        "title": "lightflyer mission",
        "lightflyer_version": lightflyer.__version__,
        "flyer": setup.flyer.describe(),
        "force_model": describe_object(setup.model),
        "planet": planet_of(setup.environment).name,
        "planet_radius_km": float(planet_of(setup.environment).radius) / 1e3,
        "assumptions": "\n".join(assumptions_of(setup, mission.rule, ensemble, inertia)),
    }
