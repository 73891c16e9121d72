"""Where and when a flyer is released."""

from dataclasses import replace
from types import NoneType
from typing import Any

import numpy as np

from lightflyer.array.namespace import double
from lightflyer.array.records import field
from lightflyer.core.clock import seconds_of
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import (
    RADIANS_PER_DEGREE,
    Altitude,
    Checked,
    Latitude,
    Longitude,
    Quantity,
    Velocity,
    quantity_of,
    require_record,
)
from lightflyer.environment.base import AbstractEnvironment, Place, Wind
from lightflyer.environment.radiation import Attitude
from lightflyer.environment.section import warn_of_kilometres
from lightflyer.mission.path.integration import Limits, Start
from lightflyer.mission.path.motion import Vehicle

_PACKAGE = __name__.partition(".")[0]
_BY_ONE = "truth value of an array", "only length-1 arrays", "only 0-dimensional arrays"
"""Of what Python says where an array stands in the place of a number."""

_YEARS = 1950, 2050  # in which the algorithm of the sun's place is good to 0.002°


def _altitude(given: Any) -> Any:
    warn_of_kilometres(given)
    return (quantity_of(Altitude) or Quantity()).number("altitude", given)


class Release(Checked):
    """Where and when a flyer is released.

    Raises
    ------
    ParameterError
        If a concrete value is out of its range.

    Examples
    --------
    >>> Release("75 km", latitude=45.0, longitude="10 deg", time="2000-01-01T12:01Z").time
    60.0
    """

    altitude: Altitude = field(converter=_altitude)  #: Geometric altitude [m]
    latitude: Latitude  #: Geodetic [deg], north and east positive
    longitude: Longitude  #: Geodetic [deg], north and east positive
    #: Seconds since 2000-01-01 12:00 UTC [s]. Constructors take a date too: a
    #: :class:`datetime.datetime`, or a text such as ``"2026-06-21T12:00:00Z"``; without a time zone
    #: it is UTC
    time: Any = field(converter=seconds_of)
    #: Over ground, to the east, north and up [m/s], shape (3,), such as that of a rocket or an
    #: aircraft; None for at rest in the air
    velocity: Velocity | None = None

    def __post_init__(self) -> None:
        if self.velocity is not None and np.shape(self.velocity) != (3,):
            raise ParameterError(
                "velocity of a release needs three components: to the east, north and up [m/s]"
            )

    def start(self) -> Start:
        """The same in the units of the integration."""
        place = Place(
            double(self.latitude * RADIANS_PER_DEGREE),
            double(self.longitude * RADIANS_PER_DEGREE),
            double(self.time),
        )
        moving = None if self.velocity is None else double(self.velocity)
        return Start(double(self.altitude), place, moving)


def limits_of(environment: AbstractEnvironment, lowest: Any, highest: Any) -> Limits:
    """Altitudes between which a mission goes on."""
    where = environment.coordinate
    if where.name != "altitude":
        raise ParameterError(f"a mission needs an environment over altitude, not over {where.name}")
    low, high = float(where.lowest), float(where.highest)
    lowest, highest = (
        None if one is None else float(where.quantity.number(name, one))
        for name, one in (("lowest", lowest), ("highest", highest))
    )
    for name, value in (("lowest", lowest), ("highest", highest)):
        if value is not None and not low <= value <= high:
            raise ParameterError(
                f"{name} altitude {value / 1e3:g} km is outside the atmosphere, which is known "
                f"from {low / 1e3:g} km to {high / 1e3:g} km"
            )
    found = Limits(low if lowest is None else lowest, high if highest is None else highest)
    if found.lowest >= found.highest:
        raise ParameterError("the lowest altitude must be below the highest")
    return found


def require_release_inside(release: Release, limits: Limits) -> None:
    """Raise unless a flyer is released between the limits of the mission, and under a known sun."""
    require_record("release", (Release,), release)
    first, last = (seconds_of(f"{year}-01-01T00:00") for year in _YEARS)
    if not first <= float(release.time) < last:
        raise ParameterError(
            f"the date of the release is outside the years {_YEARS[0]} to {_YEARS[1]}, in which "
            "the sun's place is known"
        )
    altitude = float(release.altitude)
    for beyond, what, end in (
        (altitude <= limits.lowest, "at or below the lowest", limits.lowest),
        (altitude >= limits.highest, "at or above the highest", limits.highest),
    ):
        if beyond:
            raise ParameterError(
                f"release altitude {altitude / 1e3:g} km is {what} altitude of the mission, "
                f"{float(end) / 1e3:g} km"
            )


def require_rule(vehicle: Vehicle, start: Start) -> tuple[str, ...]:
    """Raise unless a rule of attitude serves a flyer; returns what to warn of."""
    rule, name = vehicle.rule, type(vehicle.rule).__name__
    if rule.tilts and (hangs := vehicle.setup.flyer.hangs) is not None:
        raise ParameterError(
            f"{name}: {hangs}; its attitude is its own or level, and shading steers"
        )
    state = vehicle.setup.environment.state(start.altitude, start.place)
    moment = vehicle.moment(start.altitude, start.place, np.float64(0.0), state)
    if type(rule).__module__.partition(".")[0] == _PACKAGE:
        return rule.remarks(moment)
    # a rule of a user's own gives attitudes and shares of the light in arrays
    several = replace(
        moment,
        elapsed=np.array([0.0, 1.0]),
        altitude=np.broadcast_to(moment.altitude, 2),
        place=Place(*(np.broadcast_to(part, 2) for part in moment.place)),
        wind=Wind(*(np.broadcast_to(part, 2) for part in moment.wind)),
    )
    for method in ("attitude", "light"):
        try:
            found = getattr(rule, method)(moment)
            getattr(rule, method)(several)
            if method == "light":
                found = found if found is None else np.asarray(found, float)
        except (TypeError, ValueError, AttributeError) as error:
            said = str(error).splitlines()[0]
            if any(part in said for part in _BY_ONE):
                raise ParameterError(
                    f"{name}.{method} decides by a number of the moment, which many moments that "
                    "are computed together do not have alike; write numpy.where(condition, this, "
                    "that)"
                ) from None
            raise ParameterError(f"{name}.{method}: {said}") from None
        if method == "attitude":
            require_record(f"attitude of {name}", (Attitude, NoneType), found)
        elif found is not None and not (np.ndim(found) == 0 and 0.0 <= float(found) <= 1.0):
            raise ParameterError(f"{name}.light gives {found}; it is one number from 0 to 1")
    return rule.remarks(moment)
