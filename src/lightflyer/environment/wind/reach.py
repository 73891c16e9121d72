"""How far the data of a wind reach."""

from typing import Any

import numpy as np

from lightflyer.array.namespace import Numeric, xp
from lightflyer.array.records import Module, field
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import RADIANS_PER_DEGREE, Altitude
from lightflyer.environment.atmosphere.base import AbstractAtmosphere
from lightflyer.environment.base import Place
from lightflyer.environment.wind.dataset import EPOCH

_TURN = 2.0 * np.pi
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
            found |= _margins("time", place.time, time, _HOUR, *map(_date, time))
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
        begin, end = (_date(value) for value in self.ends[0])
        period = "constant in time" if begin == end else f"{begin} to {end}"
        return f"{period}, {' to '.join(self._level_names())}"

    def _level_names(self) -> tuple[str, str]:
        low, high = self.ends[1]
        if self.atmosphere is None:
            return f"{low / 1e3:.4g} km", f"{high / 1e3:.4g} km"
        return f"{np.exp(-low):.4g} Pa", f"{np.exp(-high):.4g} Pa"


def next_to(middle: Numeric, longitude: Numeric) -> Any:
    """The turn of a longitude that is next to another."""
    return middle + (longitude - middle + np.pi) % _TURN - np.pi


def _margins(
    name: str, value: Numeric, ends: tuple[float, float], unit: float, first: str, last: str
) -> dict[str, Numeric]:
    (low, high), (below, above) = ends, _SIDES[name]
    return {
        f"{name} {below} the data of the wind, which begin at {first}": (value - low) / unit,
        f"{name} {above} the data of the wind, which end at {last}": (high - value) / unit,
    }


def _date(seconds: float) -> str:
    date = EPOCH + np.timedelta64(round(seconds), "s")
    return f"{np.datetime_as_string(date, unit='m')} UTC"


@entry_point
def _minus_log_pressure(atmosphere: AbstractAtmosphere, altitude: Altitude, place: Place) -> Any:
    return -xp.log(atmosphere.pressure(altitude, place))
