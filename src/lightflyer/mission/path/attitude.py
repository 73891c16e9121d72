"""How a flyer lies during a mission: rules that give its attitude from what they see."""

import abc
from typing import Any

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module, field
from lightflyer.core.quantity import (
    RADIANS_PER_DEGREE,
    Altitude,
    Checked,
    Contradictions,
    Duration,
    Fraction,
    GroundDistance,
    LargestTilt,
)
from lightflyer.environment.base import AbstractEnvironment, Place, Wind
from lightflyer.environment.radiation import Attitude, Radiation
from lightflyer.mission.areas import Circle, angles_towards

_NEAR = 10e3
"""Distance from a station at which a flyer tilts by half of the largest tilt [m]."""


class Moment(Module):
    """What a rule sees: a flyer at one moment of its flight."""

    elapsed: Numeric  #: Time since the release [s]
    altitude: Numeric  #: [m]
    place: Place
    radiation: Radiation
    wind: Wind  #: That meets the flyer, with its error in an ensemble [m/s]
    own: Attitude | None  #: Attitude that the flyer itself states; None means level
    environment: AbstractEnvironment

    def wind_at(self, altitude: Numeric) -> Wind:
        """Wind at other altitudes here and now, shape (...), without its error [m/s].

        Of several moments at once, their axes come last.
        """
        altitude, *place = xp.broadcast_arrays(altitude, *self.place)
        found = self.environment.state(altitude, Place(*place)).wind
        still = xp.zeros_like(xp.asarray(altitude, float))
        return Wind(still, still, still) if found is None else found

    def way_to(self, station: Circle) -> tuple[Any, Any]:
        """Trajectory along the ground to the middle of a station, eastward and northward [m]."""
        latitude, longitude = (
            RADIANS_PER_DEGREE * part for part in (station.latitude, station.longitude)
        )
        planet = self.environment.planet
        assert planet is not None, "places are over planets"
        east, north = angles_towards(self.place.latitude, self.place.longitude, latitude, longitude)
        return planet.radius * east, planet.radius * north


class AbstractAttitudeRule(Checked):
    """Rule that gives the attitude of a flyer. Subclasses are final."""

    @property
    def tilts(self) -> bool:
        """Whether it is of use only to a flyer that tilts."""
        return False

    @abc.abstractmethod
    def attitude(self, moment: Moment) -> Attitude | None:
        """Attitude at a moment of the flight; None means level."""

    def light(self, moment: Moment) -> Numeric | None:
        """Share of the light that the flyer lets in [1]; None means all, at all times."""
        del moment
        return None

    def remarks(self, moment: Moment) -> tuple[str, ...]:
        """What to warn of at the release; numbers are concrete."""
        del moment
        return ()

    @abc.abstractmethod
    def describe(self) -> str:
        """The rule in a few words."""


class Own(AbstractAttitudeRule):
    """The attitude that the flyer itself states, level where it states none."""

    def attitude(self, moment: Moment) -> Attitude | None:
        return moment.own

    def describe(self) -> str:
        return "the flyer's own, at all times"


class Level(AbstractAttitudeRule):
    """Level at all times."""

    def attitude(self, moment: Moment) -> Attitude | None:
        del moment
        return None

    def describe(self) -> str:
        return "level"


class FollowSun(AbstractAttitudeRule):
    r"""Tilted towards the azimuth of the sun by a share of its zenith angle, level at night.

    With half of the zenith angle the lift goes with :math:`(1+\cos z)/2` instead of
    :math:`\cos z`. The rule asks for something that turns the flyer: nothing passive does.

    Attributes
    ----------
    share : array
        Tilt over zenith angle [1].
    largest : array
        Tilt that is not exceeded [rad].

    Notes
    -----
    The tilt goes with the share of the sun's disk that the horizon does not hide. Not
    differentiable where the largest tilt is reached.
    """

    share: Fraction = 0.5
    largest: LargestTilt = 0.25 * np.pi

    @property
    def tilts(self) -> bool:
        return True

    def attitude(self, moment: Moment) -> Attitude | None:
        light = moment.radiation
        lit = light.visible_part(1.0)
        tilt = xp.minimum(self.share * light.zenith_angle, self.largest) * lit
        return _attitude(tilt, light.azimuth)

    def describe(self) -> str:
        degrees = float(self.largest) * 180.0 / np.pi
        return (
            f"tilted towards the sun by {float(self.share):g} of its zenith angle, at most "
            f"{degrees:g}°; level at night"
        )


class TowardsStation(AbstractAttitudeRule):
    r"""Tilted towards a station, so that the flyer slides there through the air.

    At a distance :math:`d` the tilt is :math:`d/(d+10\,\mathrm{km})` of the largest one.

    Attributes
    ----------
    station : Circle
        Whose middle the flyer makes for.
    largest : array
        Tilt far from it [rad].
    """

    station: Circle
    largest: LargestTilt = RADIANS_PER_DEGREE * 15.0

    @property
    def tilts(self) -> bool:
        return True

    def attitude(self, moment: Moment) -> Attitude | None:
        east, north = moment.way_to(self.station)
        square = east**2 + north**2
        there = square == 0.0
        # a stand-in, so that derivatives at the station are numbers
        distance = xp.where(there, 0.0, xp.sqrt(xp.where(there, 1.0, square)))
        azimuth = xp.arctan2(east, xp.where(there, 1.0, north))
        return _attitude(self.largest * distance / (distance + _NEAR), azimuth)

    def describe(self) -> str:
        degrees = float(self.largest) / RADIANS_PER_DEGREE
        return f"tilted by at most {degrees:g}° towards {self.station.middle}"


def _attitude(tilt: Any, azimuth: Any) -> Attitude:
    """An attitude of traced numbers, which need no check."""
    return tree.replace_at(
        lambda attitude: (attitude.tilt, attitude.azimuth), Attitude(), (tilt, azimuth)
    )


_LEVELS = 21  # Altitudes of which the wind is compared
_ALIKE = 2e3
"""Difference of two misses of a station that is hardly worth another altitude [m]."""
_HOURS = 3600.0
_SHEAR = 0.1  # Difference of the winds below which there is nothing to choose [m/s]


class AbstractShading(Checked):
    """Rule that gives the share of the light that a flyer lets in. Subclasses are final."""

    @abc.abstractmethod
    def light(self, moment: Moment) -> Numeric:
        """Share of the light, of its reflection too [1]."""

    def remarks(self, moment: Moment) -> tuple[str, ...]:
        """What to warn of at the release; numbers are concrete."""
        del moment
        return ()

    @abc.abstractmethod
    def describe(self) -> str:
        """The rule in a few words."""


class HoldAltitude(AbstractShading):
    """Let in all light below an altitude, none above.

    Attributes
    ----------
    altitude : array
        Half of the light is let in there [m].
    width : array
        Of the layer in which the light goes from all to none [m].
    """

    altitude: Altitude
    width: GroundDistance = 1e3

    def light(self, moment: Moment) -> Numeric:
        return _let_in(moment, self.altitude, self.width)

    def describe(self) -> str:
        return f"shaded above {float(self.altitude) / 1e3:g} km"


class ChooseWind(AbstractShading):
    r"""Hold the altitude whose wind brings a flyer closest to a station.

    If :math:`d` is the way to the station and :math:`w(h)` the wind that is stated for an
    altitude, the flyer would miss the station by :math:`|d - w(h)\,t|` after a time :math:`t`. It
    makes for the mean of 21 altitudes, each weighted by how much less it misses.

    Attributes
    ----------
    station : Circle
    lowest, highest : array
        Between which altitudes it chooses [m].
    ahead : array
        The time :math:`t` [s].
    width : array
        As of :class:`HoldAltitude` [m].

    Notes
    -----
    It knows the wind as the environment states it, without the errors of an ensemble. Between two
    altitudes that are equally good it makes for the middle.
    """

    station: Circle
    lowest: Altitude
    highest: Altitude
    ahead: Duration = _HOURS
    width: GroundDistance = 1e3

    @staticmethod
    def contradiction(lowest: Numeric, highest: Numeric) -> Contradictions:
        yield lowest >= highest, "highest of the winds to choose from must be above lowest"

    def light(self, moment: Moment) -> Numeric:
        return _let_in(moment, self.wanted(moment), self.width)

    def remarks(self, moment: Moment) -> tuple[str, ...]:
        wind = moment.wind_at(np.asarray(self._altitudes()))
        if max(np.ptp(wind.east), np.ptp(wind.north)) >= _SHEAR:
            return ()
        return (
            "the wind is the same at all altitudes to choose from: none leads nearer to the "
            "station, and the flyer is held in their middle",
        )

    def _altitudes(self) -> Array:
        return self.lowest + (self.highest - self.lowest) * xp.linspace(0.0, 1.0, _LEVELS)

    def wanted(self, moment: Moment) -> Array:
        """Altitude that it makes for [m]."""
        altitudes = self._altitudes()
        altitudes = altitudes.reshape(-1, *(1,) * xp.ndim(moment.altitude))
        wind = moment.wind_at(altitudes)
        east, north = moment.way_to(self.station)
        missed = xp.hypot(east - wind.east * self.ahead, north - wind.north * self.ahead)
        weights = xp.exp(-(missed - xp.min(missed, axis=0)) / _ALIKE)
        return xp.sum(weights * altitudes, axis=0) / xp.sum(weights, axis=0)

    def describe(self) -> str:
        low, high = float(self.lowest) / 1e3, float(self.highest) / 1e3
        return (
            f"shaded so as to be where the wind of {low:g} to {high:g} km leads closest to "
            f"{self.station.middle} in {float(self.ahead) / _HOURS:g} h"
        )


class Shaded(AbstractAttitudeRule):
    """A rule of attitude together with one of shading.

    Attributes
    ----------
    shading : AbstractShading
    rule : AbstractAttitudeRule
        How the flyer lies.

    Examples
    --------
    >>> import lightflyer as lf
    >>> lf.mission.Shaded(lf.mission.HoldAltitude("72 km")).describe()
    'level; shaded above 72 km'
    """

    shading: AbstractShading
    rule: AbstractAttitudeRule = field(default_factory=Level)

    @property
    def tilts(self) -> bool:
        return self.rule.tilts

    def attitude(self, moment: Moment) -> Attitude | None:
        return self.rule.attitude(moment)

    def remarks(self, moment: Moment) -> tuple[str, ...]:
        return self.rule.remarks(moment) + self.shading.remarks(moment)

    def light(self, moment: Moment) -> Numeric | None:
        return self.shading.light(moment)

    def describe(self) -> str:
        return f"{self.rule.describe()}; {self.shading.describe()}"


def _let_in(moment: Moment, wanted: Numeric, width: Numeric) -> Array:
    """Share of the light about an altitude: smooth, so that steps of an integration may be long."""
    below = xp.clip(0.5 + (wanted - moment.altitude) / width, 0.0, 1.0)
    return below**2 * (3.0 - 2.0 * below)
