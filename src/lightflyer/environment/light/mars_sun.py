r"""The sun of Mars by date, its season, and its distance.

Seasons go by the areocentric longitude of the sun, :math:`L_s`: 0° at the northern spring equinox,
90° at the northern summer solstice.
"""

from typing import Final

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import RADIANS_PER_DEGREE
from lightflyer.environment.light.sun import (
    SECONDS_PER_DAY,
    TERRESTRIAL_MINUS_UNIVERSAL,
    AbstractSun,
    SunPosition,
)
from lightflyer.environment.planet import MARS_ECCENTRICITY, MARS_SEMI_MAJOR_AXIS

PERIHELION: Final = 251.0
"""Areocentric longitude of the sun at perihelion, about 2000 [deg]; [AllisonMcEwen2000]_."""

OBLIQUITY_SINE: Final = 0.42565
"""Sine of the angle between equator and orbit of Mars [1]; [AllisonMcEwen2000]_ Eq. (D1)."""

NOON: Final = 12.0
"""Local true solar time at which the sun stands highest [h]; a sol has 24 of these hours."""

# [AllisonMcEwen2000] Eqs. (16)-(22): of days since 2000-01-01 12:00 terrestrial time, [deg]
_ANOMALY = (19.3871, 0.52402073)
_MEAN_SUN = (270.3871, 0.524038496)
_CENTRE, _CENTRE_RATE = (10.691, 0.623, 0.050, 0.005, 0.0005), 3.0e-7
_PERTURBATION_RATE = 0.985626
# amplitude [deg], period [Julian years], phase [deg]
_PERTURBATIONS = np.array([
    (0.0071, 2.2353, 49.409),
    (0.0057, 2.7543, 168.173),
    (0.0039, 1.1177, 191.837),
    (0.0037, 15.7866, 21.736),
    (0.0021, 2.1354, 15.704),
    (0.0020, 2.4694, 95.528),
    (0.0018, 32.8493, 49.095),
])  # fmt: skip
_EQUATION_OF_TIME = (2.861, -0.071, 0.002)  # sines of two, four and six times the longitude [deg]
_DISTANCE = (1.00436, -0.09309, -0.004336, -0.00031, -0.00003)  # cosines of the anomaly
_MIDNIGHT, _MIDNIGHT_DAYS = 44_796.0 - 0.0009626, 4.5  # sols at a day, at the prime meridian
_DAYS_PER_SOL = 1.0274912517
_HALF_TURN = 180.0


class MarsSun(AbstractSun):
    """The sun of Mars; see :func:`sun_from_mars`."""

    def position(self, time: Numeric) -> SunPosition:
        return sun_from_mars(time)


@entry_point
def solar_longitude(time: Numeric) -> Array:
    """Areocentric longitude of the sun, which tells the season of Mars [rad]; 0 to 2π."""
    # Source: [AllisonMcEwen2000]_, with the coefficients of its later revision.
    longitude, _, _ = _season(_days(time))
    return xp.mod(longitude, 2.0 * np.pi)


@entry_point
def sun_from_mars(time: Numeric) -> SunPosition:
    """Direction and distance of the sun from the centre of Mars."""
    # Within 0.03° and 2e-4 of the distance between 2000 and 2050, most of it because UTC has leap
    # seconds. Differentiable.
    #
    # Source: [AllisonMcEwen2000]_, with the coefficients of its later revision.
    days = _days(time)
    longitude, anomaly, centre = _season(days)
    sols = (days - _MIDNIGHT_DAYS) / _DAYS_PER_SOL + _MIDNIGHT
    east = _HALF_TURN * RADIANS_PER_DEGREE - 2.0 * np.pi * sols  # of the mean sun
    east = east - _sines(_EQUATION_OF_TIME, 2.0 * longitude) + centre
    height = OBLIQUITY_SINE * xp.sin(longitude)
    level = xp.sqrt(1.0 - height**2)
    direction = xp.stack([level * xp.cos(east), level * xp.sin(east), height], axis=-1)
    cosines = (part * xp.cos(order * anomaly) for order, part in enumerate(_DISTANCE))
    distance = MARS_SEMI_MAJOR_AXIS * sum(cosines, xp.zeros_like(anomaly))
    return SunPosition(direction, distance * constants.ASTRONOMICAL_UNIT)


def _days(time: Numeric) -> Array:
    return xp.asarray((time + TERRESTRIAL_MINUS_UNIVERSAL) / SECONDS_PER_DAY)


def _season(days: Array) -> tuple[Array, Array, Array]:
    """Longitude of the sun, mean anomaly, and true less mean anomaly [rad]."""
    anomaly, mean_sun = (
        (first + rate * days) * RADIANS_PER_DEGREE for first, rate in (_ANOMALY, _MEAN_SUN)
    )
    amplitude, period, phase = _PERTURBATIONS.T
    angle = (_PERTURBATION_RATE * days[..., None] / period + phase) * RADIANS_PER_DEGREE
    perturbed = xp.sum(amplitude * xp.cos(angle), axis=-1) * RADIANS_PER_DEGREE
    growth = _CENTRE_RATE * days * RADIANS_PER_DEGREE * xp.sin(anomaly)
    centre = _sines(_CENTRE, anomaly) + growth + perturbed
    return mean_sun + centre, anomaly, centre


def _sines(amplitudes: tuple[float, ...], angle: Array) -> Array:
    """Sum of sines of multiples of an angle, amplitudes in degrees [rad]."""
    parts = (part * xp.sin(order * angle) for order, part in enumerate(amplitudes, start=1))
    return RADIANS_PER_DEGREE * sum(parts, xp.zeros_like(angle))


@entry_point
def distance_in_season(longitude: Numeric) -> Array:
    """Distance of Mars from the sun by season [au]."""
    # .. math:: r = \frac{a(1-e^2)}{1 + e\cos(L_s - L_p)}
    past_perihelion = longitude - PERIHELION * RADIANS_PER_DEGREE
    focal = MARS_SEMI_MAJOR_AXIS * (1.0 - MARS_ECCENTRICITY**2)
    return focal / (1.0 + MARS_ECCENTRICITY * xp.cos(past_perihelion))


@entry_point
def zenith_angle_in_season(longitude: Numeric, latitude: Numeric, hour: Numeric) -> Array:
    """Angle between sun and vertical by season, latitude and local true solar time [rad]."""
    sine = OBLIQUITY_SINE * xp.sin(longitude)
    turned = (hour - NOON) / NOON * np.pi
    across = xp.cos(latitude) * xp.sqrt(1.0 - sine**2) * xp.cos(turned)
    return xp.arccos(xp.clip(xp.sin(latitude) * sine + across, -1.0, 1.0))
