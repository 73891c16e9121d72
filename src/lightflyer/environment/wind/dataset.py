"""Reading winds on a grid from an xarray dataset: names, units, order, gaps."""

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from lightflyer.core import constants
from lightflyer.core.clock import seconds_of
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import RADIANS_PER_DEGREE
from lightflyer.core.units import scale_and_offset
from lightflyer.environment.wind.heights import (
    GAS_CONSTANT,
    altitude_of,
    check_heights,
    hydrostatic_geopotential,
    new_levels,
    on_altitudes,
)
from lightflyer.environment.wind.layouts import called, in_one_layout, not_of_the_sun, unit_of

LARGEST = 30_000_000  # Most points of a dataset's variables, which are in memory at once

_NAMES = {
    "time": ("time", "valid_time"),
    "altitude": ("altitude", "height"),
    "pressure": ("pressure", "pressure_level", "level", "plev", "isobaricInhPa"),
    "latitude": ("latitude", "lat"),
    "longitude": ("longitude", "lon"),
}
_VARIABLES = ("u", "v", "w")
_MERIDIANS = 36  # for a wind that is the same at every longitude
_DEGREES = ("degrees", "degree", "deg", "°")
_OMEGA = "Pa/s"
_OF_OMEGA = (
    "winds: w is in Pa/s, a change of pressure, which a temperature on pressure levels turns "
    "into m/s"
)
PLACING = "geopotential", "height", "temperature"
"""What tells the altitudes of pressure levels; the first of them that is there does."""

_AIR = {"temperature": "K", "geopotential": "m**2/s**2", "height": "m"}  # beside winds
_OF_AIR = "temperature", "log_pressure"
_FEWEST_LEVELS = 2
_FASTEST = 1e3  # no wind below 500 km is faster [m/s]
_COLDEST = 80.0  # no air is colder [K]


class WindGrid(NamedTuple):
    """Winds on a grid, in SI units, with increasing coordinates."""

    # shape (t,); [s since 2000-01-01 12:00 UTC]; one entry for a wind that does not change
    time: np.ndarray
    level: np.ndarray  # shape (z,); altitude [m], or the negative logarithm of the pressure in Pa
    by_pressure: bool  # Which of the two
    latitude: np.ndarray  # shape (y,); [rad]
    longitude: np.ndarray  # shape (y,); [rad]
    around: bool  # Whether the longitudes go round the whole planet
    east: np.ndarray  # shape (t, z, y, x); [m/s]; ``up`` is zero where the dataset has none
    north: np.ndarray
    up: np.ndarray
    told: str = ""  # How the altitudes of pressure levels are known
    # shape (t, z, y, x, 2); temperature [K] and logarithm of the pressure in Pa, where known
    air: np.ndarray | None = None


class WindFields(NamedTuple):
    """Fields of a dataset in SI units, shape (t, z, y, x), with increasing coordinates."""

    axes: list[np.ndarray]  # of time, level, latitude and longitude
    by_pressure: bool  # Whether levels are negative logarithms of the pressure
    same_around: bool  # Whether there is no longitude
    values: dict[str, np.ndarray]
    is_omega: bool  # Whether w is a change of pressure [Pa/s]


def read_grid(dataset: Any) -> WindGrid:
    """Check a dataset and take the winds from it."""
    fields = read_fields(dataset)
    level = fields.axes[1]
    # from the lowest one that no mountain reaches
    whole = np.logical_and.reduce(
        [np.isfinite(values).all(axis=(0, 2, 3)) for values in fields.values.values()]
    )
    first = int(np.argmax(whole))
    if level.size - first < _FEWEST_LEVELS:
        first = 0
    kept = {name: values[:, first:] for name, values in fields.values.items()}
    for name, values in kept.items():
        require_finite(values, name)
    axes = [*fields.axes]
    axes[1] = level[first:]
    fields = fields._replace(axes=axes, values=kept)
    altitude, told = heights_of(fields)
    if altitude is None:
        return grid_of(fields, told)
    new = new_levels(altitude[0].mean(axis=(1, 2)), altitude[:, 0].max(), altitude[:, -1].min())
    return grid_of(fields, told, new, winds_on(new, fields, altitude))


def read_fields(dataset: Any, *, air_only: bool = False) -> WindFields:
    """Check a dataset and take winds, temperature and geopotential from it, or these two alone."""
    dataset = in_one_layout(dataset)
    given = [] if air_only else _variables(dataset)
    names = dimensions_of(dataset, given[0] if given else str(next(iter(dataset.data_vars))))
    by_pressure = "pressure" in names
    level = "pressure" if by_pressure else "altitude"
    order = [names.get(kind) for kind in ("time", level, "latitude", "longitude")]
    axes, sorting = [], []
    for name, reader in zip(order, readers_of(by_pressure=by_pressure), strict=True):
        values = np.zeros(1) if name is None else reader(dataset[name])
        sorting.append(np.argsort(values, kind="stable"))
        axes.append(values[sorting[-1]])
        if np.any(~np.isfinite(values)) or np.any(np.diff(axes[-1]) <= 0.0):
            raise ConfigurationError(
                f"winds: {called(dataset[name])} has missing or repeated entries"
            )
        is_place = name is not None and name != names.get("time")
        if is_place and values.size == 1 and not air_only:
            raise ConfigurationError(f"winds: {called(dataset[name])} needs two entries or more")
    beside = _AIR if by_pressure else {}
    known = {name: unit for name, unit in beside.items() if name in dataset.data_vars}
    if "temperature" in known and "w" in given and _is_omega(dataset["w"]):
        known["w"] = _OMEGA
    units = dict.fromkeys(given, "m/s") | known
    present = [dimension for dimension in order if dimension is not None]
    missing_axes = tuple(axis for axis, dimension in enumerate(order) if dimension is None)
    found = {}
    for key, unit in units.items():
        array, name = dataset[key], called(dataset[key])
        if set(array.dims) != set(present):
            raise ConfigurationError(
                f"winds: {name} has other dimensions than {', '.join(present)}"
            )
        if unit != _OMEGA and _is_omega(array):
            raise ConfigurationError(f"{_OF_OMEGA}; give the temperature too, or drop it")
        values = _scale(array.transpose(*present), unit)
        if unit == "m/s" and np.any(np.abs(values) > _FASTEST):
            raise ConfigurationError(
                f"winds: {name} reaches {np.nanmax(np.abs(values)):.3g} m/s, and no wind exceeds "
                f"{_FASTEST:g} m/s: mark missing values by _FillValue, and check the units"
            )
        if unit == "K" and np.any(values < _COLDEST):
            raise ConfigurationError(
                f"winds: {name} falls to {np.nanmin(values):.3g} K, and no air is colder than "
                f'{_COLDEST:g} K: if it is in °C, set dataset["{name}"].attrs["units"] = "degC"; '
                "mark missing values by _FillValue"
            )
        if not by_pressure:
            require_finite(values, name)
        found[key] = np.expand_dims(values, missing_axes)[np.ix_(*sorting)]
    if {"geopotential", "height"} & {*known}:
        check_heights(dataset, axes[1], found)
    return WindFields(axes, by_pressure, order[-1] is None, found, units.get("w") == _OMEGA)


def readers_of(*, by_pressure: bool) -> tuple[Callable[[Any], np.ndarray], ...]:
    """What reads the coordinates: time, level, latitude, longitude."""
    return _seconds, _minus_log if by_pressure else partial(_scale, target="m"), _degrees, _degrees


def grid_of(
    fields: WindFields,
    told: str,
    altitudes: np.ndarray | None = None,
    winds: dict[str, np.ndarray] | None = None,
) -> WindGrid:
    """Winds on a grid; ``told``: how altitudes are known; ``winds``: of levels put on altitudes."""
    time, level, latitude, longitude = fields.axes
    level = level if altitudes is None else altitudes
    given = fields.values if winds is None else winds
    zero = np.zeros((time.size, level.size, latitude.size, longitude.size))
    east, north, up = (given.get(name, zero) for name in _VARIABLES)
    known = [given[name] for name in _OF_AIR if name in given and winds is not None]
    air = np.stack(known, axis=-1) if len(known) == len(_OF_AIR) else None
    if fields.same_around:
        longitude = np.arange(_MERIDIANS) / _MERIDIANS * 2.0 * np.pi
        east, north, up = (np.repeat(part, _MERIDIANS, axis=-1) for part in (east, north, up))
        air = None if air is None else np.repeat(air, _MERIDIANS, axis=3)
    if np.any(np.abs(latitude) > np.pi / 2 * (1.0 + 1e-9)):
        raise ConfigurationError("winds: latitude must be between -90 and 90 degrees")
    width, turn = longitude[-1] - longitude[0], 2.0 * np.pi
    if width > turn + 1e-6:
        raise ConfigurationError("winds: longitude goes more than once round the planet")
    around = bool(width + 1.01 * np.diff(longitude).max() >= turn)
    if width > turn - 1e-6:  # 0° and 360° are both there
        longitude = longitude[:-1]
        east, north, up = (part[..., :-1] for part in (east, north, up))
        air = None if air is None else air[..., :-1, :]
    by_pressure = fields.by_pressure and altitudes is None
    return WindGrid(
        time, level, by_pressure, latitude, longitude, around, east, north, up, told, air
    )


def _variables(dataset: Any) -> list[str]:
    """Names of the components that a dataset has."""
    there = [str(name) for name in getattr(dataset, "data_vars", ())]
    own = [called(dataset[name]) for name in there]
    given = [name for name in _VARIABLES if name in there]
    if given not in (["u", "v"], ["w"], list(_VARIABLES)):
        raise ConfigurationError(
            "winds: needs the variables u and v (towards east and north), w (up), or all three; "
            f"there are: {', '.join(own) or 'none'}"
        )
    size = dataset[given[0]].size
    if size > LARGEST:
        raise ConfigurationError(
            f"winds: {called(dataset[given[0]])} has {size:,} points, more than "
            f"{LARGEST:,}; select the times and levels that are needed, or coarsen it"
        )
    return given


def dimensions_of(dataset: Any, variable: str) -> dict[str, str]:
    """The dataset's own name of each dimension that its winds have."""
    found: dict[str, str] = {}
    own = called(dataset[variable])
    for dimension in dataset[variable].dims:
        kinds = [kind for kind, names in _NAMES.items() if dimension in names]
        if not kinds or kinds[0] in found:
            raise ConfigurationError(
                f"winds: {own} has the dimension {dimension}, which is none of time, "
                "altitude or pressure, latitude, longitude, or occurs twice; rename it or select "
                "one entry"
            )
        found[kinds[0]] = str(dimension)
    if "latitude" not in found:
        raise ConfigurationError(f"winds: {own} has no dimension latitude")
    if ("altitude" in found) == ("pressure" in found):
        raise ConfigurationError(f"winds: {own} needs one dimension altitude or pressure")
    for name in found.values():
        if name not in dataset.coords:
            raise ConfigurationError(f"winds: the dimension {name} has no coordinates")
    return found


def _scale(array: Any, target: str) -> np.ndarray:
    unit, name = unit_of(array), called(array)
    if not unit:
        raise ConfigurationError(
            f'winds: {name} has no units; set dataset["{name}"].attrs["units"] = "{target}"'
        )
    try:
        scale, offset = scale_and_offset(unit, target)
    except ConfigurationError as error:
        raise ConfigurationError(f"winds: units of {name}: {error}") from None
    return scale * np.asarray(array.values, float) + offset


def _degrees(array: Any) -> np.ndarray:
    unit = unit_of(array) or "degrees"
    if not unit.startswith(_DEGREES):
        raise ConfigurationError(f'winds: units of {called(array)}: "{unit}" is not degrees')
    return np.asarray(array.values, float) * RADIANS_PER_DEGREE


def _minus_log(array: Any) -> np.ndarray:
    values = _scale(array, "Pa")
    if not np.all(values > 0.0):
        raise ConfigurationError(f"winds: {called(array)} must be positive")
    return -np.log(values)


def _seconds(array: Any) -> np.ndarray:
    if not np.issubdtype(array.dtype, np.datetime64):
        if array.dtype == object:  # of cftime
            raise ConfigurationError(not_of_the_sun(called(array), array.dt.calendar, "dataset"))
        name = called(array)
        if " since " in unit_of(array):
            raise ConfigurationError(
                f"winds: {name} must be dates (UTC), not numbers; take xarray.decode_cf(dataset)"
            )
        raise ConfigurationError(
            f"winds: {name} must be dates (UTC); give it units such as "
            '"hours since 2024-06-21" and open it by xarray, which decodes them'
        )
    return np.asarray(seconds_of(array.values))


def _is_omega(array: Any) -> bool:
    try:
        return bool(scale_and_offset(unit_of(array), _OMEGA))
    except ConfigurationError:
        return False


def require_finite(values: np.ndarray, name: str) -> None:
    """Raise where values of a variable are missing."""
    missing = int(np.sum(~np.isfinite(values)))
    if missing:
        raise ConfigurationError(
            f"winds: {name} has {missing:,} missing values of {values.size:,}; fill them or select "
            "the part without"
        )


def heights_of(fields: WindFields) -> tuple[np.ndarray | None, str]:
    """Altitudes of pressure levels [m], shape (t, z, y, x), where a file tells them, and how."""
    if not fields.by_pressure:
        return None, ""
    known = fields.values
    if "geopotential" in known:
        geopotential, told = known["geopotential"], "the geopotential of the data"
    elif "height" in known:
        geopotential = constants.STANDARD_GRAVITY * known["height"]
        told = "the heights of the data"
    elif "temperature" in known:
        geopotential = hydrostatic_geopotential(fields.axes[1], known["temperature"])
        told = "the temperature of the data, from the lowest level in the standard atmosphere on"
    else:
        return None, "the atmosphere"
    altitude = altitude_of(geopotential, fields.axes[2][:, None])
    if np.any(np.diff(altitude, axis=1) <= 0.0):
        raise ConfigurationError(
            "winds: the heights of the data do not increase from level to level"
        )
    return altitude, told


def winds_on(new: np.ndarray, fields: WindFields, altitude: np.ndarray) -> dict[str, np.ndarray]:
    """The winds and the air on new levels [m]; ``altitude``: of the levels that they are on."""
    winds = {name: fields.values[name] for name in _VARIABLES if name in fields.values}
    if fields.is_omega:  # of air in hydrostatic balance
        pressure = np.exp(-fields.axes[1])[:, None, None]
        density = pressure / (GAS_CONSTANT * fields.values["temperature"])
        winds["w"] = -winds["w"] / (density * constants.STANDARD_GRAVITY)
    if "temperature" in fields.values:
        level = np.broadcast_to(-fields.axes[1][:, None, None], altitude.shape)
        winds |= dict(zip(_OF_AIR, (fields.values["temperature"], level), strict=True))
    return dict(zip(winds, on_altitudes(altitude, [*winds.values()], new), strict=True))
