"""Weather files as they are downloaded, brought to one layout: names, dimensions, several files."""

import glob
import re
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.extras import extra
from lightflyer.core.text import read_content
from lightflyer.core.units import scale_and_offset

_PATTERN = re.compile(r"[*?\[]")
_NETCDF = (b"\x89HDF", b"CDF")  # what such files begin with
_GRIB = (".grib", ".grib2", ".grb", ".grb2", ".gb2")
_INDEX = ".idx"  # Written by cfgrib beside a file
_IN_GRIB = "u", "v", "w", "t", "z", "gh"
_LEVELS_IN_GRIB = {"isobaricInhPa": "hPa", "isobaricInPa": "Pa"}  # GFS has both in one file

# Names in lower case, of ERA5, GFS, MERRA-2, ICON, WRF and the CF conventions.
_VARIABLES = {
    "u": "u ua ugrd uwnd u_pl u-component_of_wind_isobaric u_component_of_wind eastward_wind",
    "v": "v va vgrd vwnd v_pl v-component_of_wind_isobaric v_component_of_wind northward_wind",
    "w": "w wa omega wap vvel vertical_velocity_pressure_isobaric vertical_velocity"
    " lagrangian_tendency_of_air_pressure upward_air_velocity",
    "temperature": "temperature t ta tmp t_pl temperature_isobaric air_temperature",
    "geopotential": "geopotential z phi fi",
    "height": "gh zg h hgt ght_pl geopotential_height_isobaric geopotential_height",
}
_COORDINATES = {
    "latitude": "latitude lat",
    "longitude": "longitude lon",
    "pressure": "pressure pressure_level level plev isobaricinhpa lev isobaric",
}
_COUNTED = re.compile(r"(isobaric|time)\d+")  # as THREDDS numbers what it has several of
_OF_WRF = {"num_press_levels_stag": "pressure", "south_north": "latitude", "west_east": "longitude"}
_EITHER = ("geopotential", "height", "m"), ("height", "geopotential", "m**2/s**2")
_GRADS = "prs"  # at the end of names of fields on pressure levels
_BY_GRADS = re.compile(r"\[([^\]]+)\]\s*$")  # a unit at the end of a long name
_OF_GRADS = {"k": "K", "pa/s": "Pa/s"}
_OF_YEAR_ONE = re.compile(r"(day|hour|minute|second)s? since 0*1-0*1-0*1\b(?!.*[1-9])")
_IN_A_DAY = {"day": 1, "hour": 24, "minute": 1440, "second": 86_400}
# Days from 0001-01-01 to 2000-01-01; the first two calendars begin by Julius Caesar's
_YEAR_ONE = {"standard": 730_121, "gregorian": 730_121, "proleptic_gregorian": 730_119}
OWN_NAME = "lightflyer_own_name"  # attribute of what has another name in the file

_VERSION = "expver"  # of ERA5, whose latest months are of another version
_EVEN = 1e-3  # degrees, by which meridians and parallels of a grid may bend


def open_parts(path: str | Path) -> list[Any]:
    """Open a NetCDF or GRIB file, or all whose names match a pattern: no field is read yet."""
    parts = []
    for file in weather_files(path):
        is_grib = file.lower().endswith(_GRIB)
        if is_grib:
            extra("cfgrib", f"{file}: GRIB", "grib")
        found = []
        try:
            for dataset in _open_grib(file) if is_grib else [_open_netcdf(file)]:
                part = _with_our_names(dataset)
                wanted = [name for name in _VARIABLES if name in part.data_vars]
                part = part[wanted] if wanted else part  # no other is read from the disk
                part.set_close(dataset.close)
                found.append(part)
        except ConfigurationError:
            raise
        except (OSError, ValueError, EOFError) as error:
            damaged = Path(file).is_file() and read_content(Path(file)).startswith(_NETCDF)
            unknown = "is damaged or cut short" if damaged else "xarray knows no way to open it"
            reason = getattr(error, "strerror", None) or unknown
            kind = "GRIB" if is_grib else "NetCDF"
            raise ConfigurationError(f"{file}: cannot be read as {kind}: {reason}") from None
        if not found:
            raise ConfigurationError(f"{file}: has no u and v on pressure levels")
        parts += found
    return parts


def load_parts(path: str | Path, parts: list[Any]) -> Any:
    """One dataset in memory of files that are open, or of parts of them."""
    import xarray

    try:
        loaded = [merge_versions(part.load()) for part in parts]
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be read: {error}") from None
    if len(loaded) == 1:
        return loaded[0]
    try:
        return xarray.combine_by_coords(loaded, combine_attrs="override", join="exact")
    except ValueError as error:
        reason = str(error).partition("\n")[0]
        raise ConfigurationError(f"{path}: these files do not share one grid: {reason}") from None


def weather_files(path: str | Path) -> list[str]:
    """The files that a name or a pattern stands for, in order."""
    text = str(path)
    if not _PATTERN.search(text) or Path(text).exists():
        return [text]
    found = sorted(name for name in glob.glob(text) if not name.endswith(_INDEX))
    if not found:
        raise ConfigurationError(f"{path}: no file has such a name")
    return found


def _open_netcdf(path: str) -> Any:
    import xarray

    dataset = xarray.open_dataset(path, decode_times=False)
    for time in map(str, dataset.coords):
        unit = str(dataset[time].attrs.get("units", ""))
        calendar = str(dataset[time].attrs.get("calendar", "standard")).lower()
        if " since " in unit and calendar not in _YEAR_ONE:
            told = not_of_the_sun(time, calendar, f'xarray.open_dataset("{path}")')
            raise ConfigurationError(f'{path}: {told}.to_netcdf("dates.nc")')
        if match := _OF_YEAR_ONE.match(unit):  # of GrADS, which xarray reads with cftime alone
            later = dataset[time].values - float(_YEAR_ONE[calendar] * _IN_A_DAY[match[1]])
            since = {"units": f"{match[1]}s since 2000-01-01"}
            dataset = dataset.assign_coords({time: (dataset[time].dims, later, since)})
    try:
        return xarray.decode_cf(dataset)
    except ValueError as error:
        reason = str(error).partition(". ")[0]
        raise ConfigurationError(f"{path}: its times cannot be read: {reason}") from None


def _open_grib(path: str) -> list[Any]:
    """Winds and air on pressure levels, one part for each unit of these; a file may hold more."""
    import xarray

    found = []
    for level, unit in _LEVELS_IN_GRIB.items():
        fields = [  # one by one, as some lack levels that others have
            xarray.open_dataset(
                path, engine="cfgrib", time_dims=("valid_time",), squeeze=False,
                filter_by_keys={"typeOfLevel": level, "shortName": name},
            )
            for name in _IN_GRIB
        ]  # fmt: skip
        if not {"u", "v"} <= {str(name) for field in fields for name in field.data_vars}:
            continue
        part = xarray.merge(fields, join="inner", compat="override", combine_attrs="override")
        pressure = scale_and_offset(unit, "hPa")[0] * part[level].values
        part = part.rename({level: "pressure"})
        found.append(part.assign_coords(pressure=("pressure", pressure, {"units": "hPa"})))
    in_all = [name for name in _IN_GRIB if all(name in part for part in found)]
    return [part[in_all] for part in found]


def in_one_layout(dataset: Any) -> Any:
    """A dataset with our names, and without dimensions that say nothing."""
    if not hasattr(dataset, "data_vars"):
        return dataset
    return merge_versions(_with_our_names(dataset))


def _with_our_names(dataset: Any) -> Any:
    """The same, but for the versions of ERA5; reads no field."""
    found = _of_wrf(dataset)
    found = _renamed(found, _known(found.data_vars, _VARIABLES, found))
    for name, other, unit in _EITHER:  # whatever it is called, its unit tells
        if name in found.data_vars and other not in {*found.variables, *found.dims}:
            with suppress(ConfigurationError):
                scale_and_offset(unit_of(found[name]), unit)
                found = _renamed(found, {name: other})
    known = _known([*found.coords, *found.dims], _COORDINATES)
    known |= {
        name: "time" for name in map(str, found.dims) if re.fullmatch(r"time\d+", name.lower())
    }
    # times for which a forecast holds, and no dimension of one entry but those of the grid
    found = _renamed(found, known)
    valid = "valid_time"
    single = [
        name for name in found.dims if found.sizes[name] == 1
        and name not in ("latitude", "longitude", "pressure", "altitude", "height", valid)
        and not (name == "time" and "step" not in found.dims)
    ]  # fmt: skip
    found = found.squeeze(single, drop=False)
    if valid in found.coords and valid not in found.dims and found[valid].ndim == 1:
        own = str(found[valid].dims[0])
        found = found.drop_vars("time", errors="ignore") if own != "time" else found
        found = found.swap_dims({own: valid}).drop_vars(own, errors="ignore")
        found = found.rename({valid: "time"})
    return found.drop_vars([name for name in found.coords if not found[name].ndim], errors="ignore")


def _renamed(dataset: Any, names: Mapping[str, str]) -> Any:
    found = dataset.rename(names)
    for own, ours in names.items():
        if ours in found.variables:
            found[ours].attrs.setdefault(OWN_NAME, own)
    return found


def called(array: Any) -> str:
    """The file's own name of a variable."""
    return str(array.attrs.get(OWN_NAME, array.name))


def not_of_the_sun(time: str, calendar: str, dataset: str) -> str:
    """That a model's calendar tells no dates, and the code that brings them."""
    return (
        f"winds: {time} is in the calendar {calendar}, but the sun needs true dates: "
        f'pip install cftime, then {dataset}.convert_calendar("standard", dim="{time}", '
        'align_on="date")'
    )


def unit_of(array: Any) -> str:
    """Unit of a variable, as :mod:`lightflyer.core.units` reads it; empty where it has none."""
    at_end = _BY_GRADS.search(str(array.attrs.get("long_name", "")))
    unit = str(array.attrs.get("units") or (at_end[1] if at_end else ""))
    return _OF_GRADS.get(unit, unit).replace("gpm", "m")  # geopotential metres


def _known(names: Any, kinds: Mapping[str, str], dataset: Any = None) -> dict[str, str]:
    """Our name of each of a dataset's, where nothing has it yet."""
    found: dict[str, str] = {}
    for given in map(str, names):
        label = given.lower().removesuffix(_GRADS)
        counted = _COUNTED.fullmatch(label)
        label = counted.group(1) if counted else label
        standard = "" if dataset is None else dataset[given].attrs.get("standard_name", "")
        for ours, aliases in kinds.items():
            if (label in aliases.split() or (standard and standard in aliases.split())) and (
                ours not in found.values() and (given == ours or ours not in names)
            ):
                found[given] = ours
                break
    return {given: ours for given, ours in found.items() if given != ours}


def _of_wrf(dataset: Any) -> Any:
    """Coordinates of WRF's files of pressure levels, which it keeps as fields."""
    fields = {name: dataset.variables.get(name) for name in ("XLAT", "XLONG", "P_PL")}
    if any(field is None for field in fields.values()):
        return dataset
    latitude, longitude, pressure = (np.asarray(field, float) for field in fields.values())
    latitude, longitude = (grid.reshape(-1, *grid.shape[-2:]) for grid in (latitude, longitude))
    if max(np.ptp(latitude, axis=2).max(), np.ptp(longitude, axis=1).max()) > _EVEN:
        raise ConfigurationError(
            "winds: XLAT and XLONG do not form a grid of latitudes and longitudes; interpolate "
            "the file to one, such as by cdo remapbil"
        )
    levels = pressure.reshape(-1, pressure.shape[-1])[0]
    places = {
        "pressure": ("pressure", levels, {"units": "Pa"}),
        "latitude": ("latitude", latitude[0, :, 0]),
        "longitude": ("longitude", longitude[0, 0]),
    }
    found = dataset.drop_vars(list(fields)).rename(
        {name: ours for name, ours in _OF_WRF.items() if name in dataset.dims}
    )
    found = found.assign_coords(places)
    if "XTIME" in found.variables and "Time" in found.dims:
        return found.assign_coords(Time=found["XTIME"].values).rename(Time="time")
    return found


def merge_versions(dataset: Any) -> Any:
    """One version of ERA5 where two share the times."""
    if _VERSION not in dataset.dims:
        return dataset
    first, *others = (
        dataset.isel({_VERSION: row}, drop=True) for row in range(dataset.sizes[_VERSION])
    )
    for other in others:
        first = first.fillna(other)
    return first


def one_version(dataset: Any) -> Any:
    """The first version of ERA5, whose layout is that of all."""
    return dataset.isel({_VERSION: 0}, missing_dims="ignore")
