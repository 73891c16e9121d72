"""A mission as a dataset with units, and as files of tables: NetCDF and comma-separated values."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.core import atomic_files
from lightflyer.core.clock import dates_of
from lightflyer.core.quantity import RADIANS_PER_DEGREE
from lightflyer.mission.areas import geographic
from lightflyer.mission.path.integration import TerminationReason, Track
from lightflyer.mission.path.motion import ELAPSED, VARIABLES, Variable, node_variables

if TYPE_CHECKING:
    import xarray as xr


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


def degrees_of(position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Latitude and longitude of unit vectors [deg]; ``position`` (..., 3)."""
    flat = np.reshape(position, (-1, 3))
    found = np.full((2, len(flat)), np.nan)
    for first in range(0, len(flat), _TOGETHER):
        some = slice(first, first + _TOGETHER)
        known = np.isfinite(flat[some]).all(axis=-1, keepdims=True)
        safe = np.where(known, flat[some], [1.0, 0.0, 0.0])
        found[:, some] = np.where(known.T, np.stack(geographic(safe)) / RADIANS_PER_DEGREE, np.nan)
    latitude, longitude = found.reshape(2, *np.shape(position)[:-1])
    return latitude, longitude


def dataset_of(
    elapsed: np.ndarray,
    released: float,
    track: Track,
    values: dict[str, np.ndarray],
    nodes: tuple[str, ...],
) -> "xr.Dataset":
    """A flight over time; ``elapsed`` (times,); ``released`` [s since 2000-01-01 12:00 UTC]."""
    import xarray as xr

    dataset, known = xr.Dataset(), VARIABLES | node_variables(nodes)
    about = {"units": "s", "long_name": "time since the release"}
    dataset.coords[ELAPSED] = (ELAPSED, elapsed, about)
    date = {"long_name": "date (UTC)"}
    dataset.coords["time"] = (ELAPSED, dates_of(released + elapsed), date)
    over_time, ends = _variables(track)
    over_time |= {name: (column, known[name].attributes) for name, column in values.items()}
    dataset.update({name: (ELAPSED, *one) for name, one in over_time.items()})
    dataset.update({name: ((), *one) for name, one in ends.items()})
    return dataset


def add_several(
    dataset: "xr.Dataset", prefix: str, dimension: str, track: Track, released: np.ndarray
) -> None:
    """Add the tracks and ends of further flights; of an ensemble the share still aloft, too.

    ``prefix``: of the names; ``released``: times of the releases [s since 2000-01-01 12:00 UTC].
    """
    about = {"long_name": f"number of the {dimension}"}
    dataset.coords[dimension] = (dimension, np.arange(len(released)), about)
    date = {"long_name": "date of the release (UTC)"}
    dataset[f"{prefix}released"] = (dimension, dates_of(released), date)
    over_time, ends = _variables(track)
    dataset.update({prefix + name: ((dimension, ELAPSED), *one) for name, one in over_time.items()})
    dataset.update({prefix + name: (dimension, *one) for name, one in ends.items()})
    if dimension == "member":
        flying = np.isfinite(track.altitude).mean(axis=0)
        about = {"units": "1", "long_name": "share of the ensemble that is still aloft"}
        dataset[f"{prefix}flying"] = (ELAPSED, flying, about)


def _variables(track: Track) -> tuple[dict[str, tuple[Any, Any]], dict[str, tuple[Any, Any]]]:
    """Values and attributes of where flyers are over time, and of their ends, by name."""
    altitude = np.where(np.isfinite(track.altitude), track.altitude, np.nan)
    over_time = altitude, *degrees_of(np.asarray(track.position))
    latitude, longitude = degrees_of(np.asarray(track.end_position))
    ends = track.end_elapsed, track.end_altitude, latitude, longitude, track.termination
    tracks = {
        name: (values, about.attributes)
        for (name, about), values in zip(TRACK.items(), over_time, strict=True)
    }
    ended = {
        name: (np.asarray(values), about.attributes)
        for (name, about), values in zip(ENDS.items(), ends, strict=True)
    }
    # what the numbers of a reason mean, as the CF conventions write it
    reasons, about = ended["end_reason"]
    about["flag_values"] = np.array([int(end) for end in TerminationReason], np.int8)
    about["flag_meanings"] = " ".join(end.name.lower() for end in TerminationReason)
    return tracks, ended | {"end_reason": (reasons.astype(np.int8), about)}


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


_FORMAT = "%.10g"


def write_csv(dataset: "xr.Dataset", path: Path) -> None:
    """Write the flight of the flyer as it is stated, a row for each moment until its end."""
    known = np.isfinite(dataset.altitude.values)
    names = [name for name, value in dataset.items() if value.dims == (ELAPSED,)]
    dates = np.datetime_as_string(dataset.time.values[known], unit="ms")
    columns = {ELAPSED: dataset[ELAPSED], **{str(name): dataset[name] for name in names}}
    header = ",".join(
        ["time [UTC]", *(f"{name} [{value.attrs['units']}]" for name, value in columns.items())]
    )
    numbers = np.stack([value.values[known] for value in columns.values()], axis=1)
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(f"{header}\n")
        for date, row in zip(dates, numbers, strict=True):
            file.write(f"{date}Z,{','.join(_FORMAT % number for number in row)}\n")


def has_several(dataset: "xr.Dataset") -> bool:
    """Whether there are flights beside that of the flyer as it is stated."""
    return any(f"{prefix}end_reason" in dataset for prefix, _ in SEVERAL)


def write_ends_csv(dataset: "xr.Dataset", path: Path) -> None:
    """Write how each flight ended: of the flyer as it is stated, each member and each launch."""
    below = [str(name) for name in dataset if str(name).startswith("below_")]
    names = [*(name for name in ENDS if name != "end_reason"), *below]
    units = [f"{name} [{dataset[name].attrs['units']}]" for name in names]
    lines = [",".join(["flight", "number", *units, "end_reason"])]
    for flight, number, end in ends_of(dataset):
        cells = [_FORMAT % end[name] for name in names]
        which = "" if number is None else str(number)
        lines.append(",".join([flight, which, *cells, end["end_reason"]]))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")


_CONVENTIONS = "CF-1.11"
_AXES: dict[str, dict[str, str]] = {
    "time": {"axis": "T", "units_metadata": "leap_seconds: none"},
    "latitude": {"axis": "Y"},
    "longitude": {"axis": "X"},
    "altitude": {"axis": "Z", "positive": "up"},
}
"""What says where a flyer is, each of which is its own standard name."""

_STANDARD_NAMES = {
    "pressure": "air_pressure",
    "gas_temperature": "air_temperature",
    "wind_east": "eastward_wind",
    "wind_north": "northward_wind",
    "wind_up": "upward_air_velocity",
}
_FLIGHT = "trajectory"
_SECOND = 1e9  # nanoseconds


def write_netcdf(dataset: "xr.Dataset", path: str | Path) -> None:
    """Write a mission as NetCDF after the Climate and Forecast conventions.

    Parameters
    ----------
    dataset : xarray.Dataset
        From :func:`lightflyer.fly`.
    path : path
        Of the file. Each flight is a trajectory with its own time, latitude and longitude, missing
        after its end.
    """
    # Source: [CF111]_ chapter 9.
    written = dataset.copy()
    written["time"] = dataset.time.where(np.isfinite(dataset.altitude))
    since = (dataset[ELAPSED].values * _SECOND).round().astype("timedelta64[ns]")
    for prefix, dimension in SEVERAL:
        if f"{prefix}released" in dataset:
            dates = dataset[f"{prefix}released"].values[:, None] + since
            flying = np.isfinite(dataset[f"{prefix}altitude"].values)
            dates[~flying] = np.datetime64("NaT")
            about = {"long_name": "date (UTC)"}
            written[f"{prefix}time"] = ((dimension, ELAPSED), dates, about, {"zlib": True})
    stated = {"cf_role": f"{_FLIGHT}_id", "long_name": "which flight"}
    written.coords[_FLIGHT] = ((), "stated", stated)
    version = f"lightflyer {dataset.attrs['lightflyer_version']}"
    written.attrs = {
        "Conventions": _CONVENTIONS,
        "featureType": _FLIGHT,
        "source": f"{version}, {dataset.attrs['force_model']}",
        "history": f"written by {version}",
        **dataset.attrs,
    }
    release = np.datetime_as_string(dataset.time.values[0], unit="us")
    dated = {"units": f"seconds since {release}", "dtype": "float64"}
    for name, variable in written.variables.items():
        name = str(name)
        before, _, last = name.rpartition("_")
        if name in _STANDARD_NAMES:
            variable.attrs["standard_name"] = _STANDARD_NAMES[name]
        elif last in _AXES:
            variable.attrs |= {"standard_name": last, **_AXES[last]}
            if before and f"{before}_" not in dict(SEVERAL):
                del variable.attrs["axis"]  # where a flight ended, for one, is not along it
        if variable.attrs.get("units") == "K":
            variable.attrs["units_metadata"] = "temperature: on_scale"
        prefix = next((prefix for prefix, one in SEVERAL if one in variable.dims), "")
        known = ["time", "latitude", "longitude", *([] if prefix else ["altitude", _FLIGHT])]
        along = [prefix + key for key in known]
        none = ELAPSED not in variable.dims or name in (ELAPSED, "ensemble_flying", *along)
        variable.encoding["coordinates"] = None if none else " ".join(along)
        if np.issubdtype(variable.dtype, np.datetime64):
            variable.encoding |= dated
    written[ELAPSED].encoding["_FillValue"] = None
    atomic_files.write_netcdf(written, Path(path))
