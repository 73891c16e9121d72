"""On the ground: a station near which a flyer is to stay, and receivers of its radio link."""

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lightflyer.array.records import field
from lightflyer.budget.payload import Budget, RadioLink
from lightflyer.core.clock import date_text, seconds_of
from lightflyer.core.quantity import Altitude, Checked, Latitude, Longitude, Steepness
from lightflyer.core.text import cell_text
from lightflyer.mission.areas import Circle, units_of
from lightflyer.mission.path.integration import Trajectory
from lightflyer.mission.path.motion import ELAPSED
from lightflyer.mission.report.events import peak_of, spans_above

if TYPE_CHECKING:
    import xarray as xr


RECEIVER, PASS = "receiver", "pass"  # Dimensions
_APART = 60.0  # Longest time between samples of a flight [s]
_CLOSE = 1e-6  # Of an elevation [deg], and of a distance over that of a station's edge or a link's
_AN_HOUR, _KILOMETRE = 3600.0, 1e3
_STATION = {
    "station_distance": ("m", "distance along the ground from the station's middle"),
    "station_within": ("s", "time within the station"),
    "station_left": ("s", "time from release to first leaving the station"),
    "station_farthest": ("m", "largest distance from the station's middle"),
}
_COLUMNS = (
    "receiver", "begin", "end", "begin_h", "duration_h", "highest_elevation_deg", "nearest_km",
    "farthest_km", "least_margin_db", "data_bit",
)  # fmt: skip
_PASSES = {
    "receiver": {"long_name": "number of the receiver"},
    "begin": {"units": "s", "long_name": "time from release to coming into sight"},
    "end": {"units": "s", "long_name": "time from release to going out of sight"},
    "highest_elevation": {"units": "degree", "long_name": "highest elevation in a pass"},
    "nearest": {"units": "m", "long_name": "smallest range in a pass"},
    "farthest": {"units": "m", "long_name": "largest range in a pass"},
    "least_margin": {"units": "dB", "long_name": "margin of the radio link at the largest range"},
    "data": {"units": "bit", "long_name": "data that the payload sends in a pass"},
}
_SEEN = {
    "elevation": {"units": "degree", "long_name": "elevation of the flyer above the horizon"},
    "range": {"units": "m", "long_name": "distance of the flyer in a straight line"},
    "margin": {"units": "dB", "long_name": "margin of the radio link"},
}


def add_station(dataset: "xr.Dataset", station: Circle, trajectory: Trajectory) -> None:
    """Add distances from a station to a dataset, and how long the flyers stay there."""
    planet_radius, radius = 1e3 * dataset.attrs["planet_radius_km"], float(station.radius)
    found: dict[str, Any] = {}
    for prefix in ("", "ensemble_", "launch_"):
        if f"{prefix}latitude" not in dataset:
            continue
        track = dataset[f"{prefix}latitude"], dataset[f"{prefix}longitude"]
        distance = station.distances(units_of(*track), planet_radius)
        found[f"{prefix}station_distance"] = track[0].dims, distance
        if prefix:
            time = time_within(dataset[ELAPSED].values, distance, radius)
            found[f"{prefix}station_within"] = track[0].dims[:1], time

    def spare(at: np.ndarray) -> np.ndarray:
        """Distance to the station's edge from within, over its radius."""
        distance = station.distances(trajectory(at.ravel())[1], planet_radius)
        return 1.0 - distance.reshape(at.shape) / radius

    times = trajectory.times_within(_APART)
    stays = spans_above(spare, times, _CLOSE)
    left = [end for _, end in stays if end < times[-1]]
    found["station_within"] = (), sum(end - begin for begin, end in stays)
    found["station_left"] = (), left[0] if left else np.inf
    found["station_farthest"] = (), radius * (1.0 - spare(times).min())
    for name, (dims, values) in found.items():
        unit, text = _STATION[name.removeprefix("ensemble_").removeprefix("launch_")]
        dataset[name] = (dims, values, {"units": unit, "long_name": text})
    dataset.attrs["station"] = station.describe()
    dataset.attrs["station_radius_km"] = radius / 1e3


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
    trajectory: Trajectory,
    receivers: Sequence[Receiver],
    link: RadioLink | None,
    planet_radius: float,
) -> list[Pass]:
    """Passes of one flyer over each receiver, in the order of time."""
    times, found = trajectory.times_within(_APART), []
    reach = 0.0 if link is None else float(link.distance) * 10.0 ** (float(link.margin_db) / 20.0)
    for number, receiver in enumerate(receivers):
        lowest = float(receiver.lowest_elevation)

        def seen(at: np.ndarray, part: int, receiver: Receiver = receiver) -> np.ndarray:
            """Elevation [deg], or range [m], at times of any shape."""
            sight = receiver.look(*trajectory(at.ravel()), planet_radius)
            return sight[part].reshape(at.shape)

        def spare_elevation(at: np.ndarray, seen: Any = seen, lowest: float = lowest) -> np.ndarray:
            return np.asarray(seen(at, 0) - lowest)

        def nearness(at: np.ndarray, seen: Any = seen) -> np.ndarray:
            return np.asarray(-seen(at, 1))

        for begin, end in spans_above(spare_elevation, times, _CLOSE):
            within = np.unique([begin, *times[(times > begin) & (times < end)], end])
            highest = peak_of(spare_elevation, within)[1] + lowest
            nearest, farthest = -peak_of(nearness, within)[1], float(seen(within, 1).max())
            left = data = np.nan
            if link is not None:  # it sends while its margin is positive
                left = float(margin(link, farthest))

                def spare(at: np.ndarray, seen: Any = seen) -> np.ndarray:
                    return np.asarray(1.0 - seen(at, 1) / reach)

                sends = spans_above(spare, within, _CLOSE)
                sending = sum(stop - start for start, stop in sends)
                data = sending * float(link.data_rate) * float(link.duty)
            found.append(Pass(number, begin, end, highest, nearest, farthest, left, data))
    return sorted(found, key=lambda one: one.begin)


def margin(link: RadioLink, distance: Any) -> np.ndarray:
    """Margin of a link over a distance [dB], with the power that its own distance takes."""
    farther = np.asarray(distance) / float(link.distance)
    return float(link.margin_db) - 20.0 * np.log10(farther)


def add_telemetry(
    dataset: "xr.Dataset",
    trajectory: Trajectory,
    receivers: Sequence[Receiver],
    budget: Budget | None,
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
        dataset[f"{RECEIVER}_{name}"] = ((RECEIVER, *dataset.altitude.dims), values, _SEEN[name])
    lowest = [float(one.lowest_elevation) for one in receivers]
    about = {"units": "degree", "long_name": "elevation below which a receiver sees nothing"}
    dataset[f"{RECEIVER}_lowest_elevation"] = (RECEIVER, lowest, about)
    columns = (
        np.array(passes_of(trajectory, receivers, link, radius)).reshape(-1, len(Pass._fields)).T
    )
    for name, column in zip(Pass._fields, columns, strict=True):
        if link is not None or name not in ("least_margin", "data"):
            typed = column.astype(np.int32) if name == RECEIVER else column
            dataset[f"{PASS}_{name}"] = (PASS, typed, _PASSES[name])


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
