"""What the ground and the air above it send up: reflected light and heat radiation."""

import abc
from typing import Any, Final

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module
from lightflyer.core import constants
from lightflyer.core.checks import is_traced, require_data
from lightflyer.core.clock import date_text, seconds_of
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import RADIANS_PER_DEGREE, Checked, Fraction, Infrared, quantity_of
from lightflyer.core.text import span
from lightflyer.environment.base import Place
from lightflyer.environment.radiation import EARTH_ALBEDO, EARTH_INFRARED
from lightflyer.numerics.interpolation import Axis, interpolate


class AbstractGround(Checked):
    """Albedo and heat radiation of a planet, clouds included, by place and time.

    Subclasses are final. Methods work under JAX's transformations.
    """

    @abc.abstractmethod
    def albedo_at(self, place: Place) -> Array:
        """Share of sunlight that leaves again, evenly in all directions [1], shape (...)."""

    @abc.abstractmethod
    def infrared_at(self, place: Place) -> Array:
        """Heat radiation that leaves the planet [W/m²], shape (...)."""

    def margins(self, place: Place) -> dict[str, Numeric]:
        """How far the data still reach, for what integrates along a path.

        By what is beyond the end, in words, the distance to it: negative where there are no data.
        """
        return {}

    @abc.abstractmethod
    def describe(self) -> tuple[str, ...]:
        """Where albedo and heat radiation come from, in short texts with units."""


class UniformGround(AbstractGround):
    """The same everywhere and always.

    Attributes
    ----------
    albedo : array
        Share of sunlight that leaves again [1]; default :data:`EARTH_ALBEDO`.
    infrared : array
        Heat radiation [W/m²]; default :data:`EARTH_INFRARED`.
    """

    albedo: Fraction = EARTH_ALBEDO
    infrared: Infrared = EARTH_INFRARED

    def albedo_at(self, place: Place) -> Array:
        return _everywhere(self.albedo, place)

    def infrared_at(self, place: Place) -> Array:
        return _everywhere(self.infrared, place)

    def describe(self) -> tuple[str, ...]:
        return (
            f"albedo: {span(self.albedo)} everywhere",
            f"infrared from below: {span(self.infrared)} W/m² everywhere",
        )


@entry_point
def _everywhere(value: Numeric, place: Place) -> Array:
    return value + 0.0 * (place.latitude + place.longitude + place.time)


SECONDS_PER_YEAR: Final = 365.25 * 86_400.0  # Period of the seasons in [Knocke1988]_ [s]

_MIDWINTER = -6584.5 * 86_400.0  # 22 December 1981, 0 h [s since 2000-01-01 12:00 UTC]
# Mean, amplitude of the season's first and mean second Legendre polynomial of the sine of latitude
_ALBEDO = (0.34, 0.10, 0.29)
_EMISSIVITY = (0.68, -0.07, -0.18)
_OF_SUN = 0.25  # of sunlight is what a sphere receives on average over its surface


class Knocke1988Ground(AbstractGround):
    r"""Zonal means with seasons, fitted to satellites' measurements.

    .. math:: x_0 + x_1\cos\left(2\pi\frac{t-t_0}{\text{year}}\right)P_1(\sin\varphi)
        + x_2 P_2(\sin\varphi)

    for the albedo and for the heat radiation over a quarter of the sunlight at one astronomical
    unit, with Legendre polynomials P and midwinter :math:`t_0`.

    Notes
    -----
    Albedo 0.20 at the equator and 0.53 to 0.73 at the poles. The mean of the sunlight reflected
    is 0.30 of what falls on Earth; heat radiation is 231 W/m² on average, where newer
    measurements have 240 W/m² [Loeb2018]_. Of a single place and day, clouds make the albedo
    differ by 0.1 or more.

    References
    ----------
    [Knocke1988]_.
    """

    def albedo_at(self, place: Place) -> Array:
        return _zonal(_ALBEDO, place)

    def infrared_at(self, place: Place) -> Array:
        return _OF_SUN * constants.TOTAL_SOLAR_IRRADIANCE * _zonal(_EMISSIVITY, place)

    def describe(self) -> tuple[str, ...]:
        return (
            "albedo: zonal means with seasons of Knocke and others (1988)",
            "infrared from below: zonal means with seasons of Knocke and others (1988)",
        )


@entry_point
def _zonal(coefficients: tuple[float, float, float], place: Place) -> Array:
    mean, seasonal, curved = coefficients
    sine = xp.sin(place.latitude) + 0.0 * place.longitude
    season = xp.cos(2.0 * np.pi * (place.time - _MIDWINTER) / SECONDS_PER_YEAR)
    return mean + seasonal * season * sine + curved * 0.5 * (3.0 * sine**2 - 1.0)


_DAY = 86_400.0
_YEAR = 365.2425 * _DAY  # of the Gregorian calendar, on average
_TURN = 2.0 * np.pi
_MONTHS = 12
_REACH = 10.0 * RADIANS_PER_DEGREE  # of data towards the poles, less than which is a gap
_CLOSED = 1.01  # spacings that may be missing of a circle of longitudes

_KINDS = {"albedo": Fraction, "infrared": Infrared}
_NAMES = {
    "time": ("time", "month"),
    "latitude": ("latitude", "lat"),
    "longitude": ("longitude", "lon"),
}


class _Field(Module):
    values: Any  # shape (t, y, x)
    axes: tuple[Axis, Axis, Axis]  # of time [s], latitude and longitude [rad]
    ends: tuple[Any, Any] | None  # First and last time of data [s]; None where they never end


class GriddedGround(AbstractGround):
    """Albedo and heat radiation from a dataset, such as monthly means of satellites.

    Parameters
    ----------
    dataset : xarray.Dataset
        Variables ``albedo`` [1 or %] and ``infrared`` [W/m²], or one of them, each over any of:
        ``time`` (dates, UTC) or ``month`` (1 to 12, the same every year), ``latitude`` and
        ``longitude`` [deg], which must cover the whole planet.
    otherwise : AbstractGround
        Where the dataset lacks one of the two.

    Raises
    ------
    ConfigurationError
        In one line, what the dataset lacks.

    Notes
    -----
    Interpolated by cubics with a continuous derivative; albedo is kept between zero and one. Each
    month's mean stands in its middle, so that extremes within it are somewhat flattened. At the
    poles stands the mean of the nearest row of data.

    Examples
    --------
    >>> import xarray
    >>> sea = xarray.Dataset(
    ...     {"albedo": ("latitude", [0.6, 0.3, 0.2, 0.3, 0.6])},
    ...     {"latitude": [-90.0, -45.0, 0.0, 45.0, 90.0]},
    ... )
    >>> print(f"{GriddedGround(sea).albedo_at(Place.at(0.0, 45.0, 10.0)):.2f}")
    0.30
    """

    albedo: _Field | None
    infrared: _Field | None
    otherwise: AbstractGround

    def __init__(self, dataset: Any, otherwise: AbstractGround | None = None):
        there = list(getattr(dataset, "data_vars", ()))
        if not set(there) & set(_KINDS):
            raise ConfigurationError(
                "ground: needs the variables albedo [1], infrared [W/m²] or both; there are: "
                f"{', '.join(map(str, there)) or 'none'}"
            )
        self.albedo, self.infrared = (
            _read(dataset[name], name) if name in there else None for name in _KINDS
        )
        self.otherwise = UniformGround() if otherwise is None else otherwise

    def albedo_at(self, place: Place) -> Array:
        if self.albedo is None:
            return self.otherwise.albedo_at(place)
        return xp.clip(self._value(self.albedo, place), 0.0, 1.0)

    def infrared_at(self, place: Place) -> Array:
        if self.infrared is None:
            return self.otherwise.infrared_at(place)
        return xp.maximum(self._value(self.infrared, place), 0.0)

    def _value(self, field: _Field, place: Place) -> Array:
        require_data(self.margins(place))
        return _field_at(field, place)

    def margins(self, place: Place) -> dict[str, Numeric]:
        """Seconds to the first and to the last date."""
        found: dict[str, Numeric] = {}
        for name, field in (("albedo", self.albedo), ("infrared", self.infrared)):
            if field is not None and field.ends is not None:
                first, last = field.ends
                begins, stops = (
                    "its date" if is_traced(end) else date_text(end) for end in (first, last)
                )
                found[f"{name} on the ground begins at {begins}"] = place.time - first
                found[f"{name} on the ground ends at {stops}"] = last - place.time
        return found

    def describe(self) -> tuple[str, ...]:
        other = dict(zip(_KINDS, self.otherwise.describe(), strict=True))
        named = {"albedo": "albedo", "infrared": "infrared from below"}
        for name, field in (("albedo", self.albedo), ("infrared", self.infrared)):
            if field is not None:
                times, rows, columns = np.shape(field.values)
                dates = f"{times} dates" if field.ends else "months"
                where = f"{rows} latitudes" if rows > 1 else "all latitudes"
                other[name] = (
                    f"{named[name]}: {span(field.values)}, a dataset of "
                    f"{'the same always' if times == 1 else dates}, {where}"
                    f"{f', {columns} longitudes' if columns > 1 else ''}"
                )
        return tuple(other.values())


@entry_point
def _field_at(field: _Field, place: Place) -> Array:
    value = interpolate(field.values, field.axes, (place.time, place.latitude, place.longitude))
    if field.ends is None:
        return value
    first, last = field.ends
    return xp.where((place.time >= first) & (place.time <= last), value, np.nan)


def _read(array: Any, name: str) -> _Field:
    names = _dimensions(array, name)
    values = _check(array.transpose(*names.values()), name)
    time, period, ends = np.zeros(1), None, None
    if names.get("time") == "month":
        months, period = np.asarray(array["month"].values), _YEAR
        if sorted(months.tolist()) != list(range(1, _MONTHS + 1)):
            raise ConfigurationError(f"ground: month of {name} must be the numbers 1 to 12")
        edges = seconds_of(np.arange("2001-01", "2002-02", dtype="datetime64[M]").astype("M8[s]"))
        time = np.mod(0.5 * (edges[:-1] + edges[1:])[months - 1], _YEAR)  # the middle of each
    elif "time" in names:
        dates = array[names["time"]]
        if not np.issubdtype(dates.dtype, np.datetime64):
            raise ConfigurationError(
                f"ground: time of {name} must be dates (UTC), or month the numbers 1 to 12"
            )
        time = np.asarray(seconds_of(dates.values))
        ends = (time.min(), time.max()) if time.size > 1 else None
    latitude, longitude = (
        np.asarray(array[names[kind]].values, float) * RADIANS_PER_DEGREE
        if kind in names
        else np.zeros(1)
        for kind in ("latitude", "longitude")
    )
    for position, kind in enumerate(_NAMES):
        if kind not in names:
            values = np.expand_dims(values, position)
    for position, axis in enumerate((time, latitude, longitude)):
        values = np.take(values, np.argsort(axis, kind="stable"), position)
    time, latitude, longitude = (np.sort(axis) for axis in (time, latitude, longitude))
    for kind, axis in zip(_NAMES, (time, latitude, longitude), strict=True):
        if np.any(~np.isfinite(axis)) or np.any(np.diff(axis) <= 0.0):
            raise ConfigurationError(f"ground: {kind} of {name} has missing or repeated entries")
    if "longitude" in names:
        width = longitude[-1] - longitude[0]
        if abs(width - _TURN) < 1e-6:  # 0° and 360° are both there
            longitude, values = longitude[:-1], values[..., :-1]
        elif not (
            longitude.size > 2 and width <= _TURN <= width + _CLOSED * np.diff(longitude).max()
        ):
            raise ConfigurationError(
                f"ground: longitude of {name} must go once round the planet, in three steps or more"
            )
    if "latitude" in names:
        latitude, values = _to_poles(latitude, values, name)
    around = _TURN if "longitude" in names else None
    return _Field(values, (Axis(time, period), Axis(latitude), Axis(longitude, around)), ends)


def _dimensions(array: Any, name: str) -> dict[str, str]:
    """The dataset's own name of each dimension that a variable has, in our order."""
    unknown = set(array.dims) - {known for names in _NAMES.values() for known in names}
    if unknown:
        raise ConfigurationError(
            f"ground: {name} has the dimension {', '.join(sorted(map(str, unknown)))}, which is "
            "none of time or month, latitude, longitude; rename it or select one entry"
        )
    found = {
        kind: [str(dimension) for dimension in array.dims if dimension in names]
        for kind, names in _NAMES.items()
    }
    for kind, there in found.items():
        if len(there) > 1:
            raise ConfigurationError(f"ground: {name} has two dimensions of {kind}")
        if there and there[0] not in array.coords:
            raise ConfigurationError(f"ground: the dimension {there[0]} has no coordinates")
    return {kind: there[0] for kind, there in found.items() if there}


def _check(array: Any, name: str) -> np.ndarray:
    quantity = quantity_of(_KINDS[name])
    assert quantity is not None
    try:
        values = np.asarray(quantity.number(name, array), float)
    except ParameterError as error:
        raise ConfigurationError(f"ground: {error}") from None
    missing = int(np.sum(~np.isfinite(values)))
    if missing:
        raise ConfigurationError(
            f"ground: {name} has {missing:,} missing values of {values.size:,}; fill them (albedo "
            "in the polar night has no effect)"
        )
    try:
        quantity.check(name, values)
    except ParameterError as error:
        raise ConfigurationError(f"ground: {error}") from None
    if doubt := quantity.unlikely(values):
        raise ConfigurationError(f"ground: {name} = {doubt}")
    return values


def _to_poles(latitude: np.ndarray, values: np.ndarray, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Rows of data up to the poles."""
    pole = 0.5 * np.pi
    if max(latitude[0] + pole, pole - latitude[-1]) > _REACH or np.any(np.abs(latitude) > pole):
        raise ConfigurationError(
            f"ground: latitude of {name} must reach from -90 to 90 degrees, or within 10 of them"
        )
    for row, end in ((0, -pole), (-1, pole)):
        if abs(latitude[row] - end) > 1e-6:
            where = 0 if row == 0 else latitude.size
            mean = values[:, row].mean(-1, keepdims=True)  # broadcasts over longitudes
            latitude = np.insert(latitude, where, end)
            values = np.insert(values, where, mean, axis=1)
    return latitude, values
