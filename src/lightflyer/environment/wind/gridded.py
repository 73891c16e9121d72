"""Wind from data on a grid, and another wind above, below and beside them."""

import math
from functools import reduce
from pathlib import Path
from typing import Any

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module, field
from lightflyer.core.checks import is_traced
from lightflyer.core.clock import date_text
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import RADIANS_PER_DEGREE, Altitude, require_record
from lightflyer.environment.base import AbstractAtmosphere, Place, Wind
from lightflyer.environment.wind.base import AbstractWind, AirBesideWind, near_poles, next_to
from lightflyer.environment.wind.dataset import WindGrid, read_grid
from lightflyer.environment.wind.store import WindStore, open_wind
from lightflyer.numerics.interpolation import Axis, interpolate

_TURN = 2.0 * np.pi
_SPACING_OF_TIDES = 21_600.0  # seconds between entries that still tell half a day's tide


# Units of margins, in which ends compare.
_HOUR = 3600.0
TWO_KILOMETRES = 2e3
_LOG_PRESSURE = 0.3  # of the same order
_ONE_DEGREE = RADIANS_PER_DEGREE

_TAKES_OVER = 'beyond = "gradient", in Python WindBeyondData, has another wind take over there'
_SIDES = {
    "time": ("before", "after"),
    "altitude": ("below", "above"),
    "latitude": ("south of", "north of"),
    "longitude": ("west of", "east of"),
}


class Reach(Module):
    """First and last coordinates of data on a grid."""

    atmosphere: AbstractAtmosphere | None  # by whose pressure levels are found; None by altitude
    # of time, level, latitude and longitude
    ends: tuple[tuple[float, float], ...] = field(static=True)
    around: bool = field(static=True)  # Whether longitudes go round the planet

    def level(self, altitude: Altitude, place: Place) -> Any:
        """Coordinate of an altitude: itself, or the negative logarithm of its pressure in Pa."""
        if self.atmosphere is None:
            return altitude
        return _minus_log_pressure(self.atmosphere, altitude, place)

    def margins(self, altitude: Altitude, place: Place) -> dict[str, Numeric]:
        """How far the data still reach, as :meth:`~.base.AbstractWind.margins` has it."""
        time, level, latitude, longitude = self.ends
        found: dict[str, Numeric] = {}
        if time[0] != time[1]:
            found |= _margins("time", place.time, time, _HOUR, *map(date_text, time))
        lowest, highest = self._level_names()
        unit = TWO_KILOMETRES if self.atmosphere is None else _LOG_PRESSURE
        height = self.level(altitude, place)
        found |= _margins("altitude", height, level, unit, lowest, f"{highest}; {_TAKES_OVER}")
        south, north = (f"{end / RADIANS_PER_DEGREE:.4g}°" for end in latitude)
        if np.ptp(latitude) < np.pi:
            found |= _margins("latitude", place.latitude, latitude, _ONE_DEGREE, south, north)
        west, east = (f"{end / RADIANS_PER_DEGREE:.4g}°" for end in longitude)
        if not self.around:
            near = next_to(0.5 * sum(longitude), place.longitude)
            found |= _margins("longitude", near, longitude, _ONE_DEGREE, west, east)
        return found

    def describe(self) -> str:
        """Times and levels, in words."""
        begin, end = map(date_text, self.ends[0])
        period = "constant in time" if begin == end else f"{begin} to {end}"
        return f"{period}, {' to '.join(self._level_names())}"

    def _level_names(self) -> tuple[str, str]:
        low, high = self.ends[1]
        if self.atmosphere is None:
            return f"{low / 1e3:.4g} km", f"{high / 1e3:.4g} km"
        return f"{np.exp(-low):.4g} Pa", f"{np.exp(-high):.4g} Pa"


def _margins(
    name: str, value: Numeric, ends: tuple[float, float], unit: float, first: str, last: str
) -> dict[str, Numeric]:
    (low, high), (below, above) = ends, _SIDES[name]
    return {
        f"{name} {below} the data of the wind, which begin at {first}": (value - low) / unit,
        f"{name} {above} the data of the wind, which end at {last}": (high - value) / unit,
    }


@entry_point
def _minus_log_pressure(atmosphere: AbstractAtmosphere, altitude: Altitude, place: Place) -> Any:
    return -xp.log(atmosphere.pressure(altitude, place))


class GriddedWind(AbstractWind):
    """Wind from a dataset, interpolated in time, height, latitude and longitude.

    Horizontal winds are interpolated as vectors in space. So a pole, where east and north turn
    with the longitude, is a place like any other, and so is the date line. Interpolation is by
    local cubics with a continuous derivative.

    Parameters
    ----------
    dataset : xarray.Dataset or WindGrid
        Variables ``u`` and ``v``, the wind towards east and north, ``w``, the wind upwards, or all
        three, each with ``units`` that convert to m/s. Dimensions: ``latitude`` and
        ``longitude`` in degrees; ``altitude`` (geometric, above sea level) or ``pressure``, with
        units; ``time`` as dates in UTC. Without ``time`` the wind does not change, without
        ``longitude`` it is the same all around. Usual other names of dimensions are known, such as
        ``lat``, ``level``, ``valid_time``.
        ERA5, GFS, MERRA-2, ICON on a regular grid and WRF on pressure levels are read as they are;
        a ``w`` in Pa/s becomes m/s by the temperature beside it. Pressure levels lie where the
        dataset's geopotential, or its heights, or its temperature has them.
    atmosphere : AbstractAtmosphere, optional
        Finds the altitudes of pressure levels where the dataset has none of these.
    air : bool
        Whether flights meet the dataset's temperature and pressure too, where it has a temperature
        on pressure levels; by default they do.

    Raises
    ------
    ConfigurationError
        In one line, if a variable, a dimension or a unit is missing or wrong, if data are missing
        in between, or the dataset has more than 30 million points; files may have more.

    Notes
    -----
    Where longitudes go all around and latitudes reach a pole to within their spacing, the wind is
    defined up to the pole and across; a row at the pole itself counts by its mean vector.

    Examples
    --------
    >>> import xarray as xr
    >>> heights = ("altitude", [40e3, 60e3, 80e3], {"units": "m"})
    >>> places = {"altitude": heights, "latitude": [-60.0, 0.0, 60.0]}
    >>> names, unit = tuple(places), {"units": "m/s"}
    >>> u, v = (names, np.full((3, 3), -40.0), unit), (names, np.zeros((3, 3)), unit)
    >>> wind = GriddedWind(xr.Dataset({"u": u, "v": v}, places))
    >>> print(wind.describe()[0])
    wind: data, constant in time, 40 km to 80 km, nothing upwards
    """

    table: Any  # None where the data are in their files
    axes: Any  # of the table: of time, level, latitude and longitude
    reach: Reach
    rises: bool = field(static=True)
    has_air: bool = field(static=True)
    told: str = field(static=True)
    store: WindStore | None = field(static=True)
    spacing: float = field(static=True)  # longest of its times [s]; infinite for one time

    def __init__(
        self, dataset: Any, atmosphere: AbstractAtmosphere | None = None, *, air: bool = True
    ):
        is_read = isinstance(dataset, WindGrid | WindStore)
        grid = dataset if is_read else read_grid(dataset)
        if grid.by_pressure and atmosphere is None:
            raise ConfigurationError(
                "winds: on pressure levels need an atmosphere, which knows their altitudes"
            )
        self.told = grid.told
        if isinstance(grid, WindStore):
            self.store, self.table, self.axes, self.rises = grid, None, None, grid.rises
            self.has_air = air and grid.has_air
            coordinates = tuple(grid.axes)
        else:
            self.store, self.rises = None, bool(np.any(grid.up))
            self.has_air = air and grid.air is not None
            self.table, self.axes = _tabulate(grid)
            coordinates = grid.time, grid.level, grid.latitude, grid.longitude
        self.spacing = float(np.diff(coordinates[0]).max(initial=0.0)) or math.inf
        ends = [(float(axis[0]), float(axis[-1])) for axis in coordinates]
        if grid.around:
            south, north = near_poles(coordinates[2])
            pole = 0.5 * np.pi
            ends[2] = (-pole if south else ends[2][0], pole if north else ends[2][1])
        known = atmosphere if grid.by_pressure else None
        self.reach = Reach(known, tuple(ends), grid.around)

    @classmethod
    def from_file(
        cls, path: str | Path, atmosphere: AbstractAtmosphere | None = None, *, air: bool = True
    ) -> "GriddedWind":
        """Wind from a NetCDF or GRIB file, or from all that match a pattern such as ``era5-*.nc``.

        ``atmosphere``, ``air``: as of the class. Of more than 2.5 million points of a variable only
        a window is in memory, around all places that were asked for. It may have 40 million points.
        """
        try:
            return cls(open_wind(path), atmosphere, air=air)
        except ConfigurationError as error:
            told = str(error)
            raise ConfigurationError(
                told if told.startswith(str(path)) else f"{path}: {told}"
            ) from None

    def velocity(self, altitude: Altitude, place: Place) -> Wind:
        wind = self._at(altitude, place)[:3]
        return self._require_margins(altitude, place, Wind(*wind))

    def air(
        self, altitude: Altitude, place: Place, atmosphere: AbstractAtmosphere
    ) -> AirBesideWind | None:
        if not self.has_air:
            return None
        temperature, log_pressure = self._at(altitude, place)[3:]
        return AirBesideWind(temperature, xp.exp(log_pressure))

    def _at(self, altitude: Altitude, place: Place) -> tuple[Any, ...]:
        """East, north, up [m/s], and where known temperature [K] and logarithm of the pressure."""
        table, axes = self.table, self.axes
        if self.store is not None:
            if is_traced(altitude, place):
                raise ParameterError(
                    "winds of large files are read where a mission goes, not under JAX's "
                    "transformations; select what is needed: "
                    "GriddedWind(xarray.open_dataset(file).sel(...))"
                )
            table, axes = self.store.table_around(place, _tabulate)
        nodes = axes[3].nodes
        longitude = next_to(0.5 * (nodes[0] + nodes[-1]), place.longitude)
        return _interpolate(table, axes, self.reach.level(altitude, place), place, longitude)

    def margins(self, altitude: Altitude, place: Place) -> dict[str, Numeric]:
        return self.reach.margins(altitude, place)

    @property
    def has_tides(self) -> bool:
        return self.spacing <= _SPACING_OF_TIDES

    def describe(self) -> tuple[str, ...]:
        upwards = "" if self.rises else ", nothing upwards"
        heights = f"; altitudes of its levels by {self.told}" if self.told else ""
        air = ("air: temperature and pressure of the data of the wind",) if self.has_air else ()
        return (f"wind: data, {self.reach.describe()}{upwards}{heights}", *air)


def winds_in_files(whole: Any) -> list[GriddedWind]:
    """The winds of an object, such as an environment, whose data are in files."""
    leaves = tree.leaves(whole, is_leaf=_is_data)
    return [leaf for leaf in leaves if _is_data(leaf) and leaf.store is not None]


def _is_data(leaf: Any) -> bool:
    return isinstance(leaf, GriddedWind)


def _tabulate(grid: WindGrid) -> tuple[np.ndarray, tuple[Axis, Axis, Axis, Axis]]:
    """Table of vectors and its axes, which go on over the poles where all meridians meet there."""
    nodes = grid.latitude
    east, north = _directions(nodes[:, None], grid.longitude, np)
    horizontal = grid.east[..., None] * east + grid.north[..., None] * north
    air = [] if grid.air is None else [grid.air]
    table = np.concatenate([horizontal, grid.up[..., None], *air], axis=-1)
    if grid.around:
        south, north = near_poles(nodes)
        if south:
            table, nodes = _extend_over_pole(table, nodes)
        if north:
            turned, mirrored = _extend_over_pole(table[:, :, ::-1], -nodes[::-1])
            table, nodes = turned[:, :, ::-1], -mirrored[::-1]
    around = _TURN if grid.around else None
    return table, (Axis(grid.time), Axis(grid.level), Axis(nodes), Axis(grid.longitude, around))


def _directions(latitude: Any, longitude: Any, xp: Any = xp) -> tuple[Any, Any]:
    """Unit vectors east and north in the frame of the planet, shape (..., 3)."""
    latitude, longitude = xp.broadcast_arrays(latitude, longitude)
    sine, cosine = xp.sin(longitude), xp.cos(longitude)
    height = xp.sin(latitude)
    east = xp.stack([-sine, cosine, xp.zeros_like(sine)], axis=-1)
    north = xp.stack([-height * cosine, -height * sine, xp.cos(latitude)], axis=-1)
    return east, north


def _extend_over_pole(table: np.ndarray, latitude: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Table and latitudes with two rows more, beyond the pole, where it is met from behind."""
    at_pole = bool(np.isclose(latitude[0], -np.pi / 2))
    if at_pole:  # one wind, whatever the longitude
        table, around = table.copy(), table[:, :, :3].mean(axis=3)
        size = np.linalg.norm(table[:, :, 0, :, :3], axis=-1).mean(axis=2)
        # Eastward and northward winds that are the same at all longitudes, as ERA5 has them there,
        # are no one wind: they have no mean. It is that of the rows beside, by a parabola.
        _, first, second = (latitude[:3] - latitude[0]) ** 2
        beside = (second * around[:, :, 1] - first * around[:, :, 2]) / (second - first)
        no_wind = np.linalg.norm(around[:, :, 0, :3], axis=-1) < 0.5 * size
        around[:, :, 0, :3] = np.where(no_wind[..., None], beside[..., :3], around[:, :, 0, :3])
        table[:, :, 0] = around[:, :, :1]
    count = table.shape[3]
    rows = table[:, :, int(at_pole) :][:, :, :2]
    half, other_half = count // 2, (count + 1) // 2
    behind = 0.5 * (np.roll(rows, half, axis=3) + np.roll(rows, other_half, axis=3))
    nodes = -np.pi - latitude[int(at_pole) :][:2]
    return np.concatenate([behind[:, :, ::-1], table], axis=2), np.append(nodes[::-1], latitude)


@entry_point
def _interpolate(
    table: Any, axes: tuple[Axis, ...], level: Numeric, place: Place, longitude: Numeric
) -> tuple[Any, ...]:
    found = interpolate(table, axes, (place.time, level, place.latitude, longitude))
    east, north = _directions(place.latitude, place.longitude)
    horizontal = found[..., :3]
    along = (xp.sum(horizontal * part, axis=-1) for part in (east, north))
    return (*along, *xp.moveaxis(found[..., 3:], -1, 0))


class WindBeyondData(AbstractWind):
    """Wind from data, which another one takes over from smoothly where they end.

    Within the last two kilometres, degree or hour of the data the other wind gains weight, up to
    all of it at their end. So does the temperature of the atmosphere. Above and below, the pressure
    keeps its ratio to the atmosphere's, as it has to in hydrostatic balance.

    Parameters
    ----------
    data : GriddedWind
    beyond : AbstractWind
        Such as a :class:`GradientWind`. It need not reach where the data do.

    Notes
    -----
    Once continuously differentiable where both winds are.
    """

    data: GriddedWind
    beyond: AbstractWind

    def __init__(self, data: GriddedWind, beyond: AbstractWind):
        require_record("data", (GriddedWind,), data)
        require_record("beyond", (AbstractWind,), beyond)
        self.data, self.beyond = data, beyond

    def velocity(self, altitude: Altitude, place: Place) -> Wind:
        return self._require_margins(altitude, place, _velocity(self, altitude, place))

    def air(
        self, altitude: Altitude, place: Place, atmosphere: AbstractAtmosphere
    ) -> AirBesideWind | None:
        if not self.data.has_air:
            return None
        return _air(self, altitude, place, atmosphere)

    def margins(self, altitude: Altitude, place: Place) -> dict[str, Numeric]:
        within = _within(self.data, altitude, place) - 1.0
        found = self.beyond.margins(altitude, place)
        return {name: xp.maximum(margin, within) for name, margin in found.items()}

    def share_of_data(self, altitude: Altitude, place: Place) -> Any:
        """Weight of the data in the wind [1]: one inside, zero where they end."""
        return _weight(self.data, altitude, place)

    @property
    def has_tides(self) -> bool:
        return self.data.has_tides and self.beyond.has_tides

    def describe(self) -> tuple[str, ...]:
        beyond = (text.removeprefix("wind: ") for text in self.beyond.describe())
        return (*self.data.describe(), *(f"wind beyond the data: {text}" for text in beyond))


@entry_point
def _within(data: AbstractWind, altitude: Altitude, place: Place) -> Numeric:
    """How far the nearest end of the data is, in the units of margins."""
    return reduce(xp.minimum, data.margins(altitude, place).values())


@entry_point
def _weight(data: AbstractWind, altitude: Altitude, place: Place) -> Numeric:
    return _smooth(_within(data, altitude, place))


def _smooth(within: Numeric) -> Numeric:
    share = xp.clip(within, 0.0, 1.0)
    return share**2 * (3.0 - 2.0 * share)


@entry_point
def _air(
    wind: WindBeyondData, altitude: Altitude, place: Place, atmosphere: AbstractAtmosphere
) -> AirBesideWind:
    margins = wind.data.margins(altitude, place).items()
    sides = [margin for name, margin in margins if not name.startswith("altitude")]
    beside = _smooth(reduce(xp.minimum, sides, xp.asarray(1.0)))
    # the altitude, which stays within the data and slows down in their last two kilometres
    lowest, highest = wind.data.reach.ends[1]

    def slowed(distance: Numeric) -> Array:
        inside = xp.clip(distance / TWO_KILOMETRES, 0.0, 1.0)
        return xp.maximum(distance, 0.5 * TWO_KILOMETRES * (1.0 + inside**2))

    inner = lowest + slowed(highest - slowed(highest - altitude) - lowest)
    data = wind.data.air(inner, place, atmosphere)
    assert data is not None
    known = beside > 0.0  # elsewhere NaN
    warmer = xp.where(known, data.temperature - atmosphere.temperature(inner, place), 0.0)
    ratio = xp.where(known, data.pressure / atmosphere.pressure(inner, place), 1.0)
    return AirBesideWind(
        atmosphere.temperature(altitude, place) + _weight(wind.data, altitude, place) * warmer,
        atmosphere.pressure(altitude, place) * ratio**beside,
    )


@entry_point
def _velocity(wind: WindBeyondData, altitude: Altitude, place: Place) -> Wind:
    weight = _weight(wind.data, altitude, place)
    inner = wind.data.velocity(altitude, place)
    outer = wind.beyond.velocity(altitude, place)
    parts = (
        weight * xp.where(weight > 0.0, here, 0.0)  # NaN where a wind does not reach
        + (1.0 - weight) * xp.where(weight < 1.0, there, 0.0)
        for here, there in zip(inner, outer, strict=True)
    )
    return Wind(*parts)


def with_end_of_data(whole: Any) -> WindBeyondData | None:
    """The wind of an object, such as an environment, that another one takes over from."""
    leaves = tree.leaves(whole, is_leaf=lambda leaf: isinstance(leaf, WindBeyondData))
    return next((leaf for leaf in leaves if isinstance(leaf, WindBeyondData)), None)
