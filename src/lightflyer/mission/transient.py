"""Flights from their release on, which keep their inertia until all move as they do in balance.

That is the first seconds after a release from a rocket or an aircraft, or in air too thin for
balance; from there on all are in balance.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import by_numpy
from lightflyer.core.constants import STANDARD_GRAVITY, TOTAL_SOLAR_IRRADIANCE
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.core.progress import report
from lightflyer.environment.base import Place
from lightflyer.mission.areas import distances_between, geographic
from lightflyer.mission.fleet import Flights, WorkFolder, flight_of, fly_all, note, unflown
from lightflyer.mission.path.dynamics import FlightConditions, Inertia, Moving, follow
from lightflyer.mission.path.integration import (
    Plan,
    Start,
    TerminationReason,
    Track,
    Trajectory,
    integrate,
)
from lightflyer.mission.path.motion import (
    ELAPSED,
    INERTIA,
    Course,
    Variable,
    Vehicle,
    in_balance,
    planet_of,
    within,
)

if TYPE_CHECKING:
    import xarray as xr

_FIRST_CHECK = 5.0  # seconds after which is first checked whether all are in balance; then twice
_STEPS = 200_000  # of a flight between two checks, at most
_BATCH = 64  # Flights that are integrated together: a state's slopes are many numbers
_FLYING = int(TerminationReason.STILL_FLYING)
_MATTERS, _RULES = (0.1, 10.0), (1.0, 300.0)
"""Heat of the air's motion that is warned of, and that is refused: its power over that of sunlight
[1], of which thin air transfers all, and the warmth of air that is stopped [K], as warm as dense
air makes a flyer."""

_SAMPLES = 8  # in each interval of the integration

_ABOUT = {
    "speed": Variable("m s-1", "speed over ground at the release"),
    "balance": Variable("s", "time from the release to balance of all flights"),
    "distance": Variable("m", "distance over ground from the release to where it is in balance"),
    "highest": Variable("m", "highest altitude until it is in balance"),
    "acceleration": Variable("m s-2", "largest acceleration until it is in balance"),
    "pressure": Variable("Pa", "largest dynamic pressure until it is in balance"),
    "heating": Variable("W m-2", "largest power of the air's motion, whose heat is left out"),
    "warmth": Variable("K", "largest warmth of air that is stopped"),
}
PREFIX = "release_"


class Transient(NamedTuple):
    """The first flight from the release until all are in balance."""

    until: float  # Time since the release from which all are [s]
    trajectory: Trajectory
    conditions: Callable[[np.ndarray], FlightConditions]


def fly_flights(
    flights: Flights,
    plan: Plan,
    stated: Vehicle | None = None,
    inertia: Inertia | None = None,
    work: WorkFolder | None = None,
) -> tuple[Track, Trajectory | None, Transient | None]:
    """Tracks of all flights; and the trajectory of the first, that of the ``stated`` flyer.

    ``inertia``: keeps it to the end; ``work``: has the flights of an interrupted call.
    """
    limits, elapsed, accuracy = plan
    vehicle, start = flight_of(flights, 0)
    thrown = start.velocity is not None
    if inertia is None and not thrown and np.all(_stays_in_balance(vehicle, start)):
        first, trajectory = (None, None) if stated is None else follow(stated, start, *plan)
        return fly_all(flights, *plan, first, work), trajectory, None
    if thrown and vehicle.setup.flyer.floats:
        raise ParameterError(
            f"{vehicle.setup.flyer.describe()}: the gas that moves with a balloon is left out, so "
            "that it takes no velocity of a release"
        )
    starts = tree.map_leaves(lambda leaf: np.asarray(leaf)[:, None], flights.starts)
    law = Moving(flights.vehicle, starts.place.time, limits, inertia)
    steps = accuracy if inertia is not None else replace(accuracy, steps=_STEPS)
    with by_numpy():
        states = law.at_release(starts)[:, 0]
    tracks, flying, begun = unflown(flights, elapsed), np.ones(flights.count, bool), None
    until, last, balanced = 0.0, float(elapsed[-1]), False
    while until < last and not balanced:
        before, until = (
            until,
            last if inertia is not None else min(2.0 * until or _FIRST_CHECK, last),
        )
        report("flying with inertia", int(until), int(last), "s")
        times = np.union1d([before, until], elapsed[(elapsed > before) & (elapsed < until)])
        rows = np.flatnonzero(flying)
        for some in np.array_split(rows, -(-rows.size // _BATCH)):
            found = integrate(law.take(some), states[some], times, steps)
            note(tracks, some, elapsed, times, found.track)
            states[some] = found.ends
            if some[0] == 0:
                begun = found.trajectory if begun is None else begun.followed_by(found.trajectory)
        flying &= tracks.termination == _FLYING
        if until < last:
            with by_numpy():
                in_balance_now = law.is_balanced(until, states[:, None])[:, 0]
            balanced = bool(np.all(in_balance_now | ~flying))
    assert begun is not None
    first_law = Moving(vehicle, starts.place.time[:1], limits, inertia)

    def conditions(at: np.ndarray) -> FlightConditions:
        with by_numpy():
            met = first_law.conditions(at, begun.states(at)[None])
        return FlightConditions(*(part[0] for part in met))

    transient = Transient(until, begun, conditions)
    rest = plan._replace(elapsed=np.append(until, elapsed[elapsed > until]))
    if rest.elapsed.size == 1:
        return tracks, begun, transient
    place = Place(*geographic(tracks.end_position), np.asarray(flights.starts.place.time))
    flights = replace(flights, starts=Start(tracks.end_altitude, place))
    first, trajectory = None, begun
    if stated is not None:
        first, later = follow(stated, flight_of(flights, 0)[1], *rest)
        trajectory = begun.followed_by(later) if later.times[-1] >= until else begun
    later_tracks = fly_all(flights, *rest, first, work)
    count = len(later_tracks.end_altitude)  # fewer where a user ended it early
    tracks = tree.map_leaves(lambda leaf: np.array(leaf[:count]), tracks)
    flying_on = np.flatnonzero(tracks.termination == _FLYING)
    joined = tree.map_leaves(lambda leaf: leaf[flying_on], later_tracks)
    note(tracks, flying_on, elapsed, rest.elapsed, joined)
    return tracks, trajectory, transient


@entry_point
def _stays_in_balance(vehicle: Vehicle, start: Start) -> Any:
    local = vehicle.surroundings(start.altitude, start.place, 0.0)
    return in_balance(vehicle, local)[2] < INERTIA


def since(until: float, course: Course, values: dict[str, Any]) -> tuple[Course, dict[str, Any]]:
    """Moments of a flight from some time on, at least the last."""
    rows = np.asarray(course.elapsed) >= min(until, np.max(course.elapsed))
    part = Course(course.elapsed[rows], course.altitude[rows], course.position[rows],
                  course.released)  # fmt: skip
    return part, {name: value[rows] for name, value in values.items()}


def add_transient(
    dataset: "xr.Dataset", vehicle: Vehicle, transient: Transient, released: float
) -> list[str]:
    """Add what happens until a flyer is in balance, and its speeds there; returns warnings."""
    edges = transient.trajectory.times
    marks = np.linspace(0.0, edges.size - 1.0, _SAMPLES * (edges.size - 1) + 1)
    times = np.interp(marks, np.arange(edges.size), edges)
    height, position = transient.trajectory(times)
    met = transient.conditions(times)
    pressure = 0.5 * met.density * met.speed**2
    radius = float(planet_of(vehicle.setup.environment).radius)
    found = {
        "speed": np.linalg.norm(met.ground[0]),
        "balance": transient.until,
        "distance": distances_between(position[-1], position[0], radius),
        "highest": height.max(),
        "acceleration": met.acceleration.max(),
        "pressure": pressure.max(),
        "heating": (pressure * met.speed).max(),
        "warmth": (0.5 * met.speed**2 / met.heat_capacity).max(),
    }
    for name, value in found.items():
        dataset[PREFIX + name] = ((), float(value), _ABOUT[name].attributes)
    early = dataset[ELAPSED].values <= times[-1]
    moving = transient.conditions(dataset[ELAPSED].values[early]).ground
    for name, column in zip(("eastward", "northward", "vertical"), moving.T, strict=True):
        dataset[f"{name}_speed"].values[early] = column
    for name in ("axial_speed", "slope_speed", "drag_power"):  # known in balance alone
        dataset[name].values[early] = np.nan
    hot = (
        f"the air heats it with up to {found['heating']:.3g} W/m², by up to "
        f"{found['warmth']:.0f} K, which is left out"
    )
    heat = found["heating"] / TOTAL_SOLAR_IRRADIANCE, found["warmth"]
    if np.all(np.greater(heat, _RULES)):
        raise ParameterError(
            f"released at {height[0] / 1e3:g} km with {found['speed']:.3g} m/s a flyer is lost in "
            f"this model: {hot}; release it slower or higher"
        )
    course = within(vehicle, Course(times, height, position, released))
    place = Place(*geographic(position), released + times)
    state = vehicle.setup.environment.state(course.altitude, place)
    warnings = list(vehicle.setup.flyer.drag_diagnostics(replace(state, wind=None), met.speed))
    if np.all(np.greater(heat, _MATTERS)):
        warnings.append(f"in the first seconds {hot}")
    return warnings


def summarise_transient(dataset: "xr.Dataset") -> dict[str, Any] | None:
    """The first seconds in numbers, with a unit at the end of each name; None without them."""
    if f"{PREFIX}speed" not in dataset:
        return None
    given = {name: float(dataset[PREFIX + name]) for name in _ABOUT}
    return {
        "speed_m_s": given["speed"],
        "in_balance_after_s": given["balance"],
        "moved_km": given["distance"] / 1e3,
        "highest_altitude_km": given["highest"] / 1e3,
        "largest_acceleration_g": given["acceleration"] / STANDARD_GRAVITY,
        "dynamic_pressure_pa": given["pressure"],
        "heating_w_m2": given["heating"],
        "warmth_k": given["warmth"],
    }


def transient_text(found: dict[str, Any]) -> str:
    """The first seconds in words."""
    return (
        f"with {found['speed_m_s']:.4g} m/s, highest {found['highest_altitude_km']:.2f} km; in "
        f"balance within {found['in_balance_after_s']:.3g} s and {found['moved_km']:.3g} km; at "
        f"most {found['largest_acceleration_g']:.3g} g and "
        f"{found['dynamic_pressure_pa']:.3g} Pa of dynamic pressure"
    )
