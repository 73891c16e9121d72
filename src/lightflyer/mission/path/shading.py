r"""A flyer that lets in less light than there is, to hold an altitude or to choose its wind.

A film whose absorptance can be turned down, or a blind before it, steers a flyer up and down. The
share of the light that it lets in goes smoothly from one to zero about the altitude that is wanted.
Heat radiation is not held off, so that shade is not night: a film may still be lifted by what it
takes from below.
"""

import abc

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import field
from lightflyer.core.quantity import Altitude, Checked, Duration, GroundDistance
from lightflyer.environment.radiation import Attitude
from lightflyer.mission.areas import Circle
from lightflyer.mission.path.attitude import AbstractAttitudeRule, Level, Moment

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
    def contradiction(lowest: Numeric, highest: Numeric) -> str | None:
        if np.all(lowest < highest):
            return None
        return "highest of the winds to choose from must be above lowest"

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
