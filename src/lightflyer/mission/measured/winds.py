"""The wind that a measured track shows, less the wind in use at the same places."""

from typing import NamedTuple

import numpy as np

from lightflyer.array.namespace import Numeric, xp
from lightflyer.array.records import Module
from lightflyer.environment.base import Place, Wind
from lightflyer.mission.measured.geometry import moved
from lightflyer.mission.measured.track import MeasuredTrack
from lightflyer.mission.path.moments import Course, moments
from lightflyer.mission.path.motion import Craft
from lightflyer.numerics.cubic_grid import Axis, interpolate

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


class WindOfTrack(Module):
    """What a track adds to the wind in use, over time; in place of a random error of the wind."""

    axis: Axis  # Of the time since the release [s]
    table: Numeric  # shape (n, 2); eastward and northward [m/s]
    upwards: Numeric = 0.0  # [m/s]

    @classmethod
    def of(cls, found: WindDifference) -> "WindOfTrack":
        """The means over time, and the first and the last of them before and after."""
        if not found.east.size:
            return cls(Axis([0.0]), np.zeros((1, 2)))
        middle = 0.5 * (found.lowest + found.highest)
        return cls(Axis(middle), np.stack([found.east, found.north], axis=1))

    def add_to_wind(self, wind: Wind, place: Place, elapsed: Numeric) -> Wind:
        """A wind with it; ``elapsed``: time since the release."""
        del place
        nodes = self.axis.nodes
        more = interpolate(self.table, (self.axis,), (xp.clip(elapsed, nodes[0], nodes[-1]),))
        return Wind(wind.east + more[..., 0], wind.north + more[..., 1], wind.up + self.upwards)


def wind_differences(
    track: MeasuredTrack, craft: Craft, span: tuple[float, float], released: float
) -> tuple[WindDifference, WindDifference]:
    """By time and by altitude, within a span of time; both [s since 2000-01-01 12:00 UTC].

    The flyer's own way through the air, which only a tilted one has, is taken off.
    """
    steps = int(np.clip(np.ceil((span[1] - span[0]) / _STEP), 1, _MOST_STEPS))
    edges = np.linspace(*span, steps + 1)
    found = moved(track, edges, craft.planet)
    since = 0.5 * (edges[1:] + edges[:-1]) - released
    there = moments(craft, Course(since, found.altitude, found.position, released))
    gaps = track.gaps
    in_gap = np.any(
        (edges[:-1, None] < track.time[gaps + 1]) & (edges[1:, None] > track.time[gaps]), axis=1
    )
    east = found.east - np.asarray(there["eastward_speed"])
    north = found.north - np.asarray(there["northward_speed"])
    known = np.isfinite(east) & np.isfinite(north) & ~in_gap
    values = east[known], north[known], np.diff(edges)[known], found.altitude[known]
    return (
        _means(since[known], _edges(span[0] - released, span[1] - released, _LENGTHS), values),
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
