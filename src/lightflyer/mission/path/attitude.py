"""How a flyer lies during a mission: rules that give its attitude from what they see."""

import abc
from typing import Any

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Numeric, xp
from lightflyer.array.records import Module
from lightflyer.core.quantity import RADIANS_PER_DEGREE, Checked, Fraction, LargestTilt
from lightflyer.environment.base import AbstractEnvironment, Place, Wind
from lightflyer.environment.radiation import Attitude, Radiation
from lightflyer.mission.areas import Circle
from lightflyer.mission.path.position import angles_towards

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
        """Way along the ground to the middle of a station, eastward and northward [m]."""
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
