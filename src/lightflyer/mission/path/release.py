"""Where and when a flyer is released."""

from types import NoneType
from typing import Any

import numpy as np

from lightflyer.core.clock import seconds_of
from lightflyer.core.errors import ParameterError
from lightflyer.core.precision import in_double
from lightflyer.core.quantity import (
    RADIANS_PER_DEGREE,
    Altitude,
    Checked,
    Latitude,
    Longitude,
    Velocity,
    require_record,
)
from lightflyer.environment.base import AbstractEnvironment, Place
from lightflyer.environment.radiation import Attitude
from lightflyer.mission.path.attitude import AbstractAttitudeRule, Moment
from lightflyer.mission.path.integration import Limits, Start
from lightflyer.mission.path.motion import Craft
from lightflyer.pytree.lazy_jax import jax
from lightflyer.pytree.module import field

_PACKAGE = __name__.partition(".")[0]
_YEARS = 1950, 2050  # in which the algorithm of the sun's place is good to 0.002°


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

    altitude: Altitude  #: Geometric altitude [m]
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
            in_double(self.latitude * RADIANS_PER_DEGREE),
            in_double(self.longitude * RADIANS_PER_DEGREE),
            in_double(self.time),
        )
        moving = None if self.velocity is None else in_double(self.velocity)
        return Start(in_double(self.altitude), place, moving)


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


def require_at_rest(release: Release, what: str) -> None:
    """Raise where a release has a velocity, for what is in balance from the first moment on."""
    if release.velocity is not None:
        raise ParameterError(
            f"{what} is in balance from the release on, and takes no velocity; leave it out, or "
            "take lf.fly"
        )


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


def require_rule(craft: Craft, start: Start) -> tuple[str, ...]:
    """Raise unless a rule of attitude serves a flyer; returns what to warn of."""
    rule, name = craft.rule, type(craft.rule).__name__
    if rule.tilts and craft.setup.flyer.floats:
        raise ParameterError(
            f"{name}: a balloon hangs upright; its attitude is its own or level, and shading steers"
        )
    state = craft.setup.environment.state(start.altitude, start.place)
    moment = craft.moment(start.altitude, start.place, np.float64(0.0), state)
    if type(rule).__module__.partition(".")[0] != _PACKAGE:
        _require_own(rule, moment)
    return rule.remarks(moment)


def _require_own(rule: AbstractAttitudeRule, moment: Moment) -> None:
    """Raise unless a rule of a user's own gives an attitude and a share of the light."""
    name = type(rule).__name__
    for method in ("attitude", "light"):
        try:
            jax.eval_shape(lambda moment, method=method: getattr(rule, method)(moment), moment)
            found = getattr(rule, method)(moment)
        except jax.errors.ConcretizationTypeError:
            raise ParameterError(
                f"{name}.{method} decides by a number of the moment, which flights computed "
                "together do not have alike; write jax.numpy.where(condition, this, that)"
            ) from None
        except (TypeError, ValueError, AttributeError) as error:
            raise ParameterError(f"{name}.{method}: {str(error).splitlines()[0]}") from None
        if method == "attitude":
            require_record(f"attitude of {name}", (Attitude, NoneType), found)
        elif found is not None and not (np.ndim(found) == 0 and 0.0 <= float(found) <= 1.0):
            raise ParameterError(
                f"{name}.light gives {np.asarray(found)}; it is one number from 0 to 1"
            )
