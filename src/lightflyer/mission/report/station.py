"""How long flyers stay near a place."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lightflyer.mission.areas import Circle, units_of
from lightflyer.mission.path.integration import Way
from lightflyer.mission.report.dataset import ELAPSED
from lightflyer.statics.grid_refinement import crossing

if TYPE_CHECKING:
    import xarray as xr

_APART = 60.0  # Longest time between looks at the distance [s]
_CLOSE = 1e-6  # Of the distance at the station's edge, over its radius

_ABOUT = {
    "distance": {"units": "m", "long_name": "distance along the ground from the station's middle"},
    "within": {"units": "s", "long_name": "time within the station"},
    "left": {"units": "s", "long_name": "time from release to first leaving the station"},
    "farthest": {"units": "m", "long_name": "largest distance from the station's middle"},
}
_PREFIX = "station_"
_AN_HOUR = 3600.0


class Stay(NamedTuple):
    """How long a flyer stays near a place."""

    within: float  # Time within the station in all [s]
    left: float  # Time from the release to first leaving it; infinite where it never does [s]
    farthest: float  # Largest distance [m]


def stay_of(way: Way, station: Circle, planet_radius: float) -> Stay:
    """Stay of one flyer."""
    end, radius = float(way.times[-1]), float(station.radius)
    times = np.unique([*way.times, *np.linspace(0.0, end, 1 + int(np.ceil(end / _APART)))])

    def spare(at: np.ndarray) -> np.ndarray:
        """Way to the station's edge from within, over its radius."""
        distance = station.distances(way(at.ravel())[1], planet_radius)
        return 1.0 - distance.reshape(at.shape) / radius

    looks = spare(times)
    inside = looks > 0.0
    before = np.flatnonzero(inside[1:] != inside[:-1])
    leaves, ends = inside[before], (times[before], times[before + 1])
    edges = crossing(
        spare, np.where(leaves, *ends[::-1]), np.where(leaves, *ends), tolerance=_CLOSE
    )
    within = np.where(leaves, edges, -edges).sum() + (end if inside[-1] else 0.0)
    left = edges[leaves]
    farthest = radius * (1.0 - looks.min())
    return Stay(float(within), float(left[0]) if left.size else np.inf, float(farthest))


def add_station(dataset: "xr.Dataset", station: Circle, stay: Stay) -> None:
    """Add distances from a station to a dataset, and how long the flyers stay there."""
    radius = 1e3 * dataset.attrs["planet_radius_km"]
    for prefix in ("", "ensemble_", "launch_"):
        if f"{prefix}latitude" not in dataset:
            continue
        track = dataset[f"{prefix}latitude"], dataset[f"{prefix}longitude"]
        distance = station.distances(units_of(*track), radius)
        dims = track[0].dims
        dataset[f"{prefix}{_PREFIX}distance"] = (dims, distance, _ABOUT["distance"])
        if prefix:
            time = time_within(dataset[ELAPSED].values, distance, float(station.radius))
            dataset[f"{prefix}{_PREFIX}within"] = (dims[:1], time, _ABOUT["within"])
    for name, value in stay._asdict().items():
        dataset[_PREFIX + name] = ((), value, _ABOUT[name])
    dataset.attrs["station"] = station.describe()
    dataset.attrs["station_radius_km"] = float(station.radius) / 1e3


def time_within(elapsed: np.ndarray, distance: np.ndarray, radius: float) -> np.ndarray:
    """Time within a radius of what is known at some times, with straight lines between; (n,)."""
    begin, end = distance[:, :-1], distance[:, 1:]
    near, far = np.minimum(begin, end), np.maximum(begin, end)
    steps = np.where(far > near, far - near, 1.0)
    share = np.where(far > near, np.clip((radius - near) / steps, 0.0, 1.0), near <= radius)
    share = np.where(np.isfinite(begin + end), share, 0.0)
    return np.asarray((share * np.diff(elapsed)).sum(axis=-1))


def summarise_station(dataset: "xr.Dataset") -> dict[str, Any]:
    """How long a flyer stays near a place, with a unit at the end of each name."""
    left = float(dataset.station_left)
    return {
        "place": dataset.attrs["station"],
        "within_h": float(dataset.station_within) / _AN_HOUR,
        "left_after_h": left / _AN_HOUR if np.isfinite(left) else None,
        "farthest_km": float(dataset.station_farthest) / 1e3,
    }
