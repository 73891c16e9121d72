"""A mission as a dataset with units."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.core.clock import dates_of
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import RADIANS_PER_DEGREE
from lightflyer.mission.path.integration import Track
from lightflyer.mission.path.moments import Variable
from lightflyer.mission.path.position import latitude_and_longitude
from lightflyer.mission.path.termination import TerminationReason

if TYPE_CHECKING:
    import xarray as xr

_places_of = entry_point(latitude_and_longitude)

ELAPSED = "elapsed"  # Dimension of time

TRACK = {
    "altitude": Variable("m", "geometric altitude"),
    "latitude": Variable("degree_north", "geodetic latitude"),
    "longitude": Variable("degree_east", "longitude"),
}
"""Where a flyer is."""

ENDS = {
    "end_elapsed": Variable("s", "time from release to end"),
    "end_altitude": Variable("m", "altitude at the end"),
    "end_latitude": Variable("degree_north", "latitude at the end"),
    "end_longitude": Variable("degree_east", "longitude at the end"),
    "end_reason": Variable("1", "what ended the mission"),
}
"""Where, when and why a flight ended."""


_TOGETHER = 100_000  # Places that are worked out at once, which keeps temporary arrays small
SEVERAL = (("ensemble_", "member"), ("launch_", "launch"))
"""Prefixes and dimensions of flights beside that of the flyer as it is stated."""


@dataclass(frozen=True)
class Several:
    """Flights along a dimension of the dataset."""

    prefix: str  # Of the names of its variables
    dimension: str
    labels: dict[str, tuple[np.ndarray, Variable]]  # Coordinates along the dimension
    track: Track  # Fields have a leading axis
    released: np.ndarray  # Times of the releases [s since 2000-01-01 12:00 UTC]


def degrees_of(position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Latitude and longitude of unit vectors [deg]; ``position`` (..., 3)."""
    flat = np.reshape(position, (-1, 3))
    found = np.full((2, len(flat)), np.nan)
    for first in range(0, len(flat), _TOGETHER):
        some = slice(first, first + _TOGETHER)
        known = np.isfinite(flat[some]).all(axis=-1, keepdims=True)
        safe = np.where(known, flat[some], [1.0, 0.0, 0.0])
        found[:, some] = np.where(known.T, np.stack(_places_of(safe)) / RADIANS_PER_DEGREE, np.nan)
    latitude, longitude = found.reshape(2, *np.shape(position)[:-1])
    return latitude, longitude


def dataset_of(
    elapsed: np.ndarray,
    released: float,
    track: Track,
    values: dict[str, np.ndarray],
    variables: dict[str, Variable],
) -> "xr.Dataset":
    """A flight over time; ``elapsed`` (times,); ``released`` [s since 2000-01-01 12:00 UTC]."""
    import xarray as xr

    places = {**_places(track), **values}
    known = TRACK | variables
    dataset = xr.Dataset(
        {name: (ELAPSED, values, _attributes(known[name])) for name, values in places.items()}
    )
    about = {"units": "s", "long_name": "time since the release"}
    dataset.coords[ELAPSED] = (ELAPSED, elapsed, about)
    date = {"long_name": "date (UTC)"}
    dataset.coords["time"] = (ELAPSED, dates_of(released + elapsed), date)
    for name, value in _ends(track).items():
        dataset[name] = ((), value, _attributes(ENDS[name]) | _flags(name))
    return dataset


def add_several(dataset: "xr.Dataset", several: Several) -> None:
    """Add the tracks and ends of further flights."""
    size = len(several.track.end_altitude)
    about = {"long_name": f"number of the {several.dimension}"}
    dataset.coords[several.dimension] = (several.dimension, np.arange(size), about)
    date = {"long_name": "date of the release (UTC)"}
    released = (several.dimension, dates_of(several.released), date)
    dataset[f"{several.prefix}released"] = released
    for name, (label, variable) in several.labels.items():
        dataset.coords[name] = (several.dimension, label, _attributes(variable))
    for name, values in _places(several.track).items():
        dims = (several.dimension, ELAPSED)
        dataset[several.prefix + name] = (dims, values, _attributes(TRACK[name]))
    for name, value in _ends(several.track).items():
        about = _attributes(ENDS[name]) | _flags(name)
        dataset[several.prefix + name] = (several.dimension, value, about)


def add_survival(dataset: "xr.Dataset", several: Several) -> None:
    """Add the share of an ensemble that still flies."""
    flying = np.isfinite(several.track.altitude).mean(axis=0)
    about = {"units": "1", "long_name": "share of the ensemble that is still aloft"}
    dataset[several.prefix + "flying"] = (ELAPSED, flying, about)


def ends_of(dataset: "xr.Dataset") -> Iterator[tuple[str, int | None, dict[str, Any]]]:
    """Which flights there are, their numbers, and how each ended: by names of ends."""
    names = [*ENDS, *(str(name) for name in dataset if str(name).startswith("below_"))]
    for prefix, dimension in (("", ""), *SEVERAL):
        if f"{prefix}end_reason" not in dataset:
            continue
        columns = [np.atleast_1d(dataset[prefix + name].values) for name in names]
        for number, row in enumerate(zip(*columns, strict=True)):
            end = {name: value.item() for name, value in zip(names, row, strict=True)}
            end["end_reason"] = TerminationReason(end["end_reason"]).name.lower()
            yield dimension or "stated", number if dimension else None, end


def _places(track: Track) -> dict[str, np.ndarray]:
    latitude, longitude = degrees_of(np.asarray(track.position))
    altitude = np.asarray(track.altitude)
    return {
        "altitude": np.where(np.isfinite(altitude), altitude, np.nan),
        "latitude": latitude,
        "longitude": longitude,
    }


def _ends(track: Track) -> dict[str, Any]:
    latitude, longitude = degrees_of(np.asarray(track.end_position))
    return {
        "end_elapsed": np.asarray(track.end_elapsed),
        "end_altitude": np.asarray(track.end_altitude),
        "end_latitude": latitude,
        "end_longitude": longitude,
        "end_reason": np.asarray(track.termination).astype(np.int8),
    }


def _attributes(variable: Variable) -> dict[str, Any]:
    return {"units": variable.unit, "long_name": variable.long_name}


def _flags(name: str) -> dict[str, Any]:
    """What the numbers of a reason mean, as the CF conventions write it."""
    if name != "end_reason":
        return {}
    return {
        "flag_values": np.array([int(end) for end in TerminationReason], np.int8),
        "flag_meanings": " ".join(end.name.lower() for end in TerminationReason),
    }
