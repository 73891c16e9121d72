"""A mission as NetCDF that other programs know how to read: a trajectory for each flight."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.core import atomic_files
from lightflyer.mission.report.dataset import ELAPSED, SEVERAL

if TYPE_CHECKING:
    import xarray as xr

_CONVENTIONS = "CF-1.11"
_ALONG: dict[str, dict[str, str]] = {
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
        variable.attrs |= _attributes(str(name))
        if variable.attrs.get("units") == "K":
            variable.attrs["units_metadata"] = "temperature: on_scale"
        variable.encoding["coordinates"] = _coordinates(str(name), variable)
        if np.issubdtype(variable.dtype, np.datetime64):
            variable.encoding |= dated
    written[ELAPSED].encoding["_FillValue"] = None
    atomic_files.write_netcdf(written, Path(path))


def _attributes(name: str) -> dict[str, Any]:
    """Names that the conventions give a variable."""
    if name in _STANDARD_NAMES:
        return {"standard_name": _STANDARD_NAMES[name]}
    before, _, last = name.rpartition("_")
    if last not in _ALONG:
        return {}
    about = {"standard_name": last, **_ALONG[last]}
    if before and f"{before}_" not in dict(SEVERAL):
        del about["axis"]  # where a flight ended, for one, is not along it
    return about


def _coordinates(name: str, variable: "xr.Variable") -> str | None:
    """Where and when the values of a variable are, by the names of other variables."""
    prefix = next((prefix for prefix, one in SEVERAL if one in variable.dims), "")
    known = ["time", "latitude", "longitude", *([] if prefix else ["altitude", _FLIGHT])]
    along = [prefix + key for key in known]
    none = ELAPSED not in variable.dims or name in (ELAPSED, "ensemble_flying", *along)
    return None if none else " ".join(along)
