"""Wind from data on a grid: a reanalysis, a forecast, a climatology."""

import math
from collections.abc import Callable, Iterator
from functools import partial, reduce
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Numeric, xp
from lightflyer.array.records import field
from lightflyer.core.checks import is_traced
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import Altitude
from lightflyer.environment.atmosphere.base import AbstractAtmosphere
from lightflyer.environment.base import Place, Wind
from lightflyer.environment.wind.base import AbstractWind, Air
from lightflyer.environment.wind.dataset import WindGrid, read_grid
from lightflyer.environment.wind.reach import Reach, next_to
from lightflyer.environment.wind.store import Store, open_wind
from lightflyer.numerics.cubic_grid import Axis, interpolate

T = TypeVar("T")

_TURN = 2.0 * np.pi
_SPACING_OF_TIDES = 21_600.0  # seconds between entries that still tell half a day's tide


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
    axes: tuple[Axis, Axis, Axis, Axis] | None
    bounds: Any  # shape (4, 2); between which the table is the data's; None for everywhere
    reach: Reach
    rises: bool = field(static=True)
    has_air: bool = field(static=True)
    told: str = field(static=True)
    store: Store | None = field(static=True)
    spacing: float = field(static=True)  # longest of its times [s]; infinite for one time

    def __init__(
        self, dataset: Any, atmosphere: AbstractAtmosphere | None = None, *, air: bool = True
    ):
        is_read = isinstance(dataset, WindGrid | Store)
        grid = dataset if is_read else read_grid(dataset)
        if grid.by_pressure and atmosphere is None:
            raise ConfigurationError(
                "winds: on pressure levels need an atmosphere, which knows their altitudes"
            )
        self.told, self.bounds = grid.told, None
        if isinstance(grid, Store):
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
            south, north = _near_poles(coordinates[2])
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
        a part is in memory, that around a place, and the next one is read where it is wanted.
        """
        try:
            return cls(open_wind(path), atmosphere, air=air)
        except ConfigurationError as error:
            told = str(error)
            raise ConfigurationError(
                told if told.startswith(str(path)) else f"{path}: {told}"
            ) from None

    def velocity(self, altitude: Altitude, place: Place) -> Wind:
        if self.table is None:
            found = Wind(*by_parts(GriddedWind.velocity, self, altitude, place, Wind))
            return self._require_margins(altitude, place, found)
        wind = self.at_level(self.reach.level(altitude, place), place)[:3]
        return self._require_margins(altitude, place, Wind(*wind))

    def at_level(self, level: Numeric, place: Place) -> tuple[Any, ...]:
        """Wind and air of a table at a coordinate of its levels, wherever it ends.

        East, north, up [m/s], and where known temperature [K] and logarithm of the pressure.
        """
        assert self.axes is not None
        longitude = self._longitude(place)
        return _interpolate(self.table, self.axes, self.bounds, level, place, longitude)

    def air(self, altitude: Altitude, place: Place, atmosphere: AbstractAtmosphere) -> Air | None:
        if not self.has_air:
            return None
        if self.table is None:
            look = partial(GriddedWind.air, atmosphere=atmosphere)
            return Air(*by_parts(look, self, altitude, place, Air))
        temperature, log_pressure = self.at_level(self.reach.level(altitude, place), place)[3:]
        return Air(temperature, xp.exp(log_pressure))

    def part(self, place: Place) -> "GriddedWind":
        """The wind around a place, in memory; everywhere where all is."""
        if self.store is None:
            return self
        part = self.store.part_at(Place(*map(float, place)))
        found = (*self.store.kept(part, _tabulate), self.store.bounds_of(part))
        return tree.replace_at(lambda wind: (wind.table, wind.axes, wind.bounds), self, found)

    def holds(self, place: Place) -> Any:
        """Whether this part of the data is that of a place."""
        if self.bounds is None:
            return self.table is not None
        return _is_within(self.bounds, (place.time, 0.0, place.latitude, self._longitude(place)))

    def _longitude(self, place: Place) -> Any:
        """The turn of a longitude that is next to the table."""
        assert self.axes is not None
        nodes = self.axes[3].nodes
        return next_to(0.5 * (nodes[0] + nodes[-1]), place.longitude)

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


def _is_within(bounds: Any, position: tuple[Any, ...]) -> Any:
    found = True
    for (low, high), x in zip(bounds, position, strict=True):
        found = found & (x >= low) & (x <= high)
    return found


def parts_at(whole: T, place: Place) -> T:
    """An object, such as an environment, whose winds from files are the parts around a place."""
    found: T = tree.map_leaves(
        lambda leaf: leaf.part(place) if _is_data(leaf) else leaf, whole, is_leaf=_is_data
    )
    return found


def parts_along(whole: T, place: Place, wanted: np.ndarray) -> Iterator[tuple[T, np.ndarray]]:
    """Trees as of :func:`parts_at`, one after the other, and which places each is for.

    ``place``: arrays, shape (n,); ``wanted``: which of them there are data for, shape (n,).
    """
    left = wanted.copy()
    while left.any():
        first = int(np.argmax(left))
        part = parts_at(whole, Place(*(values[first] for values in place)))
        here = left & hold(part, place)
        here[first] = True  # whatever rounding says
        yield part, here
        left &= ~here


def winds_in_files(whole: Any) -> list[GriddedWind]:
    """The winds of an object whose data are in files, or a part of them in memory."""
    leaves = tree.leaves(whole, is_leaf=_is_data)
    return [leaf for leaf in leaves if _is_data(leaf) and leaf.store is not None]


def hold(whole: Any, place: Place) -> Any:
    """Whether the parts of all winds from files are those of a place."""
    return reduce(np.logical_and, [wind.holds(place) for wind in winds_in_files(whole)], True)


def _is_data(leaf: Any) -> bool:
    return isinstance(leaf, GriddedWind)


def by_parts(
    look: Callable[[Any, Any, Place], Any],
    wind: Any,
    altitude: Altitude,
    place: Place,
    kind: type[Wind] | type[Air],
) -> Any:
    """What a wind some of which is in files tells, part by part of these; NaN where it ends.

    ``kind``: of what ``look`` returns, whose numbers are returned.
    """
    if all(one.table is not None for one in winds_in_files(wind)):
        return look(wind, altitude, place)
    if is_traced(altitude, place):
        raise ParameterError(
            "winds of large files are read where a mission goes, not under JAX's transformations; "
            "select what is needed: GriddedWind(xarray.open_dataset(file).sel(...))"
        )
    shape = np.broadcast_shapes(*map(np.shape, (altitude, *place)))
    height, *where = (np.broadcast_to(part, shape).ravel() for part in (altitude, *place))
    flat = Place(*where)
    inside = reduce(np.minimum, wind.margins(height, flat).values(), np.zeros(height.size)) >= 0.0
    found = np.full((len(kind._fields), height.size), np.nan)
    for part, here in parts_along(wind, flat, inside):
        found[:, here] = look(part, height[here], Place(*(values[here] for values in flat)))
    return [row.reshape(shape)[()] for row in found]


def _tabulate(grid: WindGrid) -> tuple[np.ndarray, tuple[Axis, Axis, Axis, Axis]]:
    """Table of vectors and its axes, which go on over the poles where all meridians meet there."""
    table, nodes = _as_vectors(grid), grid.latitude
    if grid.around:
        south, north = _near_poles(nodes)
        if south:
            table, nodes = _extend_over_pole(table, nodes)
        if north:
            turned, mirrored = _extend_over_pole(table[:, :, ::-1], -nodes[::-1])
            table, nodes = turned[:, :, ::-1], -mirrored[::-1]
    around = _TURN if grid.around else None
    return table, (Axis(grid.time), Axis(grid.level), Axis(nodes), Axis(grid.longitude, around))


def _near_poles(latitude: np.ndarray) -> tuple[bool, bool]:
    """Whether parallels reach the south and the north pole to within their spacing."""
    near = 0.5 * np.pi - 1.01 * float(np.diff(latitude).max(initial=0.0))
    return bool(latitude[0] < -near), bool(latitude[-1] > near)


def _as_vectors(grid: WindGrid) -> np.ndarray:
    """Three components in space of the horizontal wind, and the wind upwards, on the grid."""
    latitude, longitude = grid.latitude[:, None], grid.longitude
    east, north = _directions(latitude, longitude, np)
    horizontal = grid.east[..., None] * east + grid.north[..., None] * north
    air = [] if grid.air is None else [grid.air]
    return np.concatenate([horizontal, grid.up[..., None], *air], axis=-1)


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
        table = table.copy()
        table[:, :, 0] = table[:, :, 0].mean(axis=2, keepdims=True)
    count = table.shape[3]
    rows = table[:, :, int(at_pole) :][:, :, :2]
    half, other_half = count // 2, (count + 1) // 2
    behind = 0.5 * (np.roll(rows, half, axis=3) + np.roll(rows, other_half, axis=3))
    nodes = -np.pi - latitude[int(at_pole) :][:2]
    return np.concatenate([behind[:, :, ::-1], table], axis=2), np.append(nodes[::-1], latitude)


@entry_point
def _interpolate(
    table: Any,
    axes: tuple[Axis, ...],
    bounds: Any,
    level: Numeric,
    place: Place,
    longitude: Numeric,
) -> tuple[Any, ...]:
    position = (place.time, level, place.latitude, longitude)
    found = interpolate(table, axes, position)
    if bounds is not None:  # beyond a part of the data there are others
        found = xp.where(_is_within(bounds, position)[..., None], found, np.nan)
    east, north = _directions(place.latitude, place.longitude)
    horizontal = found[..., :3]
    along = (xp.sum(horizontal * part, axis=-1) for part in (east, north))
    return (*along, *xp.moveaxis(found[..., 3:], -1, 0))
