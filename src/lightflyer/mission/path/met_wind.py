"""The winds over the places of a flight, where they are in files of which only parts are read."""

from typing import Any

import jax
import numpy as np

from lightflyer.core.quantity import Altitude
from lightflyer.core.types import Numeric
from lightflyer.environment.base import Place, Wind
from lightflyer.environment.wind.base import AbstractWind
from lightflyer.environment.wind.gridded import GriddedWind, parts_along, winds_in_files
from lightflyer.environment.wind.reach import Reach
from lightflyer.mission.path.integration import Track
from lightflyer.mission.path.motion import Craft
from lightflyer.mission.path.position import latitude_and_longitude
from lightflyer.mission.path.termination import TerminationReason
from lightflyer.numerics.cubic_grid import Axis, interpolate
from lightflyer.program.entry_point import entry_point

_places = entry_point(latitude_and_longitude)
_AT_END = 1e-3  # Margin to the end of data within which a flight has met it


class MetWind(AbstractWind):
    """The column of a wind over a flyer, by time alone; as of the data at the times given."""

    reach: Reach
    columns: Any  # shape (times, levels, 3); [m/s]
    axes: tuple[Axis, Axis]  # of times and levels

    def velocity(self, altitude: Altitude, place: Place) -> Wind:
        level = self.reach.level(altitude, place)
        wind = _interpolate(self.columns, self.axes, place.time, level)
        return self._require_margins(altitude, place, wind)

    def margins(self, altitude: Altitude, place: Place) -> dict[str, Numeric]:
        return self.reach.margins(altitude, place)

    def describe(self) -> tuple[str, ...]:
        return (f"wind: data along a flight, {self.reach.describe()}",)


@entry_point
def _interpolate(columns: Any, axes: tuple[Axis, Axis], time: Numeric, level: Numeric) -> Wind:
    found = interpolate(columns, axes, (time, level))
    return Wind(found[..., 0], found[..., 1], found[..., 2])


def with_met_winds(craft: Craft, position: Any, released: Any, elapsed: Any) -> Craft:
    """A flyer whose winds from files are those over some places.

    ``position``: unit vectors, shape (n, 3); ``elapsed``: shape (n,) [s after ``released``].
    """
    if not winds_in_files(craft):
        return craft
    times, first = np.unique(np.asarray(released) + np.asarray(elapsed), return_index=True)
    place = Place(*_places(np.asarray(position)[first]), times)

    def met(leaf: Any) -> Any:
        if not isinstance(leaf, GriddedWind) or leaf.store is None:
            return leaf
        levels = leaf.store.axes[1]
        columns = np.full((times.size, levels.size, 3), np.nan)
        for part, here in parts_along(leaf, place, np.ones(times.size, bool)):
            there = Place(*(values[here, None] for values in place))
            columns[here] = np.stack(part.at_level(levels, there), axis=-1)
        return MetWind(leaf.reach, columns, (Axis(times), Axis(levels)))

    found: Craft = jax.tree.map(met, craft, is_leaf=lambda leaf: isinstance(leaf, GriddedWind))
    return found


def left_their_part(tree: Any, track: Track, released: Any) -> Any:
    """Whether flights ended though the data of winds from files go on, shape (...).

    ``tree``: that has the winds; ``track``: fields have the shape (...) in front.
    """
    place = Place(*_places(track.end_position), released + track.end_elapsed)
    ended = np.equal(track.termination, TerminationReason.NO_DATA)
    for wind in winds_in_files(tree):
        margins = wind.margins(track.end_altitude, place).values()
        ended = ended & (np.min([*margins], axis=0) > _AT_END)
    return ended & bool(winds_in_files(tree))
