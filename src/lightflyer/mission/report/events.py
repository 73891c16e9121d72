"""What happens on a flight, and when, whatever is kept of it.

Light and heat are looked at where the integration stepped and in between, then closer and closer
where light passes a level or heat turns.
"""

from collections.abc import Callable
from enum import IntEnum
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lightflyer.core.entry_point import entry_point
from lightflyer.environment.base import Place
from lightflyer.environment.wind.beyond import WindBeyondData
from lightflyer.mission.path.integration import Way
from lightflyer.mission.path.moments import Course, moments
from lightflyer.mission.path.motion import Craft
from lightflyer.mission.path.position import latitude_and_longitude
from lightflyer.statics.grid_refinement import crossing, peak

if TYPE_CHECKING:
    import xarray as xr

_places = entry_point(latitude_and_longitude)

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


def close_look(craft: Craft, way: Way, released: float) -> tuple[Course, dict[str, np.ndarray]]:
    """A flight at moments that do not depend on what is kept of it, and what it is like then."""
    return _look(craft, way, released, close_times(way))


def close_times(way: Way) -> np.ndarray:
    """Times of a :func:`close_look` [s]."""
    end = way.times[-1]
    evenly = np.linspace(0.0, end, 1 + int(np.ceil(end / _APART)))
    return np.unique([*way.times, *evenly])


def _look(
    craft: Craft, way: Way, released: float, elapsed: np.ndarray
) -> tuple[Course, dict[str, np.ndarray]]:
    course = Course(elapsed, *way(elapsed), released)
    return course, moments(craft, course)


def events_of(
    craft: Craft,
    way: Way,
    course: Course,
    first: dict[str, np.ndarray],
    ending: WindBeyondData | None = None,
) -> Events:
    """Events of a flight, from a :func:`close_look` at it; ``ending``: a wind whose data end."""
    times = np.asarray(course.elapsed)

    def look(elapsed: np.ndarray) -> dict[str, np.ndarray]:
        """Moments of any shape."""
        _, found = _look(craft, way, float(course.released), elapsed.ravel())
        return {name: np.reshape(values, elapsed.shape) for name, values in found.items()}

    found: list[tuple[Event, float]] = []
    strongest = first["irradiance"].max()
    if strongest > 0.0:
        kinds = Event.LIGHT_BEGINS, Event.LIGHT_ENDS
        found += _passes(
            lambda at: look(at)["irradiance"], times, first["irradiance"], _HALF * strongest, kinds
        )
    if ending is not None:

        def other_share(at: np.ndarray) -> np.ndarray:
            height, position = way(at.ravel())
            place = Place(*_places(position), course.released + at.ravel())
            return np.reshape(1.0 - ending.share_of_data(height, place), at.shape)

        kinds = Event.OTHER_WIND_BEGINS, Event.OTHER_WIND_ENDS
        found += _passes(other_share, times, other_share(times), _HALF, kinds)
    altitude = way(times)[0]
    for kind, sign in ((Event.LOWEST, -1.0), (Event.HIGHEST, 1.0)):

        def height(at: np.ndarray, sign: float = sign) -> np.ndarray:
            return sign * way(at.ravel())[0].reshape(at.shape)

        found.append((kind, _top(height, times, sign * altitude)))
    hottest = _top(lambda at: look(at)["temperature"], times, first["temperature"])
    found.append((Event.HOTTEST, hottest))
    found.sort(key=lambda one: one[1])
    order, when = (np.array(part) for part in zip(*found, strict=True))
    return Events(order, when, way(when)[0], look(when)["temperature"])


def _passes(
    value: Callable[[np.ndarray], np.ndarray],
    times: np.ndarray,
    values: np.ndarray,
    level: float,
    kinds: tuple[Event, Event],
) -> list[tuple[Event, float]]:
    """When a value passes a level, upwards and downwards; upwards, too, where it begins above."""
    over = values > level
    before = np.flatnonzero(over[1:] != over[:-1])
    rises = over[before + 1]
    ends = times[before], times[before + 1]
    outside, inside = np.where(rises, ends, ends[::-1])
    passed = crossing(lambda at: value(at) / level - 1.0, outside, inside, tolerance=_CLOSE)
    found = [
        (kinds[0] if up else kinds[1], float(at)) for up, at in zip(rises, passed, strict=True)
    ]
    return [(kinds[0], float(times[0]))] * bool(over[0]) + found


def _top(
    function: Callable[[np.ndarray], np.ndarray], times: np.ndarray, values: np.ndarray
) -> float:
    """When a value is largest."""
    best = int(np.argmax(values))
    low, high = times[max(best - 1, 0)], times[min(best + 1, times.size - 1)]
    return float(peak(function, low, high, flat=_FLAT)[0][0])


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
