"""The wind that a flyer met along its way, where it is in files of which only parts are read."""

import equinox as eqx
import jax.numpy as jnp

from lightflyer.core.quantity import Altitude
from lightflyer.core.types import Numeric
from lightflyer.environment.base import Place, Wind
from lightflyer.environment.wind.base import AbstractWind
from lightflyer.environment.wind.gridded import by_parts, winds_in_files
from lightflyer.mission.path.moments import Course
from lightflyer.mission.path.motion import Craft
from lightflyer.mission.path.position import latitude_and_longitude
from lightflyer.program.entry_point import entry_point

_places = entry_point(latitude_and_longitude)


class MetWind(AbstractWind):
    """A wind by time alone: that of the places where a flyer was."""

    times: Numeric  # shape (n,); [s since 2000-01-01 12:00 UTC]
    met: Wind  # shape (n,); [m/s]

    def velocity(self, altitude: Altitude, place: Place) -> Wind:
        return _at(self, place.time + 0.0 * altitude)

    def describe(self) -> tuple[str, ...]:
        return ("wind: as met along the way",)


@entry_point
def _at(wind: MetWind, time: Numeric) -> Wind:
    return Wind(*(jnp.interp(time, wind.times, part) for part in wind.met))


def with_met_wind(craft: Craft, course: Course) -> Craft:
    """A flyer whose wind from files is the one along a course; as it is without such a wind."""
    environment = craft.setup.environment
    if not winds_in_files(environment):
        return craft
    times = course.released + course.elapsed
    place = Place(*_places(course.position), times)
    wind = environment.wind  # type: ignore[attr-defined]
    met = by_parts(_velocity, wind, course.altitude, place)
    return eqx.tree_at(lambda craft: craft.setup.environment.wind, craft, MetWind(times, met))


def _velocity(wind: AbstractWind, altitude: Altitude, place: Place) -> Wind:
    return wind.velocity(altitude, place)
