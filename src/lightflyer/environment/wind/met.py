"""The winds over the places of a flight, where they are in files of which only parts are read."""

from typing import Any, TypeVar

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Numeric, xp
from lightflyer.array.records import field
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Altitude
from lightflyer.environment.atmosphere.base import AbstractAtmosphere
from lightflyer.environment.base import Place, Wind
from lightflyer.environment.wind.base import AbstractWind, Air
from lightflyer.environment.wind.gridded import GriddedWind, parts_along
from lightflyer.environment.wind.reach import Reach
from lightflyer.numerics.cubic_grid import Axis, interpolate

T = TypeVar("T")


class MetWind(AbstractWind):
    """The column of a wind over a flyer, by time alone; as of the data at the times given."""

    reach: Reach
    # shape (times, levels, 3 or 5); wind [m/s], and temperature [K] and logarithm of the pressure
    columns: Any
    axes: tuple[Axis, Axis]  # of times and levels
    has_air: bool = field(static=True)

    def velocity(self, altitude: Altitude, place: Place) -> Wind:
        level = self.reach.level(altitude, place)
        wind = _interpolate(self.columns, self.axes, place.time, level)
        return self._require_margins(altitude, place, Wind(*wind[:3]))

    def air(self, altitude: Altitude, place: Place, atmosphere: AbstractAtmosphere) -> Air | None:
        del atmosphere
        if not self.has_air:
            return None
        level = self.reach.level(altitude, place)
        temperature, log_pressure = _interpolate(self.columns, self.axes, place.time, level)[3:]
        return Air(temperature, xp.exp(log_pressure))

    def margins(self, altitude: Altitude, place: Place) -> dict[str, Numeric]:
        return self.reach.margins(altitude, place)

    def describe(self) -> tuple[str, ...]:
        return (f"wind: data along a flight, {self.reach.describe()}",)


@entry_point
def _interpolate(columns: Any, axes: tuple[Axis, Axis], time: Numeric, level: Numeric) -> Any:
    return tuple(xp.moveaxis(interpolate(columns, axes, (time, level)), -1, 0))


def with_met_winds(whole: T, place: Place) -> T:
    """An object, such as an environment, whose winds from files are those over some places.

    ``place``: fields have the shape (n,).
    """
    times, first = np.unique(place.time, return_index=True)
    place = Place(place.latitude[first], place.longitude[first], times)

    def met(leaf: Any) -> Any:
        if not isinstance(leaf, GriddedWind) or leaf.store is None:
            return leaf
        levels = leaf.store.axes[1]
        columns = np.full((times.size, levels.size, 5 if leaf.store.has_air else 3), np.nan)
        for part, here in parts_along(leaf, place, np.ones(times.size, bool)):
            there = Place(*(values[here, None] for values in place))
            columns[here] = np.stack(part.at_level(levels, there), axis=-1)
        return MetWind(leaf.reach, columns, (Axis(times), Axis(levels)), leaf.has_air)

    found: T = tree.map_leaves(met, whole, is_leaf=lambda leaf: isinstance(leaf, GriddedWind))
    return found
