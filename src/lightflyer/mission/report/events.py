"""What happens on a flight, and when, whatever is kept of it.

Light and heat are looked at where the integration stepped and in between, then closer and closer
where light passes a level or heat turns.
"""

from collections.abc import Callable
from enum import IntEnum
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lightflyer.environment.base import Place
from lightflyer.environment.wind.gridded import WindBeyondData
from lightflyer.mission.areas import geographic
from lightflyer.mission.path.integration import Trajectory
from lightflyer.mission.path.motion import Course, Vehicle, moments
from lightflyer.statics.grid_refinement import crossing, peak

if TYPE_CHECKING:
    import xarray as xr

Function = Callable[[np.ndarray], np.ndarray]
"""A value over time, at times of any shape."""

EVENT = "event"  # Dimension of events, and how their variables begin

_HALF = 0.5  # Share of the strongest light above which it counts as day, and of the other wind
_APART = 300.0  # Longest time between the first looks [s]
_CLOSE = 1e-6  # of a level of light, over its size
_FLAT = 1e-9  # of an extreme, over its size


class Event(IntEnum):
    """What happens."""

    LIGHT_BEGINS = 0
    LIGHT_ENDS = 1
    LOWEST = 2
    HIGHEST = 3
    HOTTEST = 4
    OTHER_WIND_BEGINS = 5  # where the data of the wind end
    OTHER_WIND_ENDS = 6


class Events(NamedTuple):
    """What happens, in the order of time; shape (n,)."""

    kind: np.ndarray
    elapsed: np.ndarray  # Time since the release [s]
    altitude: np.ndarray  # [m]
    temperature: np.ndarray  # Of the flyer [K]


def sample_flight(
    vehicle: Vehicle, trajectory: Trajectory, released: float, elapsed: np.ndarray | None = None
) -> tuple[Course, dict[str, np.ndarray]]:
    """A flight at some times [s], by default at such as do not depend on what is kept of it."""
    if elapsed is None:
        elapsed = trajectory.times_within(_APART)
    course = Course(elapsed, *trajectory(elapsed), released)
    return course, moments(vehicle, course)


def events_of(
    vehicle: Vehicle,
    trajectory: Trajectory,
    course: Course,
    first: dict[str, np.ndarray],
    ending: WindBeyondData | None = None,
) -> Events:
    """Events of a flight, from :func:`sample_flight`; ``ending``: a wind whose data end."""
    times = np.asarray(course.elapsed)

    def sampled(elapsed: np.ndarray, name: str) -> np.ndarray:
        """Moments of any shape."""
        _, values = sample_flight(vehicle, trajectory, float(course.released), elapsed.ravel())
        return np.reshape(values[name], elapsed.shape)

    def other_share(at: np.ndarray) -> np.ndarray:
        height, position = trajectory(at.ravel())
        place = Place(*geographic(position), course.released + at.ravel())
        assert ending is not None
        return np.reshape(1.0 - ending.share_of_data(height, place), at.shape)

    passed: list[tuple[tuple[Event, Event], Function, np.ndarray, float]] = []
    half = _HALF * first["irradiance"].max()
    if half > 0.0:
        kinds = Event.LIGHT_BEGINS, Event.LIGHT_ENDS
        passed.append((kinds, lambda at: sampled(at, "irradiance"), first["irradiance"], half))
    if ending is not None:
        kinds = Event.OTHER_WIND_BEGINS, Event.OTHER_WIND_ENDS
        passed.append((kinds, other_share, other_share(times), _HALF))
    found: list[tuple[Event, float]] = []
    for kinds, value, values, level in passed:
        spare = values / level - 1.0

        def over(at: np.ndarray, value: Function = value, level: float = level) -> np.ndarray:
            return value(at) / level - 1.0

        edges, rises = edges_of(over, times, _CLOSE, spare)
        found += [(kinds[0], float(times[0]))] * bool(spare[0] > 0.0)  # it begins above
        found += [(kinds[0 if up else 1], float(at)) for up, at in zip(rises, edges, strict=True)]
    for kind, sign in ((Event.LOWEST, -1.0), (Event.HIGHEST, 1.0)):

        def height(at: np.ndarray, sign: float = sign) -> np.ndarray:
            return sign * trajectory(at.ravel())[0].reshape(at.shape)

        found.append((kind, peak_of(height, times, flat=_FLAT)[0]))
    hottest = peak_of(
        lambda at: sampled(at, "temperature"), times, first["temperature"], flat=_FLAT
    )
    found.append((Event.HOTTEST, hottest[0]))
    found.sort(key=lambda one: one[1])
    order, when = (np.array(part) for part in zip(*found, strict=True))
    return Events(order, when, trajectory(when)[0], sampled(when, "temperature"))


def edges_of(
    value: Function, times: np.ndarray, tolerance: float, values: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """When a value passes zero between some times, and whether it rises there, shape (n,).

    ``values``: at these times, where they are known.
    """
    over = (value(times) if values is None else values) > 0.0
    before = np.flatnonzero(over[1:] != over[:-1])
    rises = over[before + 1]
    ends = times[before], times[before + 1]
    outside, inside = np.where(rises, ends, ends[::-1])
    return crossing(value, outside, inside, tolerance=tolerance), rises


def spans_above(value: Function, times: np.ndarray, tolerance: float) -> list[tuple[float, float]]:
    """Spans of time in which a value is positive."""
    values = value(times)
    edges, rises = edges_of(value, times, tolerance, values)
    begins = times[:1][values[:1] > 0.0].tolist() + edges[rises].tolist()
    ends = edges[~rises].tolist() + times[-1:][values[-1:] > 0.0].tolist()
    return list(zip(begins, ends, strict=True))


def peak_of(
    value: Function, times: np.ndarray, values: np.ndarray | None = None, **options: Any
) -> tuple[float, float]:
    """When a value is largest, sought closely between the neighbours of the largest, and its size.

    ``values``: at these times, where they are known; ``options``: of the search.
    """
    values = value(times) if values is None else values
    best = int(np.argmax(values))
    low, high = times[max(best - 1, 0)], times[min(best + 1, times.size - 1)]
    place, size = peak(value, low, high, **options)
    return float(place[0]), max(float(values[best]), float(size[0]))


def add_events(dataset: "xr.Dataset", events: Events) -> None:
    """Add events to a flight's dataset."""
    about: dict[str, dict[str, Any]] = {
        "kind": {
            "long_name": "what happens",
            "flag_values": np.array([int(kind) for kind in Event], np.int8),
            "flag_meanings": " ".join(kind.name.lower() for kind in Event),
        },
        "elapsed": {"units": "s", "long_name": "time from release to event"},
        "altitude": {"units": "m", "long_name": "altitude at the event"},
        "temperature": {"units": "K", "long_name": "temperature of the flyer at the event"},
    }
    for name, values in events._asdict().items():
        column = values.astype(np.int8) if name == "kind" else values
        dataset[f"{EVENT}_{name}"] = (EVENT, column, about[name])


def read_events(dataset: "xr.Dataset") -> Events:
    """The events of a flight's dataset."""
    return Events(*(dataset[f"{EVENT}_{name}"].values for name in Events._fields))


def spans_between(
    events: Events, begin: Event, end: Event, last: float
) -> list[tuple[float, float]]:
    """Spans from one kind of event to another [s]; ``last``: end of the flight."""
    found: list[tuple[float, float]] = []
    since: float | None = None
    for kind, elapsed in zip(events.kind, events.elapsed, strict=True):
        if kind == begin:
            since = float(elapsed)
        elif kind == end and since is not None:
            found.append((since, float(elapsed)))
            since = None
    return found if since is None else [*found, (since, last)]


def at_event(events: Events, kind: Event) -> tuple[float, float, float]:
    """Time [s], altitude [m] and temperature [K] of the one event of a kind."""
    place = int(np.flatnonzero(events.kind == kind)[0])
    return tuple(float(column[place]) for column in events[1:])  # type: ignore[return-value]
