"""A mission: where a flyer goes, how long it stays up, and what ends it."""

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import lightflyer
from lightflyer.array import tree
from lightflyer.array.records import field
from lightflyer.config.designs import as_design
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import (
    Altitude,
    Checked,
    Duration,
    Quantity,
    quantity_of,
    require_record,
)
from lightflyer.design.setup import Setup
from lightflyer.environment.base import AbstractEnvironment, Place
from lightflyer.environment.wind.gridded import with_end_of_data
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel
from lightflyer.mission.areas import Circle, geographic
from lightflyer.mission.fleet import BATCH, Ensemble, WorkFolder, describe_work, flights_of
from lightflyer.mission.path.attitude import AbstractAttitudeRule, Own
from lightflyer.mission.path.dynamics import Inertia, follow
from lightflyer.mission.path.integration import (
    LONGEST_STEP,
    TOLERANCE,
    Accuracy,
    Plan,
    TerminationReason,
    Track,
)
from lightflyer.mission.path.motion import Course, Vehicle, moments, planet_of
from lightflyer.mission.path.release import (
    Release,
    limits_of,
    require_release_inside,
    require_rule,
)
from lightflyer.mission.report.assumptions import (
    assumptions_of,
    describe_object,
    diagnose_flight,
    termination_text,
)
from lightflyer.mission.report.dataset import add_several, dataset_of
from lightflyer.mission.report.events import add_events, events_of, sample_flight
from lightflyer.mission.report.ground import Receiver, add_station, add_telemetry
from lightflyer.mission.report.landing import HIGHEST_GROUND, Landing, add_landing
from lightflyer.mission.transient import add_transient, fly_flights, since
from lightflyer.numerics.rootfind import SolverStatus
from lightflyer.statics.balance import ENERGY_TOLERANCE, require_converged

if TYPE_CHECKING:
    import xarray as xr

MOST_TIMES = 1440  # Times that are kept where nobody asks for a spacing
MOST_TIMES_OF_ENSEMBLE = 288  # The same beside an ensemble, each of whose members keeps its track

_DURATION = quantity_of(Duration) or Quantity()
_DELAY = Quantity("s")
_ROUNDING = 1e-9
_SINKING = 1e-2  # more slowly a flyer stays where it is [m/s]
_SHORTEST = 60.0  # seconds between times that are kept where nobody asks for a spacing


class Mission(Checked):
    """From where and when, for how long, and how a flyer flies, and what is flown beside it.

    Attributes
    ----------
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

    Raises
    ------
    ParameterError
        If a number is out of its range, or a part is of another class.
    """

    release: Release
    duration: Duration
    attitude: AbstractAttitudeRule = field(default=None, converter=lambda rule: rule or Own())
    every: Duration | None = None
    ensemble: Ensemble | None = None
    launches: tuple[float, ...] = field(
        default=(),
        converter=lambda given: tuple(float(_DELAY.number("launches", delay)) for delay in given),
    )
    lowest: Altitude | None = None
    highest: Altitude | None = None
    station: Circle | None = None
    landing: Landing | None = None
    receivers: tuple[Receiver, ...] = field(default=(), converter=tuple)
    inertia: Inertia | None = None
    tolerance: float = TOLERANCE

    def __check_init__(self) -> None:
        require_record("release", (Release,), self.release)
        require_record("attitude", (AbstractAttitudeRule,), self.attitude)
        if self.station is not None:
            require_record("station", (Circle,), self.station)

    @property
    def several(self) -> bool:
        """Whether there are flights beside that of the flyer as it is stated."""
        return self.ensemble is not None or len(self.launches) > 0


def fly(
    what: Any,
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
    mission: Mission | None = None,
    *,
    folder: str | Path | None = None,
    **fields: Any,
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
    mission : Mission, optional
    folder : path, optional
        Keeps the flights of ensemble and launches. The same call continues where it was
        interrupted.
    **fields
        Fields of :class:`~lightflyer.mission.Mission`, such as ``release`` and ``duration``: in
        place of a mission, or in place of fields of it.

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
    design = as_design(what, environment, model)
    mission = Mission(**fields) if mission is None else replace(mission, **fields)
    setup, ensemble, launches = design.setup, mission.ensemble, mission.launches
    vehicle, start = Vehicle(setup, mission.attitude), mission.release.start()
    limits = limits_of(setup.environment, mission.lowest, mission.highest)
    require_release_inside(mission.release, limits)
    ends_at_ground = float(limits.lowest) <= HIGHEST_GROUND
    if mission.landing is not None and not ends_at_ground:
        raise ParameterError(
            f"landing has no effect: the mission ends at {float(limits.lowest) / 1e3:g} km, above "
            "any ground; lower its lowest altitude"
        )
    # raises where the data of winds or ground do not reach
    warnings = [*design.warnings, *require_rule(vehicle, start)]
    elapsed = times_of(mission.duration, mission.every, several=mission.several)
    plan = Plan(limits, elapsed, Accuracy.for_duration(float(elapsed[-1]), mission.tolerance))
    flights = flights_of(design, mission.attitude, start, ensemble, launches)
    work = None
    if folder is not None and mission.several:
        parts = {
            "release": start, "ensemble": ensemble, "attitude": mission.attitude,
            "altitudes": limits, "times": elapsed, "flights": [flights.starts, flights.varied],
        }  # fmt: skip
        described = describe_work(design, parts)
        described["accuracy, batch"] = f"{plan.accuracy}, {BATCH}"
        work = WorkFolder(Path(folder), "flights.json", "mission", described)
    tracks, trajectory, transient = fly_flights(flights, plan, vehicle, mission.inertia, work)
    assert trajectory is not None

    # the flight of the flyer as it is stated, over time
    first, released = _rows(tracks, 0), float(start.place.time)
    known = np.isfinite(first.altitude)
    altitude = np.where(known, first.altitude, first.end_altitude)
    position = np.where(known[:, None], first.position, first.end_position)
    values = moments(vehicle, Course(elapsed, altitude, position, released))
    residual = values.pop("residual")[known]
    missed = residual > ENERGY_TOLERANCE
    status = np.where(missed, int(SolverStatus.TOLERANCE_MISSED), int(SolverStatus.CONVERGED))
    require_converged("heat balance along the way", status, residual)
    values = {name: np.where(known, value, np.nan) for name, value in values.items()}
    dataset = dataset_of(elapsed, released, first, values, setup.flyer.nodes)
    place = Place(*geographic(first.end_position), released + float(first.end_elapsed))
    dataset.attrs["end"] = termination_text(
        TerminationReason(int(first.termination)), setup.environment, first.end_altitude, place
    )
    last = np.maximum(elapsed[-1] - np.array([_SHORTEST, 0.0]), 0.0)
    rise = float(np.diff(trajectory(last)[0])[0] / np.diff(last)[0])
    if int(first.termination) == TerminationReason.STILL_FLYING and abs(rise) > _SINKING:
        dataset.attrs["end"] += f", {'rising' if rise > 0.0 else 'sinking'} at {abs(rise):.2g} m/s"
    sampled = sample_flight(vehicle, trajectory, released)
    ending = with_end_of_data(setup.environment)
    add_events(dataset, events_of(vehicle, trajectory, *sampled, ending))
    if transient is None or mission.inertia is not None:
        warnings += diagnose_flight(vehicle, *sampled)
    else:
        warnings += diagnose_flight(vehicle, *since(transient.until, *sampled))
    if transient is not None:
        warnings += add_transient(dataset, vehicle, transient, released)

    # those that are flown beside it, fewer where a user ended them early
    flown, times = len(tracks.end_altitude), np.asarray(flights.starts.place.time)
    if flown < flights.count:
        goes_on = "" if folder is None else ", the same call goes on"
        warnings.append(
            f"interrupted: {flown - 1} of {flights.count - 1} further flights were flown{goes_on}"
        )
    dataset.attrs["warnings"] = "\n".join(dict.fromkeys(warnings))
    if ensemble is not None and flown > 1:
        rows = slice(1, min(flown, 1 + ensemble.members))
        add_several(dataset, "ensemble_", "member", _rows(tracks, rows), times[rows])
    if launches and flown == flights.count:
        chosen = [0, *range(flown - len(launches), flown)]
        add_several(dataset, "launch_", "launch", _rows(tracks, chosen), times[chosen])
        about = {"units": "s", "long_name": "delay of the release"}
        dataset.coords["launch_delay"] = ("launch", np.array([0.0, *launches]), about)

    # what decides the results
    planet, highest = planet_of(setup.environment), setup.flyer.highest_temperature
    if highest is not None:
        dataset.attrs["highest_temperature_k"] = float(highest)
    if ending is not None:
        winds = (text.removeprefix("wind: ") for text in ending.beyond.describe())
        dataset.attrs["other_wind"] = "; ".join(winds)
    dataset.attrs |= {
        "title": "lightflyer mission",
        "lightflyer_version": lightflyer.__version__,
        "flyer": setup.flyer.describe(),
        "force_model": describe_object(setup.model),
        "planet": planet.name,
        "planet_radius_km": float(planet.radius) / 1e3,
        "assumptions": "\n".join(
            assumptions_of(setup, mission.attitude, ensemble, mission.inertia)
        ),
    }
    if ends_at_ground:
        add_landing(dataset, vehicle, *sampled, mission.landing or Landing())
    if mission.station is not None:
        add_station(dataset, mission.station, trajectory)
    add_telemetry(dataset, trajectory, mission.receivers, setup.budget)
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
    if release.velocity is not None:
        raise ParameterError(
            "a trajectory is in balance from the release on, and takes no velocity; leave it out, "
            "or take lf.fly"
        )
    limits = limits_of(environment, None, None)
    times = np.asarray(elapsed, float)
    accuracy = Accuracy.for_duration(float(times[-1]), tolerance, longest_step)
    vehicle = Vehicle(Setup(flyer, environment, model), attitude or Own())
    found, _ = follow(vehicle, release.start(), limits, times, accuracy)
    return found


def times_of(duration: Any, every: Any = None, *, several: bool = False) -> np.ndarray:
    """Times that a mission keeps [s], shape (times,); from zero to the duration, evenly spaced."""

    def seconds(name: str, value: Any) -> float:
        number = float(_DURATION.number(name, value))
        _DURATION.check(name, number)
        return number

    length = seconds("duration", duration)
    if every is None:
        spacing = max(_SHORTEST, length / (MOST_TIMES_OF_ENSEMBLE if several else MOST_TIMES))
    else:
        spacing = seconds("every", every)
    return np.linspace(0.0, length, 1 + max(1, math.ceil(length / spacing - _ROUNDING)))


def _rows(tracks: Track, rows: Any) -> Track:
    return tree.map_leaves(lambda leaf: leaf[rows], tracks)
