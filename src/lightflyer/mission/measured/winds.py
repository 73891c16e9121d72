"""The wind that a measured track shows, less the wind in use at the same places."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lightflyer.environment.base import AbstractEnvironment, Place
from lightflyer.mission.measured.geometry import moved
from lightflyer.mission.measured.track import MeasuredTrack
from lightflyer.mission.path.motion import planet_of
from lightflyer.program.entry_point import entry_point

_STEP = 300.0  # over which a velocity is taken: receivers are off by metres [s]
_MOST_STEPS = 2000
_PIECES = 12  # at most, of the time and of the altitudes
_LENGTHS = 900.0 * np.array([1, 2, 4, 8, 12, 24, 48, 96, 192, 384, 768])  # of pieces [s]
_THICKNESSES = 100.0 * np.array([1, 2, 5, 10, 20, 50, 100, 200])  # of bands [m]


class WindDifference(NamedTuple):
    """Means over parts of a track, shape (n,)."""

    lowest: np.ndarray  # Edges: since the release [s], or altitudes [m]
    highest: np.ndarray
    east: np.ndarray  # [m/s]
    north: np.ndarray  # [m/s]
    duration: np.ndarray  # Over which the mean is [s]
    altitude: np.ndarray  # Mean [m]


def wind_differences(
    track: MeasuredTrack, environment: AbstractEnvironment, span: tuple[float, float], released: Any
) -> tuple[WindDifference, WindDifference]:
    """By time and by altitude, within a span of time; both [s since 2000-01-01 12:00 UTC]."""
    steps = int(np.clip(np.ceil((span[1] - span[0]) / _STEP), 1, _MOST_STEPS))
    moments = np.linspace(*span, steps + 1)
    found = moved(track, moments, planet_of(environment))
    middle = 0.5 * (moments[1:] + moments[:-1])
    wind = _winds(environment, found.altitude, Place(found.latitude, found.longitude, middle))
    gaps = track.gaps
    in_gap = np.any(
        (moments[:-1, None] < track.time[gaps + 1]) & (moments[1:, None] > track.time[gaps]), axis=1
    )
    east, north = found.east - np.asarray(wind[0]), found.north - np.asarray(wind[1])
    known = np.isfinite(east) & np.isfinite(north) & ~in_gap
    values = east[known], north[known], np.diff(moments)[known], found.altitude[known]
    since = middle[known] - released
    return (
        _means(since, _edges(span[0] - released, span[1] - released, _LENGTHS), values),
        _means(values[3], _edges(*_range(values[3]), _THICKNESSES), values),
    )


def _range(values: np.ndarray) -> tuple[float, float]:
    return (values.min(), values.max()) if values.size else (0.0, 0.0)


def _edges(low: float, high: float, widths: np.ndarray) -> np.ndarray:
    """Edges of few equal parts of a round width that hold a range."""
    fits = widths[np.ceil(high / widths) - np.floor(low / widths) <= _PIECES]
    width = fits[0] if fits.size else widths[-1]
    first = np.floor(low / width)
    return width * np.arange(first, max(np.ceil(high / width), first + 1.0) + 0.5)


def _means(by: np.ndarray, edges: np.ndarray, values: tuple[np.ndarray, ...]) -> WindDifference:
    part = np.clip(np.searchsorted(edges, by, side="right") - 1, 0, edges.size - 2)
    east, north, lasted, altitude = values
    duration = np.bincount(part, lasted, edges.size - 1)
    held = duration > 0.0

    def mean(of: np.ndarray) -> np.ndarray:
        total = np.bincount(part, lasted * of, edges.size - 1)
        return np.asarray(total[held] / duration[held])

    return WindDifference(
        edges[:-1][held], edges[1:][held], mean(east), mean(north), duration[held], mean(altitude)
    )


@entry_point
def _winds(environment: AbstractEnvironment, altitude: Any, place: Place) -> tuple[Any, Any]:
    """Wind towards east and north [m/s], shape (n,); NaN where it is not known."""

    def at(height: Any, place: Place) -> tuple[Any, Any]:
        wind = environment.state(height, place).wind
        none = 0.0 * height
        return (none, none) if wind is None else (wind.east + none, wind.north + none)

    return jax.vmap(at)(jnp.asarray(altitude), Place(*map(jnp.asarray, place)))
