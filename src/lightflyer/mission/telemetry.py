"""Receivers on the ground: when they see a flyer, and what its radio link then has left."""

import csv
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lightflyer.array.records import field
from lightflyer.budget.link import RadioLink
from lightflyer.budget.payload import Budget
from lightflyer.core.clock import date_text, seconds_of
from lightflyer.core.quantity import Altitude, Checked, Latitude, Longitude, Steepness
from lightflyer.core.text import cell_text
from lightflyer.mission.areas import units_of
from lightflyer.mission.path.integration import Way
from lightflyer.statics.grid_refinement import crossing, peak

if TYPE_CHECKING:
    import xarray as xr

RECEIVER, PASS = "receiver", "pass"  # Dimensions
_APART = 60.0  # Longest time between looks at a flyer [s]
_CLOSE = 1e-6  # Of an elevation [deg], and of a distance over the largest one that the link bears
_AN_HOUR, _KILOMETRE = 3600.0, 1e3

_COLUMNS = (
    "receiver", "begin", "end", "begin_h", "duration_h", "highest_elevation_deg", "nearest_km",
    "farthest_km", "least_margin_db", "data_bit",
)  # fmt: skip
_ABOUT = {
    "receiver": {"long_name": "number of the receiver"},
    "begin": {"units": "s", "long_name": "time from release to coming into sight"},
    "end": {"units": "s", "long_name": "time from release to going out of sight"},
    "highest_elevation": {"units": "degree", "long_name": "highest elevation in a pass"},
    "nearest": {"units": "m", "long_name": "smallest range in a pass"},
    "farthest": {"units": "m", "long_name": "largest range in a pass"},
    "least_margin": {"units": "dB", "long_name": "margin of the radio link at the largest range"},
    "data": {"units": "bit", "long_name": "data that the payload sends in a pass"},
}
_ALONG = {
    "elevation": {"units": "degree", "long_name": "elevation of the flyer above the horizon"},
    "range": {"units": "m", "long_name": "distance of the flyer in a straight line"},
    "margin": {"units": "dB", "long_name": "margin of the radio link"},
}


class Receiver(Checked):
    """A receiver on the ground.

    Attributes
    ----------
    name : str
    latitude, longitude : array
        [deg].
    altitude : array
        [m].
    lowest_elevation : array
        Below which it sees nothing [deg].
    """

    name: str = field(static=True)
    latitude: Latitude
    longitude: Longitude
    altitude: Altitude = 0.0
    lowest_elevation: Steepness = 5.0

    def look(
        self, altitude: np.ndarray, position: np.ndarray, planet_radius: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Elevation [deg] and range [m] of flyers, without refraction; ``position`` (..., 3)."""
        up = units_of(self.latitude, self.longitude)
        sight = (planet_radius + altitude)[..., None] * position
        sight = sight - (planet_radius + float(self.altitude)) * up
        distance = np.linalg.norm(sight, axis=-1)
        return np.degrees(np.arcsin(np.clip(sight @ up / distance, -1.0, 1.0))), distance


class Pass(NamedTuple):
    """From when to when a receiver sees a flyer, and what it receives."""

    receiver: int
    begin: float  # [s]
    end: float
    highest_elevation: float  # [deg]
    nearest: float  # [m]
    farthest: float
    least_margin: float  # Of the link, at the largest range [dB]; NaN without a link
    data: float  # [bit]; NaN without a link


def passes_of(
    way: Way, receivers: Sequence[Receiver], link: RadioLink | None, planet_radius: float
) -> list[Pass]:
    """Passes of one flyer over each receiver, in the order of time."""
    end = float(way.times[-1])
    evenly = np.linspace(0.0, end, 1 + int(np.ceil(end / _APART)))
    times = np.unique([*way.times, *evenly])
    found = []
    for number, receiver in enumerate(receivers):
        seen = _Seen(way, receiver, planet_radius)
        for begin, last in _spans(seen.spare_elevation, times):
            within = np.unique([begin, *times[(times > begin) & (times < last)], last])
            distances = seen.distance(within)
            farthest = float(distances.max())
            found.append(
                Pass(
                    number,
                    begin,
                    last,
                    _highest(seen.spare_elevation, within) + float(receiver.lowest_elevation),
                    -_highest(seen.nearness, within),
                    farthest,
                    np.nan if link is None else float(margin(link, farthest)),
                    np.nan if link is None else _data(seen, link, within),
                )
            )
    return sorted(found, key=lambda one: one.begin)


class _Seen(NamedTuple):
    """A flyer as a receiver sees it, at times of any shape."""

    way: Way
    receiver: Receiver
    planet_radius: float

    def spare_elevation(self, at: np.ndarray) -> np.ndarray:
        """Above the lowest one [deg]."""
        elevation, _ = self.receiver.look(*self.way(at.ravel()), self.planet_radius)
        return elevation.reshape(at.shape) - float(self.receiver.lowest_elevation)

    def distance(self, at: np.ndarray) -> np.ndarray:
        _, distance = self.receiver.look(*self.way(at.ravel()), self.planet_radius)
        return distance.reshape(at.shape)

    def nearness(self, at: np.ndarray) -> np.ndarray:
        return -self.distance(at)


def _data(seen: _Seen, link: RadioLink, times: np.ndarray) -> float:
    """Data that a link sends while its margin is positive [bit]."""
    reach = float(link.distance) * 10.0 ** (float(link.margin_db) / 20.0)
    spans = _spans(lambda at: 1.0 - seen.distance(at) / reach, times)
    sending = sum(stop - start for start, stop in spans)
    return sending * float(link.data_rate) * float(link.duty)


def margin(link: RadioLink, distance: Any) -> np.ndarray:
    """Margin of a link over a distance [dB], with the power that its own distance takes."""
    farther = np.asarray(distance) / float(link.distance)
    return float(link.margin_db) - 20.0 * np.log10(farther)


def _spans(
    function: Callable[[np.ndarray], np.ndarray], times: np.ndarray
) -> list[tuple[float, float]]:
    """Spans in which a function is positive."""
    inside = function(times) > 0.0
    before = np.flatnonzero(inside[1:] != inside[:-1])
    ends = times[before], times[before + 1]
    leaves = inside[before]
    edges = crossing(
        function, np.where(leaves, *ends[::-1]), np.where(leaves, *ends), tolerance=_CLOSE
    )
    bounds = [times[0]] * bool(inside[0]) + list(edges) + [times[-1]] * bool(inside[-1])
    return [(float(a), float(b)) for a, b in zip(bounds[::2], bounds[1::2], strict=True)]


def _highest(function: Callable[[np.ndarray], np.ndarray], times: np.ndarray) -> float:
    """Largest value of a function, looked at closely between the neighbours of the largest."""
    values = function(times)
    best = int(np.argmax(values))
    low, high = times[max(best - 1, 0)], times[min(best + 1, times.size - 1)]
    return max(float(values[best]), float(peak(function, low, high)[1][0]))


def add_telemetry(
    dataset: "xr.Dataset", way: Way, receivers: Sequence[Receiver], budget: Budget | None
) -> None:
    """Add passes, and elevation, range and margin over time, to a flight's dataset."""
    if not receivers:
        return
    link = None if budget is None else budget.link
    radius = _KILOMETRE * dataset.attrs["planet_radius_km"]
    dataset.coords[RECEIVER] = [receiver.name for receiver in receivers]
    position = units_of(dataset.latitude, dataset.longitude)
    looks = [one.look(dataset.altitude.values, position, radius) for one in receivers]
    along = dict(zip(("elevation", "range"), np.swapaxes(looks, 0, 1), strict=True))
    if link is not None:
        along["margin"] = margin(link, along["range"])
    for name, values in along.items():
        dataset[f"{RECEIVER}_{name}"] = ((RECEIVER, *dataset.altitude.dims), values, _ALONG[name])
    lowest = [float(one.lowest_elevation) for one in receivers]
    about = {"units": "degree", "long_name": "elevation below which a receiver sees nothing"}
    dataset[f"{RECEIVER}_lowest_elevation"] = (RECEIVER, lowest, about)
    columns = np.array(passes_of(way, receivers, link, radius)).reshape(-1, len(Pass._fields)).T
    for name, column in zip(Pass._fields, columns, strict=True):
        if link is not None or name not in ("least_margin", "data"):
            typed = column.astype(np.int32) if name == RECEIVER else column
            dataset[f"{PASS}_{name}"] = (PASS, typed, _ABOUT[name])


def summarise_telemetry(dataset: "xr.Dataset") -> dict[str, Any]:
    """Passes of a flight, with a unit at the end of each name."""
    released = seconds_of(dataset.time.values[0])
    numbers = dataset[f"{PASS}_{RECEIVER}"].values
    passes = []
    for row, number in enumerate(numbers):
        value = {
            name: float(dataset[f"{PASS}_{name}"][row])
            for name in Pass._fields[1:]
            if f"{PASS}_{name}" in dataset
        }
        one: dict[str, Any] = {"receiver": str(dataset[RECEIVER].values[number])}
        for name in ("begin", "end"):
            one[name] = date_text(released + value[name])
        one["begin_h"] = value["begin"] / _AN_HOUR
        one["duration_h"] = (value["end"] - value["begin"]) / _AN_HOUR
        one["highest_elevation_deg"] = value["highest_elevation"]
        one |= {f"{name}_km": value[name] / _KILOMETRE for name in ("nearest", "farthest")}
        if "data" in value:
            one |= {"least_margin_db": value["least_margin"], "data_bit": value["data"]}
        passes.append(one)
    return {
        "in_sight_h": sum(one["duration_h"] for one in passes),
        "data_bit": sum(one["data_bit"] for one in passes) if f"{PASS}_data" in dataset else None,
        "passes": passes,
    }


def write_passes_csv(found: dict[str, Any], path: Path) -> None:
    """Write the passes of :func:`summarise_telemetry`, a row for each."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, _COLUMNS, restval="", lineterminator="\n")
        writer.writeheader()
        for one in found["passes"]:
            writer.writerow(
                {
                    name: f"{x:.10g}" if isinstance(x, float) else cell_text(str(x))
                    for name, x in one.items()
                }
            )
